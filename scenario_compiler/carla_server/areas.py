"""Areas on lanes in which a light or a sign applies to vehicles, and the vehicles that touch them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import Generic, NamedTuple, TypeVar

from scenario_compiler.carla_server.rectangles import half_along, least_overlap
from scenario_compiler.roads import LanePosition, Network, Pose

LENGTH, HEIGHT, BACK = 3.0, 2.0, 3.0
"""Length and height of the area before a stop line, and the distance of its middle before the line, m: CARLA's
(`UTrafficLightComponent`, `UStopSignComponent`, `UYieldSignComponent` of 0.9.16).
"""

WIDTH_SHARE = 0.5
LEAST_WIDTH = 0.02
"""Width of that area as a share of the lane's width, and its least width, m."""

CELL = 8.0
LONGEST = 6.0
"""Edge of a cell of the index, and a vehicle's greatest half diagonal, m."""

What = TypeVar("What")


class Box(NamedTuple):
    """A vehicle's box, or an area: middle of its bottom, heading, length, width, height. OpenDRIVE axes, m and rad."""

    x: float
    y: float
    z: float
    heading: float
    length: float
    width: float
    height: float

    def touches(self, other: Box) -> bool:
        """Return whether two boxes overlap."""
        if self.z > other.z + other.height or other.z > self.z + self.height:
            return False
        return least_overlap(self, other)[2] >= 0.0

    def sides(self) -> tuple[tuple[float, float], ...]:
        """Return its least and greatest coordinate along each of the world's axes, m."""
        x, y = half_along(self, 1.0, 0.0), half_along(self, 0.0, 1.0)
        return (self.x - x, self.x + x), (self.y - y, self.y + y), (self.z, self.z + self.height)


def box_at(pose: Pose, length: float, width: float, height: float) -> Box:
    """Return a box whose middle is at a pose, also in height."""
    return Box(pose.x, pose.y, pose.z - 0.5 * height, pose.heading, length, width, height)


def area_before(network: Network, line: LanePosition) -> Box:
    """Return the area before a stop line; if no lane leads to the line, the area at the line."""
    at = network.previous(line, BACK) or line
    width = max(WIDTH_SHARE * network.lane_width(at.road, at.lane, at.s), LEAST_WIDTH)
    return box_at(network.lane_pose(at.road, at.lane, at.s), LENGTH, width, HEIGHT)


class AreaIndex(Generic[What]):
    """Areas with their owners, indexed by the squares of the plane in which a vehicle touches them."""

    def __init__(self, areas: Iterable[tuple[Box, What]]) -> None:
        """Sort the areas into squares."""
        self._cells: dict[tuple[int, int], list[tuple[Box, What]]] = {}
        for area, what in areas:
            for cell in _cells(area.x, area.y, 0.5 * math.hypot(area.length, area.width) + LONGEST):
                self._cells.setdefault(cell, []).append((area, what))

    @property
    def empty(self) -> bool:
        """Whether there is no area."""
        return not self._cells

    def is_near(self, x: float, y: float) -> bool:
        """Return whether a vehicle whose middle is at a point may touch an area."""
        return (math.floor(x / CELL), math.floor(y / CELL)) in self._cells

    def touched(self, box: Box) -> Iterator[What]:
        """Yield the owners of the areas that a vehicle's box touches."""
        for area, what in self._cells.get((math.floor(box.x / CELL), math.floor(box.y / CELL)), ()):
            if area.touches(box):
                yield what


def _cells(x: float, y: float, reach: float) -> Iterator[tuple[int, int]]:
    """Yield the squares that a circle's bounding square touches."""
    for column in range(math.floor((x - reach) / CELL), math.floor((x + reach) / CELL) + 1):
        for row in range(math.floor((y - reach) / CELL), math.floor((y + reach) / CELL) + 1):
            yield column, row
