"""The least post-encroachment time: from when one vehicle leaves a place until the other arrives there.

Two vehicles were at the same place if the box of one overlaps the box that the other had some rows before. Of the last
row in which it did, `between_rows` finds the moments at which the one left the place and the other arrived; the time
between them is shorter than that between the rows by less than two rows. The poses of all entities in the last seconds
are kept in columns that are not cleared between runs; `trail_count` says how many of them are valid. The search
backwards skips the rows in which the other vehicle was too far away, and returns how far both may travel before there
can be a result. A vehicle that drives straight on stays in one strip of the plane; the rows since which the ego has
been beside that strip are skipped too, and while it stays there only earlier rows count.
"""

from __future__ import annotations

from math import sqrt

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.numbers import clip, length_of
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.columns.totals import TRAIL_ROWS, Totals
from scenario_compiler.engine.measures.between_rows import rows_too_many
from scenario_compiler.engine.motion.trailers import coupled
from scenario_compiler.marker import compiled

ASK_AGAIN = 50.0
"""Distance travelled by both after which it is asked again whether a strip is needed, m; chosen."""

LONGEST = 10.0
"""Post-encroachment time from which it counts as undefined, s; chosen."""

APART = 0.1
"""Greatest time between two kept rows, s, unless the step is longer; chosen."""

SAME_STRIP = 1.0e-6
"""Sideways displacement up to which an entity of the same heading is in the same strip, m."""

SLACK = 1.0e-3
"""Least distance from a strip at which a box is surely beside it, m."""


@compiled
def rows_between(step: float) -> int:
    """Return the number of time steps from one kept row to the next: as many as fit into APART, at least one."""
    if not step > 0.0:
        return 1
    return int(clip(APART / max(step, 1.0e-9) + 1.0e-6, 1.0, 1.0e6))


@compiled
def rows_looked_at(step: float) -> int:
    """Return the number of earlier kept rows that are compared with the present one, plus one.

    The time may be shorter than that between two rows by less than two rows.
    """
    if not step > 0.0:
        return 1
    return int(clip(LONGEST / max(step * rows_between(step), 1.0e-9) + 3.0, 1.0, 1.0 * TRAIL_ROWS))


@compiled
def begin_trails(p: Program, m: Totals, ego: int) -> None:
    """Write the constants of a run: how many other entities may move, and which rows are kept."""
    m.movers[0] = 0
    for i in range(p.entity_count[0]):
        if i != ego and p.entity_motion[i] != op.MOTION_STATIC:
            m.movers[0] += 1
    m.trail_every[0] = rows_between(p.const[slot.K_STEP])
    m.trail_limit[0] = rows_looked_at(p.const[slot.K_STEP])


@compiled
def kept_at(m: Totals, i: int, k: int) -> int:
    """Return the index of the row of an entity's trail that was kept k rows before the present one."""
    row = m.trail_at[0] - k
    if row < 0:
        row = row + TRAIL_ROWS
    return i * TRAIL_ROWS + row


@compiled
def keep_place(st: State, m: Totals, i: int) -> None:
    """Keep an entity's pose, and its displacement since the previous kept row."""
    at = kept_at(m, i, 0)
    x = st.middle_x[i]
    y = st.middle_y[i]
    m.trail_x[at] = x
    m.trail_y[at] = y
    m.trail_z[at] = st.z[i]
    m.trail_cos[at] = st.box_cos[i]
    m.trail_sin[at] = st.box_sin[i]
    m.trail_there[at] = st.present[i]
    if m.trail_count[0] > 0:
        before = kept_at(m, i, 1)
        dx = x - m.trail_x[before]
        dy = y - m.trail_y[before]
        square = dx * dx + dy * dy
        m.trail_way[i] = sqrt(square) if square > 0.0 else 0.0
        m.trail_square[i] = max(m.trail_square[i], square)


@compiled
def divides(p: Program, i: int, j: int, along: float, across: float, c: float, s: float) -> int:
    """Return 1 if an axis of box i separates it from box j, whose centre is (along, across) in i's axes.

    `c` and `s` are the absolute cosine and sine of the angle between the boxes.
    """
    a = p.entity_const[i]
    b = p.entity_const[j]
    long = 0.5 * p.const[b + slot.E_LENGTH]
    wide = 0.5 * p.const[b + slot.E_WIDTH]
    if abs(along) > 0.5 * p.const[a + slot.E_LENGTH] + long * c + wide * s:
        return 1
    return 1 if abs(across) > 0.5 * p.const[a + slot.E_WIDTH] + long * s + wide * c else 0


