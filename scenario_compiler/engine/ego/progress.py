"""Detects that the automated vehicle stands without a reason.

Reasons are a leader that moves or a queue behind one, a red signal, a collision, and a stop that the scenario orders: a
target speed of zero or an input that an action holds. The stop of a minimum-risk manoeuvre does not count, because the
automation no longer drives; at the destination the run ends.
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.extent import front_of
from scenario_compiler.engine.columns.log import log_event
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.objects_ahead import QUEUE_GAP, follows_any
from scenario_compiler.marker import compiled

CREEPING = 0.5
"""Speed below which a vehicle makes no progress, m/s; the last metre up to a gap is driven more slowly."""


@compiled
def stop_is_ordered(st: State) -> int:
    """Return 1 if the scenario orders the ego to stand."""
    if st.target_speed[0] <= CREEPING:
        return 1
    held = st.held_on[op.HELD_BRAKE] == 1 and st.held_value[op.HELD_BRAKE] > 0.0
    parked = st.held_on[op.HELD_PARKING_BRAKE] == 1 and st.held_value[op.HELD_PARKING_BRAKE] > 0.0
    idle = st.held_on[op.HELD_THROTTLE] == 1 and st.held_value[op.HELD_THROTTLE] <= 0.0
    out_of_gear = st.held_on[op.HELD_GEAR] == 1 and st.held_value[op.HELD_GEAR] <= 0.0
    uncoupled = st.held_on[op.HELD_CLUTCH] == 1 and st.held_value[op.HELD_CLUTCH] >= 1.0
    return 1 if held or parked or idle or out_of_gear or uncoupled else 0


@compiled
def waits_at_red(p: Program, st: State, i: int) -> int:
    """Return 1 if the ego is the first vehicle before the line of a red signal."""
    front = front_of(p, i)
    return 1 if st.red_line[0] < front + QUEUE_GAP else 0


@compiled
def waits_in_queue(p: Program, st: State, i: int) -> int:
    """Return 1 if the ego waits before a red signal, or follows a leader that moves or a queue behind one."""
    return 1 if waits_at_red(p, st, i) == 1 or follows_any(p, st) == 1 else 0


@compiled
def stands_with_reason(p: Program, st: State, i: int) -> int:
    """Return 1 if the ego has a reason to stand that needs no request, or is not automated."""
    automated = st.takeover_state[0] in (op.TAKEOVER_AUTOMATED, op.TAKEOVER_WARNING)
    if not automated or st.crashed[0] == 1 or stop_is_ordered(st) == 1:
        return 1
    return waits_in_queue(p, st, i)


@compiled
def watch_progress(p: Program, st: State, i: int) -> None:
    """Measure how long the automated ego has stood without a reason; if that is too long, log it once for each stop."""
    st.held_up[0] = 0
    if st.v[i] >= CREEPING or stands_with_reason(p, st, i) == 1:
        st.held_up_since[0] = -1.0
        st.held_up_logged[0] = 0
        return
    if st.held_up_since[0] < 0.0:
        st.held_up_since[0] = st.clock[0]
    if st.clock[0] - st.held_up_since[0] < p.const[slot.K_NO_PROGRESS_AFTER] - op.TOLERANCE:
        return
    st.held_up[0] = 1
    if st.held_up_logged[0] == 0:
        st.held_up_logged[0] = 1
        if st.time_no_progress[0] < 0.0:
            st.time_no_progress[0] = st.clock[0]
        log_event(st, op.EVENT_NO_PROGRESS, 0.0)
