"""The truth about the lane in a picture, and when a detected boundary is right."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.camera import View, vehicle_axes
from scenario_compiler.perception.lane_detector import Boundary

Floats = NDArray[np.float64]

X = np.arange(6.0, 18.5, 1.0)
"""Distances ahead of the camera at which a boundary has to be right, m."""

TILT_FROM, TILT_TO = 5.0, 22.0
"""Stretch ahead of the camera to which the plane of the road is fitted, m."""

NEAREST, FARTHEST = 2.0, 45.0
"""Depths between which pixels of boundaries are labelled, m."""

SEEN, SEEN_SHARE = 0.15, 0.6
"""Product of quality and the weather's contrast above which paint counts as visible, and the share of the stretch that
needs it.
"""


@dataclass(frozen=True, eq=False)
class Truth:
    """The lane ahead.

    Attributes:
        boundaries: y(X) of the left and the right boundary in the camera's ground frame, m; infinite where a boundary
            turns away so much that it never comes as far ahead.
        painted: Share of the stretch with visible paint, of the left and the right boundary.
        pixels: (n, 2) u, v in the image, in order of travel, of points of the left and the right boundary.
        tilt: Upward tilt of the camera relative to its mounting, rad, against a plane through the road ahead.
    """

    boundaries: tuple[Floats, Floats]
    painted: tuple[float, float]
    pixels: tuple[Floats, Floats] = (np.empty((0, 2)), np.empty((0, 2)))
    tilt: float = 0.0

    @staticmethod
    def of(view: View, left: Floats, right: Floats, painted: tuple[float, float]) -> Truth:
        """Return the truth from points (n, 3) of both boundaries in the world, in order of travel."""
        flat = view.world_to_ground(left), view.world_to_ground(right)
        both = np.concatenate([left, right])
        ahead = np.concatenate(flat)[:, 0]
        rise = (both - view.foot) @ vehicle_axes(view.pose)[:, 2]
        near = (ahead > TILT_FROM) & (ahead < TILT_TO)
        tilt = -float(rise[near] @ ahead[near]) / max(float(ahead[near] @ ahead[near]), 1e-9)
        return Truth((_at(flat[0]), _at(flat[1])), painted, (_pixels(view, left), _pixels(view, right)), tilt)

    def error(self, side: int, boundary: Boundary) -> float:
        """Return the largest lateral error of a detected boundary, m."""
        return float(np.abs(boundary.y(X) - self.boundaries[side]).max())

    def there(self, side: int) -> bool:
        """Return whether the boundary counts as painted."""
        return self.painted[side] > SEEN_SHARE


def _pixels(view: View, points: Floats) -> Floats:
    seen = view.to_camera(points)
    depth = seen[:, 2]
    return view.to_image(seen[(depth > NEAREST) & (depth < FARTHEST)])


def _at(points: Floats) -> Floats:
    ahead, last = [], -np.inf
    for x, y in points.tolist():
        if x > last:
            ahead.append((x, y))
            last = x
        elif last > 0.0:
            break
    along = np.array(ahead)
    return np.asarray(np.interp(X, along[:, 0], along[:, 1], right=np.inf))
