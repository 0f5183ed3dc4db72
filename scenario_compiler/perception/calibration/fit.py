"""Fits the confidence, and measures the reliability of probabilities."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.confidence import Confidence, Tree

Floats = NDArray[np.float64]

BINS = tuple(k / 10 for k in range(11))
"""Borders of the reliability table."""

COUNTED = 100
"""Least number of observations for a bin to count."""

REPEATED, ONE_OF_TEN = 400, 0.9
"""Number of measurements that are drawn to know what chance does, and the share of them below the stated error."""

TREES, MOST_BINS = 500, 128
"""Number of trees, and of the intervals of each feature between which their thresholds lie."""

SETTINGS = {
    "objective": "binary:logistic",
    "multi_strategy": "multi_output_tree",
    "tree_method": "hist",
    "grow_policy": "lossguide",
    "max_bin": MOST_BINS,
    "max_leaves": 31,
    "max_depth": 8,
    "eta": 0.05,
    "subsample": 0.5,
    "colsample_bytree": 0.4,
    "min_child_weight": 30,
    "lambda": 5,
    "seed": 1,
    "nthread": 1,
}
"""How XGBoost fits them, in one thread, so that sums have one order.

They were chosen by the cross-entropy on 46 road files, a quarter of them left out at a time: 0.195 while driving, 0.217
on first images. With more and deeper trees it was the same, with 220 trees of depth 5 0.201 and 0.227.
"""

BORDER, VALUE = 4, 3
"""Decimal places of the trees' thresholds and values."""


def fit_confidence(rows: Floats, labels: Floats, weight: Floats | None = None) -> Confidence:
    """Return the confidence that XGBoost fits to observations (T. Chen and C. Guestrin, arXiv 1603.02754).

    Args:
        rows: (N, F) features.
        labels: (N, 3) whether the geometry was right, paint was there, and both, as 0 or 1.
        weight: (N,) weight of each observation; equal if None.

    Raises:
        ModuleNotFoundError: XGBoost is not installed.
    """
    import xgboost

    share = np.ones(len(rows)) if weight is None else weight / weight.mean()
    mean = np.clip(np.average(labels, axis=0, weights=share), 0.001, 0.999)
    start = np.round(np.log(mean / (1.0 - mean)), VALUE)
    margin = np.tile(start, (len(rows), 1))
    data = xgboost.QuantileDMatrix(rows, labels, weight=share, base_margin=margin, max_bin=MOST_BINS, nthread=1)
    fitted = xgboost.train(SETTINGS, data, TREES)
    return Confidence.of(start.tolist(), (_tree(json.loads(one)) for one in fitted.get_dump(dump_format="json")))


def _tree(root: dict[str, Any]) -> Tree:
    """Return a tree of XGBoost's textual dump.

    Thresholds are numbers that occurred, and belong to the node behind them; so they are rounded down.
    """
    feature, threshold, value = [], [], []
    level = [root]
    for node in level:
        if "leaf" in node:
            feature.append(-1)
            value.append([round(one, VALUE) for one in node["leaf"]])
        else:
            feature.append(int(node["split"].removeprefix("f")))
            threshold.append(math.floor(node["split_condition"] * 10**BORDER) / 10**BORDER)
            behind = {one["nodeid"]: one for one in node["children"]}
            level += [behind[node["yes"]], behind[node["no"]]]
    return Tree(feature, threshold, value)


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
    right, place = outcomes > 0.5, _bin_of(p)
    bins = []
    for number, (low, high) in enumerate(pairwise(BINS)):
        inside = place == number
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


def largest_by_chance(p: Floats, outcomes: Floats, clips: NDArray[np.int64]) -> float:
    """Return the error of a bin that the largest one of a flawless confidence exceeds in one of ten such measurements.

    The observations of a clip resemble each other, so whole clips are drawn, with replacement (B. Efron, The Annals of
    Statistics 7, 1979). What is left of the outcomes without the mean error of their bin stands for chance.

    Args:
        p: (N,) probabilities.
        outcomes: (N,) outcomes, as 0 or 1.
        clips: (N,) numbers; neighbours with the same number are of one clip.
    """
    place = _bin_of(p)
    count = np.bincount(place, minlength=len(BINS) - 1)
    counted = np.flatnonzero(count >= COUNTED)
    if not len(counted):
        return 0.0
    clip = np.cumsum(np.append(False, np.diff(clips) != 0))
    error = outcomes - p
    error = error - (np.bincount(place, error, len(count)) / np.maximum(count, 1))[place]
    shape = int(clip[-1]) + 1, len(count)
    errors, many = (
        np.bincount(clip * len(count) + place, weight, shape[0] * shape[1]).reshape(shape)[:, counted]
        for weight in (error, np.ones_like(error))
    )
    draw = np.random.default_rng(1)
    drawn = draw.multinomial(shape[0], np.full(shape[0], 1.0 / shape[0]), REPEATED)
    return float(np.quantile(np.abs((drawn @ errors) / np.maximum(drawn @ many, 1.0)).max(axis=1), ONE_OF_TEN))


def _bin_of(p: Floats) -> NDArray[np.int64]:
    """Return the number of the bin of each probability (N,); 1 is in the last one."""
    return np.asarray(np.clip(np.searchsorted(BINS, p, side="right") - 1, 0, len(BINS) - 2), np.int64)


def area_under_curve(p: Floats, right: NDArray[np.bool_]) -> float:
    """Return the share of pairs of a right and a wrong one that p orders correctly; ties count half."""
    from scipy.stats import rankdata

    yes, no = int(right.sum()), int((~right).sum())
    if not yes or not no:
        return float("nan")
    return float((rankdata(p)[right].sum() - yes * (yes + 1) / 2) / (yes * no))
