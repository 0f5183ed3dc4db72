"""Places relative to another place on a road: a number of lanes away, and at a distance across the road."""

from __future__ import annotations

from math import pi

from scenario_compiler.marker import compiled
from scenario_compiler.roads.geometry import road_reference
from scenario_compiler.roads.lanes import lane_at, lane_centre, lane_direction, lane_exists, lane_pose
from scenario_compiler.roads.tables import RoadTables


@compiled
def lane_beyond(n: RoadTables, road: int, lane: int, s: float, by: int, facing: int) -> int:
    """Return the lane `by` lanes to the left as seen along `facing` (1: along s), or the last one before it."""
    at = lane
    step = facing if by > 0 else -facing
    for _ in range(abs(by)):
        beside = at + step
        if beside == 0:
            beside = beside + step
        if lane_exists(n, road, beside, s) == 0:
            return at
        at = beside
    return at


@compiled
def lane_nearest(n: RoadTables, road: int, s: float, t: float) -> int:
    """Return the lane that contains t at s, or else the one with the nearest centre; 0 on a road without lanes."""
    lane = lane_at(n, road, s, t)
    if lane != 0:
        return lane
    best = 1.0e9
    for side in (-1, 1):
        at = side
        while lane_exists(n, road, at, s) == 1:
            centre, _ = lane_centre(n, road, at, s)
            if abs(t - centre) < best:
                best = abs(t - centre)
                lane = at
            at = at + side
    return lane


@compiled
def lanes_away(
    n: RoadTables, road: int, lane: int, s: float, by: int, left: float, along_lane: int
) -> tuple[int, float, float]:
    """Return (lane, offset, heading) of a place `by` lanes to the left and `left` metres from that lane's centre.

    With `along_lane` 1, left and the heading are relative to the lane's direction of travel, otherwise to s.
    """
    sense = 1
    if along_lane == 1:
        sense = lane_direction(n, road, lane, s)
    at = lane_beyond(n, road, lane, s, by, sense)
    offset = sense * left
    _, _, _, h, _, _ = lane_pose(n, road, at, s, offset)
    if along_lane == 1 and lane_direction(n, road, at, s) < 0:
        h = h + pi
    return at, offset, h


@compiled
def across_road(n: RoadTables, road: int, lane: int, s: float, offset: float, dt: float) -> tuple[int, float, float]:
    """Return (lane, offset, heading along s) of a place dt to the left of a place in a lane; lane 0 without lanes."""
    centre, _ = lane_centre(n, road, lane, s)
    t = centre + offset + dt
    at = lane_nearest(n, road, s, t)
    centre, _ = lane_centre(n, road, at, s)
    _, _, h, _ = road_reference(n, road, s)
    return at, t - centre, h
