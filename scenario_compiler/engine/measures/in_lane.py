"""The ego in its lane: distances of its sides from the edges, and the time until it crosses them.

The same formulas, in the same order of operations, are in `recording.in_lane`, over arrays.
"""

from __future__ import annotations

from math import cos, sin

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.extent import front_of, rear_of
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.totals import Totals
from scenario_compiler.engine.motion.collision import reported_entity
from scenario_compiler.marker import compiled
from scenario_compiler.vocabulary.horizon import HORIZON

JUMP = 1.0
"""Change of the lane offset from one row to the next that indicates another lane, m."""


@compiled
def follow_departure(m: Totals, left: float, to_left: float, to_right: float) -> None:
    """Add a row in which the ego is beyond an edge of its lane, or off every lane.

    The depth is measured from the lane that it left; when its reference point enters another lane, its offset is
    continued as in the row before.
    """
    if m.departed[0] == 0:
        m.departed[0] = 1
        m.departures[0] += 1
        m.departed_rows[0] = 0
        m.departed_aside[0] = 0.0
        m.departed_step[0] = 0.0
        m.departed_width[0] = m.before_width[0]
    elif abs(left - m.departed_left[0]) > JUMP:
        m.departed_aside[0] += m.departed_step[0] - (left - m.departed_left[0])
    else:
        m.departed_step[0] = left - m.departed_left[0]
    m.departed_left[0] = left
    m.departed_rows[0] += 1
    m.longest_departure[0] = max(m.longest_departure[0], m.departed_rows[0])
    if m.before_lane[0] != 0 and m.departed_width[0] > 0.0:
        at = left + m.departed_aside[0]
        deep = max(at + to_left, to_right - at) - 0.5 * m.departed_width[0]
        m.deepest_departure[0] = max(m.deepest_departure[0], deep)


@compiled
def add_crossing(m: Totals, time: float) -> None:
    """Add the time until an edge is crossed, s."""
    if time < HORIZON:
        m.least_crossing[0] = min(m.least_crossing[0], time)
        m.crossing_sum[0] += time
        m.crossing_rows[0] += 1


@compiled
def surely_inside(p: Program, m: Totals, left: float) -> int:
    """Return 1 if a bound shows that no corner is beyond an edge: a sine is at most its angle, a cosine at most 1."""
    base = p.entity_const[reported_entity(p)]
    reach = abs(p.const[base + slot.E_CENTER]) + 0.5 * p.const[base + slot.E_LENGTH]
    side = 0.5 * p.const[base + slot.E_WIDTH] + reach * abs(m.before_heading[0])
    return 1 if m.before_lane[0] != 0 and abs(left) + side < 0.5 * m.before_width[0] else 0


@compiled
def add_in_lane(p: Program, m: Totals, left: float) -> None:
    """Add the waiting row, whose offset `left` to the left of its lane's centre is known now, m."""
    if m.before_present[0] == 0 or m.before_intact[0] == 0:
        m.departed[0] = 0
        return
    if m.before_after[0] == 0 and m.departed[0] == 0 and surely_inside(p, m, left) == 1:
        return
    ego = reported_entity(p)
    turned = sin(m.before_heading[0])
    front = front_of(p, ego) * turned
    rear = -rear_of(p, ego) * turned
    wide = 0.5 * p.const[p.entity_const[ego] + slot.E_WIDTH] * abs(cos(m.before_heading[0]))
    to_left = max(front, rear) + wide
    to_right = wide - min(front, rear)
    on_lane = 1 if m.before_lane[0] != 0 and m.before_width[0] > 0.0 else 0
    room_left = 0.5 * m.before_width[0] - (left + to_left)
    room_right = 0.5 * m.before_width[0] - (to_right - left)
    out = 1 if m.before_lane[0] == 0 or (on_lane == 1 and min(room_left, room_right) < 0.0) else 0
    if out == 1:
        follow_departure(m, left, to_left, to_right)
    else:
        m.departed[0] = 0
    if m.before_after[0] == 0:
        return
    if out == 1:
        if m.time_departed[0] < 0.0:
            m.time_departed[0] = m.before_time[0]
        add_crossing(m, 0.0)
        return
    across = m.before_v[0] * turned
    if on_lane == 1 and across != 0.0:
        add_crossing(m, (room_left if across > 0.0 else room_right) / abs(across) if abs(across) > 0.0 else op.FAR)
