"""The confidence in a detected boundary: calibrated probabilities, and separately the sensor's health.

The probabilities are those that the geometry is right, that paint is there, and of both (see `lane_detector.Boundary`).
They are functions of `features`, computed by a network with one hidden layer that `calibration.fit` fits to rendered
clips of maps and of artificial roads. `scenario-compiler calibrate` measures their reliability and writes
docs/perception.md.

The health falls with the noise that is measured in the image, as defined in `engine.camera_health`. This is policy, not
measurement, because the geometry stays right under far more noise. Other faults of a camera are detected by
`sensor_health`. sigma_hat is Immerkaer's estimate (Computer Vision and Image Understanding 64, 1996) with a median
instead of the mean, so that edges, paint and rain do not count.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, fields
from functools import lru_cache
from importlib import resources

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.birds_eye import X_STEP, Ridges
from scenario_compiler.perception.lane_fit import STANDS_OUT, Fit

Floats = NDArray[np.float64]

FARTHEST = 4.0
"""Number of standard deviations from its mean at which a feature is clipped."""

FEATURES = (
    *("prominence", "painted", "residual", "contrast", "support", "row_scale", "width_off", "along", "stretch"),
    *("contrast_along", "green", "blind", "reach", "curvature", "offset", "slope_deviation", "near", "far"),
    *("inner_rival", "outer_rival", "tilt", "tilt_deviation", "moved", "remembered", "way"),
    *("other_prominence", "other_along", "other_slope_deviation", "other_far", "apart_slope", "apart_curvature"),
)
"""Names of the features, in order."""

_HALVES = slice(round(1.0 / X_STEP), round(7.0 / X_STEP)), slice(round(7.0 / X_STEP), round(13.0 / X_STEP))
"""Rows from 6 to 12 m and from 12 to 18 m ahead of the camera."""

_SECOND = np.array([1, -2, 1], np.float32)
"""The second difference. Taken along and across, it is the difference of two Laplacians that Immerkaer uses."""

_LARGEST, _STRIP = 8 * 255, 64
"""Greatest response to it, and the number of rows that are processed together, which keeps the memory small and fast.
"""


@dataclass(frozen=True, eq=False)
class Confidence:
    """Three probabilities as functions of the features: a network with one layer of H hidden units.

    Attributes:
        middle: (F,) mean of each feature in the fit.
        scale: (F,) its standard deviation.
        hidden: (H, F + 1) weights of the hidden units (tanh), the last of each its bias.
        out: (3, H + F + 1) weights of the three outputs (logistic): of the hidden units, the features, the bias.
    """

    middle: Floats
    scale: Floats
    hidden: Floats
    out: Floats

    def __call__(self, row: Floats) -> tuple[float, float, float]:
        """Return the probabilities that the geometry is right, that paint is there, and of both, for one side."""
        geometry, paint, both = self.all(row[None])[0].tolist()
        return geometry, paint, both

    def all(self, rows: Floats) -> Floats:
        """Return the probabilities (N, 3) of features (N, F)."""
        known = np.clip((rows - self.middle) / self.scale, -FARTHEST, FARTHEST)
        inner = np.tanh(known @ self.hidden[:, :-1].T + self.hidden[:, -1])
        total = np.concatenate([inner, known], axis=1) @ self.out[:, :-1].T + self.out[:, -1]
        return np.asarray(1.0 / (1.0 + np.exp(-np.clip(total, -30.0, 30.0))))


@lru_cache(maxsize=4)
def load_confidence(file: str, names: tuple[str, ...]) -> Confidence:
    """Return a packaged confidence from its file, which must have the features with these names."""
    data = json.loads(resources.files("scenario_compiler.perception").joinpath(file).read_text("utf-8"))
    if tuple(data["features"]) != names:
        raise RuntimeError(f"{file} was made for other features; run `scenario-compiler calibrate --fit`")
    return Confidence(*(np.array(data[one.name]) for one in fields(Confidence)))


def confidence_text(confidence: Confidence, names: tuple[str, ...]) -> str:
    """Return the text of the file for a confidence over the features with these names."""
    numbers = {one.name: np.round(getattr(confidence, one.name), 4).tolist() for one in fields(Confidence)}
    return json.dumps({"features": names, **numbers}, indent=None, separators=(",", ":")).replace("],", "],\n") + "\n"


@dataclass(frozen=True)
class Circumstances:
    """What is known in addition to an image's ridges and arcs.

    Attributes:
        width_off: Difference of the lane's width from the expected one, m.
        tilt: The detected tilt, rad, and its deviation.
        moved: Distance of the side, 12 m ahead, from its remembered position, m; None without memory.
        way: Whether the planned route was given.
    """

    width_off: float
    tilt: tuple[float, float]
    moved: float | None
    way: bool


def features(fit: Fit, other: Fit, ridges: Ridges, known: Circumstances) -> NDArray[np.float64]:
    """Return the features of one side, (len(FEATURES),), all of the order of 1."""
    near = slice(0, round(15.0 / X_STEP))
    window = np.ones(4) / 4.0
    bright = np.convolve(fit.contrast[near], window, mode="valid")
    longest = _longest_run(fit.on_curve[near] > 1.2) * X_STEP
    apart = fit.curve - other.curve
    return np.array(
        [
            math.log(max(fit.prominence, 0.1)),
            fit.painted,
            5.0 * fit.residual,
            math.log1p(float(np.sort(fit.contrast[near])[-20:].mean()) / 10.0),
            0.1 * fit.support,
            math.log(float(ridges.scale.mean())),
            min(max(abs(known.width_off) - 0.2, 0.0), 1.0),
            _along(fit),
            math.log1p(longest),
            math.log1p(float(np.sort(bright)[-16:].mean()) / 10.0),
            min(max(fit.green, 0.0), 30.0) / 10.0,
            min(max(fit.nearest - 6.0, 0.0), 12.0) / 4.0,
            fit.farthest / 10.0,
            40.0 * abs(float(fit.curve[2])),
            min(max(abs(float(fit.curve[0])) - 1.75, -1.0), 1.5),
            _log_deviation(fit),
            *(float((fit.on_curve[rows] > STANDS_OUT).mean()) for rows in _HALVES),
            *(0.1 * (fit.support - rival) for rival in fit.rivals),
            20.0 * abs(known.tilt[0]),
            60.0 * known.tilt[1],
            0.0 if known.moved is None else min(4.0 * abs(known.moved), 2.0),
            0.0 if known.moved is None else 1.0,
            1.0 if known.way else 0.0,
            math.log(max(other.prominence, 0.1)),
            _along(other),
            _log_deviation(other),
            float((other.on_curve[_HALVES[1]] > STANDS_OUT).mean()),
            min(20.0 * abs(float(apart[1])), 2.0),
            min(100.0 * abs(float(apart[2])), 2.0),
        ]
    )


def _along(fit: Fit) -> float:
    """Return the mean strength of the four best metres within 20 m."""
    run = np.convolve(np.minimum(fit.on_curve, 5.0)[: round(15.0 / X_STEP)], np.ones(4) / 4.0, mode="valid")
    return float(np.sort(run)[-16:].mean())


def _log_deviation(fit: Fit) -> float:
    return 0.5 * math.log(min(max(fit.slope_deviation, 1e-3), 1.0) / 0.01)


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
