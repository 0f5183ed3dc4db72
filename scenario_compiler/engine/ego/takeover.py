"""The takeover: warning, request, escalation, response and minimum-risk manoeuvre.

It advances at control steps. A cause must hold in `count` of the last `of` control steps. The time of the driver's
response is drawn at the request; until then only the automation acts.
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.log import log_event
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.answering import note_stages, plan_answer
from scenario_compiler.engine.ego.around import note_density
from scenario_compiler.engine.ego.limits import closing_speed, lane_ends, request_distance, short_distance
from scenario_compiler.engine.ego.minimum_risk import minimum_risk_due
from scenario_compiler.engine.ego.reach import look_with_sensor
from scenario_compiler.engine.ego.standing import log_standstill
from scenario_compiler.engine.ego.unchanged import time_left
from scenario_compiler.engine.ego.warning import (
    note_reason,
    step_warning,
    warn,
    warned_long_enough,
    warning_cause,
    warning_distance,
)
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables

HISTORY_SIZE = 32


@compiled
def remember(st: State, cause: int, raw: int, count: float, of: float) -> None:
    """Record whether a cause has a reason at this control step; it asks if it had one in `count` of the last `of`."""
    bits = (st.history[cause] * 2 + raw) & 0xFFFFFFFF
    st.history[cause] = bits
    found = 0
    k = 0
    while bits >> k != 0 and k < of:
        found += (bits >> k) & 1
        k += 1
    st.asking[cause] = 1 if found > 0 and found >= count else 0


@compiled
def lacks_confidence(p: Program, st: State) -> int:
    """Return 1 if the confidence in both sides of the lane is too low, and the vehicle does not merge across a line."""
    if st.merging[0] == 1:
        return 0
    limit = p.const[slot.K_CONFIDENCE_REQUEST]
    return 1 if st.conf_left[0] < limit and st.conf_right[0] < limit else 0


@compiled
def asking_cause(n: RoadTables, p: Program, st: State, i: int) -> int:
    """Return the cause that asks for a takeover now, or CAUSE_NONE; updates the history of every cause."""
    unwell = 1 if st.health[0] < p.const[slot.K_HEALTH_REQUEST] else 0
    near = request_distance(p, closing_speed(st, i), slot.K_BLOCKED_BUDGET, slot.K_BLOCKED_COUNT)
    blocked = 1 if st.blocked_distance[0] <= near else 0
    low = lacks_confidence(p, st)
    ending = lane_ends(n, p, st, request_distance(p, st.v[i], slot.K_LANE_END_BUDGET, slot.K_LANE_END_COUNT))
    reasons = low + unwell + blocked + ending + st.auto_request[0] + st.held_up[0]
    st.quiet[0] = st.quiet[0] + 1 if reasons == 0 else 0
    if st.quiet[0] > HISTORY_SIZE:
        return op.CAUSE_NONE
    remember(st, op.CAUSE_LANE_CONFIDENCE, low, p.const[slot.K_CONFIDENCE_COUNT], p.const[slot.K_CONFIDENCE_OF])
    remember(st, op.CAUSE_SENSOR_HEALTH, unwell, p.const[slot.K_HEALTH_COUNT], p.const[slot.K_HEALTH_OF])
    remember(st, op.CAUSE_PATH_BLOCKED, blocked, p.const[slot.K_BLOCKED_COUNT], p.const[slot.K_BLOCKED_OF])
    remember(st, op.CAUSE_LANE_ENDS, ending, p.const[slot.K_LANE_END_COUNT], p.const[slot.K_LANE_END_OF])
    st.asking[op.CAUSE_CONTROLLER] = st.auto_request[0]
    st.asking[op.CAUSE_NO_PROGRESS] = st.held_up[0]
    automated = st.takeover_state[0] in (op.TAKEOVER_AUTOMATED, op.TAKEOVER_WARNING)
    if automated and unwell == 0 and warned_long_enough(p, st) == 0:
        st.asking[op.CAUSE_LANE_CONFIDENCE] = 0
    for k in range(p.cause_count[0]):
        if st.asking[p.cause_order[k]] == 1:
            return p.cause_order[k]
    return op.CAUSE_NONE


@compiled
def note_short_start(n: RoadTables, p: Program, st: State, i: int) -> None:
    """Log a limit ahead that is already within its time budget at the first control step."""
    if st.frame[0] != 1:
        return
    cause = op.CAUSE_NONE
    if p.cause_on[op.CAUSE_LANE_ENDS] == 1:
        within = short_distance(p, st.v[i], slot.K_LANE_END_BUDGET, slot.K_LANE_END_COUNT)
        if lane_ends(n, p, st, within) == 1:
            cause = op.CAUSE_LANE_ENDS
    if p.cause_on[op.CAUSE_PATH_BLOCKED] == 1:
        within = short_distance(p, closing_speed(st, i), slot.K_BLOCKED_BUDGET, slot.K_BLOCKED_COUNT)
        if st.blocked_distance[0] < within:
            cause = op.CAUSE_PATH_BLOCKED
    if cause != op.CAUSE_NONE:
        st.time_short_start[0] = st.clock[0]
        log_event(st, op.EVENT_SHORT_START, 1.0 * cause)


@compiled
def foreseen_cause(n: RoadTables, p: Program, st: State, i: int) -> int:
    """Return the cause that is a reason to warn, or CAUSE_NONE."""
    within = warning_distance(p, st.v[i], slot.K_LANE_END_WARNING, slot.K_LANE_END_BUDGET)
    return warning_cause(p, st, i, lane_ends(n, p, st, within))


@compiled
def request_takeover(p: Program, st: State, cause: int) -> None:
    """Request a takeover for a cause, and plan the driver's response."""
    now = st.clock[0]
    st.takeover_state[0] = op.TAKEOVER_REQUEST
    st.cause[0] = cause
    st.requests[0] += 1
    st.request_at[0] = now
    st.path_anew[0] = 0
    if st.time_request[0] < 0.0:
        st.time_request[0] = now
    plan_answer(p, st)
    log_event(st, op.EVENT_REQUEST, 1.0 * cause)


