"""The planned route as the line along which the lane is searched: its bends are known, the lane's position is not.

The ground is viewed along the route instead of straight ahead. There s is the distance along it from beside the camera,
and t the distance to the left of the line through the camera that is parallel to it: a lane that follows the route is
straight in s and t, however the road bends, also where the camera does not see the end of the bend, or where several
lanes are painted. The map's widths, heights and banks of the lane are known as well: distances from the route are
measured relative to the width, and what lies higher is looked for higher in the image.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.route_ahead import LOOKED_AT, WayPoint, stretch_of, turn_of

Floats = NDArray[np.float64]

BEYOND = 100.0
"""Length by which a route is continued straight, m; the map of the ground ends earlier."""

WIDTH_AT, NARROWEST = 10.0, 2.0
"""Distance ahead of the camera at which the width of the lane is taken, and the least width of a lane to drive in, m.
"""

SCALES = (0.8, 1.25)
"""Bounds of the relative width of the lane."""

GRADED = np.arange(5.0, 22.5, 1.0)
"""Distances along the route over which its grade is taken, m."""

LEAST_SCALE = 0.2
"""Least length of a line beside a metre of the route: the ground near the centre of a bend is not viewed."""

MOST_MOVED = 0.5
"""Motion across the route between two images from which they have other routes, m."""

PLACED, PLACING_STEPS = np.arange(-2.0, 40.0, 0.5), 2
"""Distances along the route among which the one nearest to a point is taken, m, and Newton's steps from there."""

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
        turn: Change of its heading from beside the camera to the end of the compared stretch, rad.
        width: Width of the lane `WIDTH_AT` ahead, m; None if it begins or ends there.
        scale: (n,) width of the lane relative to that: distances from the route are multiplied by it.
        rise: (n,) height of the road above the plane below the ego, m.
        bank: (n,) by how much the road rises to the left for each metre, against that plane.
        junction: Distance along it from beside the camera to the next junction, m, 0 inside one; infinite if there is
            none.
    """

    s: Floats
    x: Floats
    y: Floats
    middle: Floats
    heading: Floats
    turn: float
    width: float | None
    scale: Floats
    rise: Floats
    bank: Floats
    junction: float

    @staticmethod
    def along(way: Sequence[WayPoint], junction: float = math.inf) -> Course | None:
        """Return the course along the points of a route; None if it has too few ahead on the compared stretch.

        Args:
            way: The points, in the camera's ground frame.
            junction: Distance along the route from beside the camera to the next junction, m; 0 if the camera is in
                one, or just behind it.
        """
        if len(stretch_of(way)) < 3:
            return None
        points = np.array(way)
        points = points[np.append(True, np.hypot(*np.diff(points[:, :2], axis=0).T) > 0.0)]
        first = max(int(np.argmax(points[:, 0] >= 0.0)), 1)
        before, after = points[first - 1], points[first]
        if after[0] <= before[0]:
            return None
        share = -before[0] / (after[0] - before[0])
        points = points[first - 1 :]
        end = points[-1] - points[-2]
        beyond = points[-1:].copy()
        beyond[0, :2] += end[:2] * (BEYOND / math.hypot(*end[:2]))
        points = np.concatenate([points, beyond])
        dx, dy = np.diff(points[:, :2], axis=0).T
        lengths = np.hypot(dx, dy)
        s = np.append(0.0, np.cumsum(lengths)) - share * lengths[0]
        x, y, width, rise, bank = points.T
        usual = float(np.interp(WIDTH_AT, s, width))
        known = usual if usual >= NARROWEST else None
        scale = np.ones_like(width) if known is None else np.clip(width / known, *SCALES)
        middle, heading = 0.5 * (s[:-1] + s[1:]), np.unwrap(np.arctan2(dy, dx))
        return Course(s, x, y, middle, heading, turn_of(way), known, scale, rise, bank, junction)

    @cached_property
    def aside(self) -> float:
        """Distance from the camera to the left to the route, m."""
        begin = np.zeros(1)
        return float((np.interp(begin, self.s, self.y) * np.cos(self.heading_at(begin)))[0])

    def moved_since(self, before: Course) -> float:
        """Return by how much t of what lies on the ground has grown since the previous image, m; 0 for another route.

        The camera's own motion across the route tells it.
        """
        moved = self.aside - before.aside
        return moved if abs(moved) < MOST_MOVED else 0.0

    @property
    def bend(self) -> float:
        """Mean curvature up to there, 1/m."""
        begin, end = self.heading_at(np.array([0.0, LOOKED_AT[1]])).tolist()
        return float(end - begin) / LOOKED_AT[1]

    def heading_at(self, s: Floats) -> Floats:
        """Return the heading at s, rad."""
        return np.interp(s, self.middle, self.heading)

    def points(self, s: Floats, t: Floats) -> tuple[Floats, Floats]:
        """Return x and y at s and t, which broadcast; NaN near the centre of a bend and beyond it."""
        heading = self.heading_at(s)
        bend = np.interp(s, self.s[1:-1], np.diff(self.heading) / np.diff(self.middle))
        aside = self._from_route(s, t)
        aside = np.where(1.0 - bend * aside > LEAST_SCALE, aside, np.nan)
        x, y = np.interp(s, self.s, self.x), np.interp(s, self.s, self.y)
        return x - aside * np.sin(heading), y + aside * np.cos(heading)

    def place(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Return s and t (n,) of points (n,), m, on the normal of the nearest point of the route up to `PLACED`."""
        dx, dy = x[:, None] - np.interp(PLACED, self.s, self.x), y[:, None] - np.interp(PLACED, self.s, self.y)
        s = PLACED[(dx * dx + dy * dy).argmin(axis=1)]
        for _ in range(PLACING_STEPS):
            heading, dx, dy = self._off(s, x, y)
            s = s + dx * np.cos(heading) + dy * np.sin(heading)
        heading, dx, dy = self._off(s, x, y)
        aside = dy * np.cos(heading) - dx * np.sin(heading)
        return s, aside / np.interp(s, self.s, self.scale) + self.aside

    def _off(self, s: Floats, x: Floats, y: Floats) -> tuple[Floats, Floats, Floats]:
        """Return the route's heading at s, and by how much points are off the route's point there."""
        return self.heading_at(s), x - np.interp(s, self.s, self.x), y - np.interp(s, self.s, self.y)

    def _from_route(self, s: Floats, t: Floats) -> Floats:
        """Return the distance from the route to the left, m, at s and t, which broadcast."""
        return np.asarray((t - self.aside) * np.interp(s, self.s, self.scale))

    def height(self, s: Floats, t: Floats) -> Floats:
        """Return the height of the road above the plane below the ego, m, at s and t, which broadcast."""
        return np.asarray(np.interp(s, self.s, self.rise) + self._from_route(s, t) * np.interp(s, self.s, self.bank))

    @cached_property
    def grade(self) -> float:
        """Tilt against that plane of the one that is nearest to the route, rad, positive where the road falls away."""
        x, rise = np.interp(GRADED, self.s, self.x), np.interp(GRADED, self.s, self.rise)
        return -float(rise @ x) / float(x @ x)

    def across(self, s: Floats, parabola: tuple[float, float, float]) -> Floats:
        """Return t (n,) at s (n,) of the curve y = a + b x + c x**2 / 2 given by a, b and c.

        It is not finite where the curve does not cross the route's normal on this side of the centre of the bend.
        """
        a, b, c = parabola
        heading, scale, t = self.heading_at(s), np.interp(s, self.s, self.scale), np.zeros_like(s)
        sine, cosine = np.sin(heading), np.cos(heading)
        for _ in range(CROSSING_STEPS):
            x, y = self.points(s, t)
            slope = b + c * x
            away = (y - (a + b * x + 0.5 * c * x * x)) / np.maximum(cosine + slope * sine, 0.1)
            t = t - away / scale
        return t

    def lever(self, s: Floats, t: Floats, slope: Floats, height: float) -> Floats:
        """Return by how many metres to the left a line appears to move at s for a radian of upward tilt, (n,).

        Args:
            s: (n,) m.
            t: (n,) where the line is there, m.
            slope: (n,) dt/ds.
            height: Height of the camera, m.
        """
        x, y = self.points(s, t)
        widening = np.interp(s, self.middle, np.diff(self.scale) / np.diff(self.s))
        heading = self.heading_at(s) + np.arctan(slope * np.interp(s, self.s, self.scale) + widening * (t - self.aside))
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
