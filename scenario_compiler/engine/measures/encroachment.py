"""The least post-encroachment time: between one vehicle's leaving a place and the other's coming there.

Two vehicles were at one place where the box of one overlaps the box that the other had some rows before. The places
of the last seconds are kept of every entity, in columns that are not cleared between runs: `trail_count` says which of
them count. A look back skips the rows in which the other one was too far away to have come here.
"""

from __future__ import annotations

from math import cos, sin, sqrt

from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.numbers import clip
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.columns.totals import TRAIL_ROWS, Totals
from scenario_compiler.marker import compiled

LONGEST = 10.0
"""Post-encroachment time from which on there is none, s: our own choice."""


@compiled
def rows_between(step: float) -> int:
    """Return the number of time steps from one kept row to the next: 1, and more where not all would find room."""
    return int(clip(LONGEST / max(step * TRAIL_ROWS, 1.0e-9) + 1.0 - 1.0e-9, 1.0, 1.0e6))


@compiled
def rows_looked_at(step: float) -> int:
    """Return how many kept rows before the present one are looked at, and one."""
    return int(clip(LONGEST / max(step * rows_between(step), 1.0e-9) + 0.5, 1.0, 1.0 * TRAIL_ROWS))


@compiled
def keep_place(st: State, m: Totals, i: int) -> None:
    """Keep where an entity is, and how far it has come since the row before at most."""
    at = i * TRAIL_ROWS + m.trail_count[0] % TRAIL_ROWS
    m.trail_x[at] = st.middle_x[i]
    m.trail_y[at] = st.middle_y[i]
    m.trail_z[at] = st.z[i]
    m.trail_h[at] = st.h[i]
    m.trail_there[at] = st.present[i]
    if m.trail_count[0] == 0:
        return
    before = i * TRAIL_ROWS + (m.trail_count[0] - 1) % TRAIL_ROWS
    dx = st.middle_x[i] - m.trail_x[before]
    dy = st.middle_y[i] - m.trail_y[before]
    if dx != 0.0 or dy != 0.0:
        m.trail_step[i] = max(m.trail_step[i], sqrt(dx * dx + dy * dy))


@compiled
def divides(p: Program, i: int, j: int, along: float, across: float, c: float, s: float) -> int:
    """Return 1 where an axis of box i divides it from box j, whose middle is (along, across) in its axes.

    The boxes are turned against each other by an angle of which the absolute cosine and sine are given.
    """
    a = p.entity_const[i]
    b = p.entity_const[j]
    long = 0.5 * p.const[b + slot.E_LENGTH]
    wide = 0.5 * p.const[b + slot.E_WIDTH]
    if abs(along) > 0.5 * p.const[a + slot.E_LENGTH] + long * c + wide * s:
        return 1
    return 1 if abs(across) > 0.5 * p.const[a + slot.E_WIDTH] + long * s + wide * c else 0


@compiled
def was_here(p: Program, st: State, m: Totals, i: int, at: int, j: int) -> int:
    """Return 1 where the box that i had at a place of its trail overlaps that of j now, none above the other."""
    above = st.z[j] - m.trail_z[at]
    if above > p.const[p.entity_const[i] + slot.E_HEIGHT] or -above > p.const[p.entity_const[j] + slot.E_HEIGHT]:
        return 0
    dx = st.middle_x[j] - m.trail_x[at]
    dy = st.middle_y[j] - m.trail_y[at]
    turned = st.h[j] - m.trail_h[at]
    c = abs(cos(turned))
    s = abs(sin(turned))
    ci = cos(m.trail_h[at])
    si = sin(m.trail_h[at])
    if divides(p, i, j, dx * ci + dy * si, dy * ci - dx * si, c, s) == 1:
        return 0
    cj = cos(st.h[j])
    sj = sin(st.h[j])
    return 1 - divides(p, j, i, dx * cj + dy * sj, dy * cj - dx * sj, c, s)


@compiled
def look_back(p: Program, st: State, m: Totals, i: int, j: int, limit: int) -> int:
    """Return how many kept rows ago i was last where j is now, if less than `limit`, else that."""
    reach = st.reach[i] + st.reach[j]
    step = m.trail_step[i]
    last = min(limit - 1, m.trail_count[0])
    k = 1
    while k <= last:
        at = i * TRAIL_ROWS + (m.trail_count[0] - k) % TRAIL_ROWS
        dx = st.middle_x[j] - m.trail_x[at]
        dy = st.middle_y[j] - m.trail_y[at]
        near = dx * dx + dy * dy
        if near > reach * reach:
            if step <= 0.0:
                return limit
            k += int(clip((sqrt(near) - reach) / step, 1.0, 1.0 * TRAIL_ROWS))
        elif m.trail_there[at] == 1 and was_here(p, st, m, i, at, j) == 1:
            return k
        else:
            k += 1
    return limit


@compiled
def add_encroachment(p: Program, st: State, m: Totals, ego: int) -> None:
    """Add the row of now; nothing is left to find once boxes have overlapped at one time."""
    step = p.const[slot.K_STEP]
    if m.touched[0] == 1 or (m.rows[0] - 1) % max(rows_between(step), 1) != 0:
        return
    limit = rows_looked_at(step)
    if m.encroachment_rows[0] > 0:
        limit = m.encroachment_rows[0]
    for i in range(p.entity_count[0]):
        keep_place(st, m, i)
    for j in range(p.entity_count[0]):
        if j == ego or m.trail_step[j] <= 0.0 or st.present[j] == 0 or st.present[ego] == 0:
            continue
        limit = look_back(p, st, m, ego, j, limit)
        limit = look_back(p, st, m, j, ego, limit)
    if limit < rows_looked_at(step):
        m.encroachment_rows[0] = limit
    m.trail_count[0] += 1
