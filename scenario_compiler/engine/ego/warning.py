"""When the automation warns: a cause of a request is foreseen, or its reason is weak.

Beginning and ending have thresholds and least durations of their own, so that no warning flickers. A reason must hold
for `warning_after`; a warning lasts for at least `warning_least`, and until there has been no reason for
`warning_clear`. A total failure of the camera cannot be foreseen, so there is no warning of it: while the camera's
health is below the threshold of the request, neither the camera nor the lane that it does not see is a reason to warn.
If a limit ahead is detected too late for a warning before the request, there is only the request.
"""

from __future__ import annotations

from math import ceil

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.log import log_event
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.limits import CLOSE, budget_of, closing_speed, control_period
from scenario_compiler.marker import compiled

MOST_PERIODS = 1.0e9
"""Number of control periods up to which a time is rounded up to whole ones."""


@compiled
def time_to_begin(p: Program) -> float:
    """Return the time from the first control step with a reason to warn to the warning, s: whole control periods.

    A time that is NaN or too long to be counted is returned unchanged.
    """
    period = max(control_period(p), op.TOLERANCE)
    periods = p.const[slot.K_WARNING_AFTER] / period - op.TOLERANCE
    if not abs(periods) < MOST_PERIODS:
        return p.const[slot.K_WARNING_AFTER]
    return ceil(periods) * period


@compiled
def warning_distance(p: Program, closing: float, own: int, budget: int) -> float:
    """Return the distance to a limit within which there is a reason to warn, m; `closing` is the closing speed, m/s.

    With a budget of its own in the slot `own`, the warning begins within one control period of it. Without one, the
    warning begins `warning_lead` before the request, taking into account the time until a warning begins.
    """
    time = p.const[own]
    if time < 0.0:
        time = budget_of(p, budget) + p.const[slot.K_WARNING_LEAD] + control_period(p)
    return max((time + time_to_begin(p)) * closing, CLOSE)


@compiled
def too_late_to_lead(p: Program, distance: float, closing: float, own: int, budget: int) -> int:
    """Return 1 if a warning that begins now would be less than `warning_lead` before the request.

    One control period less is allowed, because the speed may rise. A warning with a budget of its own is never too
    late.
    """
    time = budget_of(p, budget) + p.const[slot.K_WARNING_LEAD] - control_period(p)
    return 1 if p.const[own] < 0.0 and distance < time * closing - op.TOLERANCE else 0


@compiled
def comes_too_late(p: Program, st: State, i: int, cause: int) -> int:
    """Return 1 if the limit ahead that a cause is about is too near for a warning."""
    if cause == op.CAUSE_PATH_BLOCKED:
        near, closing = st.blocked_distance[0], closing_speed(st, i)
        return too_late_to_lead(p, near, closing, slot.K_BLOCKED_WARNING, slot.K_BLOCKED_BUDGET)
    if cause == op.CAUSE_LANE_ENDS:
        near = st.lane_end_distance[0]
        return too_late_to_lead(p, near, st.v[i], slot.K_LANE_END_WARNING, slot.K_LANE_END_BUDGET)
    return 0


@compiled
def warns_of_camera(p: Program, st: State, shown: int) -> int:
    """Return 1 if the camera's health is low but not lost; `shown` is 1 while a warning is shown."""
    limit = p.const[slot.K_HEALTH_OVER] if shown == 1 else p.const[slot.K_HEALTH_WARNING]
    return 1 if st.health[0] < limit and st.health[0] >= p.const[slot.K_HEALTH_REQUEST] else 0


@compiled
def warns_of_lane(p: Program, st: State, shown: int) -> int:
    """Return 1 if a working camera recognises a side of the lane badly; `shown` is 1 while a warning is shown.

    During a merge the camera is above the line between two lanes, and sees the sides of neither.
    """
    limit = p.const[slot.K_CONFIDENCE_OVER] if shown == 1 else p.const[slot.K_CONFIDENCE_WARNING]
    if st.health[0] < p.const[slot.K_HEALTH_REQUEST] or st.merging[0] == 1:
        return 0
    return 1 if min(st.conf_left[0], st.conf_right[0]) < limit else 0


