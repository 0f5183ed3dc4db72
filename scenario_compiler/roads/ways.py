"""Ways through the road network, road by road: the next road on the way to a goal.

Lanes are ignored: a way may need lane changes, which are made elsewhere. A stretch is a road and the direction in which
it is driven: 1 along s, -1 against s.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import NamedTuple

from scenario_compiler.roads.lane_types import ROAD_TYPES, is_drivable
from scenario_compiler.roads.lanes import section_at
from scenario_compiler.roads.tables import AT_END, AT_START, NO_SPEED, RoadTables

Stretch = tuple[int, int]
"""Index of a road, and the direction in which it is driven."""

Cost = Callable[[Stretch], float]
"""Cost of passing a stretch."""


TOWN_SPEED = 13.9
"""Speed limit of a road that states none and is of no type of USUAL_SPEEDS, m/s: 50 km/h (StVO section 3)."""

USUAL_SPEEDS = {
    "motorway": 36.1,
    "rural": 27.8,
    "lowSpeed": 8.3,
    "bicycle": 8.3,
    "pedestrian": 1.9,
    "townPlayStreet": 1.9,
}
"""Speed limits of roads that state none, by the road's type, m/s: 130 km/h as recommended on German motorways, 100 km/h
outside towns, 30 km/h in zones and on cycle streets, walking speed (StVO section 3 and annexes 2 and 3).
"""


def travel_time(n: RoadTables, stretch: Stretch) -> float:
    """Return the time in which a road is driven at its speed limits, s: those of its fastest lane in this direction."""
    road, _ = stretch
    sections = range(n.road_section[road], n.road_section[road + 1])
    rows = range(n.section_lane[sections.start], n.section_lane[sections.stop])
    changes = {
        *(n.type_s[k] for k in range(n.road_type[road], n.road_type[road + 1])),
        *(n.section_s[section] for section in sections),
        *(n.speed_s[k] for k in range(n.lane_speed[rows.start], n.lane_speed[rows.stop])),
    }
    length = n.road_length[road]
    cuts = sorted({0.0, length, *(s for s in changes if 0.0 < s < length)})
    return sum((end - s) / _usual_limit(n, stretch, s) for s, end in pairwise(cuts))


def _usual_limit(n: RoadTables, stretch: Stretch, s: float) -> float:
    """Return the greatest speed limit of the drivable lanes of a direction, m/s; without any, the road's."""
    road, sense = stretch
    general = TOWN_SPEED
    for k in range(n.road_type[road], n.road_type[road + 1]):
        if n.type_s[k] <= s:
            usual = USUAL_SPEEDS.get(ROAD_TYPES[n.type_code[k]], TOWN_SPEED)
            general = usual if n.type_speed[k] == NO_SPEED else n.type_speed[k]
    limits = []
    section = section_at(n, road, s)
    for row in range(n.section_lane[section], n.section_lane[section + 1]) if section >= 0 else ():
        if is_drivable(n.lane_type[row]) == 1 and n.lane_sense[row] == sense:
            stated = [n.speed_max[k] for k in range(n.lane_speed[row], n.lane_speed[row + 1]) if n.speed_s[k] <= s]
            limits.append(stated[-1] if stated and stated[-1] != NO_SPEED else general)
    return min(max(max(limits, default=general), USUAL_SPEEDS["pedestrian"]), USUAL_SPEEDS["motorway"])


def followers(n: RoadTables, stretch: Stretch) -> list[Stretch]:
    """Return the stretches to which lanes of a stretch lead in their directions of travel, in the lanes' order.

    A road may also be left before its end, where another one is attached to it (`attachments`).
    """
    return list(dict.fromkeys(joint.to for joint in joints(n, stretch)))


class Joint(NamedTuple):
    """Where a lane leads to another stretch: the s at which the road is left, and that on the other road, m."""

    to: Stretch
    s_left: float
    s_entered: float


def joints(n: RoadTables, stretch: Stretch) -> Iterator[Joint]:
    """Yield the joints of a stretch with others, along its way and in the lanes' order."""
    road, sense = stretch
    sections = range(n.road_section[road], n.road_section[road + 1])[::sense]
    end = AT_END if sense == 1 else AT_START
    for section in sections:
        s_left = n.section_end[section] if sense == 1 else n.section_s[section]
        for row in range(n.section_lane[section], n.section_lane[section + 1]):
            if n.lane_id[row] == 0 or n.lane_sense[row] != sense:
                continue
            for link in range(n.lane_link[2 * row + end], n.lane_link[2 * row + end + 1]):
                beyond = n.lane_section[n.link_lane[link]]
                other, along = n.section_road[beyond], n.link_contact[link] == AT_START
                if other != road or section == sections[-1]:
                    s_entered = n.section_s[beyond] if along else n.section_end[beyond]
                    yield Joint((other, 1 if along else -1), s_left, s_entered)


def predecessors(n: RoadTables) -> dict[Stretch, list[Stretch]]:
    """Return for every stretch the stretches that lead to it."""
    before: dict[Stretch, list[Stretch]] = {}
    for road in range(len(n.road_length)):
        for sense in (1, -1):
            for to in followers(n, (road, sense)):
                before.setdefault(to, []).append((road, sense))
    return before


def onward(n: RoadTables, goal: Stretch, cost: Cost | None = None) -> dict[Stretch, Stretch]:
    """Return for every stretch from which a goal can be reached the next stretch on the cheapest way.

    The cost of a stretch is its length if none is given.
    """
    before = predecessors(n)
    following: dict[Stretch, Stretch] = {}
    heap: list[tuple[float, int, Stretch, Stretch | None]] = [(0.0, 0, goal, None)]
    done: set[Stretch] = set()
    count = 0
    while heap:
        spent, _, stretch, after = heapq.heappop(heap)
        if stretch in done:
            continue
        done.add(stretch)
        if after is not None:
            following[stretch] = after
        for one in before.get(stretch, ()):
            count += 1
            more = n.road_length[one[0]] if cost is None else cost(one)
            heapq.heappush(heap, (spent + more, count, one, stretch))
    return following


def path_between(n: RoadTables, start: Stretch, goal: Stretch, cost: Cost | None = None) -> list[Stretch] | None:
    """Return the stretches of the cheapest way from one to another, including both, or None (see `onward`)."""
    following = onward(n, goal, cost)
    path = [start]
    while path[-1] != goal:
        if path[-1] not in following:
            return None
        path.append(following[path[-1]])
    return path
