"""Areas on lanes in which lights and signs are for a vehicle, and which vehicles touch them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Generic, NamedTuple, TypeVar

from scenario_compiler.roads import LanePosition, Network

LENGTH, HEIGHT, BACK = 1.5, 1.0, 3.0
"""Half length and half height of the area before a stop line, and how far before the line its middle is, m: CARLA's
(`UTrafficLightComponent`, `UStopSignComponent`, `UYieldSignComponent` of 0.9.16).
"""

WIDTH_SHARE = 0.25
LEAST_WIDTH = 0.01
"""Half width of that area as a share of the lane's width, and at least, m."""

CELL = 8.0
LONGEST = 6.0
"""Edge of a cell of the index, and a vehicle's greatest half diagonal, m."""

What = TypeVar("What")


class Box(NamedTuple):
    """A vehicle's box: its middle on the ground, heading, length, width and height. OpenDRIVE axes, m and rad."""

    x: float
    y: float
    z: float
    heading: float
    length: float
    width: float
    height: float


@dataclass(frozen=True)
class Area:
    """A box on a lane: its middle, heading and half extents. OpenDRIVE axes, m and rad."""

    x: float
    y: float
    z: float
    heading: float
    length: float
    width: float
    height: float

    def touches(self, box: Box) -> bool:
        """Return whether a vehicle's box and this one overlap."""
        if box.z > self.z + self.height or box.z + box.height < self.z - self.height:
            return False
        away = (box.x - self.x, box.y - self.y)
        both = (self.heading, self.length, self.width), (box.heading, 0.5 * box.length, 0.5 * box.width)
        for heading, *_ in both:
            for across in (heading, heading + 0.5 * math.pi):
                c, s = math.cos(across), math.sin(across)
                reach = sum(
                    length * abs(math.cos(one - across)) + width * abs(math.sin(one - across))
                    for one, length, width in both
                )
                if abs(c * away[0] + s * away[1]) > reach:
                    return False
        return True

    def half_extents(self) -> tuple[float, float, float]:
        """Return the half extents of the box along the world's axes about this one, m."""
        c, s = abs(math.cos(self.heading)), abs(math.sin(self.heading))
        return self.length * c + self.width * s, self.length * s + self.width * c, self.height


def area_before(network: Network, line: LanePosition) -> Area:
    """Return the area before a stop line, at the line where no lane leads to it."""
    at = network.previous(line, BACK) or line
    width = max(WIDTH_SHARE * network.lane_width(at.road, at.lane, at.s), LEAST_WIDTH)
    pose = network.lane_pose(at.road, at.lane, at.s)
    return Area(pose.x, pose.y, pose.z, pose.heading, LENGTH, width, HEIGHT)


class AreaIndex(Generic[What]):
    """Areas, each with what it is of, by the squares of the plane in which a vehicle touches them."""

    def __init__(self, areas: Iterable[tuple[Area, What]]) -> None:
        """Sort the areas into squares."""
        self._cells: dict[tuple[int, int], list[tuple[Area, What]]] = {}
        for area, what in areas:
            for cell in _cells(area.x, area.y, math.hypot(area.length, area.width) + LONGEST):
                self._cells.setdefault(cell, []).append((area, what))

    @property
    def empty(self) -> bool:
        """Whether there is no area."""
        return not self._cells

    def touched(self, box: Box) -> Iterator[What]:
        """Yield what the areas are of that a vehicle's box touches."""
        for area, what in self._cells.get((math.floor(box.x / CELL), math.floor(box.y / CELL)), ()):
            if area.touches(box):
                yield what


def _cells(x: float, y: float, reach: float) -> Iterator[tuple[int, int]]:
    """Yield the squares that a circle's bounding square touches."""
    for column in range(math.floor((x - reach) / CELL), math.floor((x + reach) / CELL) + 1):
        for row in range(math.floor((y - reach) / CELL), math.floor((y + reach) / CELL) + 1):
            yield column, row