@compiled
def step_automated(n: RoadTables, p: Program, st: State, i: int) -> None:
    """Advance the states automated and warning: request a takeover, begin a warning or end it."""
    cause = asking_cause(n, p, st, i)
    note_short_start(n, p, st, i)
    if st.ordered_request[0] != op.CAUSE_NONE:
        cause = st.ordered_request[0]
    foreseen = foreseen_cause(n, p, st, i)
    if cause != op.CAUSE_NONE:
        note_density(n, p, st, i)
        look_with_sensor(n, p, st, i)
        request_takeover(p, st, cause)
        st.limit_time[0] = time_left(n, p, st, i, cause)
    elif st.ordered_warning[0] == 1 and st.takeover_state[0] == op.TAKEOVER_AUTOMATED:
        warn(st, op.CAUSE_SCHEDULED)
        note_reason(st, foreseen)
    else:
        step_warning(p, st, i, foreseen)


@compiled
def switch_hazard_lights(st: State, on: int) -> None:
    """Switch the hazard lights, and log a change."""
    if st.hazard_lights[0] != on:
        st.hazard_lights[0] = on
        log_event(st, op.EVENT_HAZARD_LIGHTS, 1.0 * on)


@compiled
def begin_minimum_risk(p: Program, st: State) -> None:
    """Begin the minimum-risk manoeuvre."""
    st.takeover_state[0] = op.TAKEOVER_MINIMUM_RISK
    if st.time_minimum_risk[0] < 0.0:
        st.time_minimum_risk[0] = st.clock[0]
    log_event(st, op.EVENT_MINIMUM_RISK, 0.0)
    switch_hazard_lights(st, p.hazard_lights[0])


