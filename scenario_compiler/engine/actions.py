"""How running actions act, each writing its entity at once, in document order: init actions first, then the story's.

Semi-implicit: a speed action writes the speed of the end of the step, and the entity moves with it. A lane change
moves its entity along the path with the speed of that moment, so what it moves to the side is missing ahead. After
esmini 3.6.
"""

from __future__ import annotations

from math import atan, atan2, pi

from scenario_compiler.engine.motion import glide, place_scripted
from scenario_compiler.engine.numbers import safe_sqrt
from scenario_compiler.engine.opcodes import (
    ACTION_FOLLOW_PATH,
    ACTION_LANE_CHANGE,
    ACTION_LANE_OFFSET,
    ACTION_SPEED,
    DIMENSION_DISTANCE,
    ELEMENT_ACTION,
    MOTION_SCRIPTED,
    RUNNING,
    TOLERANCE,
)
from scenario_compiler.engine.own_path import step_follow_path
from scenario_compiler.engine.shapes import shape_slope, shape_value
from scenario_compiler.engine.starts import set_speed
from scenario_compiler.engine.state import State
from scenario_compiler.engine.storyboard import action_done
from scenario_compiler.engine.tables import Program
from scenario_compiler.marker import compiled
from scenario_compiler.roads.lanes import lane_centre
from scenario_compiler.roads.tables import RoadTables


@compiled
def step_speed(p: Program, st: State, k: int, dt: float) -> int:
    """Set the speed after dt of a change; return 1 in the step that reaches the target."""
    span = st.action_span[k]
    progress = st.action_progress[k] + dt
    st.action_progress[k] = progress
    if span <= 0.0 or progress >= span - TOLERANCE:
        if span > 0.0:
            set_speed(p, st, p.action_entity[k], st.action_from[k] + st.action_change[k])
        return 1
    share = shape_value(st, p.action_shape[k], progress / span)
    set_speed(p, st, p.action_entity[k], st.action_from[k] + st.action_change[k] * share)
    return 0


@compiled
def shift_to(n: RoadTables, st: State, k: int, i: int, progress: float, offset: float) -> int:
    """Write the progress and offset of a lane change; return 1 when it is done, with the heading along the lane."""
    st.action_progress[k] = progress
    st.kept_off[i] = offset
    done = 0
    if progress >= st.action_span[k] - TOLERANCE:
        st.kept_off[i] = st.action_from[k] + st.action_change[k]
        st.turn[i] = 0.0
        done = 1
    centre, _ = lane_centre(n, st.road[i], st.kept_lane[i], st.s[i])
    st.t[i] = centre + st.kept_off[i]
    return done


@compiled
def lane_change_by_distance(n: RoadTables, p: Program, st: State, k: int, i: int, dt: float) -> int:
    """Move an entity through a lane change whose progress is the distance ahead; return 1 when it is done."""
    span = max(st.action_span[k], TOLERANCE)
    progress = st.action_progress[k]
    slope = st.action_change[k] * shape_slope(p.action_shape[k], progress / span) / span
    ahead = st.v[i] * dt / safe_sqrt(1.0 + slope * slope)
    st.turn[i] = st.facing[i] * atan(slope)
    progress = min(progress + abs(ahead), span)
    offset = st.action_from[k] + st.action_change[k] * shape_value(st, p.action_shape[k], progress / span)
    done = shift_to(n, st, k, i, progress, offset)
    glide(n, p, st, i, ahead)
    return done


@compiled
def lane_change_by_time(n: RoadTables, p: Program, st: State, k: int, i: int, dt: float) -> int:
    """Move an entity through a lane change whose progress is time; return 1 when it is done.

    Where the change asks for more than the entity moves in the step, it goes straight sideways as far as it can, with
    the share done as if the shape were linear. The offset is shifted first: on a curve s moves by the new offset.
    """
    span = max(st.action_span[k], TOLERANCE)
    progress = st.action_progress[k]
    change = st.action_change[k]
    side = dt * abs(change) * shape_slope(p.action_shape[k], progress / span) / span
    path = abs(st.v[i]) * dt
    left = 1.0 if change > 0.0 else -1.0
    if side > path:
        st.turn[i] = st.facing[i] * left * 0.5 * pi
        progress = min(progress + span * path / max(abs(change), TOLERANCE), span)
        return shift_to(n, st, k, i, progress, st.action_from[k] + change * progress / span)
    ahead = safe_sqrt(path * path - side * side)
    st.turn[i] = st.facing[i] * left * atan2(side, ahead) if side > 0.0 else 0.0
    progress = min(progress + dt, span)
    offset = st.action_from[k] + change * shape_value(st, p.action_shape[k], progress / span)
    done = shift_to(n, st, k, i, progress, offset)
    glide(n, p, st, i, ahead if st.v[i] > 0.0 else -ahead)
    return done


@compiled
def step_lane_change(n: RoadTables, p: Program, st: State, k: int, dt: float) -> int:
    """Step a lane change or a move to an offset; return 1 when it is done.

    A standing entity waits; the ego has done so at once.
    """
    i = p.action_entity[k]
    if p.entity_motion[i] != MOTION_SCRIPTED or st.road[i] < 0:
        return 1
    if st.action_span[k] <= 0.0:
        st.kept_off[i] = st.action_from[k] + st.action_change[k]
        place_scripted(n, p, st, i)
        return 1
    if abs(st.v[i]) < TOLERANCE or dt <= 0.0:
        return 0
    if p.action_dimension[k] == DIMENSION_DISTANCE:
        done = lane_change_by_distance(n, p, st, k, i, dt)
    else:
        done = lane_change_by_time(n, p, st, k, i, dt)
    st.moved[i] = 1
    place_scripted(n, p, st, i)
    if st.ended[i] == 1:
        return 1
    return done


@compiled
def step_action(n: RoadTables, p: Program, st: State, k: int, dt: float) -> None:
    """Step one running action and complete it where it is done."""
    op = p.action_op[k]
    done = 1
    if op == ACTION_SPEED:
        done = step_speed(p, st, k, dt)
    elif op in (ACTION_LANE_CHANGE, ACTION_LANE_OFFSET):
        done = step_lane_change(n, p, st, k, dt)
    elif op == ACTION_FOLLOW_PATH:
        done = step_follow_path(n, p, st, k, dt)
    if done == 1:
        action_done(p, st, k, st.frame[0] + 1)


@compiled
def run_actions(n: RoadTables, p: Program, st: State, dt: float) -> None:
    """Step all running actions: the init's, then the story's in document order."""
    for c in range(p.init_count[0]):
        if st.action_state[p.init_action[c]] == RUNNING:
            step_action(n, p, st, p.init_action[c], dt)
    for e in range(p.element_count[0]):
        if p.element_kind[e] == ELEMENT_ACTION and st.element_state[e] == RUNNING:
            k = p.element_action[e]
            if k >= 0:
                step_action(n, p, st, k, dt)
