"""Adds a row to the measures of the takeover: the request, the response, and the driving after it."""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.numbers import SAME_TIME
from scenario_compiler.engine.columns.totals import Totals
from scenario_compiler.marker import compiled

BRAKING = 0.1
"""Brake position that counts as an input."""


@compiled
def since(m: Totals, time: float) -> int:
    """Return 1 if the last row is at or after the time of an event that has occurred."""
    return 1 if time >= 0.0 and m.row_time[0] >= time - SAME_TIME else 0


@compiled
def behind_collision(m: Totals) -> int:
    """Return 1 if the last row is after the first collision."""
    return 1 if m.time_collision[0] >= 0.0 and m.row_time[0] > m.time_collision[0] + SAME_TIME else 0


@compiled
def add_request(m: Totals) -> None:
    """Store the speed and the limit of the first request, the latter from the first row after it that has a cause.

    The row of the request's own time was recorded before the request.
    """
    if m.asked[0] == 0:
        m.asked[0] = 1
        m.request_speed[0] = m.row_v[0]
    behind = m.row_time[0] > m.time_request[0] + SAME_TIME
    if behind and m.request_cause[0] == op.CAUSE_NONE and m.row_cause[0] != op.CAUSE_NONE:
        m.request_cause[0] = m.row_cause[0]
        m.request_blocked[0] = m.row_blocked[0]
        m.request_blocked_speed[0] = m.row_blocked_speed[0]
        m.request_lane_end[0] = m.row_lane_end[0]
        m.request_limit_time[0] = m.row_limit_time[0]
        m.request_density[0] = m.row_density[0]


@compiled
def add_driving(m: Totals) -> None:
    """Add the accelerations of a row from the request on."""
    if behind_collision(m) == 1:
        return
    m.greatest_longitudinal[0] = max(m.greatest_longitudinal[0], abs(m.row_a[0]))
    if m.rows[0] > 1:
        lateral = abs(m.row_v[0] * m.row_v[0] * m.curvature[0])
        m.greatest_lateral[0] = max(m.greatest_lateral[0], lateral)


@compiled
def follow_driving(m: Totals) -> None:
    """Record whether the driver of the first response drives in the last row.

    The row of the response does not count, because the automation still commanded its motion; nor do rows after the
    first collision, because nobody commands the motion any more.
    """
    if m.driving[0] == 2 or m.time_response[0] < 0.0 or m.row_time[0] <= m.time_response[0] + SAME_TIME:
        return
    drives = m.row_state[0] in (op.TAKEOVER_MANUAL, op.TAKEOVER_HAND_BACK)
    m.driving[0] = 1 if drives and behind_collision(m) == 0 else 2


@compiled
def add_takeover(m: Totals) -> None:
    """Add the last row to the measures that start with the request and with the response."""
    follow_driving(m)
    if since(m, m.time_request[0]) == 1:
        add_request(m)
        if m.row_present[0] == 1:
            add_driving(m)
    if m.time_first_brake[0] < 0.0 and m.driving[0] == 1 and m.row_brake[0] > BRAKING:
        m.time_first_brake[0] = m.row_time[0]