@compiled
def answer(st: State) -> None:
    """Let the driver take over."""
    now = st.clock[0]
    st.takeover_state[0] = op.TAKEOVER_MANUAL
    st.manual_since[0] = now
    st.manoeuvre[0] = op.MANOEUVRE_KEEP
    st.answer_at[0] = op.FAR
    if st.time_response[0] < 0.0:
        st.time_response[0] = now
    log_event(st, op.EVENT_RESPONSE, now - st.request_at[0])
    switch_hazard_lights(st, 0)


@compiled
def step_requested(n: RoadTables, p: Program, st: State, i: int) -> None:
    """Advance the states request, escalation and minimum-risk manoeuvre to response, standstill or the next of them."""
    now = st.clock[0]
    state = st.takeover_state[0]
    note_stages(st)
    if now >= st.answer_at[0] - op.TOLERANCE:
        answer(st)
    elif state == op.TAKEOVER_MINIMUM_RISK:
        if st.v[i] <= 0.0:
            st.takeover_state[0] = op.TAKEOVER_STANDSTILL
            log_standstill(n, p, st, i, 0)
    elif minimum_risk_due(p, st, i) == 1:
        begin_minimum_risk(p, st)
    elif state == op.TAKEOVER_REQUEST and now - st.request_at[0] >= p.const[slot.K_ESCALATE_AFTER] - op.TOLERANCE:
        st.takeover_state[0] = op.TAKEOVER_ESCALATION
        if st.time_escalation[0] < 0.0:
            st.time_escalation[0] = now
        log_event(st, op.EVENT_ESCALATION, 0.0)


@compiled
def hand_back(st: State) -> None:
    """Hand control back; the automation drives from the next control step on."""
    st.takeover_state[0] = op.TAKEOVER_HAND_BACK
    st.cause[0] = op.CAUSE_NONE
    st.warning_reason_since[0] = -1.0
    for c in range(op.CAUSES):
        st.history[c] = 0
    log_event(st, op.EVENT_HAND_BACK, 0.0)


@compiled
def step_manual(n: RoadTables, p: Program, st: State, i: int) -> None:
    """Advance the manual states: hand back after the given time if no cause asks, and activate a control step later."""
    cause = asking_cause(n, p, st, i)
    if st.takeover_state[0] == op.TAKEOVER_HAND_BACK:
        st.takeover_state[0] = op.TAKEOVER_AUTOMATED
        st.looking[0] = 0
        log_event(st, op.EVENT_ACTIVATION, 0.0)
        return
    if st.ordered_hand_back[0] == 1 and st.crashed[0] == 0:
        hand_back(st)
        return
    wait = p.const[slot.K_HAND_BACK_AFTER]
    if wait <= 0.0 or st.clock[0] - st.manual_since[0] < wait - op.TOLERANCE or cause != op.CAUSE_NONE:
        return
    foreseen = foreseen_cause(n, p, st, i)
    if foreseen == op.CAUSE_NONE and st.manoeuvre[0] == op.MANOEUVRE_KEEP and st.crashed[0] == 0:
        hand_back(st)


@compiled
def step_takeover(n: RoadTables, p: Program, st: State, i: int) -> None:
    """Advance the takeover by one control step.

    A request or warning that is ordered during the hand-back waits until the automation drives.
    """
    state = st.takeover_state[0]
    if state in (op.TAKEOVER_AUTOMATED, op.TAKEOVER_WARNING):
        step_automated(n, p, st, i)
    elif state in (op.TAKEOVER_MANUAL, op.TAKEOVER_HAND_BACK):
        step_manual(n, p, st, i)
    elif state != op.TAKEOVER_STANDSTILL:
        step_requested(n, p, st, i)
    st.ordered_hand_back[0] = 0
    if op.TAKEOVER_HAND_BACK not in (state, st.takeover_state[0]):
        st.ordered_request[0] = op.CAUSE_NONE
        st.ordered_warning[0] = 0
