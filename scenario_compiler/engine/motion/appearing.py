"""Placing entities: teleports, appearing and disappearing, and visibility.

A teleport does not change the speed, and is the only motion of its entity in that step (esmini 3.6). On a lane, the
entity then follows that lane with its offset and heading there; off every road it goes straight on. Its trailers are
put in line behind it.
"""

from __future__ import annotations

from math import cos, pi

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.log import fault
from scenario_compiler.engine.columns.numbers import angle_between, is_number
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.collision import measure_reach
from scenario_compiler.engine.motion.entities import place_scripted
from scenario_compiler.engine.motion.free import place_free
from scenario_compiler.engine.motion.on_tracks import place_anywhere
from scenario_compiler.engine.motion.path import leave_road, locate_ego, set_path
from scenario_compiler.engine.motion.places import clear_place
from scenario_compiler.engine.motion.positions import PLACE_NONE, PLACE_ON_LANE, position_is_number
from scenario_compiler.engine.motion.trailers import straighten_trailers
from scenario_compiler.marker import compiled
from scenario_compiler.roads.geometry import wrap_heading
from scenario_compiler.roads.lanes import lane_direction, lane_pose
from scenario_compiler.roads.tables import RoadTables


@compiled
def lead_along(n: RoadTables, st: State, i: int, road: int, lane: int, s: float, offset: float, h: float) -> None:
    """Let an entity follow a lane from a place on it, with its heading `h` in the world, rad."""
    _, _, _, along, _, _ = lane_pose(n, road, lane, s, offset)
    direction = lane_direction(n, road, lane, s)
    away = angle_between(h, along if direction > 0 else along + pi)
    st.road[i] = road
    st.s[i] = s
    st.kept_lane[i] = lane
    st.kept_off[i] = offset
    st.changing[i] = 0
    st.facing[i] = direction
    st.turn[i] = away
    if cos(away) < 0.0:
        st.facing[i] = -direction
        st.turn[i] = angle_between(away, pi)


@compiled
def stand_free(st: State, i: int, x: float, y: float, z: float, h: float) -> None:
    """Put an entity at a point off every road."""
    leave_road(st, i)
    st.kept_lane[i] = 0
    st.kept_off[i] = 0.0
    st.facing[i] = 1
    st.turn[i] = 0.0
    st.x[i] = x
    st.y[i] = y
    st.z[i] = z
    st.h[i] = wrap_heading(h)
    st.pitch[i] = 0.0
    st.body_pitch[i] = 0.0
    st.roll[i] = 0.0


@compiled
def put_at(n: RoadTables, p: Program, st: State, i: int, k: int) -> None:
    """Put an entity at a position; a position that lies nowhere is a fault of the run."""
    kind, road, lane, s, offset, x, y, z, h = place_anywhere(n, p, st, k, i)
    if kind == PLACE_NONE:
        fault(st, op.FAULT_OFF_ROAD_START, i)
        return
    if p.position_guide[k] >= 0:
        st.guide[i] = p.position_guide[k]
    if kind == PLACE_ON_LANE:
        lead_along(n, st, i, road, lane, s, offset, h)
        place_scripted(n, st, i)
    else:
        stand_free(st, i, x, y, z, h)
    note_arrival(n, p, st, i)


@compiled
def start_entity(n: RoadTables, p: Program, st: State, order: int) -> None:
    """Put the `order`-th entity at its start position; one without a start position at the world's origin."""
    i = p.entity_order[order]
    k = p.entity_position[i]
    if k < 0:
        stand_free(st, i, 0.0, 0.0, 0.0, 0.0)
        note_arrival(n, p, st, i)
    elif is_number(st.v[i]) == 0 or position_is_number(p, k) == 0:
        leave_road(st, i)
        fault(st, op.FAULT_NOT_FINITE, i)
    elif p.position_op[k] == op.POSITION_RANDOM:
        start_at_random(n, p, st, i, order)
    else:
        put_at(n, p, st, i, k)


@compiled
def start_at_random(n: RoadTables, p: Program, st: State, i: int, order: int) -> None:
    """Put an entity at a random place that is clear of the entities placed before it."""
    k = p.entity_position[i]
    road, lane, s, offset, direction = clear_place(n, p, st, k, order, 0, op.PLACE_ATTEMPTS)
    if road < 0:
        leave_road(st, i)
        fault(st, op.FAULT_NO_ROOM, i)
        return
    st.road[i] = road
    st.s[i] = s
    st.kept_lane[i] = lane
    st.kept_off[i] = offset
    st.facing[i] = direction
    st.turn[i] = p.const[p.position_const[k] + slot.P_TURN]
    place_scripted(n, st, i)
    note_arrival(n, p, st, i)


@compiled
def note_arrival(n: RoadTables, p: Program, st: State, i: int) -> None:
    """Update everything that depends on where an entity was put: its odometer, its trailers, the ego's path."""
    st.ended[i] = 0
    st.last_x[i] = st.x[i]
    st.last_y[i] = st.y[i]
    if i == p.ego[0]:
        set_path(n, st, st.road[i], st.kept_lane[i], st.s[i])
        if p.entity_motion[i] == op.MOTION_BICYCLE or p.entity_motion[i] == op.MOTION_POSED:
            locate_ego(n, p, st, i)
    straighten_trailers(n, p, st, i)


@compiled
def add_entity(n: RoadTables, p: Program, st: State, i: int, k: int) -> None:
    """Let an entity appear at a position; an entity that is already present stays where it is."""
    if st.present[i] == 1:
        return
    st.present[i] = 1
    put_at(n, p, st, i, k)


@compiled
def spawn_entity(
    n: RoadTables, p: Program, st: State, i: int, x: float, y: float, z: float, h: float, v: float
) -> None:
    """Let an entity appear at a point of the world, with a new state."""
    st.present[i] = 1
    st.visible[i] = op.SEEN_BY_ALL
    st.v[i] = v
    st.last_v[i] = v
    st.a[i] = 0.0
    st.steer[i] = 0.0
    st.throttle[i] = 0.0
    st.brake[i] = 0.0
    st.command_throttle[i] = 0.0
    st.command_steer[i] = 0.0
    st.command_brake[i] = 0.0
    st.command_reverse[i] = 0
    st.odometer[i] = 0.0
    st.lights[i] = 0
    st.contact[i] = 0
    st.struck[i] = 0
    st.body_pitch[i] = 0.0
    measure_reach(p, st, i)
    stand_free(st, i, x, y, z, h)
    place_free(n, st, i)
    note_arrival(n, p, st, i)


@compiled
def delete_entity(st: State, i: int) -> None:
    """Let an entity disappear; its trailer stays behind.

    It keeps its speed for when it appears again; its running actions continue to change it (esmini 3.6).
    """
    st.present[i] = 0
    if st.towed[i] >= 0:
        st.towed_by[st.towed[i]] = op.NONE
        st.towed[i] = op.NONE
    if st.towed_by[i] >= 0:
        st.towed[st.towed_by[i]] = op.NONE
        st.towed_by[i] = op.NONE