@compiled
def met_then(p: Program, st: State, m: Totals, i: int, at: int, j: int, dx: float, dy: float) -> int:
    """Return 1 if i's box at an index of its trail overlaps j's present box; (dx, dy) leads from i's centre to j's."""
    ci = m.trail_cos[at]
    si = m.trail_sin[at]
    cj = st.box_cos[j]
    sj = st.box_sin[j]
    c = abs(ci * cj + si * sj)
    s = abs(ci * sj - si * cj)
    if divides(p, i, j, dx * ci + dy * si, dy * ci - dx * si, c, s) == 1:
        return 0
    return 1 - divides(p, j, i, dx * cj + dy * sj, dy * cj - dx * sj, c, s)


@compiled
def is_beside_strip(p: Program, m: Totals, ego: int, j: int, x: float, y: float, c: float, s: float) -> int:
    """Return 1 if the ego's box does not reach into the strip in which j drives.

    (x, y) is the centre of the ego's box, m; c and s are cosine and sine of its heading.
    """
    strip_c = m.strip_cos[j]
    strip_s = m.strip_sin[j]
    across = y * strip_c - x * strip_s - m.strip_off[j]
    base = p.entity_const[ego]
    half_ego = p.const[base + slot.E_LENGTH] * abs(s * strip_c - c * strip_s)
    half_ego += p.const[base + slot.E_WIDTH] * abs(c * strip_c + s * strip_s)
    wide = p.const[p.entity_const[j] + slot.E_WIDTH]
    return 1 if abs(across) > 0.5 * (half_ego + wide) + SLACK else 0


@compiled
def kept_rows_beside(p: Program, m: Totals, ego: int, j: int, last: int) -> int:
    """Return for how many kept rows before the present one, at most `last`, j was in its strip and the ego beside."""
    c = m.strip_cos[j]
    s = m.strip_sin[j]
    for k in range(1, last + 1):
        at = kept_at(m, j, k)
        off = m.trail_y[at] * c - m.trail_x[at] * s
        if c != m.trail_cos[at] or s != m.trail_sin[at] or abs(off - m.strip_off[j]) > SAME_STRIP:
            return k - 1
        at = kept_at(m, ego, k)
        if is_beside_strip(p, m, ego, j, m.trail_x[at], m.trail_y[at], m.trail_cos[at], m.trail_sin[at]) == 0:
            return k - 1
    return last


@compiled
def rows_beside(p: Program, st: State, m: Totals, ego: int, j: int, last: int) -> int:
    """Return for how many kept rows, with the present one, the ego has been beside the strip in which j drives.

    In none of them was one of the two where the other is now. Of the rows before those in which this is asked, the
    last `last` ones are looked at.
    """
    c = st.box_cos[j]
    s = st.box_sin[j]
    off = st.middle_y[j] * c - st.middle_x[j] * s
    if c != m.strip_cos[j] or s != m.strip_sin[j] or abs(off - m.strip_off[j]) > SAME_STRIP:
        m.strip_cos[j] = c
        m.strip_sin[j] = s
        m.strip_off[j] = off
        m.beside_rows[j] = 0
    if m.beside_at[j] != m.trail_count[0] - 1:
        m.beside_rows[j] = 0
    m.beside_at[j] = m.trail_count[0]
    if is_beside_strip(p, m, ego, j, st.middle_x[ego], st.middle_y[ego], st.box_cos[ego], st.box_sin[ego]) == 0:
        m.beside_rows[j] = 0
    elif m.beside_rows[j] > 0:
        m.beside_rows[j] += 1
    else:
        m.beside_rows[j] = 1 + kept_rows_beside(p, m, ego, j, last)
    return m.beside_rows[j]


@compiled
def look_back(p: Program, st: State, m: Totals, i: int, j: int, limit: int, apart: int) -> tuple[int, float]:
    """Return how many kept rows ago i was last where j is now, at most `limit`; and a distance, m.

    Before both together have travelled this distance, no result is possible. From a row in which the boxes are a gap
    apart, the rows of half this distance are skipped, in which the boxes are still apart by the other half. Once no
    such distance is left to find, the rows of the whole gap are skipped. The last `apart` rows, with the present one,
    are known to have no result; if they are skipped, the distance is that for the rows before them alone.
    """
    reach = st.reach[i] + st.reach[j]
    step = sqrt(max(m.trail_square[i], 0.0))
    last = min(limit - 1, m.trail_count[0])
    k = 1
    free = op.FAR
    if apart > 1:
        k = apart
    else:
        free = length_of(st.middle_x[j] - st.middle_x[i], st.middle_y[j] - st.middle_y[i]) - reach
    while k <= last:
        at = kept_at(m, i, k)
        dx = st.middle_x[j] - m.trail_x[at]
        dy = st.middle_y[j] - m.trail_y[at]
        gap = length_of(dx, dy) - reach
        free = min(free, 0.5 * gap)
        if gap <= 0.0:
            above = st.z[j] - m.trail_z[at]
            over = above > p.const[p.entity_const[i] + slot.E_HEIGHT]
            under = -above > p.const[p.entity_const[j] + slot.E_HEIGHT]
            if m.trail_there[at] == 1 and not over and not under and met_then(p, st, m, i, at, j, dx, dy) == 1:
                return k, 0.0
            k += 1
        elif step <= 0.0:
            return limit, free
        else:
            skipped = 0.5 * gap if free > 0.0 else gap
            leap = clip(skipped / step, 1.0, 1.0 * TRAIL_ROWS)
            if not leap >= 1.0:
                leap = 1.0
            k += int(leap)
    return limit, free


