"""Compares a detected boundary with the planned route: whether it leads where the ego is to go.

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
    return max((_share_on_way(boundary, _stretch(way)) - LEAST_SHARE) / (1.0 - LEAST_SHARE), 0.0)


def shape_of(way: Sequence[Point]) -> Point | None:
    """Return slope and curvature (1/m) below the camera of a parabola fitted to the route; None if none fits."""
    stretch = _stretch(way)
    if len(stretch) < 3:
        return None
    (x0, y0), (x1, y1), (x2, y2) = stretch[0], stretch[len(stretch) // 2], stretch[-1]
    if not x0 < x1 < x2:
        return None
    first, second = (y1 - y0) / (x1 - x0), (y2 - y1) / (x2 - x1)
    curvature = 2.0 * (second - first) / (x2 - x0)
    return first - 0.5 * curvature * (x0 + x1), curvature


def _share_on_way(boundary: Boundary, stretch: Sequence[Point]) -> float:
    for count, (x, y) in enumerate(stretch):
        if abs(_apart(boundary, x, y, stretch[0])) > OFF_THE_WAY:
            return count / len(stretch)
    return 1.0


def _stretch(way: Sequence[Point]) -> list[Point]:
    """Return the points of the route on the compared stretch, by their distance along it from beside the camera."""
    begin, end = LOOKED_AT
    covered, found = 0.0, []
    ahead = dropwhile(lambda point: point[0] < 0.0, way)
    for before, point in pairwise(ahead):
        covered += math.dist(before, point)
        if begin <= covered <= end:
            found.append(point)
    return found


def _apart(boundary: Boundary, x: float, y: float, begin: Point) -> float:
    """Return the distance by which the boundary has moved to the left of the route since the beginning, m."""
    return float(boundary.y(x) - boundary.y(begin[0])) - (y - begin[1])
