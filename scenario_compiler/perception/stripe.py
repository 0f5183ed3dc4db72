"""The paint along a line that was found: whether the ground is brighter on it than on both its sides.

A network that has learned what roads look like takes a boundary for painted where boundaries usually are. This looks
at each metre of the boundary by itself, so it also tells where paint begins and ends.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.birds_eye import (
    COMPARED,
    MEAN_OVER,
    STRONGEST,
    X_STEP,
    Y_STEP,
    deviation_of,
    ground_lookup,
    stands_out,
)
from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.course import Course
from scenario_compiler.perception.lane_fit import STANDS_OUT

Floats = NDArray[np.float64]

FROM = 6.0
AHEAD: Floats = np.asarray(FROM + X_STEP * (np.arange(96) + 0.5))
"""(96,) distances ahead at which the strip is looked at, m."""

ASIDE: Floats = np.asarray(Y_STEP * np.arange(20.0, -20.5, -1.0))
"""(41,) distances to the left of the line at which it is looked at, m."""

ON_LINE = np.abs(ASIDE) < 0.26
"""(41,) which of them are on the line: a boundary is right up to 0.25 m from the true one."""

NEARER, FARTHER, JUDGED, BEYOND = slice(0, 24), slice(24, 48), slice(0, 48), slice(48, None)
"""The two halves of the stretch on which a boundary has to be right, this stretch, and what lies beyond it."""


@dataclass(frozen=True, eq=False)
class Stripe:
    """The ground along a line, (96,) each.

    Attributes:
        strength: By how much the most prominent stripe on the line is brighter than both its sides, in units of the
            row's own deviation, 0-8.
        contrast: The same in grey levels (twice the smaller step).
        beside: Brightness of the ground beside it, grey levels.
    """

    strength: Floats
    contrast: Floats
    beside: Floats

    @property
    def shown(self) -> NDArray[np.bool_]:
        """(96,) where it counts as painted."""
        return self.strength > STANDS_OUT


def stripe_along(bright: NDArray[np.uint8], camera: Camera, t: Floats, pitch: float, course: Course | None) -> Stripe:
    """Return what an image shows along a line; nothing where the line lies outside the image.

    Args:
        bright: (height, width) grey levels (see `bright_of`).
        camera: The camera of the image.
        t: (96,) where the line is at `AHEAD`, m to the left, along the route if there is one.
        pitch: Upward tilt of the camera relative to its mounting, rad, against the map if there is a route.
        course: The planned route; None for straight ahead.
    """
    s, across = AHEAD[:, None], np.asarray(t[:, None] + ASIDE)
    lookup = ground_lookup(camera, s, across, pitch, course)
    single = cv2.remap(bright, lookup.column, lookup.row, cv2.INTER_LINEAR).astype(np.float32)
    above = np.asarray(cv2.blur(single, MEAN_OVER), np.float32)
    curve, contrast = stands_out(above)
    contrast *= lookup.seen
    scale = deviation_of(np.abs(curve) * lookup.seen, lookup.count)
    rows, first = np.arange(len(AHEAD)), int(ON_LINE.argmax())
    place = first + contrast[:, ON_LINE].argmax(axis=1)
    most = contrast[rows, place]
    beside = 0.5 * (above[rows, place - COMPARED] + above[rows, place + COMPARED])
    return Stripe(*(one.astype(np.float64) for one in (np.minimum(most / scale, STRONGEST), most, beside)))
