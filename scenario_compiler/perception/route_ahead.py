"""The planned route ahead of the camera, as a map with the lanes' widths and heights knows it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import dropwhile, pairwise
from typing import NamedTuple


class WayPoint(NamedTuple):
    """A point of the planned route, with what the map knows of its lane there; by default a level lane.

    Attributes:
        x: Distance ahead of the camera, m.
        y: Distance to the left of it, m.
        width: Width of the lane, m.
        height: Height above the plane of the road below the ego, m.
        bank: By how much the road rises to the left for each metre, against that plane.
    """

    x: float
    y: float
    width: float = 3.5
    height: float = 0.0
    bank: float = 0.0


LOOKED_AT = (6.0, 18.0)
"""Beginning and end of the stretch ahead of the camera to which the probability of a boundary refers, m."""

SHARP = 0.15
"""Change of the route's heading up to the end of that stretch from which a bend is sharp, rad. The default camera sees
0.39 rad to either side; in a bend with a radius below 33 m it does not see the inner boundary as far as 18 m ahead.
"""


LEAST_ONWARD = 0.5
"""Least distance by which a point of the route is farther on than the one before it, m; usual are 1 m."""


def without_folds(way: Iterable[WayPoint]) -> list[WayPoint]:
    """Return the points of a route that lead on.

    Where a road's reference line has a corner, the middle of a lane on the inner side of it goes back a little, because
    each of its points lies on the normal of a place on that line.
    """
    kept: list[WayPoint] = []
    for point in way:
        if len(kept) < 2:
            onward = LEAST_ONWARD if not kept else math.dist(point[:2], kept[0][:2])
        else:
            (x, y), (dx, dy) = kept[-1][:2], (kept[-1].x - kept[-2].x, kept[-1].y - kept[-2].y)
            onward = ((point.x - x) * dx + (point.y - y) * dy) / math.hypot(dx, dy)
        if onward >= LEAST_ONWARD:
            kept.append(point)
    return kept


def stretch_of(way: Sequence[WayPoint]) -> list[WayPoint]:
    """Return the points of the route on the compared stretch, by their distance along it from beside the camera."""
    covered, found = 0.0, []
    for before, point in pairwise(_until_the_end(way)):
        covered += math.dist(before[:2], point[:2])
        if covered >= LOOKED_AT[0]:
            found.append(point)
    return found


def turn_of(route: Sequence[WayPoint]) -> float:
    """Return the change of the route's heading from beside the camera to the end of the compared stretch, rad."""
    headings = [math.atan2(b.y - a.y, b.x - a.x) for a, b in pairwise(_until_the_end(route))]
    return sum(math.remainder(after - before, math.tau) for before, after in pairwise(headings))


def _until_the_end(way: Sequence[WayPoint]) -> list[WayPoint]:
    """Return the points of the route from beside the camera to the end of the compared stretch."""
    covered, found = 0.0, list[WayPoint]()
    for point in dropwhile(lambda point: point.x < 0.0, way):
        covered += math.dist(found[-1][:2], point[:2]) if found else 0.0
        if covered > LOOKED_AT[1]:
            break
        found.append(point)
    return found
