"""Resolves a position of the plan at the moment of its use, to a lane or to a point off every road.

Teleports, conditions, appearing entities and the vertices of trajectories all use this module. A position relative to
an entity is measured from where that entity is at that time. Distances along a road are those of its reference line,
distances along a lane those of its centre line ("offset along the center line of the lane, where the reference entity
is located", RelativeLanePosition, ASAM OpenSCENARIO; esmini 3.6 takes the reference line for both). They end where the
road ends.
"""

from __future__ import annotations

from math import cos, pi, sin

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.numbers import is_number
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.beside import own_lane
from scenario_compiler.engine.motion.path import STEP_OVER
from scenario_compiler.engine.motion.places import resolve_position
from scenario_compiler.engine.motion.routes import next_turn
from scenario_compiler.marker import compiled
from scenario_compiler.roads.below import place_below
from scenario_compiler.roads.lanes import lane_direction, lane_pose
from scenario_compiler.roads.relative import across_road, lanes_away
from scenario_compiler.roads.tables import RoadTables
from scenario_compiler.roads.travel import LANE_STEP, advance, along_reference

PLACE_NONE = 0
"""A position that lies nowhere: relative to an entity off the road, or in a lane that does not exist."""
PLACE_ON_LANE = 1
PLACE_FREE = 2

HOPS = 64
"""Greatest number of roads that a distance along the road leads over."""


@compiled
def turn_for(n: RoadTables, p: Program, st: State, i: int, other: int, road: int) -> int:
    """Return the road after `road` on the route of the entity i to be placed, or of the one that it is relative to.

    It is -1 if neither has a route from there.
    """
    turn = op.NONE
    if i >= 0:
        turn = next_turn(n, p, st, i, road)
    if turn < 0 and other >= 0:
        turn = next_turn(n, p, st, other, road)
    return turn


@compiled
def advance_by_way(
    n: RoadTables, p: Program, st: State, i: int, other: int, road: int, lane: int, s: float, ds: float
) -> tuple[int, int, float]:
    """Return (road, lane, s) after ds along the lane's direction of travel (against it for ds < 0).

    The turns are those of `turn_for`. If the lane ends before, the place is its end.
    """
    left = abs(ds)
    forward = 1.0 if ds >= 0.0 else -1.0
    for _ in range(HOPS):
        sense = forward * lane_direction(n, road, lane, s)
        room = n.road_length[road] - s if sense > 0.0 else s
        step = min(left, room)
        road, lane, s, rest = advance(n, road, lane, s, forward * step, turn_for(n, p, st, i, other, road))
        left = left - step
        if left <= 0.0 or rest > 0.0:
            return road, lane, s
        next_road, next_lane, next_s, rest = advance(
            n, road, lane, s, forward * min(left, STEP_OVER), turn_for(n, p, st, i, other, road)
        )
        if rest > 0.0:
            return road, lane, s
        road = next_road
        lane = next_lane
        s = next_s
        left = left - STEP_OVER
        if left <= 0.0:
            return road, lane, s
    return road, lane, s


@compiled
def advance_in_lane(
    n: RoadTables, p: Program, st: State, i: int, other: int, road: int, lane: int, s: float, ds: float
) -> tuple[int, int, float]:
    """Return the same as `advance_by_way` for a distance along the centre line of the lane."""
    left = abs(ds)
    forward = 1.0 if ds >= 0.0 else -1.0
    while left > 0.0:
        step = min(left, LANE_STEP)
        along = along_reference(n, road, lane, s, forward * step)
        before = s
        before_road = road
        road, lane, s = advance_by_way(n, p, st, i, other, road, lane, s, along)
        if road == before_road and abs(s - before) < 0.5 * abs(along):
            return road, lane, s
        left = left - step
    return road, lane, s


@compiled
def place_from_entity(n: RoadTables, p: Program, st: State, k: int, i: int) -> tuple[int, int, float, float, float]:
    """Return (road, lane, s, offset, reference heading) of a position relative to an entity; road -1 if there is none.

    With POSITION_ALONG_LANE, ahead and left refer to the lane's direction of travel, otherwise to the road's s.
    """
    other = p.position_entity[k]
    road = st.road[other]
    if road < 0:
        return -1, 0, 0.0, 0.0, 0.0
    base = p.position_const[k]
    lane, beside = own_lane(p, st, other)
    direction = lane_direction(n, road, lane, st.s[other])
    ahead = p.const[base + slot.P_S]
    along_lane = 1 if p.position_flags[k] & op.POSITION_ALONG_LANE != 0 else 0
    if along_lane == 1:
        road, lane, s = advance_in_lane(n, p, st, i, other, road, lane, st.s[other], ahead)
    else:
        road, lane, s = advance_by_way(n, p, st, i, other, road, lane, st.s[other], ahead * direction)
    if p.position_op[k] == op.POSITION_LANES_AWAY:
        lane, offset, h = lanes_away(n, road, lane, s, p.position_lane[k], p.const[base + slot.P_OFFSET], along_lane)
    else:
        aside = beside * direction * lane_direction(n, road, lane, s)
        lane, offset, h = across_road(n, road, lane, s, aside, p.const[base + slot.P_OFFSET])
    if lane == 0:
        return -1, 0, 0.0, 0.0, 0.0
    return road, lane, s, offset, h


