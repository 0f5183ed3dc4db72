"""The takeovers of a run: the cause of each, the times of its events, and the driving in it."""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.numbers import SAME_TIME
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.columns.totals import TAKEOVERS, Totals
from scenario_compiler.engine.measures.takeover import behind_collision
from scenario_compiler.marker import compiled


@compiled
def note_state(m: Totals, k: int, state: int) -> None:
    """Record that takeover k has reached a state for the first time."""
    now = m.row_time[0]
    if state == op.TAKEOVER_ESCALATION and m.takeover_escalation[k] < 0.0:
        m.takeover_escalation[k] = now
    elif state == op.TAKEOVER_MANUAL and m.takeover_response[k] < 0.0:
        m.takeover_response[k] = now
    elif state == op.TAKEOVER_MINIMUM_RISK and m.takeover_minimum_risk[k] < 0.0:
        m.takeover_minimum_risk[k] = now
    elif state == op.TAKEOVER_STANDSTILL and m.takeover_standstill[k] < 0.0:
        m.takeover_standstill[k] = now
    elif state == op.TAKEOVER_HAND_BACK and m.takeover_hand_back[k] < 0.0:
        m.takeover_hand_back[k] = now


@compiled
def add_quality(m: Totals, k: int) -> None:
    """Add the driving of the last row to takeover k, up to the first collision."""
    if m.row_present[0] == 0 or behind_collision(m) == 1:
        return
    m.takeover_lane_time[k] = min(m.takeover_lane_time[k], m.row_lane_time[0])
    m.takeover_longitudinal[k] = max(m.takeover_longitudinal[k], abs(m.row_a[0]))
    if m.rows[0] > 1:
        m.takeover_lateral[k] = max(m.takeover_lateral[k], abs(m.row_v[0] * m.row_v[0] * m.curvature[0]))


@compiled
def add_takeovers(st: State, m: Totals) -> None:
    """Add the last row: a new request, a new state, and in the first row after a request its limit."""
    if st.requests[0] > m.requests[0]:
        m.requests[0] = st.requests[0]
        m.undescribed[0] = 1
        if m.requests[0] <= TAKEOVERS:
            m.takeover_request[m.requests[0] - 1] = st.request_at[0]
            m.takeover_cause[m.requests[0] - 1] = 1.0 * st.cause[0]
            m.takeover_speed[m.requests[0] - 1] = m.row_v[0]
    k = m.requests[0] - 1
    changed = 1 if st.takeover_state[0] != m.state[0] else 0
    m.state[0] = st.takeover_state[0]
    if k < 0 or k >= TAKEOVERS:
        return
    if changed == 1:
        note_state(m, k, m.state[0])
    behind = m.row_time[0] > m.takeover_request[k] + SAME_TIME
    if behind and m.undescribed[0] == 1 and m.row_cause[0] != op.CAUSE_NONE:
        m.undescribed[0] = 0
        m.takeover_blocked[k] = m.row_blocked[0]
        m.takeover_blocked_speed[k] = m.row_blocked_speed[0]
        m.takeover_lane_end[k] = m.row_lane_end[0]
        m.takeover_limit_time[k] = m.row_limit_time[0]
        m.takeover_density[k] = m.row_density[0]
    add_quality(m, k)


@compiled
def write_takeovers(m: Totals, out: list[float], base: int) -> None:
    """Write the takeovers to `out` from index `base`, each as `TAKEOVER_FIELDS`."""
    at = base
    for k in range(TAKEOVERS):
        out[at] = m.takeover_request[k]
        out[at + 1] = m.takeover_cause[k]
        out[at + 2] = m.takeover_blocked[k]
        out[at + 3] = m.takeover_blocked_speed[k]
        out[at + 4] = m.takeover_lane_end[k]
        out[at + 5] = m.takeover_speed[k]
        out[at + 6] = m.takeover_escalation[k]
        out[at + 7] = m.takeover_response[k]
        out[at + 8] = m.takeover_minimum_risk[k]
        out[at + 9] = m.takeover_standstill[k]
        out[at + 10] = m.takeover_hand_back[k]
        out[at + 11] = m.takeover_limit_time[k]
        out[at + 12] = m.takeover_density[k]
        out[at + 13] = m.takeover_lane_time[k]
        out[at + 14] = m.takeover_longitudinal[k]
        out[at + 15] = m.takeover_lateral[k]
        at = at + 16
