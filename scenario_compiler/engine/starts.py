"""How actions start and end: what they take over from the entity, their change and their span."""

from __future__ import annotations

from scenario_compiler.engine.appearing import act_on_place
from scenario_compiler.engine.failures import begin_failure, end_failures, update_camera
from scenario_compiler.engine.faults import log_event
from scenario_compiler.engine.keeping_aside import start_keep_aside
from scenario_compiler.engine.keeping_distance import start_keep_distance
from scenario_compiler.engine.lane_changes import start_lane_change
from scenario_compiler.engine.lane_offsets import start_lane_offset, start_limited_offset
from scenario_compiler.engine.opcodes import (
    ACTION_ASSIGN_ROUTE,
    ACTION_DISCONNECT_TRAILER,
    ACTION_END_FAILURE,
    ACTION_FAILURE,
    ACTION_FOLLOW_PATH,
    ACTION_FOLLOW_TRAJECTORY,
    ACTION_KEEP_DISTANCE,
    ACTION_KEEP_LATERAL_DISTANCE,
    ACTION_LANE_CHANGE,
    ACTION_LANE_CHANGE_TO,
    ACTION_LANE_OFFSET,
    ACTION_LIMITED_LANE_OFFSET,
    ACTION_MESSAGE,
    ACTION_RANDOM_ROUTE,
    ACTION_RELATIVE_SPEED,
    ACTION_SENSOR_NOISE,
    ACTION_SPEED,
    ACTION_SPEED_PROFILE,
    ACTION_STOP,
    ACTION_SYNCHRONIZE,
    ACTION_TELEPORT,
    ACTION_WEATHER,
    COMPLETE,
    EVENT_MESSAGE,
    EVENT_SENSOR_NOISE,
    NONE,
    RUNNING,
    STOP_NONE,
    STOP_TRIGGER,
)
from scenario_compiler.engine.own_path import start_follow_path
from scenario_compiler.engine.slots import A_TARGET
from scenario_compiler.engine.speed_profiles import start_profile
from scenario_compiler.engine.speeds import start_speed
from scenario_compiler.engine.state import State
from scenario_compiler.engine.synchronizing import start_synchronize
from scenario_compiler.engine.tables import Program
from scenario_compiler.engine.trajectories import start_trajectory
from scenario_compiler.engine.weather import begin_weather
from scenario_compiler.engine.world_actions import act_on_world
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables


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
        act_on_world(p, st, k)


@compiled
def start_action(n: RoadTables, p: Program, st: State, k: int, element: int) -> None:
    """Start an action that stands in an element, or in the init (-1)."""
    st.action_state[k] = RUNNING
    st.action_element[k] = element
    st.action_progress[k] = 0.0
    op = p.action_op[k]
    if op in (ACTION_SPEED, ACTION_RELATIVE_SPEED):
        start_speed(p, st, k)
    elif op in (ACTION_LANE_CHANGE, ACTION_LANE_CHANGE_TO):
        start_lane_change(n, p, st, k)
    elif op == ACTION_LANE_OFFSET:
        start_lane_offset(p, st, k)
    elif op == ACTION_LIMITED_LANE_OFFSET:
        start_limited_offset(n, p, st, k)
    elif op == ACTION_KEEP_DISTANCE:
        start_keep_distance(n, p, st, k)
    elif op == ACTION_KEEP_LATERAL_DISTANCE:
        start_keep_aside(n, p, st, k)
    elif op == ACTION_SPEED_PROFILE:
        start_profile(p, st, k)
    elif op == ACTION_SYNCHRONIZE:
        start_synchronize(p, st, k)
    elif op == ACTION_FOLLOW_PATH:
        start_follow_path(p, st, k)
    elif op == ACTION_FOLLOW_TRAJECTORY:
        start_trajectory(n, p, st, k)
    elif op == ACTION_SENSOR_NOISE:
        st.noise[0] = p.const[p.action_const[k] + A_TARGET]
        update_camera(p, st)
        log_event(st, EVENT_SENSOR_NOISE, st.noise[0])
    elif op in (ACTION_ASSIGN_ROUTE, ACTION_RANDOM_ROUTE):
        st.guide[p.action_entity[k]] = p.action_other[k]
    elif op >= ACTION_TELEPORT and op <= ACTION_DISCONNECT_TRAILER:
        act_on_place(n, p, st, k)
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
