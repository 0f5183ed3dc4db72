"""Runs the detector over random frames: features with outcomes, and rows of mean confidences."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeVar

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.birds_eye import X_FROM
from scenario_compiler.perception.calibration.frames import CLEAR_DAY, Wanted, random_frame
from scenario_compiler.perception.confidence import FEATURES
from scenario_compiler.perception.lane_detector import ClassicalLaneDetector
from scenario_compiler.perception.lane_fit import arc_y
from scenario_compiler.vocabulary.weather import weather_preset

Floats = NDArray[np.float64]
Value = TypeVar("Value", float, str)


@dataclass(frozen=True)
class Row:
    """One row of the table.

    Attributes:
        p: Mean probability over both sides, health included.
        any_below_warning: Share of frames with a side below 0.6.
        both_below_request: Share of frames with both sides below 0.3.
        close: Share of sides within 0.25 m of the truth.
    """

    p: float
    any_below_warning: float
    both_below_request: float
    close: float


def collect(frames: int, seed: int) -> tuple[Floats, Floats, NDArray[np.int64]]:
    """Return features (2 frames, features), outcomes (2 frames,) and each row's frame number."""
    detector = ClassicalLaneDetector(weights=(0.0,) * len(FEATURES))
    rows, outcomes = [], []
    for number in range(frames):
        frame = random_frame(np.random.default_rng([seed, number]), Wanted())
        fits, found, _ = detector.examine(frame.image)
        d = frame.x - X_FROM
        for side, (fit, row) in enumerate(zip(fits, found, strict=True)):
            y = arc_y(fit.curve, d)
            rows.append(row)
            outcomes.append(float(frame.right(side, y)))
    return np.array(rows), np.array(outcomes), np.arange(2 * frames) // 2


def table_rows(
    detector: ClassicalLaneDetector,
    what: Literal["quality", "sigma", "weather"],
    values: Sequence[Value],
    frames: int,
) -> list[tuple[Value, Row]]:
    """Return a row for each value of one thing, everything else at its best: new paint, no noise, a clear noon."""
    return [(value, mean_confidence(detector, what, value, frames)) for value in values]


def mean_confidence(
    detector: ClassicalLaneDetector, what: str, value: float | str, frames: int, seed: int = 1000
) -> Row:
    """Return the row of one value over `frames` single frames without memory; `seed` picks the roads."""
    wanted = Wanted(
        quality=float(value) if what == "quality" else 1.0,
        sigma=float(value) if what == "sigma" else 0.0,
        weather=weather_preset(str(value)) if what == "weather" else CLEAR_DAY,
        traffic=False,
    )
    p, close = np.empty((frames, 2)), []
    for number in range(frames):
        frame = random_frame(np.random.default_rng([seed, number]), wanted)
        result = detector.detect(frame.image)
        p[number] = result.p_left, result.p_right
        for side, boundary in enumerate((result.left, result.right)):
            close.append(float(np.abs(boundary.y(frame.x) - frame.boundaries[side]).max()) < 0.25)
    return Row(
        round(float(p.mean()), 3),
        round(float((p.min(axis=1) < 0.6).mean()), 3),
        round(float((p.max(axis=1) < 0.3).mean()), 3),
        round(float(np.mean(close)), 3),
    )
