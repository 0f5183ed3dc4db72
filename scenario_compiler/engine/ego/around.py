"""The ego's surroundings: the traffic density, and the time to collision along the lane."""

from __future__ import annotations

from math import cos, sin

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.extent import front_of
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.sensor import SLOW
from scenario_compiler.engine.motion.ahead import measure_on_way, walk, walk_route
from scenario_compiler.engine.motion.path import preferred_road
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables

AROUND = 500.0
"""Distance ahead and behind in which vehicles are counted for the traffic density, m; chosen: a kilometre in all."""


@compiled
def count_on_way(n: RoadTables, p: Program, st: State, i: int, along: int) -> tuple[int, float]:
    """Return (vehicles, length in m) of the last measured path, ahead of the ego (`along` 1) or behind it (-1).

    Vehicles on all lanes count if they drive in the ego's direction with 2 m/s or more. The length is AROUND, or less
    if the path ends before.
    """
    count = 0
    for j in range(p.entity_count[0]):
        if j == i or p.entity_type[j] != op.KIND_VEHICLE or measure_on_way(n, p, st, j) == 0:
            continue
        middle = 0.5 * (st.near[j] + st.far[j])
        passed = middle < 0.0 or (middle <= 0.0 and along < 0)
        if not passed and middle <= AROUND and along * st.along[j] >= SLOW:
            count += 1
    last = st.way_count[0] - 1
    if last < 0:
        return count, 0.0
    s = st.way_s[last]
    rest = n.road_length[st.way_road[last]] - s if st.way_sign[last] > 0 else s
    return count, min(st.way_from[last] + rest, AROUND)


@compiled
def note_density(n: RoadTables, p: Program, st: State, i: int) -> None:
    """Write the number of vehicles per kilometre in the ego's direction; overwrites the way ahead."""
    walk_route(n, p, st, AROUND)
    ahead, far = count_on_way(n, p, st, i, 1)
    road = st.path_road[0]
    walk(n, st, road, st.path_lane[0], st.path_s[0], -1, AROUND, preferred_road(p, st, road))
    behind, back = count_on_way(n, p, st, i, -1)
    st.traffic_density[0] = 1000.0 * (ahead + behind) / max(far + back, 1.0)


@compiled
def note_lane_time(p: Program, st: State, i: int) -> None:
    """Write the least time to collision along the lane with seen entities ahead of the ego's front bumper, s."""
    front = front_of(p, i)
    known = 0
    left = 0.0
    right = 0.0
    st.lane_time[0] = op.FAR
    for j in range(p.entity_count[0]):
        if j == i or st.on_way[j] == 0 or st.seen[j] == 0 or st.far[j] <= front:
            continue
        closing = st.v[i] - st.along[j]
        if not closing > 0.0:
            continue
        if known == 0:
            known = 1
            half = 0.5 * p.const[p.entity_const[i] + slot.E_WIDTH] * cos(st.path_heading[0])
            middle = st.path_off[0] + front * sin(st.path_heading[0])
            left = middle + half
            right = middle - half
        if st.low[j] < left and st.high[j] > right:
            st.lane_time[0] = min(st.lane_time[0], max(st.near[j] - front, 0.0) / closing)
