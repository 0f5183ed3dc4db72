"""Fits the confidence, and measures the reliability of probabilities."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from scenario_compiler.perception.confidence import FARTHEST, Confidence, Fitting

Floats = NDArray[np.float64]

BINS = tuple(k / 10 for k in range(11))
"""Borders of the reliability table."""

COUNTED = 100
"""Least number of observations for a bin to count."""

HIDDEN, OUTPUTS = 32, 3
"""Hidden units of one fit, and outputs."""

STEPS = 400
"""Greatest number of steps of the fit."""


def fit_confidence(rows: Floats, labels: Floats, fitting: Fitting, weight: Floats | None = None) -> Confidence:
    """Return the mean of several confidences with the least cross-entropy over observations.

    They start from other weights, and their logits are averaged: the mean is less wrong than one fit on other roads.

    Args:
        rows: (N, F) features.
        labels: (N, 3) whether the geometry was right, paint was there, and both, as 0 or 1.
        fitting: The penalty, and the number of fits.
        weight: (N,) weight of each observation; equal if None.
    """
    fits = [_fit(rows, labels, fitting.penalty, weight, 1 + number) for number in range(fitting.fits)]
    hidden = np.concatenate([one.hidden for one in fits])
    of_hidden = np.concatenate([one.out[:, :HIDDEN] for one in fits], axis=1) / len(fits)
    of_features = sum((one.out[:, HIDDEN:] for one in fits), np.zeros_like(fits[0].out[:, HIDDEN:])) / len(fits)
    return Confidence(fits[0].middle, fits[0].scale, hidden, np.concatenate([of_hidden, of_features], axis=1))


def _fit(rows: Floats, labels: Floats, penalty: float, weight: Floats | None, seed: int) -> Confidence:
    """Return the confidence with the least cross-entropy (L-BFGS from weights drawn with `seed`)."""
    count, size = rows.shape
    middle, scale = rows.mean(axis=0), np.maximum(rows.std(axis=0), 1e-3)
    known = np.clip((rows - middle) / scale, -FARTHEST, FARTHEST).astype(np.float32)
    labels = labels.astype(np.float32)
    share = (np.full(count, 1.0 / count) if weight is None else weight / weight.sum()).astype(np.float32)
    draw = np.random.default_rng(seed)
    start = np.concatenate([
        draw.normal(0.0, 0.3 / np.sqrt(size), HIDDEN * (size + 1)), np.zeros(OUTPUTS * (HIDDEN + size + 1))
    ])  # fmt: skip
    cut = HIDDEN * (size + 1)

    def loss(parameters: Floats) -> tuple[float, Floats]:
        single = parameters.astype(np.float32)
        hidden, out = single[:cut].reshape(HIDDEN, size + 1), single[cut:].reshape(OUTPUTS, -1)
        inner = np.tanh(known @ hidden[:, :-1].T + hidden[:, -1])
        both = np.concatenate([inner, known], axis=1)
        total = both @ out[:, :-1].T + out[:, -1]
        p = 1.0 / (1.0 + np.exp(-np.clip(total, -30.0, 30.0)))
        value = float((share[:, None] * (np.logaddexp(0.0, total) - labels * total)).sum())
        wrong = share[:, None] * (p - labels)
        back = (wrong @ out[:, :HIDDEN]) * (1.0 - inner * inner)
        gradient = np.concatenate([
            np.concatenate([back.T @ known, back.sum(axis=0)[:, None]], axis=1).ravel(),
            np.concatenate([wrong.T @ both, wrong.sum(axis=0)[:, None]], axis=1).ravel(),
        ])  # fmt: skip
        value += penalty * float(parameters @ parameters)
        return value, gradient.astype(np.float64) + 2.0 * penalty * parameters

    found = minimize(loss, start, jac=True, method="L-BFGS-B", options={"maxiter": STEPS})
    best = np.asarray(found.x)
    return Confidence(middle, scale, best[:cut].reshape(HIDDEN, size + 1), best[cut:].reshape(OUTPUTS, -1))


@dataclass(frozen=True)
class Reliability:
    """Comparison of probabilities with outcomes.

    Attributes:
        count: Number of observations.
        area: Area under the receiver operating characteristic; NaN if all outcomes were equal.
        brier: Mean squared difference of probability and outcome.
        expected_error: Mean over the observations of the difference between a bin's probability and frequency.
        largest_error: Largest such difference over the bins with at least `COUNTED` observations.
        bins: (from, to, observations, mean probability, observed frequency).
    """

    count: int
    area: float
    brier: float
    expected_error: float
    largest_error: float
    bins: tuple[tuple[float, float, int, float, float], ...]


def reliability(p: Floats, outcomes: Floats) -> Reliability:
    """Return how the probabilities p (N,) compare with the outcomes (N,)."""
    right = outcomes > 0.5
    bins = []
    for low, high in pairwise(BINS):
        inside = (p >= low) & ((p < high) | (high == BINS[-1]))
        if inside.any():
            bins.append((low, high, int(inside.sum()), float(p[inside].mean()), float(outcomes[inside].mean())))
    return Reliability(
        count=len(p),
        area=area_under_curve(p, right),
        brier=float(((p - outcomes) ** 2).mean()),
        expected_error=sum(count * abs(mean - seen) for _, _, count, mean, seen in bins) / len(p),
        largest_error=max((abs(mean - seen) for _, _, count, mean, seen in bins if count >= COUNTED), default=0.0),
        bins=tuple(bins),
    )


def area_under_curve(p: Floats, right: NDArray[np.bool_]) -> float:
    """Return the share of pairs of a right and a wrong one that p orders correctly; ties count half."""
    from scipy.stats import rankdata

    yes, no = int(right.sum()), int((~right).sum())
    if not yes or not no:
        return float("nan")
    return float((rankdata(p)[right].sum() - yes * (yes + 1) / 2) / (yes * no))
