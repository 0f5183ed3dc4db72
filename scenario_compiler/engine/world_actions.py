"""Actions on the world at large: variables, traffic signals, the time of day, controllers, background traffic."""

from __future__ import annotations

from scenario_compiler.engine.controllers import assign_controller, override_controller, switch_controller
from scenario_compiler.engine.faults import fault, log_event
from scenario_compiler.engine.opcodes import (
    ACTION_ACTIVATE_CONTROLLER,
    ACTION_ANIMATION,
    ACTION_ASSIGN_CONTROLLER,
    ACTION_COMMAND,
    ACTION_ENDS,
    ACTION_ENVIRONMENT,
    ACTION_LIGHT,
    ACTION_MODIFY_VARIABLE,
    ACTION_OVERRIDE_CONTROLLER,
    ACTION_SET_VARIABLE,
    ACTION_SIGNAL_PHASE,
    ACTION_SIGNAL_STATE,
    ACTION_STOP_TRAFFIC,
    ACTION_TRAFFIC_SINK,
    ACTION_TRAFFIC_SWARM,
    EVENT_COMMAND,
    EVENT_LIGHT,
    EVENT_SIGNAL,
    FAULT_UNKNOWN_ACTION,
    MOTION_TRAFFIC,
    MOTION_WALKER,
    TOLERANCE,
)
from scenario_compiler.engine.signals import set_phase
from scenario_compiler.engine.slots import A_DYNAMICS
from scenario_compiler.engine.state import State
from scenario_compiler.engine.surroundings import change_surroundings
from scenario_compiler.engine.tables import Program
from scenario_compiler.engine.variables import modify_variable, set_variable
from scenario_compiler.marker import compiled


@compiled
def stop_traffic(p: Program, st: State, k: int) -> None:
    """Take background traffic away, `action_lanes` entities from `action_other` on, and end actions of that name.

    `action_mode` is the number of the name, 0 for all.
    """
    for i in range(max(p.action_other[k], 0), p.action_other[k] + p.action_lanes[k]):
        kind = p.entity_motion[i]
        if p.entity_position[i] >= 0 and kind in (MOTION_TRAFFIC, MOTION_WALKER):
            st.present[i] = 0
    for other in range(p.action_count[0]):
        op = p.action_op[other]
        named = p.action_mode[k] == 0 or p.action_mode[k] == p.action_mode[other]
        if op >= ACTION_TRAFFIC_SWARM and op <= ACTION_TRAFFIC_SINK and named:
            st.action_b[other] = ACTION_ENDS


@compiled
def begin_traffic(st: State, k: int) -> None:
    """Begin a swarm, source or sink: its first step is the next."""
    st.action_a[k] = 0.0
    st.action_b[k] = 0.0


@compiled
def act_on_world(p: Program, st: State, k: int) -> None:
    """Start an action on the world at large; all of them but animations are done at once."""
    op = p.action_op[k]
    if op == ACTION_SET_VARIABLE:
        set_variable(p, st, k)
    elif op == ACTION_MODIFY_VARIABLE:
        modify_variable(p, st, k)
    elif op == ACTION_SIGNAL_STATE:
        st.signal_state[p.action_other[k]] = p.action_mode[k]
        log_event(st, EVENT_SIGNAL, 1.0 * k)
    elif op == ACTION_SIGNAL_PHASE:
        set_phase(p, st, p.action_other[k], p.action_mode[k])
        log_event(st, EVENT_SIGNAL, 1.0 * k)
    elif op == ACTION_ENVIRONMENT:
        change_surroundings(p, st, k)
    elif op in (ACTION_LIGHT, ACTION_ANIMATION):
        log_event(st, EVENT_LIGHT, 1.0 * k)
    elif op == ACTION_COMMAND:
        log_event(st, EVENT_COMMAND, 1.0 * k)
    elif op == ACTION_ACTIVATE_CONTROLLER:
        switch_controller(p, st, k)
    elif op == ACTION_ASSIGN_CONTROLLER:
        assign_controller(p, st, k)
    elif op == ACTION_OVERRIDE_CONTROLLER:
        override_controller(p, st, k)
    elif op == ACTION_STOP_TRAFFIC:
        stop_traffic(p, st, k)
    elif op >= ACTION_TRAFFIC_SWARM and op <= ACTION_TRAFFIC_SINK:
        begin_traffic(st, k)
    else:
        fault(st, FAULT_UNKNOWN_ACTION, k)


@compiled
def step_animation(p: Program, st: State, k: int, dt: float) -> int:
    """Let the time of an animation pass; return 1 when it is over."""
    st.action_progress[k] = st.action_progress[k] + dt
    return 1 if st.action_progress[k] >= p.const[p.action_const[k] + A_DYNAMICS] - TOLERANCE else 0
