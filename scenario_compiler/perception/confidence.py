"""How far a detected boundary can be trusted: a calibrated probability, and apart from it the sensor's health.

`p_geom` is the probability that the boundary lies within 0.25 m of the true one from 6 to 18 m ahead and that its
paint can be seen there (quality times the contrast that the weather leaves is over 0.15 on more than 60 % of that
stretch). It is a logistic function of `features`, fitted on rendered roads: radii from 100 m, lanes of 2.9 to 4 m,
solid and broken lines, all wear, all CARLA weathers, noise up to 90 grey levels, kerbs, seams, other cars. Weights,
table and errors are in `lane_confidence.json` beside this module, made by
`python -m scenario_compiler.perception.calibration`. In short, mean over both sides of single frames:

    paint quality   1.0  0.98   0.6  0.95   0.4  0.88   0.3  0.82   0.2  0.71   0.1  0.31   0.0  0.05
    noise sigma       0  0.98     5  0.98    20  0.91    25  0.76    30  0.50    40  0.09    60  0.00  (health included)
    weather         WetNoon 0.98   HardRainNoon 0.91   MidRainSunset 0.92   HardRainSunset 0.05   ClearNight 0.97

Stated error: by frame-disjoint cross-validation over 8000 boundaries the mean probability of a bin differs from the
observed frequency by 0.05 at most (accuracy 0.93, area under the curve 0.98, Brier score 0.049). Without any paint
both sides are below 0.3 in 87 % of single frames; kerbs and rims of the asphalt make the rest. Trained, calibrated and
tested with one renderer, the figures say nothing about photographs.

The health falls with the noise that is measured in the image, as `engine.camera_health` says: policy, not measurement,
for the geometry stays right under far more noise. What else can be wrong with a camera is seen by `sensor_health`.
sigma_hat is Immerkaer's estimate (Computer Vision and Image Understanding 64, 1996) with a median in place of the
mean, so that edges, paint and rain do not count.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.birds_eye import X_STEP, Ridges
from scenario_compiler.perception.lane_fit import Fit

FEATURES = (
    "one",
    "prominence",
    "painted",
    "residual",
    "contrast",
    "support",
    "row_scale",
    "width_off",
    "along",
    "along_squared",
    "stretch",
    "contrast_along",
    "green",
    "blind",
    "painted_squared",
    "residual_painted",
)
"""Names of the features, in the order of the weights."""

_SECOND = np.array([1, -2, 1], np.float32)
"""The second difference. Taken along and across, it is the difference of two Laplacians that Immerkaer uses."""

_LARGEST, _STRIP = 8 * 255, 64
"""Greatest response to it, and rows that are looked at together: little memory is quick memory."""


@dataclass(frozen=True)
class Calibration:
    """The weights of the logistic function, one a feature, and what they were found to be worth.

    Attributes:
        weights: One for each of `FEATURES`.
        error: Largest difference of mean probability and observed frequency over the table's reliability
            bins.
        by_quality: (paint quality, mean p_geom over both sides) on clear days.
        by_sigma: (noise in grey levels, mean p) with new paint on clear days, health included.
        neither_without_paint: Share of frames without any paint in which both sides are below 0.3.
    """

    weights: tuple[float, ...]
    error: float
    by_quality: tuple[tuple[float, float], ...]
    by_sigma: tuple[tuple[float, float], ...]
    neither_without_paint: float


@lru_cache(maxsize=1)
def load_calibration() -> Calibration:
    """Return the calibration that ships with the package."""
    text = resources.files("scenario_compiler.perception").joinpath("lane_confidence.json").read_text("utf-8")
    data = json.loads(text)
    if tuple(data["features"]) != FEATURES:
        raise RuntimeError("lane_confidence.json was made for other features; run the calibration again")
    return Calibration(
        weights=tuple(float(w) for w in data["weights"]),
        error=float(data["reliability"]["largest_error"]),
        by_quality=tuple((float(q), float(p)) for q, p in data["by_quality"]),
        by_sigma=tuple((float(s), float(p)) for s, p in data["by_sigma"]),
        neither_without_paint=float(data["neither_without_paint"]),
    )


def features(fit: Fit, ridges: Ridges, width_off: float) -> NDArray[np.float64]:
    """Return the features of one side, (len(FEATURES),).

    Args:
        fit: The side's boundary.
        ridges: The image it was found in.
        width_off: Distance of the lane's width from the expected one, m.
    """
    near = slice(0, round(15.0 / X_STEP))
    window = np.ones(4) / 4.0
    run = np.convolve(np.minimum(fit.on_curve, 5.0)[near], window, mode="valid")
    bright = np.convolve(fit.contrast[near], window, mode="valid")
    best = np.sort(run)[-16:].mean()
    longest = _longest_run(fit.on_curve[near] > 1.2) * X_STEP
    return np.array(
        [
            1.0,
            math.log(max(fit.prominence, 0.1)),
            fit.painted,
            5.0 * fit.residual,
            math.log1p(float(np.sort(fit.contrast[near])[-20:].mean()) / 10.0),
            0.1 * fit.support,
            math.log(float(ridges.scale.mean())),
            min(max(abs(width_off) - 0.4, 0.0), 0.8),
            float(best),
            float(best * best) / 5.0,
            math.log1p(longest),
            math.log1p(float(np.sort(bright)[-16:].mean()) / 10.0),
            min(max(fit.green, 0.0), 30.0) / 10.0,
            min(max(fit.nearest - 8.0, 0.0), 12.0) / 4.0,
            fit.painted * fit.painted,
            5.0 * fit.residual * fit.painted,
        ]
    )


def probability(row: NDArray[np.float64], weights: tuple[float, ...]) -> float:
    """Return the logistic function of the features `row` under `weights`."""
    total = float(row @ np.asarray(weights))
    return 1.0 / (1.0 + math.exp(-min(max(total, -30.0), 30.0)))


def noise_of(image: NDArray[np.uint8]) -> float:
    """Return sigma_hat, the noise of a BGR image in grey levels (see the module's docstring)."""
    counts = np.zeros(_LARGEST + 1, np.int64)
    for top in range(0, image.shape[0] - 2, _STRIP):
        part = cv2.extractChannel(image[top : top + _STRIP + 2], 1)
        response = cv2.sepFilter2D(part, cv2.CV_16S, _SECOND, _SECOND)
        counts += np.bincount(np.abs(response[1:-1:2, 1:-1:2]).ravel(), minlength=_LARGEST + 1)
    below = np.cumsum(counts)
    middle = np.searchsorted(below, ((int(below[-1]) - 1) // 2, int(below[-1]) // 2), side="right")
    return float(middle.mean()) / (6.0 * 0.67448975)


def _longest_run(flags: NDArray[np.bool_]) -> int:
    longest = current = 0
    for flag in flags.tolist():
        current = current + 1 if flag else 0
        longest = max(longest, current)
    return longest
