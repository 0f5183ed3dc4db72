"""The planned route as the line along which the lane is searched: its bends are known, the lane's position is not.

Where lanes branch off, and in bends whose far end the camera does not see, the ground is viewed along the route instead
of straight ahead. There s is the distance along it from beside the camera, and t the distance to the left of the line
through the camera that is parallel to it: a lane that follows the route is straight in s and t, however the road bends.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.route_ahead import LOOKED_AT, Point, stretch_of

Floats = NDArray[np.float64]

BEYOND = 100.0
"""Length by which a route is continued straight, m; the map of the ground ends earlier."""

LEAST_SCALE = 0.2
"""Least length of a line beside a metre of the route: the ground near the centre of a bend is not viewed."""

CROSSING_STEPS = 4
"""Steps of Newton's method to where a boundary crosses the route's normal."""


@dataclass(frozen=True, eq=False)
class Course:
    """A route in the camera's ground frame.

    Attributes:
        s: (n,) distances along it from beside the camera, m.
        x: (n,) its points, m ahead of the camera.
        y: (n,) its points, m to the left of the camera.
        middle: (n - 1,) distances at which its heading is known, m.
        heading: (n - 1,) rad, positive to the left.
    """

    s: Floats
    x: Floats
    y: Floats
    middle: Floats
    heading: Floats

    @staticmethod
    def along(way: Sequence[Point]) -> Course | None:
        """Return the course along the points of a route; None if it has too few ahead on the compared stretch."""
        if len(stretch_of(way)) < 3:
            return None
        points = np.array(way)
        points = points[np.append(True, np.hypot(*np.diff(points, axis=0).T) > 0.0)]
        first = max(int(np.argmax(points[:, 0] >= 0.0)), 1)
        before, after = points[first - 1], points[first]
        if after[0] <= before[0]:
            return None
        share = -before[0] / (after[0] - before[0])
        points = points[first - 1 :]
        end = points[-1] - points[-2]
        points = np.concatenate([points, points[-1:] + end * (BEYOND / math.hypot(*end))])
        dx, dy = np.diff(points, axis=0).T
        lengths = np.hypot(dx, dy)
        s = np.append(0.0, np.cumsum(lengths)) - share * lengths[0]
        x, y = points.T
        return Course(s, x, y, 0.5 * (s[:-1] + s[1:]), np.unwrap(np.arctan2(dy, dx)))

    @cached_property
    def aside(self) -> float:
        """Distance from the camera to the left to the route, m."""
        begin = np.zeros(1)
        return float((np.interp(begin, self.s, self.y) * np.cos(self.heading_at(begin)))[0])

    @property
    def turn(self) -> float:
        """Change of its heading from beside the camera to the end of the compared stretch, rad."""
        begin, end = self.heading_at(np.array([0.0, LOOKED_AT[1]])).tolist()
        return float(end - begin)

    @property
    def bend(self) -> float:
        """Mean curvature up to there, 1/m."""
        return self.turn / LOOKED_AT[1]

    def heading_at(self, s: Floats) -> Floats:
        """Return the heading at s, rad."""
        return np.interp(s, self.middle, self.heading)

    def points(self, s: Floats, t: Floats) -> tuple[Floats, Floats]:
        """Return x and y at s and t, which broadcast; NaN near the centre of a bend and beyond it."""
        heading = self.heading_at(s)
        bend = np.interp(s, self.s[1:-1], np.diff(self.heading) / np.diff(self.middle))
        aside = t - self.aside
        aside = np.where(1.0 - bend * aside > LEAST_SCALE, aside, np.nan)
        x, y = np.interp(s, self.s, self.x), np.interp(s, self.s, self.y)
        return x - aside * np.sin(heading), y + aside * np.cos(heading)

    def across(self, s: Floats, parabola: tuple[float, float, float]) -> Floats:
        """Return t (n,) at s (n,) of the curve y = a + b x + c x**2 / 2 given by a, b and c.

        It is not finite where the curve does not cross the route's normal on this side of the centre of the bend.
        """
        a, b, c = parabola
        heading, t = self.heading_at(s), np.zeros_like(s)
        sine, cosine = np.sin(heading), np.cos(heading)
        for _ in range(CROSSING_STEPS):
            x, y = self.points(s, t)
            slope = b + c * x
            t = t - (y - (a + b * x + 0.5 * c * x * x)) / np.maximum(cosine + slope * sine, 0.1)
        return t

    def lever(self, s: Floats, height: float) -> Floats:
        """Return by how many metres to the left the route appears to move at s for a radian of upward tilt, (n,)."""
        x, y = self.points(s, np.zeros_like(s))
        heading = self.heading_at(s)
        return moved_aside(x, y, np.cos(heading), np.sin(heading)) / height


def moved_aside(x: Floats, y: Floats, dx: Floats, dy: Floats) -> Floats:
    """Return by how far to its left a line appears to move for a small tilt p, divided by p and multiplied by h, (n,).

    Seen from above through a camera at a height h that is tilted up by p, what is at (x, y) appears at (1 - p x / h)
    times that (see `road_plane`).

    Args:
        x: (n,) points of the line, m ahead of the camera.
        y: (n,) its points, m to the left of the camera.
        dx: (n,) its direction there, a vector; the result grows with its length.
        dy: (n,) the same, to the left.
    """
    return np.asarray(x * (x * dy - y * dx))
