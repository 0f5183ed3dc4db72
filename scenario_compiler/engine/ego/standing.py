"""The place of a vehicle that has been stopped: its own lane, another lane, a shoulder, across an edge, off the road.

It obstructs a lane for driving if nothing ahead holds it, because others would drive on there.
"""

from __future__ import annotations

from math import cos, sin

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.extent import front_of, rear_of
from scenario_compiler.engine.columns.log import log_event
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.objects_ahead import nearest_ahead
from scenario_compiler.engine.ego.sensor import SLOW, lane_closes
from scenario_compiler.marker import compiled
from scenario_compiler.roads.lane_types import is_drivable, is_roadside
from scenario_compiler.roads.lanes import lane_type, lane_width, row_width
from scenario_compiler.roads.tables import RoadTables

HELD_WITHIN = 30.0
"""Distance up to which something ahead is taken to hold a standing vehicle, m; chosen: a stop with room to spare."""


@compiled
def sides_of(p: Program, st: State, i: int) -> tuple[float, float]:
    """Return how far the ego's box reaches to the left and to the right of its reference point, across its lane, m."""
    turned = sin(st.path_heading[0])
    front = front_of(p, i) * turned
    rear = -rear_of(p, i) * turned
    wide = 0.5 * p.const[p.entity_const[i] + slot.E_WIDTH] * abs(cos(st.path_heading[0]))
    return max(front, rear) + wide, wide - min(front, rear)


@compiled
def standing_place(n: RoadTables, p: Program, st: State, i: int) -> int:
    """Return the STANDS_... code of the ego's place; its own lane is that of its path.

    It stands in its own lane only if its whole box does, and on a shoulder only if no part of it is in the lane beside.
    """
    road = st.road[i]
    if road < 0 or st.lane[i] == 0:
        return op.STANDS_OFF_ROAD
    row = st.path_row[0]
    to_left, to_right = sides_of(p, st, i)
    if st.path_anew[0] == 0 and road == st.path_road[0] and row >= 0:
        half = 0.5 * row_width(n, row, st.path_s[0])
        left = st.path_off[0]
        if abs(left) <= half:
            return op.STANDS_IN_OWN_LANE if max(left + to_left, to_right - left) <= half else op.STANDS_ACROSS_EDGE
    lane = st.lane[i]
    kind = lane_type(n, road, lane, st.s[i])
    if is_drivable(kind) == 1:
        return op.STANDS_IN_OTHER_LANE
    if is_roadside(kind) == 0:
        return op.STANDS_OFF_ROAD
    inwards = -st.off[i] if lane > 0 else st.off[i]
    reach = inwards + (to_left if lane * st.path_sense[0] < 0 else to_right)
    return op.STANDS_ACROSS_EDGE if reach > 0.5 * lane_width(n, road, lane, st.s[i]) else op.STANDS_ON_SHOULDER


@compiled
def is_held(p: Program, st: State, i: int) -> int:
    """Return 1 if an object, a red signal or the end of the lane close ahead, or a collision, holds the ego.

    A moving leader does not hold it.
    """
    front = front_of(p, i)
    leader, gap = nearest_ahead(p, st, i, op.AHEAD_FOLLOWED)
    _, blocked = nearest_ahead(p, st, i, op.AHEAD_BLOCKING)
    nearest = min(min(blocked, st.red_line[0] - front), lane_closes(st))
    if leader >= 0 and st.along[leader] < SLOW:
        nearest = min(nearest, gap)
    return 1 if nearest <= HELD_WITHIN or st.crashed[0] == 1 else 0


@compiled
def log_standstill(n: RoadTables, p: Program, st: State, i: int, by_hand: int) -> None:
    """Log the standstill of the ego with its place, and whether it obstructs a lane."""
    now = st.clock[0]
    if st.time_standstill[0] < 0.0:
        st.time_standstill[0] = now
    place = standing_place(n, p, st, i)
    log_event(st, op.EVENT_STANDSTILL, 1.0 * by_hand + 2.0 * place)
    in_lane = place in (op.STANDS_IN_OWN_LANE, op.STANDS_IN_OTHER_LANE, op.STANDS_ACROSS_EDGE)
    if in_lane and is_held(p, st, i) == 0:
        if st.time_obstruction[0] < 0.0:
            st.time_obstruction[0] = now
        log_event(st, op.EVENT_OBSTRUCTION, 0.0)