@compiled
def rows_worth(m: Totals) -> int:
    """Return the number of earlier kept rows, plus one, from which a smaller least time is possible."""
    return min(m.trail_limit[0], int(clip(m.encroachment_rows[0], 0.0, 1.0 * TRAIL_ROWS)) + 3)


@compiled
def note_place(p: Program, st: State, m: Totals, i: int, j: int, k: int) -> int:
    """Note the time since i, whose last box there is that of k kept rows ago, was where j is; return `rows_worth`."""
    before = kept_at(m, j, 1)
    rows = k - rows_too_many(p, st, m, i, kept_at(m, i, k), kept_at(m, i, k - 1), j, before)
    m.encroachment_rows[0] = min(m.encroachment_rows[0], max(rows, 0.0))
    return rows_worth(m)


@compiled
def look_back_twice(p: Program, st: State, m: Totals, j: int, ego: int, limit: int, apart: int) -> int:
    """Look back with both as the one that comes later, where the free distance is used up; return `rows_worth`."""
    worth = limit
    if m.free_before[j] <= 0.0:
        rows, free = look_back(p, st, m, ego, j, worth, apart)
        m.free_before[j] = free
        if rows < worth:
            worth = note_place(p, st, m, ego, j, rows)
    if m.free_behind[j] <= 0.0:
        rows, free = look_back(p, st, m, j, ego, worth, apart)
        m.free_behind[j] = free
        if rows < worth:
            worth = note_place(p, st, m, j, ego, rows)
    return worth


@compiled
def look_back_where_due(p: Program, st: State, m: Totals, j: int, ego: int, limit: int) -> int:
    """Note the least time between the presence of the ego and of j at one place; return `rows_worth`.

    If no distance is free, because one of them is where the other passed close by, the rows since which the ego has
    been beside j's strip are left out. No result with those is possible while it stays beside the same strip; once it
    does not, or after `ASK_AGAIN`, all rows are searched again.
    """
    driven = m.trail_way[j] + m.trail_way[ego]
    m.free_before[j] -= driven
    m.free_behind[j] -= driven
    last = min(limit - 1, m.trail_count[0])
    apart = 0
    if m.strip_for[j] > 0.0:
        m.strip_for[j] -= driven
        apart = rows_beside(p, st, m, ego, j, last)
        if apart <= 1 or m.strip_for[j] <= 0.0:
            apart = 0
            m.strip_for[j] = 0.0
            m.free_before[j] = 0.0
            m.free_behind[j] = 0.0
    if m.free_before[j] > 0.0 and m.free_behind[j] > 0.0:
        return limit
    worth = look_back_twice(p, st, m, j, ego, limit, apart)
    if apart == 0 and (m.free_before[j] <= 0.0 or m.free_behind[j] <= 0.0):
        apart = rows_beside(p, st, m, ego, j, last)
        if apart > 1:
            m.strip_for[j] = ASK_AGAIN
            worth = look_back_twice(p, st, m, j, ego, worth, apart)
    return worth


@compiled
def add_encroachment(p: Program, st: State, m: Totals, ego: int) -> None:
    """Add the present row; after an overlap of boxes no smaller value is possible."""
    if m.rows[0] == 1:
        begin_trails(p, m, ego)
    if st.flag[0] != op.FAULT_NONE or m.movers[0] == 0 or m.touched[0] == 1:
        return
    if (m.rows[0] - 1) % max(m.trail_every[0], 1) != 0:
        return
    for i in range(p.entity_count[0]):
        if p.entity_motion[i] != op.MOTION_STATIC:
            keep_place(st, m, i)
    limit = rows_worth(m)
    if st.present[ego] == 1:
        for j in range(p.entity_count[0]):
            if j == ego or st.present[j] == 0:
                continue
            if coupled(p, st, ego, j) == 1:
                m.free_before[j] = 0.0
                m.free_behind[j] = 0.0
                m.strip_for[j] = 0.0
            elif m.trail_square[j] > 0.0:
                limit = look_back_where_due(p, st, m, j, ego, limit)
    m.trail_count[0] += 1
    m.trail_at[0] = m.trail_at[0] + 1 if m.trail_at[0] < TRAIL_ROWS - 1 else 0
