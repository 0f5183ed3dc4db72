"""Where a traffic vehicle may appear: on a drivable lane that is free ahead and behind for the speeds there.

A place is free if neither the vehicle nor the one behind it would have to brake harder than is comfortable to keep its
time gap, if the lane continues, and if nobody on another road is close.
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.numbers import length_of, ratio, safe_sqrt
from scenario_compiler.engine.columns.presence import there_for
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.entities import place_scripted
from scenario_compiler.engine.motion.path import leave_road
from scenario_compiler.engine.traffic.driving import LOOK_AHEAD, NARROWEST_LANE, lane_goes_on, look, prepare_driver
from scenario_compiler.engine.traffic.neighbours import follower_on_way, leader_on_way
from scenario_compiler.marker import compiled
from scenario_compiler.roads.lane_types import is_drivable
from scenario_compiler.roads.lanes import lane_direction, row_width, section_at
from scenario_compiler.roads.tables import RoadTables

AROUND = 15.0
"""Least distance to all entities on other roads, m."""

LINE_ROOM_AT_START = 15.0
"""Distance to a junction's line that remains if a vehicle that appears brakes comfortably at once, m."""

END_ROOM = 20.0
"""How much shorter than LOOK_AHEAD the lane ahead may be where a vehicle appears, m."""


@compiled
def lane_by_draw(n: RoadTables, road: int, s: float, bits: int) -> int:
    """Return one of the lanes at s, chosen by 32 random bits; 0 if vehicles cannot appear in the chosen one."""
    section = section_at(n, road, s)
    if section < 0 or n.road_junction[road] >= 0:
        return 0
    first = n.section_lane[section]
    count = n.section_lane[section + 1] - first
    if count <= 0:
        return 0
    row = first + bits % max(count, 1)
    if n.lane_id[row] == 0 or is_drivable(n.lane_type[row]) == 0 or row_width(n, row, s) < NARROWEST_LANE:
        return 0
    return n.lane_id[row]


@compiled
def safe_gap(p: Program, i: int, v: float, lead: float) -> float:
    """Return the gap that a driver needs behind a vehicle, including comfortable braking if that is slower, m."""
    base = p.entity_const[i]
    ahead = max(lead, 0.0)
    braking = ratio(v * v - ahead * ahead, 2.0 * p.const[base + slot.E_DECELERATION], 0.0)
    return p.const[base + slot.E_MINIMUM_GAP] + v * p.const[base + slot.E_TIME_GAP] + max(braking, 0.0)


@compiled
def alone_around(p: Program, st: State, i: int) -> int:
    """Return 1 if nobody on another road is close to an entity."""
    for j in range(p.entity_count[0]):
        if st.road[j] == st.road[i] or there_for(st, j, op.SEEN_BY_TRAFFIC) == 0:
            continue
        if length_of(st.x[j] - st.x[i], st.y[j] - st.y[i]) < AROUND:
            return 0
    return 1


@compiled
def has_room(n: RoadTables, p: Program, st: State, i: int) -> int:
    """Return 1 if a traffic vehicle has room ahead and behind; slow it down so that it can stop at a junction.

    The entities must have been listed by road.
    """
    if alone_around(p, st, i) == 0:
        return 0
    look(n, st, i, st.kept_lane[i], 1, LOOK_AHEAD)
    gap, lead = leader_on_way(n, p, st, i)
    if lane_goes_on(n, st, i) < LOOK_AHEAD - END_ROOM:
        return 0
    if st.way_count[0] > 1 and n.road_junction[st.way_road[1]] >= 0:
        room = max(st.way_from[1] - LINE_ROOM_AT_START, 0.0)
        st.v[i] = min(st.v[i], safe_sqrt(2.0 * p.const[p.entity_const[i] + slot.E_DECELERATION] * room))
    if gap < safe_gap(p, i, st.v[i], lead):
        return 0
    look(n, st, i, st.kept_lane[i], -1, LOOK_AHEAD)
    behind, gap_behind = follower_on_way(n, p, st, i)
    if behind >= 0 and gap_behind < safe_gap(p, behind, st.v[behind], st.v[i]):
        return 0
    return 1


@compiled
def try_place(n: RoadTables, p: Program, st: State, i: int, road: int, lane: int, s: float) -> None:
    """Put an absent traffic vehicle into a lane with its start speed, without letting it appear."""
    st.road[i] = road
    st.s[i] = s
    st.kept_lane[i] = lane
    st.facing[i] = lane_direction(n, road, lane, s)
    prepare_driver(n, p, st, i)
    st.v[i] = max(st.v[i], 0.0)
    place_scripted(n, st, i)


@compiled
def let_appear(st: State, i: int) -> None:
    """Let a traffic vehicle appear where it has been put, and add it to the list by road."""
    st.present[i] = 1
    st.a[i] = 0.0
    st.last_x[i] = st.x[i]
    st.last_y[i] = st.y[i]
    st.last_v[i] = st.v[i]
    b = st.road[i] % op.BUCKETS
    st.bucket_next[i] = st.bucket_head[b]
    st.bucket_head[b] = i


@compiled
def appears_at(n: RoadTables, p: Program, st: State, i: int) -> int:
    """Let a vehicle appear where it has been put if it has room there, and return 1; otherwise take it off the road."""
    if has_room(n, p, st, i) == 0:
        leave_road(st, i)
        return 0
    let_appear(st, i)
    return 1
