"""Lanes beside a lane, counted to the left as an entity faces."""

from __future__ import annotations

from scenario_compiler.marker import compiled
from scenario_compiler.roads.lanes import lane_exists
from scenario_compiler.roads.tables import RoadTables


@compiled
def count_lanes(lane: int, by: int, facing: int) -> int:
    """Return the id `by` lanes to the left of a lane as seen along `facing` (1: along s), without the centre lane."""
    step = facing
    count = by
    if by < 0:
        step = -facing
        count = -by
    at = lane
    for _ in range(count):
        at = at + step
        if at == 0:
            at = at + step
    return at


@compiled
def neighbour_lane(n: RoadTables, road: int, lane: int, s: float, by: int, facing: int) -> int:
    """Return the lane `by` lanes to the left as seen along `facing`, 0 where there is none."""
    at = count_lanes(lane, by, facing)
    return at if lane_exists(n, road, at, s) == 1 else 0
