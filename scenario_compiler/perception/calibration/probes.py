"""A few pictures that reveal a change of the renderer or of the detector.

Anything that was fitted to the detector's output, such as surrogate perception, stores its output for these pictures.
The stored numbers reveal more than a digest of files: a comment changes none of them, and another processor hardly any.
"""

from __future__ import annotations

from scenario_compiler.perception.calibration.bank import BANK, pictures
from scenario_compiler.perception.detectors import DetectorName, create_detector

PROBES = (
    *("straight", "radius 100 m, left", "radius 60 m, right", "leader at 15 m", "truck to the left", "sun ahead"),
    *("ClearNight", "HardRainNoon", "HardRainSunset", "noise 20", "pitch +1 degrees", "worn paint", "no paint"),
)
"""Situations of the bank."""

SEED, AT = 5, 12.0
"""Seed of the pictures, and the distance at which a boundary is measured, m."""


def probes(detector: DetectorName = "classical") -> tuple[tuple[float, ...], ...]:
    """Return for each picture (confidence left, right; position of the left boundary, of the right one, m)."""
    made, found = create_detector(detector), []
    for name in PROBES:
        image, _ = next(pictures(next(one for one in BANK if one.name == name), SEED, 1))
        lane = made.detect(image)
        numbers = (lane.left.p, lane.right.p, float(lane.left.y(AT)), float(lane.right.y(AT)))
        found.append(tuple(round(number, 3) for number in numbers))
    return tuple(found)
