"""By how much the time between two rows in which boxes overlap is longer than the time that really passed.

The earlier box is that of a row, and the later box that of another row. The one left the place after its row, and the
other arrived before its own. Between two rows, boxes move straight on at constant speed. Let the earlier box be that
of a part x of the time between two rows later, and the later box that of a part sum - x earlier. On each axis of the
boxes, the distance of the centres is then linear in x and in the sum, so that for a sum the boxes overlap on this axis
for the x of one interval. They overlap if all these intervals have a value in common, which they have as soon as each
two of them have one. `recording.between_rows` has the same formulas over arrays.
"""

from __future__ import annotations

from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.numbers import clip, ratio
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.columns.totals import INTERVALS, Totals
from scenario_compiler.marker import compiled

STILL = 1.0e-9
"""Least difference between the displacements of both along an axis, m: a smaller one counts as this."""


@compiled
def allow(m: Totals, at: int, middle: float, lean: float, half: float) -> None:
    """Write an interval of x: its middle at a sum of 0, what the middle gains with the sum, and half its length."""
    m.allowed_middle[at] = middle
    m.allowed_lean[at] = lean
    m.allowed_half[at] = half


@compiled
def allow_on_axis(m: Totals, at: int, reach: float, apart: float, first: float, second: float) -> None:
    """Write the interval of x in which two boxes overlap on an axis.

    `reach` is the sum of their half extents on it, `apart` the distance from the first centre to the second one;
    `first` and `second` are their displacements between two rows, m.
    """
    if first < second:
        apart = -apart
        first = -first
        second = -second
    closing = max(first - second, STILL)
    allow(m, at, apart / closing, -second / closing, reach / closing)


@compiled
def allow_on_axes_of(
    p: Program, m: Totals, at: int, i: int, j: int, c: float, s: float, c_turned: float, s_turned: float
) -> None:
    """Write the intervals for the two axes of box i; `c` and `s` are the cosine and sine of its heading.

    `c_turned` and `s_turned` are the absolute cosine and sine of the angle between the boxes.
    """
    a = p.entity_const[i]
    b = p.entity_const[j]
    long = 0.5 * p.const[b + slot.E_LENGTH]
    wide = 0.5 * p.const[b + slot.E_WIDTH]
    along = 0.5 * p.const[a + slot.E_LENGTH] + long * c_turned + wide * s_turned
    across = 0.5 * p.const[a + slot.E_WIDTH] + long * s_turned + wide * c_turned
    dx = m.place_apart[0]
    dy = m.place_apart[1]
    ux = m.place_first[0]
    uy = m.place_first[1]
    wx = m.place_second[0]
    wy = m.place_second[1]
    allow_on_axis(m, at, along, dx * c + dy * s, ux * c + uy * s, wx * c + wy * s)
    allow_on_axis(m, at + 1, across, dy * c - dx * s, uy * c - ux * s, wy * c - wx * s)


@compiled
def greatest_sum(m: Totals) -> float:
    """Return the greatest sum at which each two intervals have a value of x in common, 0 to 2."""
    most = 2.0
    for a in range(1, INTERVALS):
        for b in range(a):
            middle = m.allowed_middle[a] - m.allowed_middle[b]
            lean = m.allowed_lean[a] - m.allowed_lean[b]
            if lean < 0.0:
                lean = -lean
                middle = -middle
            most = min(most, ratio(m.allowed_half[a] + m.allowed_half[b] - middle, lean, 2.0))
    return max(most, 0.0)


@compiled
def least_part(m: Totals, most: float) -> float:
    """Return the least x that all intervals allow at the greatest sum."""
    least = 0.0
    for a in range(INTERVALS):
        least = max(least, m.allowed_middle[a] + m.allowed_lean[a] * most - m.allowed_half[a])
    return min(least, 1.0)


@compiled
def rows_too_many(p: Program, st: State, m: Totals, i: int, then: int, after: int, j: int, before: int) -> float:
    """Return by how many rows the time from i's earlier box to j's present box, which overlap, is too long, 0 to 2.

    `then` and `after` are indices of i's trail, of its earlier box and of the next row; `before` is the index of the
    row before the present one in j's. An entity that is absent in that next row, or in that row before, counts as
    present in the one row only. First the headings are those of the rows, then those of the moments found with them.
    """
    m.place_apart[0] = st.middle_x[j] - m.trail_x[then]
    m.place_apart[1] = st.middle_y[j] - m.trail_y[then]
    stays = 1.0 * m.trail_there[after]
    came = 1.0 * m.trail_there[before]
    m.place_first[0] = stays * (m.trail_x[after] - m.trail_x[then])
    m.place_first[1] = stays * (m.trail_y[after] - m.trail_y[then])
    m.place_second[0] = came * (st.middle_x[j] - m.trail_x[before])
    m.place_second[1] = came * (st.middle_y[j] - m.trail_y[before])
    allow(m, 0, 0.5 * stays, 0.0, 0.5 * stays)
    allow(m, 1, -0.5 * came, 1.0, 0.5 * came)
    part = 0.0
    most = 0.0
    for _ in range(2):
        ci = m.trail_cos[then] + part * (m.trail_cos[after] - m.trail_cos[then])
        si = m.trail_sin[then] + part * (m.trail_sin[after] - m.trail_sin[then])
        cj = st.box_cos[j] + (most - part) * (m.trail_cos[before] - st.box_cos[j])
        sj = st.box_sin[j] + (most - part) * (m.trail_sin[before] - st.box_sin[j])
        c = abs(ci * cj + si * sj)
        s = abs(ci * sj - si * cj)
        allow_on_axes_of(p, m, 2, i, j, ci, si, c, s)
        allow_on_axes_of(p, m, 4, j, i, cj, sj, c, s)
        most = greatest_sum(m)
        part = clip(least_part(m, most), 0.0, most)
    return most
