"""Finds connecting roads of a junction that cross, merge or part, so that only one of them may be driven on."""

from __future__ import annotations

import math

from scenario_compiler.roads import Network
from scenario_compiler.roads.lane_types import is_drivable
from scenario_compiler.roads.lanes import lane_type

NEAR = 2.9
"""Distance between the centres of two lanes below which vehicles on them may touch, m: two wide cars side by side."""

STEP = 1.5
"""Distance between the compared points of a lane, m."""

Points = list[tuple[float, float]]


def conflicts_of(network: Network) -> tuple[list[int], list[int]]:
    """Return row starts by road, and the roads that conflict with each road, by the indices of the network."""
    n = network.tables
    by_junction: dict[int, list[int]] = {}
    for road, junction in enumerate(n.road_junction):
        if junction >= 0:
            by_junction.setdefault(junction, []).append(road)
    points = {road: _middles(network, road) for roads in by_junction.values() for road in roads}
    first, others = [0], list[int]()
    for road, junction in enumerate(n.road_junction):
        for other in by_junction.get(junction, []) if junction >= 0 else []:
            if other != road and _near(points[road], points[other]):
                others.append(other)
        first.append(len(others))
    return first, others


def _middles(network: Network, road: int) -> Points:
    n = network.tables
    name, length = network.road_ids[road], n.road_length[road]
    count = max(2, math.ceil(length / STEP) + 1)
    found: Points = []
    for k in range(count):
        s = length * k / (count - 1)
        for lane in network.lanes_at(name, s):
            if lane.lane != 0 and is_drivable(lane_type(n, road, lane.lane, s)) == 1:
                pose = network.lane_pose(name, lane.lane, s)
                found.append((pose.x, pose.y))
    return found


def _near(one: Points, other: Points) -> bool:
    return any((ax - bx) ** 2 + (ay - by) ** 2 < NEAR * NEAR for ax, ay in one for bx, by in other)
