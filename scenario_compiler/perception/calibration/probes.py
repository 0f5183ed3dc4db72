"""A few pictures that reveal a change of the renderer or of the detector.

Anything that was fitted to the detector's output, such as surrogate perception, stores its output for these pictures.
The comparison is numeric and not by a digest of files: a comment has no effect, and another processor little.
"""

from __future__ import annotations

from collections.abc import Sequence

from scenario_compiler.perception.calibration.bank import BANK, pictures
from scenario_compiler.perception.detectors import DetectorName, create_detector

PROBES = (
    *("straight", "radius 100 m, left", "radius 60 m, right", "leader at 15 m", "truck to the left", "sun ahead"),
    *("ClearNight", "HardRainNoon", "HardRainSunset", "noise 20", "pitch +1 degrees", "worn paint", "no paint"),
)
"""Situations of the bank."""

SEED, AT = 5, 12.0
"""Seed of the pictures, and the distance at which a boundary is measured, m."""

TOLERANCE = 0.05
"""Greatest difference of a confidence, and of a trusted boundary's position, m, that does not count as a change."""

TRUSTED = 0.5
"""Confidence above which a boundary's position is compared; that of a missing boundary is arbitrary."""


def probes(detector: DetectorName = "classical") -> tuple[tuple[float, ...], ...]:
    """Return for each picture (confidence left, right; position of the left boundary, of the right one, m)."""
    made, found = create_detector(detector), []
    for name in PROBES:
        image, _ = next(pictures(next(one for one in BANK if one.name == name), SEED, 1))
        lane = made.detect(image)
        numbers = (lane.left.p, lane.right.p, float(lane.left.y(AT)), float(lane.right.y(AT)))
        found.append(tuple(round(number, 3) for number in numbers))
    return tuple(found)


def changes(before: Sequence[Sequence[float]], now: Sequence[Sequence[float]]) -> list[str]:
    """Return the situations for whose pictures the detector's output has changed."""
    if len(before) != len(PROBES):
        return list(PROBES)
    found = []
    for name, old, new in zip(PROBES, before, now, strict=True):
        places = [(old[2 + k], new[2 + k]) for k in range(2) if min(old[k], new[k]) >= TRUSTED]
        pairs = [(old[0], new[0]), (old[1], new[1]), *places]
        if any(abs(a - b) > TOLERANCE for a, b in pairs):
            found.append(name)
    return found
