"""The planned route ahead of the camera, and where the automation uses it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import dropwhile, pairwise

Point = tuple[float, float]

LOOKED_AT = (6.0, 18.0)
"""Beginning and end of the stretch ahead of the camera to which the probability of a boundary refers, m."""

SHARP = 0.15
"""Change of the route's heading up to the end of that stretch from which a bend is sharp, rad. The default camera sees
0.39 rad to either side; in a bend with a radius below 33 m it does not see the inner boundary as far as 18 m ahead.
"""


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
