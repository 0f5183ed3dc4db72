"""A person at the wheel, who takes over, drives with pedals and steering wheel, and hands back.

The person's inputs stand in input columns of the state, which Python writes between steps. None of them is random, so a
run can be repeated exactly from its recorded inputs.
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.log import log_event
from scenario_compiler.engine.columns.numbers import clip
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.foresight import LIFT_OFF
from scenario_compiler.engine.ego.takeover import begin_minimum_risk, hand_back, switch_hazard_lights
from scenario_compiler.marker import compiled


@compiled
def nothing_asks(p: Program, st: State) -> int:
    """Return 1 if no cause asked for a takeover at the last control step."""
    for k in range(p.cause_count[0]):
        if st.asking[p.cause_order[k]] == 1:
            return 0
    return 1


@compiled
def takes_over(p: Program, st: State) -> int:
    """Return 1 if a person wishes to take over, and the automation drives.

    This begins a control step of its own, so that the response is not delayed to the automation's next one.
    """
    if p.person[0] == 0 or st.person_wish[0] != op.WISH_TAKE_OVER or st.crashed[0] == 1:
        return 0
    state = st.takeover_state[0]
    ended = state in (op.TAKEOVER_MANUAL, op.TAKEOVER_HAND_BACK, op.TAKEOVER_STANDSTILL)
    return 0 if ended else 1


@compiled
def heed_person(p: Program, st: State) -> None:
    """Carry out the person's wish: take over at any time, hand back if no cause requests, stop if the person has left.

    An experimenter may also wish that the automation requests a takeover now. Nothing is answered by a person who left
    and takes over again in the minimum-risk manoeuvre that this began: it has no cause, and no request is open. After a
    collision no wish is heeded.
    """
    wish = st.person_wish[0]
    state = st.takeover_state[0]
    if wish == op.WISH_TAKE_OVER:
        left = 1 if state == op.TAKEOVER_MINIMUM_RISK and st.cause[0] == op.CAUSE_NONE else 0
        if state in (op.TAKEOVER_AUTOMATED, op.TAKEOVER_WARNING) or left == 1:
            st.takeover_state[0] = op.TAKEOVER_MANUAL
            st.cause[0] = op.CAUSE_NONE
            st.manual_since[0] = st.clock[0]
            log_event(st, op.EVENT_OVERRIDE, 0.0)
            switch_hazard_lights(st, 0)
        elif state in (op.TAKEOVER_REQUEST, op.TAKEOVER_ESCALATION, op.TAKEOVER_MINIMUM_RISK):
            st.answer_at[0] = st.clock[0]
    elif wish == op.WISH_HAND_BACK:
        if state == op.TAKEOVER_MANUAL and nothing_asks(p, st) == 1:
            hand_back(st)
    elif wish == op.WISH_REQUEST:
        if state in (op.TAKEOVER_AUTOMATED, op.TAKEOVER_WARNING):
            st.ordered_request[0] = op.CAUSE_SCHEDULED
    elif wish == op.WISH_LEAVE and state == op.TAKEOVER_MANUAL:
        st.cause[0] = op.CAUSE_NONE
        begin_minimum_risk(p, st)


@compiled
def drive_by_person(st: State, i: int) -> None:
    """Apply the person's pedals and steering wheel to the ego, which slows down without pedals."""
    st.drag[i] = LIFT_OFF
    st.command_throttle[i] = clip(st.person_throttle[0], 0.0, 1.0)
    st.command_brake[i] = clip(st.person_brake[0], 0.0, 1.0)
    st.command_steer[i] = clip(st.person_steer[0], -1.0, 1.0)
