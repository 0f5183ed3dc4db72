"""Lane keeping: statistics of the lateral position in the first seconds after the response, row by row."""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.numbers import SAME_TIME, clip, safe_sqrt
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.totals import Totals
from scenario_compiler.engine.measures.in_lane import JUMP, add_in_lane
from scenario_compiler.engine.measures.takeover import behind_collision, since
from scenario_compiler.marker import compiled

SETTLING = 10.0
SETTLED = 60.0
"""Ends of the two windows after the response in which lane keeping is measured, s: the first from 0 to 10 s, the second
from there to 60 s.
"""

WINDOW = 10.0
"""Length of the windows whose stability is assessed, s; chosen."""

BAND = 0.25
"""Standard deviation of the lateral position up to which a window is stable, m; chosen: the upper end of what is
measured for drivers who have settled (0.15 to 0.25 m).
"""


LEAST_STEP = 1.0e-6
"""Step along the road above which it has a direction, m: the place of a vehicle that stands is located again in each
step, and may differ in the last digits.
"""


@compiled
def add_position(m: Totals, k: int, position: float) -> None:
    """Add a lateral position to the mean and the sum of squares of a spread (Welford 1962)."""
    m.spread_count[k] += 1
    off_mean = position - m.spread_mean[k]
    m.spread_mean[k] += off_mean / max(m.spread_count[k], 1)
    m.spread_squares[k] += off_mean * (position - m.spread_mean[k])


@compiled
def deviation_of(m: Totals, k: int) -> float:
    """Return the standard deviation (n - 1) of a spread, m."""
    return safe_sqrt(m.spread_squares[k] / max(m.spread_count[k] - 1, 1))


@compiled
def rows_of_window(step: float) -> int:
    """Return the number of rows of a window whose stability is assessed."""
    if not step > 0.0:
        return 2
    return int(clip(WINDOW / max(step, 1.0e-6) + 0.5, 2.0, 1.0e6))


@compiled
def add_stability(p: Program, m: Totals, position: float) -> None:
    """Add a row in which the driver of the first response drives; when a window is full, assess its stability."""
    if m.before_driven[0] == 0 or m.before_present[0] == 0:
        return
    add_position(m, op.SPREAD_OF_WINDOW, position)
    if m.spread_count[op.SPREAD_OF_WINDOW] < rows_of_window(p.const[slot.K_STEP]):
        return
    if deviation_of(m, op.SPREAD_OF_WINDOW) > BAND:
        m.stable_from[0] = -1
    elif m.stable_from[0] < 0:
        m.stable_from[0] = m.windows[0]
    m.windows[0] += 1
    m.spread_count[op.SPREAD_OF_WINDOW] = 0
    m.spread_mean[op.SPREAD_OF_WINDOW] = 0.0
    m.spread_squares[op.SPREAD_OF_WINDOW] = 0.0


@compiled
def finish_keeping(m: Totals) -> None:
    """Write the standard deviations of the windows in which the driver drives all the time and keeps the lane."""
    for k in range(2):
        end = m.time_response[0] + (SETTLING if k == 0 else SETTLED)
        intact = m.time_collision[0] < 0.0 or m.time_collision[0] >= end - SAME_TIME
        lasts = intact and m.time_response[0] >= 0.0 and m.row_time[0] >= end - SAME_TIME
        if lasts and m.spread_broken[k] == 0 and m.spread_count[k] > 1:
            if k == 0:
                m.settling_deviation[0] = deviation_of(m, k)
            else:
                m.settled_deviation[0] = deviation_of(m, k)


@compiled
def step_to_last_row(m: Totals) -> int:
    """Return the sign of the step along the road to the last row.

    It is 0 if the vehicle stands, or if the step led to another road or behind a collision.
    """
    step = m.row_s[0] - m.before_s[0]
    if m.before_road[0] != m.row_road[0] or abs(step) <= LEAST_STEP or behind_collision(m) == 1:
        return 0
    return 1 if step > 0.0 else -1


@compiled
def add_offset(m: Totals, left: float) -> None:
    """Add the distance of the waiting row from the centre of the lane at the request.

    A lane change shifts the centre from which the offset is measured; the vehicle itself is assumed to move as in the
    row before.
    """
    changed = left - m.added_left[0]
    if m.added_count[0] > 0 and abs(changed) > JUMP:
        if m.before_after[0] == 1 and m.added_after[0] == 1:
            m.aside[0] = m.aside[0] + (m.added_step[0] - changed)
    elif m.added_count[0] > 0:
        m.added_step[0] = changed
    if m.before_after[0] == 1 and m.before_present[0] == 1 and m.before_lane[0] != 0:
        m.greatest_offset_after[0] = max(m.greatest_offset_after[0], abs(left + m.aside[0]))
    if m.before_answered[0] == 1 and m.before_present[0] == 1 and m.offset_at_response[0] >= op.FAR:
        m.offset_at_response[0] = left + m.aside[0]
        m.heading_at_response[0] = m.before_heading[0]
    m.added_count[0] += 1
    m.added_after[0] = m.before_after[0]


@compiled
def add_keeping(p: Program, m: Totals, step: int) -> None:
    """Add the waiting row, once the step along the road after it is known.

    Its offset is positive to the left in the direction of travel: that of the step after it, or of the step before it,
    or of the last step that had one.
    """
    sense = step if step != 0 else m.sense[0]
    if sense != 0:
        m.sense_kept[0] = sense
    m.sense[0] = step
    left = -m.before_off[0] if m.sense_kept[0] < 0 else m.before_off[0]
    add_offset(m, left)
    add_in_lane(p, m, left)
    add_stability(p, m, left + m.aside[0])
    for k in range(2):
        if m.before_inside[k] == 1:
            changed = m.added_inside[k] == 1 and abs(left - m.added_left[0]) > JUMP
            behind = m.before_time[0] > m.time_response[0] + SAME_TIME
            if changed or m.before_present[0] == 0 or (behind and m.before_driven[0] == 0):
                m.spread_broken[k] = 1
            add_position(m, k, left)
        m.added_inside[k] = m.before_inside[k]
    m.added_left[0] = left


@compiled
def add_to_keeping(p: Program, m: Totals) -> None:
    """Make the last row the waiting one, which is added when the next row is known."""
    if m.rows[0] > 1:
        step = step_to_last_row(m)
        add_keeping(p, m, step)
    m.before_road[0] = m.row_road[0]
    m.before_s[0] = m.row_s[0]
    m.before_off[0] = m.row_off[0]
    m.before_present[0] = m.row_present[0]
    m.before_lane[0] = m.row_lane[0]
    m.before_time[0] = m.row_time[0]
    m.before_v[0] = m.row_v[0]
    m.before_width[0] = m.row_width[0]
    m.before_heading[0] = m.row_heading[0]
    m.before_intact[0] = 1 - behind_collision(m)
    m.before_after[0] = since(m, m.time_request[0]) * m.before_intact[0]
    m.before_answered[0] = since(m, m.time_response[0])
    m.before_driven[0] = 1 if m.driving[0] == 1 else 0
    m.before_inside[0] = 0
    m.before_inside[1] = 0
    if since(m, m.time_response[0]) == 0:
        return
    if m.row_time[0] <= m.time_response[0] + SETTLING + SAME_TIME:
        m.before_inside[0] = 1
    if since(m, m.time_response[0] + SETTLING) == 1 and m.row_time[0] <= m.time_response[0] + SETTLED + SAME_TIME:
        m.before_inside[1] = 1
