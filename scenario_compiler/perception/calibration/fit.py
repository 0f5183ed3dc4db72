"""The logistic fit and how well its probabilities come true."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

BINS = (0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0)
"""Borders of the reliability table."""


@dataclass(frozen=True)
class Reliability:
    """How probabilities compare with what happened.

    Attributes:
        count: Number of boundaries.
        accuracy: Share in which p > 0.5 said the right thing.
        area: Area under the receiver operating characteristic.
        brier: Mean squared difference of probability and outcome.
        bins: (from, to, boundaries, mean probability, observed frequency).
        largest_error: Largest difference of the last two over the bins with at least 30 boundaries.
    """

    count: int
    accuracy: float
    area: float
    brier: float
    bins: list[tuple[float, float, int, float, float]]
    largest_error: float


def fit_logistic(rows: Floats, outcomes: Floats, ridge: float = 0.3) -> Floats:
    """Return the weights of a logistic regression by Newton's method, with a ridge penalty.

    Args:
        rows: (n, features).
        outcomes: (n,) 0 or 1.
        ridge: Penalty on the squared weights, halved.
    """
    weights = np.zeros(rows.shape[1])
    for _ in range(100):
        p = _logistic(rows @ weights)
        gradient = rows.T @ (outcomes - p) - ridge * weights
        curvature = (rows * (p * (1.0 - p))[:, None]).T @ rows + ridge * np.eye(rows.shape[1])
        step = np.linalg.solve(curvature, gradient)
        weights += step
        if float(np.abs(step).max()) < 1e-8:
            break
    return weights


def cross_validated(rows: Floats, outcomes: Floats, groups: NDArray[np.int64], folds: int = 5) -> Floats:
    """Return probabilities (n,), each by weights fitted without its fold; a group (a frame) is never split."""
    p = np.empty(len(rows))
    for fold in range(folds):
        held = groups % folds == fold
        p[held] = _logistic(rows[held] @ fit_logistic(rows[~held], outcomes[~held]))
    return p


def reliability(p: Floats, outcomes: Floats) -> Reliability:
    """Return how the probabilities p (n,) compare with the outcomes (n,)."""
    ranks = np.empty(len(p))
    ranks[np.argsort(p, kind="stable")] = np.arange(1, len(p) + 1)
    right = outcomes > 0.5
    yes, no = int(right.sum()), int((~right).sum())
    bins = []
    for low, high in pairwise(BINS):
        inside = (p >= low) & ((p < high) | (high == BINS[-1]))
        if inside.any():
            bins.append((low, high, int(inside.sum()), float(p[inside].mean()), float(outcomes[inside].mean())))
    return Reliability(
        count=len(p),
        accuracy=float(((p > 0.5) == right).mean()),
        area=float((ranks[right].sum() - yes * (yes + 1) / 2) / max(yes * no, 1)),
        brier=float(((p - outcomes) ** 2).mean()),
        bins=bins,
        largest_error=max(abs(mean - seen) for _, _, count, mean, seen in bins if count >= 30),
    )


def _logistic(total: Floats) -> Floats:
    return np.asarray(1.0 / (1.0 + np.exp(-np.clip(total, -30.0, 30.0))))
