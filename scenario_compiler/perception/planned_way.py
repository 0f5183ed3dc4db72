"""Compares a detected boundary with the planned route: whether it leads where the ego is to go.

Only the route's shape is used. The route is shifted to the boundary at the beginning of the compared stretch, so that
the map provides its bends but never the lane's position. The comparison can only lower a probability.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from scenario_compiler.perception.route_ahead import LOOKED_AT, WayPoint, stretch_of

if TYPE_CHECKING:
    from scenario_compiler.perception.lane_detector import Boundary

LEAST_SHARE = 0.6
"""Share of the compared stretch on which paint must be visible for a boundary to count as painted."""

OFF_THE_WAY = 1.75
"""Distance from the route's shape at which a boundary belongs to another lane, m: half a lane."""

NEAREST_STEPS = 4
"""Steps of Gauss and Newton's method to the point of a boundary that is nearest to a point of the route."""


def on_way(boundary: Boundary, way: Sequence[WayPoint]) -> Boundary:
    """Return the boundary with the probabilities that it has beside the planned route (see `worth_on_way`)."""
    worth = worth_on_way(boundary, way)
    return replace(boundary, p_geom=boundary.p_geom * worth, p=boundary.p * worth)


def worth_on_way(boundary: Boundary, way: Sequence[WayPoint]) -> float:
    """Return the factor for a boundary's probability beside the planned route, 0 to 1.

    It is 1 if the boundary follows the route on the whole compared stretch, and falls to 0 if it leaves the route so
    early that the rest would not count as painted.

    Args:
        boundary: The boundary, in the camera's ground frame.
        way: Points of the planned route in that frame.
    """
    return max((_share_on_way(boundary, stretch_of(way)) - LEAST_SHARE) / (1.0 - LEAST_SHARE), 0.0)


def _share_on_way(boundary: Boundary, stretch: Sequence[WayPoint]) -> float:
    if boundary.course is None:
        apart = [_aside(boundary, point) for point in stretch]
    else:
        apart = boundary.across(range(round(LOOKED_AT[0]), round(LOOKED_AT[1]) + 1)).tolist()
    off = (abs(aside - apart[0]) > OFF_THE_WAY for aside in apart)
    return next((count / len(apart) for count, away in enumerate(off) if away), 1.0)


def _aside(boundary: Boundary, point: WayPoint) -> float:
    """Return the distance from a point of the route to the boundary, m, positive if the boundary is to its left."""
    x, begin, y = point.x, point.x, point.y
    for _ in range(NEAREST_STEPS):
        slope = boundary.slope_at(x)
        x -= (x - begin + (float(boundary.y(x)) - y) * slope) / (1.0 + slope * slope)
    return math.copysign(math.hypot(x - begin, float(boundary.y(x)) - y), float(boundary.y(begin)) - y)
