"""The truth about the lane in a picture, and when a detected boundary is right."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.camera import View, vehicle_axes
from scenario_compiler.perception.lane_detector import Boundary
from scenario_compiler.perception.planned_way import LEAST_SHARE
from scenario_compiler.perception.route_ahead import LOOKED_AT

Floats = NDArray[np.float64]

X = np.arange(LOOKED_AT[0], LOOKED_AT[1] + 0.5, 1.0)
"""Distances ahead of the camera along the lane at which a detected boundary has to be near the true one, m."""

DRAWN = np.arange(0.0, 30.25, 0.25)
"""Distances ahead of the camera of the points of a detected boundary with which the true one is compared, m."""

TILT_FROM, TILT_TO = 5.0, 22.0
"""Stretch ahead of the camera to which the plane of the road is fitted, m."""

NEAREST, FARTHEST = 2.0, 45.0
"""Depths between which pixels of boundaries are labelled, m."""

SEEN = 0.15
"""Product of quality and the weather's contrast above which paint counts as visible."""


@dataclass(frozen=True, eq=False)
class Truth:
    """The lane ahead.

    Attributes:
        boundaries: (n, 2) points of the left and the right boundary in the camera's ground frame, in order of travel,
            m.
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
        return Truth(flat, painted, (_pixels(view, left), _pixels(view, right)), tilt)

    def error(self, side: int, boundary: Boundary) -> float:
        """Return the largest distance of the true boundary from a detected one, 6 to 18 m ahead along the lane, m."""
        detected = np.stack(boundary.points(DRAWN), axis=1)
        detected = detected[np.isfinite(detected[:, 0])]
        return float(_distances(self._judged(side), detected).max()) if len(detected) > 1 else math.inf

    def _judged(self, side: int) -> Floats:
        """Return points (len(X), 2) of the true boundary, 6 to 18 m ahead along the lane."""
        middle = 0.5 * (self.boundaries[0] + self.boundaries[1])
        along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(middle, axis=0).T))])
        beside = int(np.argmax(middle[:, 0] >= 0.0))
        x, y = self.boundaries[side].T
        at = X + along[beside] - middle[beside, 0]
        return np.stack([np.interp(at, along, x), np.interp(at, along, y)], axis=1)

    def y(self, side: int, x: float) -> float:
        """Return where the boundary first crosses a distance ahead of the camera; infinite if it never does, m."""
        ahead, left = self.boundaries[side].T
        crossed = np.flatnonzero((ahead[:-1] <= x) & (ahead[1:] > x))
        if not len(crossed):
            return math.inf
        k = int(crossed[0])
        return float(left[k] + (left[k + 1] - left[k]) * (x - ahead[k]) / (ahead[k + 1] - ahead[k]))

    def there(self, side: int) -> bool:
        """Return whether the boundary counts as painted."""
        return self.painted[side] > LEAST_SHARE


def _pixels(view: View, points: Floats) -> Floats:
    seen = view.to_camera(points)
    depth = seen[:, 2]
    return view.to_image(seen[(depth > NEAREST) & (depth < FARTHEST)])


def _distances(points: Floats, line: Floats) -> Floats:
    """Return the distances (m,) of points (m, 2) from a line through points (n, 2)."""
    along = np.diff(line, axis=0)
    from_starts = points[:, None] - line[:-1]
    share = (from_starts * along).sum(axis=2) / np.maximum((along * along).sum(axis=1), 1e-12)
    away = from_starts - np.clip(share, 0.0, 1.0)[..., None] * along
    nearest: Floats = np.hypot(away[..., 0], away[..., 1]).min(axis=1)
    return nearest
