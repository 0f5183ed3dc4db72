"""Controllers that actions assign to entities, activate and deactivate, or override.

An entity that the storyboard moves has the default controller, which keeps its speed; the only other controller that
drives such an entity is car following. Overridden pedals and an overridden steering wheel affect only the ego.
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.numbers import clip
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.marker import compiled

SWITCHES_SPEED = 1
SPEED_ON = 2
HOLDS_INPUT = 4
"""Bits of the flags of controller actions: whether the longitudinal domain is switched, whether it is switched on, and
whether an input is held from now on.
"""

STEERING_RATIO = 16.0
"""Angle of the steering wheel divided by that of the front wheels; usual for cars."""


@compiled
def reset_controllers(p: Program, st: State) -> None:
    """Give every entity the controller that it has in the plan."""
    for i in range(p.entity_count[0]):
        st.follows[i] = p.entity_follows[i]
        st.controller[i] = op.CONTROLLER_FOLLOW if p.entity_follows[i] == 1 else op.CONTROLLER_DEFAULT
        st.desired[i] = p.const[p.entity_const[i] + slot.E_DESIRED_SPEED]


@compiled
def switch_controller(p: Program, st: State, k: int) -> None:
    """Switch the longitudinal domain of an entity's controller on or off, if the action says so.

    A car-following controller without a given speed aims for the speed that the entity has at this moment.
    """
    i = p.action_entity[k]
    if p.action_flags[k] & SWITCHES_SPEED == 0:
        return
    st.follows[i] = 0
    if p.action_flags[k] & SPEED_ON != 0 and st.controller[i] == op.CONTROLLER_FOLLOW:
        st.follows[i] = 1
        if st.desired[i] < 0.0:
            st.desired[i] = max(st.v[i], 0.0)


@compiled
def activate_controller(p: Program, st: State, k: int) -> None:
    """Switch the longitudinal domain of the named controller of an action's entity, or of its present one if unnamed.

    A controller that is switched on takes the domain over from the present one; to switch off another one than the
    present one has no effect.
    """
    i = p.action_entity[k]
    named = p.action_mode[k]
    if p.action_flags[k] & SWITCHES_SPEED != 0 and named not in (op.CONTROLLER_PRESENT, st.controller[i]):
        if p.action_flags[k] & SPEED_ON == 0:
            return
        st.controller[i] = named
        st.desired[i] = p.const[p.action_const[k] + slot.A_TARGET]
    switch_controller(p, st, k)


@compiled
def assign_controller(p: Program, st: State, k: int) -> None:
    """Give an action's entity a controller and the speed that it aims for, which is negative if none is given."""
    i = p.action_entity[k]
    st.controller[i] = p.action_mode[k]
    st.desired[i] = p.const[p.action_const[k] + slot.A_TARGET]
    if st.controller[i] != op.CONTROLLER_FOLLOW:
        st.follows[i] = 0
    switch_controller(p, st, k)


@compiled
def override_controller(p: Program, st: State, k: int) -> None:
    """Hold an input of the ego, or release it."""
    if p.action_entity[k] != p.ego[0]:
        return
    held = p.action_mode[k]
    st.held_on[held] = 1 if p.action_flags[k] & HOLDS_INPUT != 0 else 0
    st.held_value[held] = p.const[p.action_const[k] + slot.A_TARGET]


@compiled
def hold_inputs(p: Program, st: State, ego: int) -> None:
    """Replace the ego's commands by the held inputs; while a brake is held, there is no throttle."""
    if st.held_on[op.HELD_BRAKE] == 1:
        st.command_brake[ego] = clip(st.held_value[op.HELD_BRAKE], 0.0, 1.0)
        st.command_throttle[ego] = 0.0
    if st.held_on[op.HELD_PARKING_BRAKE] == 1:
        st.command_brake[ego] = max(st.command_brake[ego], clip(st.held_value[op.HELD_PARKING_BRAKE], 0.0, 1.0))
        st.command_throttle[ego] = 0.0
    if st.held_on[op.HELD_THROTTLE] == 1:
        st.command_throttle[ego] = clip(st.held_value[op.HELD_THROTTLE], 0.0, 1.0)
    if st.held_on[op.HELD_CLUTCH] == 1:
        st.command_throttle[ego] = st.command_throttle[ego] * (1.0 - clip(st.held_value[op.HELD_CLUTCH], 0.0, 1.0))
    if st.held_on[op.HELD_GEAR] == 1 and st.held_value[op.HELD_GEAR] <= 0.0:
        st.command_throttle[ego] = 0.0
    if st.held_on[op.HELD_WHEEL] == 1:
        most = max(p.const[p.entity_const[ego] + slot.E_MAX_STEER], 0.01)
        st.command_steer[ego] = clip(st.held_value[op.HELD_WHEEL] / STEERING_RATIO / most, -1.0, 1.0)
