"""How actions start and end: what they take over from the entity, their change and their span."""

from __future__ import annotations

from scenario_compiler.engine.failures import begin_failure, end_failures, update_camera
from scenario_compiler.engine.faults import fault, log_event
from scenario_compiler.engine.lane_keeping import plan_shift, shift_distance
from scenario_compiler.engine.numbers import clip
from scenario_compiler.engine.opcodes import (
    ACTION_END_FAILURE,
    ACTION_FAILURE,
    ACTION_FOLLOW_PATH,
    ACTION_LANE_CHANGE,
    ACTION_LANE_OFFSET,
    ACTION_MESSAGE,
    ACTION_SENSOR_NOISE,
    ACTION_SPEED,
    ACTION_STOP,
    ACTION_WEATHER,
    COMPLETE,
    DIMENSION_DISTANCE,
    EVENT_MESSAGE,
    EVENT_SENSOR_NOISE,
    FAULT_UNKNOWN_ACTION,
    MOTION_SCRIPTED,
    NONE,
    RUNNING,
    STOP_NONE,
    STOP_TRIGGER,
)
from scenario_compiler.engine.own_path import start_follow_path
from scenario_compiler.engine.shapes import shape_peak, transition_span
from scenario_compiler.engine.slots import (
    A_DYNAMICS,
    A_TARGET,
    E_MAX_ACCELERATION,
    E_MAX_DECELERATION,
    E_MAX_SPEED,
)
from scenario_compiler.engine.state import State
from scenario_compiler.engine.tables import Program
from scenario_compiler.engine.weather import begin_weather
from scenario_compiler.marker import compiled
from scenario_compiler.roads.lanes import lane_centre, lane_exists
from scenario_compiler.roads.tables import RoadTables

OFFSET_ACCELERATION = 1.0
"""Greatest lateral acceleration with which the ego's automation moves to an offset, m/s2."""


@compiled
def neighbour_lane(n: RoadTables, road: int, lane: int, s: float, by: int, facing: int) -> int:
    """Return the lane `by` lanes to the left as seen along `facing` (1: along s), 0 where there is none.

    The centre lane is not counted.
    """
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
    if lane_exists(n, road, at, s) == 0:
        return 0
    return at


@compiled
def set_speed(p: Program, st: State, i: int, speed: float) -> None:
    """Set a scripted entity's speed, or the speed that the ego's automation aims for."""
    if p.entity_motion[i] == MOTION_SCRIPTED:
        st.v[i] = speed
    elif i == p.ego[0]:
        st.target_speed[0] = max(speed, 0.0)


@compiled
def speed_before(p: Program, st: State, i: int) -> float:
    """Return what `set_speed` changes."""
    if p.entity_motion[i] != MOTION_SCRIPTED and i == p.ego[0]:
        return st.target_speed[0]
    return st.v[i]


@compiled
def start_speed(p: Program, st: State, k: int) -> None:
    """Prepare a change of speed; one too fast for the entity's limits takes longer, but a step does not."""
    i = p.action_entity[k]
    base = p.action_const[k]
    block = p.entity_const[i]
    most = p.const[block + E_MAX_SPEED]
    target = clip(p.const[base + A_TARGET], -most, most)
    begin = speed_before(p, st, i)
    change = target - begin
    shape = p.action_shape[k]
    span = transition_span(shape, p.action_dimension[k], p.const[base + A_DYNAMICS], change)
    if p.action_dimension[k] == DIMENSION_DISTANCE and span > 0.0:
        both = abs(begin + target)
        span = 2.0 * span / both if both > 1.0e-9 else 0.0
    if span > 0.0:
        limit = p.const[block + E_MAX_ACCELERATION] if change > 0.0 else p.const[block + E_MAX_DECELERATION]
        peak = shape_peak(shape) * abs(change)
        if limit > 1.0e-9 and peak > limit * span:
            span = peak / limit
    else:
        set_speed(p, st, i, target)
    st.action_from[k] = begin
    st.action_change[k] = change
    st.action_span[k] = span
    st.longitudinal[i] = k