@compiled
def from_own_axes(st: State, i: int, ahead: float, left: float, up: float) -> tuple[float, float, float]:
    """Return a vector in an entity's own axes, m, in those of the world: turned by its roll, pitch and heading."""
    c = cos(st.roll[i])
    w = sin(st.roll[i])
    side = left * c - up * w
    up = left * w + up * c
    c = cos(st.pitch[i])
    w = sin(st.pitch[i])
    forward = ahead * c + up * w
    up = up * c - ahead * w
    c = cos(st.h[i])
    w = sin(st.h[i])
    return forward * c - side * w, forward * w + side * c, up


@compiled
def point_of(p: Program, st: State, k: int) -> tuple[float, float, float, float, int]:
    """Return (x, y, z, heading, 1 if z counts) of a position that is a point in the world."""
    base = p.position_const[k]
    x = p.const[base + slot.P_S]
    y = p.const[base + slot.P_OFFSET]
    turn = p.const[base + slot.P_TURN]
    z = p.const[base + slot.P_Z]
    kind = p.position_op[k]
    if kind == op.POSITION_FREE:
        return x, y, z, turn, 1 if p.position_flags[k] & op.POSITION_WITH_HEIGHT != 0 else 0
    other = p.position_entity[k]
    h = turn
    if p.position_flags[k] & op.POSITION_ABSOLUTE == 0:
        h = st.h[other] + turn
    if kind == op.POSITION_RELATIVE_OBJECT:
        x, y, z = from_own_axes(st, other, x, y, z)
    return st.x[other] + x, st.y[other] + y, st.z[other] + z, h, 1


@compiled
def position_is_number(p: Program, k: int) -> int:
    """Return 1 if the numbers of a position are finite."""
    base = p.position_const[k]
    total = p.const[base + slot.P_S] + p.const[base + slot.P_OFFSET] + p.const[base + slot.P_TURN]
    kind = p.position_op[k]
    if kind in (op.POSITION_FREE, op.POSITION_RELATIVE_OBJECT, op.POSITION_RELATIVE_WORLD):
        total = total + p.const[base + slot.P_Z]
    return is_number(total)


@compiled
def place_of(
    n: RoadTables, p: Program, st: State, k: int, i: int
) -> tuple[int, int, int, float, float, float, float, float, float]:
    """Return (PLACE_... code, road, lane, s, offset, x, y, z, heading) of a position for entity i (or NONE).

    A position along a trajectory is PLACE_NONE here; because its vertices are positions themselves, `on_tracks`
    resolves it.
    """
    if position_is_number(p, k) == 0 or p.position_op[k] == op.POSITION_ON_TRAJECTORY:
        return PLACE_NONE, -1, 0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    kind = p.position_op[k]
    if kind in (op.POSITION_FREE, op.POSITION_RELATIVE_OBJECT, op.POSITION_RELATIVE_WORLD):
        x, y, z, h, with_height = point_of(p, st, k)
        found, road, lane, s, offset = place_below(n, x, y, h, z, with_height)
        if found == 0:
            return PLACE_FREE, -1, 0, 0.0, 0.0, x, y, z, h
        _, _, surface, _, _, _ = lane_pose(n, road, lane, s, offset)
        return PLACE_ON_LANE, road, lane, s, offset, x, y, surface, h
    if kind in (op.POSITION_LANES_AWAY, op.POSITION_RELATIVE_ROAD):
        road, lane, s, offset, along = place_from_entity(n, p, st, k, i)
    else:
        road, lane, s, offset, direction = resolve_position(n, p, st, k)
        along = 0.0
        if road >= 0:
            _, _, _, along, _, _ = lane_pose(n, road, lane, s, offset)
            if direction < 0:
                along = along + pi
    if road < 0:
        return PLACE_NONE, -1, 0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    h = p.const[p.position_const[k] + slot.P_TURN]
    if p.position_flags[k] & op.POSITION_ABSOLUTE == 0:
        h = along + h
    x, y, z, _, _, _ = lane_pose(n, road, lane, s, offset)
    return PLACE_ON_LANE, road, lane, s, offset, x, y, z, h
