"""Where the automation uses the planned route, and whether a detected boundary leads where the ego is to go.

Only the route's shape is used. The route is shifted to the boundary at the beginning of the compared stretch, so that
the map provides its bends but never the lane's position. The comparison can only lower a probability.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import dropwhile, pairwise
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from scenario_compiler.perception.lane_detector import Boundary

Point = tuple[float, float]

LOOKED_AT = (6.0, 18.0)
"""Beginning and end of the stretch ahead of the camera to which the probability of a boundary refers, m."""

LEAST_SHARE = 0.6
"""Share of that stretch on which paint must be visible for a boundary to count as painted."""

OFF_THE_WAY = 1.75
"""Distance from the route's shape at which a boundary belongs to another lane, m: half a lane."""

STEPS = 4
"""Steps of Gauss and Newton's method to the point of a boundary that is nearest to a point of the route."""

SHARP = 0.15
"""Change of the route's heading up to the end of that stretch from which a bend is sharp, rad. The default camera sees 0.39 rad to
either side; in a bend with a radius below 33 m it does not see the inner boundary as far as 18 m ahead.
"""


def on_way(boundary: Boundary, way: Sequence[Point]) -> Boundary:
    """Return the boundary with the probabilities that it has beside the planned route (see `worth_on_way`)."""
    worth = worth_on_way(boundary, way)
    return replace(boundary, p_geom=boundary.p_geom * worth, p=boundary.p * worth)


def worth_on_way(boundary: Boundary, way: Sequence[Point]) -> float:
    """Return the factor for a boundary's probability beside the planned route, 0 to 1.

    It is 1 if the boundary follows the route on the whole compared stretch, and falls to 0 if it leaves the route so
    early that the rest would not count as painted.

    Args:
        boundary: The boundary, in the camera's ground frame.
        way: Points of the planned route in that frame, (x ahead, y left), m.
    """
    return max((_share_on_way(boundary, stretch_of(way)) - LEAST_SHARE) / (1.0 - LEAST_SHARE), 0.0)


def known_way(route: Sequence[Point], junction: float) -> Sequence[Point]:
    """Return the planned route where the camera alone does not determine the lane ahead; otherwise no points.

    Args:
        route: Points of the route in the camera's ground frame, (x ahead, y left), m.
        junction: Distance from the camera to the next junction, m; infinite without one in reach.
    """
    return route if junction <= LOOKED_AT[1] or abs(_turn(route)) > SHARP else ()


def stretch_of(way: Sequence[Point]) -> list[Point]:
    """Return the points of the route on the compared stretch, by their distance along it from beside the camera."""
    covered, found = 0.0, []
    for before, point in pairwise(_until_the_end(way)):
        covered += math.dist(before, point)
        if covered >= LOOKED_AT[0]:
            found.append(point)
    return found


def _until_the_end(way: Sequence[Point]) -> list[Point]:
    """Return the points of the route from beside the camera to the end of the compared stretch."""
    covered, found = 0.0, list[Point]()
    for point in dropwhile(lambda point: point[0] < 0.0, way):
        covered += math.dist(found[-1], point) if found else 0.0
        if covered > LOOKED_AT[1]:
            break
        found.append(point)
    return found


def _turn(route: Sequence[Point]) -> float:
    """Return the change of the route's heading from beside the camera to the end of the compared stretch, rad."""
    headings = [math.atan2(y1 - y0, x1 - x0) for (x0, y0), (x1, y1) in pairwise(_until_the_end(route))]
    return sum(math.remainder(after - before, math.tau) for before, after in pairwise(headings))


def _share_on_way(boundary: Boundary, stretch: Sequence[Point]) -> float:
    first = None
    for count, point in enumerate(stretch):
        aside = _aside(boundary, point)
        first = aside if first is None else first
        if abs(aside - first) > OFF_THE_WAY:
            return count / len(stretch)
    return 1.0


def _aside(boundary: Boundary, point: Point) -> float:
    """Return the distance from a point of the route to the boundary, m, positive if the boundary is to its left."""
    x, (begin, y) = point[0], point
    for _ in range(STEPS):
        slope = boundary.slope + boundary.curvature * x
        x -= (x - begin + (_y(boundary, x) - y) * slope) / (1.0 + slope * slope)
    return math.copysign(math.hypot(x - begin, _y(boundary, x) - y), _y(boundary, begin) - y)


def _y(boundary: Boundary, x: float) -> float:
    return boundary.y0 + boundary.slope * x + 0.5 * boundary.curvature * x * x