@compiled
def warns_of_standing(p: Program, st: State) -> int:
    """Return 1 if the vehicle will soon have stood for too long."""
    if st.held_up_since[0] < 0.0:
        return 0
    early = p.const[slot.K_WARNING_LEAD] + time_to_begin(p) + control_period(p)
    stood = st.clock[0] - st.held_up_since[0]
    return 1 if stood >= p.const[slot.K_NO_PROGRESS_AFTER] - early else 0


@compiled
def warning_cause(p: Program, st: State, i: int, ending: int) -> int:
    """Return the cause that is a reason to warn, or CAUSE_NONE.

    `ending` is 1 if the lane ends within the warning's distance and no gap beside it is free.
    """
    shown = 1 if st.takeover_state[0] == op.TAKEOVER_WARNING else 0
    if p.cause_on[op.CAUSE_SENSOR_HEALTH] == 1 and warns_of_camera(p, st, shown) == 1:
        return op.CAUSE_SENSOR_HEALTH
    if p.cause_on[op.CAUSE_LANE_CONFIDENCE] == 1 and warns_of_lane(p, st, shown) == 1:
        return op.CAUSE_LANE_CONFIDENCE
    if p.cause_on[op.CAUSE_PATH_BLOCKED] == 1:
        reach = warning_distance(p, closing_speed(st, i), slot.K_BLOCKED_WARNING, slot.K_BLOCKED_BUDGET)
        if st.blocked_distance[0] <= reach:
            return op.CAUSE_PATH_BLOCKED
    if p.cause_on[op.CAUSE_LANE_ENDS] == 1 and ending == 1:
        return op.CAUSE_LANE_ENDS
    if p.cause_on[op.CAUSE_NO_PROGRESS] == 1 and warns_of_standing(p, st) == 1:
        return op.CAUSE_NO_PROGRESS
    return op.CAUSE_NONE


@compiled
def warn(st: State, cause: int) -> None:
    """Begin a warning."""
    st.takeover_state[0] = op.TAKEOVER_WARNING
    st.cause[0] = cause
    st.warning_since[0] = st.clock[0]
    if st.time_warning[0] < 0.0:
        st.time_warning[0] = st.clock[0]
    log_event(st, op.EVENT_WARNING, 1.0 * cause)


@compiled
def note_reason(st: State, cause: int) -> None:
    """Record the time since which there has been a reason to warn, or the time since which there has been none."""
    if cause != op.CAUSE_NONE:
        st.warning_clear_since[0] = -1.0
        if st.warning_reason_since[0] < 0.0:
            st.warning_reason_since[0] = st.clock[0]
    else:
        st.warning_reason_since[0] = -1.0
        if st.warning_clear_since[0] < 0.0:
            st.warning_clear_since[0] = st.clock[0]


@compiled
def step_warning(p: Program, st: State, i: int, cause: int) -> None:
    """Begin or end the warning; `cause` is the cause that is a reason to warn now, or CAUSE_NONE."""
    now = st.clock[0]
    note_reason(st, cause)
    if st.takeover_state[0] == op.TAKEOVER_AUTOMATED:
        held = now - st.warning_reason_since[0]
        ready = cause != op.CAUSE_NONE and held >= p.const[slot.K_WARNING_AFTER] - op.TOLERANCE
        if ready and comes_too_late(p, st, i, cause) == 0:
            warn(st, cause)
    elif cause == op.CAUSE_NONE:
        lasted = now - st.warning_since[0] >= p.const[slot.K_WARNING_LEAST] - op.TOLERANCE
        if lasted and now - st.warning_clear_since[0] >= p.const[slot.K_WARNING_CLEAR] - op.TOLERANCE:
            st.takeover_state[0] = op.TAKEOVER_AUTOMATED
            st.cause[0] = op.CAUSE_NONE
            log_event(st, op.EVENT_WARNING_OVER, 0.0)


@compiled
def warned_long_enough(p: Program, st: State) -> int:
    """Return 1 if a warning has been shown for the time by which it has to precede a request."""
    if p.const[slot.K_WARNING_LEAD] <= 0.0:
        return 1
    if st.takeover_state[0] != op.TAKEOVER_WARNING:
        return 0
    return 1 if st.clock[0] - st.warning_since[0] >= p.const[slot.K_WARNING_LEAD] - op.TOLERANCE else 0
