"""Sources and sinks of traffic: vehicles appear around a place at a rate, or disappear near one."""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.numbers import is_number, length_of, ratio
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.seeds import run_seed
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.path import leave_road
from scenario_compiler.engine.motion.positions import PLACE_NONE, PLACE_ON_LANE, place_of
from scenario_compiler.engine.traffic.driving import vanish
from scenario_compiler.engine.traffic.free_places import appears_at, lane_by_draw, try_place
from scenario_compiler.engine.traffic.neighbours import list_by_road
from scenario_compiler.marker import compiled
from scenario_compiler.randomness import random_hash, random_unit
from scenario_compiler.roads.lane_types import is_drivable
from scenario_compiler.roads.lanes import lane_type
from scenario_compiler.roads.tables import RoadTables
from scenario_compiler.roads.travel import advance

SOURCE_TRIES = 4
"""Number of places that are tried in a frame: that of the source, then some around it."""

ALONE_IN_LANE = 1.0
"""Radius below which all vehicles of a source appear exactly at its place, m."""


@compiled
def place_around(
    n: RoadTables, p: Program, st: State, k: int, i: int, attempt: int
) -> tuple[int, int, float, float, float]:
    """Return (road, lane, s, x, y) of a place near a source; x and y are the source's own; road -1 if there is none."""
    kind, road, lane, s, _, x, y, _, _ = place_of(n, p, st, p.action_position[k], op.NONE)
    if kind != PLACE_ON_LANE:
        return -1, 0, 0.0, 0.0, 0.0
    radius = p.const[p.action_const[k] + slot.U_RADIUS]
    if radius >= ALONE_IN_LANE and is_number(radius) == 1:
        seed = run_seed(st, op.NONE)
        draw = 2 * (SOURCE_TRIES * (st.frame[0] & 65535) + attempt)
        ahead = radius * (2.0 * random_unit(seed, op.STREAM_TRAFFIC, i, draw) - 1.0)
        road, lane, s, rest = advance(n, road, lane, s, ahead, op.NONE)
        if rest > 0.0:
            return -1, 0, 0.0, 0.0, 0.0
        if attempt > 0:
            lane = lane_by_draw(n, road, s, random_hash(seed, op.STREAM_TRAFFIC, i, draw + 1))
    if lane == 0 or is_drivable(lane_type(n, road, lane, s)) == 0:
        return -1, 0, 0.0, 0.0, 0.0
    return road, lane, s, x, y


@compiled
def emit_vehicle(n: RoadTables, p: Program, st: State, k: int, i: int) -> int:
    """Let a vehicle of a source appear at a free place around it; return 1 if there is one."""
    reach = max(p.const[p.action_const[k] + slot.U_RADIUS], ALONE_IN_LANE)
    for attempt in range(SOURCE_TRIES):
        road, lane, s, x, y = place_around(n, p, st, k, i, attempt)
        if road < 0:
            continue
        try_place(n, p, st, i, road, lane, s)
        if attempt > 0 and length_of(st.x[i] - x, st.y[i] - y) > reach:
            leave_road(st, i)
        elif appears_at(n, p, st, i) == 1:
            return 1
    return 0


@compiled
def first_absent(p: Program, st: State, k: int) -> int:
    """Return the first absent vehicle of an action, or NONE."""
    first = max(p.action_other[k], 0)
    for i in range(first, first + p.action_lanes[k]):
        if st.present[i] == 0:
            return i
    return op.NONE


@compiled
def next_due(p: Program, st: State, k: int) -> float:
    """Return the time of the next vehicle of a source or sink after one now, s; without a rate it is now."""
    rate = p.const[p.action_const[k] + slot.U_RATE]
    period = ratio(1.0, rate, 0.0) if rate > 0.0 else 0.0
    return max(st.action_a[k], st.clock[0] - p.const[slot.K_STEP]) + period


@compiled
def emit_due(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Let the next vehicle of a source appear if it is due and has room."""
    i = first_absent(p, st, k)
    if i < 0 or st.clock[0] < st.action_a[k] - op.TOLERANCE:
        return
    list_by_road(p, st)
    if emit_vehicle(n, p, st, k, i) == 1:
        st.action_a[k] = next_due(p, st, k)


@compiled
def take_due(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Let the traffic vehicles near a sink disappear if they are due."""
    kind, _, _, _, _, x, y, _, _ = place_of(n, p, st, p.action_position[k], op.NONE)
    if kind == PLACE_NONE:
        return
    radius = p.const[p.action_const[k] + slot.U_RADIUS]
    for i in range(p.entity_count[0]):
        if p.entity_motion[i] == op.MOTION_TRAFFIC and st.present[i] == 1:
            due = st.clock[0] >= st.action_a[k] - op.TOLERANCE
            if due and length_of(st.x[i] - x, st.y[i] - y) <= radius:
                vanish(st, i)
                st.action_a[k] = next_due(p, st, k)