@compiled
def start_lane_change(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Freeze the target lane and lead the entity by it, offset by the present gap; its heading is reset to the lane's.

    The ego's automation takes the target as its lane and steers there by itself. A target that does not exist leaves a
    change of 0.
    """
    i = p.action_entity[k]
    road = st.road[i]
    st.action_from[k] = 0.0
    st.action_change[k] = 0.0
    st.action_span[k] = 0.0
    st.lateral[i] = k
    if road < 0:
        return
    target = neighbour_lane(n, road, st.lane[i], st.s[i], p.action_lanes[k], st.facing[i])
    if target == 0:
        return
    if p.entity_motion[i] != MOTION_SCRIPTED:
        if i == p.ego[0]:
            st.path_road[0] = road
            st.path_lane[0] = target
            st.path_s[0] = st.s[i]
        return
    centre, _ = lane_centre(n, road, target, st.s[i])
    gap = st.t[i] - centre
    st.kept_lane[i] = target
    st.kept_off[i] = gap
    st.turn[i] = 0.0
    st.action_from[k] = gap
    st.action_change[k] = -gap
    value = p.const[p.action_const[k] + A_DYNAMICS]
    st.action_span[k] = transition_span(p.action_shape[k], p.action_dimension[k], value, gap)


@compiled
def start_lane_offset(p: Program, st: State, k: int) -> None:
    """Prepare a move to an offset from the lane's centre; the ego's automation plans it and steers by itself."""
    i = p.action_entity[k]
    base = p.action_const[k]
    left = p.const[base + A_TARGET]
    st.action_from[k] = 0.0
    st.action_change[k] = 0.0
    st.action_span[k] = 0.0
    st.lateral[i] = k
    if st.road[i] < 0:
        return
    if p.entity_motion[i] != MOTION_SCRIPTED:
        if i == p.ego[0]:
            least = shift_distance(st.v[i], left - st.path_off[0], OFFSET_ACCELERATION)
            plan_shift(st, i, left, max(least, st.v[i] * p.const[base + A_DYNAMICS]))
        return
    st.turn[i] = 0.0
    st.action_from[k] = st.kept_off[i]
    st.action_change[k] = st.facing[i] * left - st.kept_off[i]
    value = p.const[base + A_DYNAMICS]
    st.action_span[k] = transition_span(p.action_shape[k], p.action_dimension[k], value, st.action_change[k])


@compiled
def act_at_once(p: Program, st: State, k: int) -> None:
    """Do an action that concerns the run as a whole: the camera, the weather, a message, the end."""
    op = p.action_op[k]
    if op == ACTION_FAILURE:
        begin_failure(st, p.action_other[k])
        update_camera(p, st)
    elif op == ACTION_END_FAILURE:
        end_failures(p, st, p.action_other[k])
        update_camera(p, st)
    elif op == ACTION_WEATHER:
        begin_weather(p, st, k)
    elif op == ACTION_MESSAGE:
        log_event(st, EVENT_MESSAGE, 1.0 * p.action_other[k])
    elif op == ACTION_STOP:
        if st.stop[0] == STOP_NONE:
            st.stop[0] = STOP_TRIGGER
    else:
        fault(st, FAULT_UNKNOWN_ACTION, k)


@compiled
def start_action(n: RoadTables, p: Program, st: State, k: int, element: int) -> None:
    """Start an action that stands in an element, or in the init (-1)."""
    st.action_state[k] = RUNNING
    st.action_element[k] = element
    st.action_progress[k] = 0.0
    op = p.action_op[k]
    if op == ACTION_SPEED:
        start_speed(p, st, k)
    elif op == ACTION_LANE_CHANGE:
        start_lane_change(n, p, st, k)
    elif op == ACTION_LANE_OFFSET:
        start_lane_offset(p, st, k)
    elif op == ACTION_FOLLOW_PATH:
        start_follow_path(p, st, k)
    elif op == ACTION_SENSOR_NOISE:
        st.noise[0] = p.const[p.action_const[k] + A_TARGET]
        update_camera(p, st)
        log_event(st, EVENT_SENSOR_NOISE, st.noise[0])
    else:
        act_at_once(p, st, k)


@compiled
def end_action(p: Program, st: State, k: int) -> None:
    """End an action and free the domain that it held."""
    st.action_state[k] = COMPLETE
    i = p.action_entity[k]
    if i < 0:
        return
    if st.longitudinal[i] == k:
        st.longitudinal[i] = NONE
    if st.lateral[i] == k:
        st.lateral[i] = NONE
