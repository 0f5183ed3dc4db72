"""The least distance of the ego's box from others, and the least time to collision on the circle that it drives.

The same formulas, in the same order of operations, are in `recording.boxes` and `recording.on_path`, over arrays. The
exact computation is slow, so it is done only if a bound does not rule out a new least value.
"""

from __future__ import annotations

from math import atan2, cos, pi, sin, sqrt

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.extent import front_of
from scenario_compiler.engine.columns.numbers import length_of
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.columns.totals import Totals
from scenario_compiler.engine.motion.collision import SLACK, is_above, overlap
from scenario_compiler.marker import compiled
from scenario_compiler.roads.geometry import wrap_heading
from scenario_compiler.vocabulary.horizon import HORIZON

STRAIGHT = 1e-6
"""Curvature below which a path counts as straight, 1/m."""

OTHER = 4
"""Index of the other entity's corners, after those of the ego."""


@compiled
def see_heading(st: State, m: Totals, i: int) -> None:
    """Keep an entity's heading as it is recorded, with its cosine and sine; most entities drive straight on.

    Cosine and sine are those of the entity's box if its heading is the same.
    """
    h = st.h[i]
    if h < 0.0 or h >= 2.0 * pi:
        h = wrap_heading(h)
    if h == m.seen_h[i]:
        return
    m.seen_h[i] = h
    if h == st.box_h[i]:
        m.seen_cos[i] = st.box_cos[i]
        m.seen_sin[i] = st.box_sin[i]
    else:
        m.seen_cos[i] = cos(h)
        m.seen_sin[i] = sin(h)


@compiled
def lay_corners(p: Program, st: State, m: Totals, i: int, base: int) -> None:
    """Write the corners of a box to `corner_x` and `corner_y` from index `base`.

    Their order is front left, rear left, rear right, front right.
    """
    at = p.entity_const[i]
    long = 0.5 * p.const[at + slot.E_LENGTH]
    wide = 0.5 * p.const[at + slot.E_WIDTH]
    center = p.const[at + slot.E_CENTER]
    c = m.seen_cos[i]
    s = m.seen_sin[i]
    for corner in range(4):
        along = center + (long if corner in (0, 3) else -long)
        across = wide if corner < 2 else -wide
        m.corner_x[base + corner] = st.x[i] + along * c - across * s
        m.corner_y[base + corner] = st.y[i] + along * s + across * c


@compiled
def squared_distance_to_corners(p: Program, st: State, m: Totals, i: int, base: int) -> float:
    """Return the least squared distance from the box of i to four corners, m2."""
    at = p.entity_const[i]
    center = p.const[at + slot.E_CENTER]
    long = 0.5 * p.const[at + slot.E_LENGTH]
    wide = 0.5 * p.const[at + slot.E_WIDTH]
    c = m.seen_cos[i]
    s = m.seen_sin[i]
    least = op.FAR * op.FAR
    for corner in range(base, base + 4):
        dx = m.corner_x[corner] - st.x[i]
        dy = m.corner_y[corner] - st.y[i]
        along = max(abs(dx * c + dy * s - center) - long, 0.0)
        across = max(abs(dy * c - dx * s) - wide, 0.0)
        least = min(least, along * along + across * across)
    return least


@compiled
def lay_along_circle(st: State, m: Totals, ego: int) -> None:
    """Write the other box's corners, relative to the circle that the ego drives, to `corner_along` and `corner_across`.

    Both are in m; across is positive to the left.
    """
    bend = m.curvature[0]
    side = -1.0 if bend < 0.0 else 1.0
    bent = 1 if abs(bend) > STRAIGHT else 0
    radius = 1.0 / max(abs(bend), STRAIGHT)
    c = m.seen_cos[ego]
    s = m.seen_sin[ego]
    for corner in range(4):
        dx = m.corner_x[OTHER + corner] - st.x[ego]
        dy = m.corner_y[OTHER + corner] - st.y[ego]
        along = c * dx + s * dy
        across = c * dy - s * dx
        if bent == 1:
            inward = radius - side * across
            across = side * (radius - length_of(along, inward))
            along = atan2(along, inward) * radius
        m.corner_along[corner] = along
        m.corner_across[corner] = across


@compiled
def least_along(m: Totals, half: float) -> float:
    """Return the least distance along the circle of the part of the box within `half` of the circle, m, or FAR."""
    least = op.FAR
    low = op.FAR
    high = -op.FAR
    for k in range(4):
        across = m.corner_across[k]
        low = min(low, across)
        high = max(high, across)
        if abs(across) <= half:
            least = min(least, m.corner_along[k])
    if low >= half or high <= -half:
        return op.FAR
    for k in range(4):
        following = (k + 1) % 4
        for side in range(2):
            edge = half if side == 1 else -half
            here = m.corner_across[k] - edge
            there = m.corner_across[following] - edge
            if (here < 0.0) != (there < 0.0):
                share = here / (here - there)
                along = m.corner_along[k] + share * (m.corner_along[following] - m.corner_along[k])
                least = min(least, along)
    return least


@compiled
def add_ahead(p: Program, st: State, m: Totals, ego: int, j: int, front: float) -> None:
    """Add an entity that is in the path ahead; its corners must have been written.

    A box on the far side of the circle, where ahead and behind meet, and one around its centre do not count as ahead.
    """
    lay_along_circle(st, m, ego)
    along = least_along(m, 0.5 * p.const[p.entity_const[ego] + slot.E_WIDTH])
    gap = along - front
    if along >= op.FAR or gap < 0.0:
        return
    a = m.corner_along[0]
    b = m.corner_along[1]
    c = m.corner_along[2]
    d = m.corner_along[3]
    if (max(a, b, c, d) - min(a, b, c, d)) * abs(m.curvature[0]) >= pi:
        return
    m.least_headway[0] = min(m.least_headway[0], gap / st.v[ego] if st.v[ego] > 0.0 else op.FAR)
    tangent = m.seen_h[ego] + m.curvature[0] * ((a + b + c + d) / 4.0)
    closing = st.v[ego] - st.v[j] * cos(m.seen_h[j] - tangent)
    time = gap / closing if closing > 0.0 else op.FAR
    m.least_time_to_collision[0] = min(m.least_time_to_collision[0], time)
    square = closing * closing
    if time < HORIZON:
        m.least_room[0] = min(m.least_room[0], 2.0 * gap / square if square > 0.0 else op.FAR)


@compiled
def may_be_ahead(p: Program, st: State, m: Totals, ego: int, j: int, front: float) -> int:
    """Return 0 if an entity cannot give a new least time to collision, headway or room to brake.

    No part of a box is farther from its centre than its half diagonal. A part within w of a circle and `a` along it is
    no farther away than a + w. The distance of the box's centre from the circle is (2 left - k (ahead^2 + left^2)) / (1
    + q), with q its distance from the circle's centre times the curvature k.
    """
    dx = st.middle_x[j] - st.x[ego]
    dy = st.middle_y[j] - st.y[ego]
    reach = st.reach[j] + SLACK
    ahead = dx * m.seen_cos[ego] + dy * m.seen_sin[ego]
    if ahead + reach < min(front, 0.0):
        return 0
    beside = reach + 0.5 * p.const[p.entity_const[ego] + slot.E_WIDTH]
    near = dx * dx + dy * dy
    fastest = st.v[ego] + abs(st.v[j])
    if fastest <= 0.0:
        return 0
    braking = min(0.5 * m.least_room[0] * fastest, HORIZON) * fastest
    gap = max(m.least_time_to_collision[0] * fastest, m.least_headway[0] * st.v[ego], braking)
    least = front + beside + gap
    if near > least * least:
        return 0
    left = dy * m.seen_cos[ego] - dx * m.seen_sin[ego]
    bend = m.curvature[0]
    q = length_of(bend * ahead, 1.0 - bend * left)
    return 1 if abs(2.0 * left - bend * near) <= (beside + SLACK) * (1.0 + q) else 0


@compiled
def add_distance(p: Program, st: State, m: Totals, ego: int, j: int) -> None:
    """Add the distance to the other box, whose corners must have been written."""
    of_ego = squared_distance_to_corners(p, st, m, ego, OTHER)
    of_other = squared_distance_to_corners(p, st, m, j, 0)
    m.least_distance[0] = min(m.least_distance[0], sqrt(min(of_ego, of_other)))


@compiled
def measure_boxes(p: Program, st: State, m: Totals, ego: int) -> None:
    """Add the other entities' boxes in this row; after an overlap of boxes no smaller value is possible."""
    if m.touched[0] == 1:
        return
    front = front_of(p, ego)
    laid = 0
    for j in range(p.entity_count[0]):
        if j == ego or st.present[j] == 0:
            continue
        dx = st.middle_x[j] - st.middle_x[ego]
        dy = st.middle_y[j] - st.middle_y[ego]
        near = dx * dx + dy * dy
        reach = st.reach[ego] + st.reach[j] + SLACK
        if near <= reach * reach and overlap(p, st, ego, j) == 1:
            m.touched[0] = 1
            m.least_distance[0] = 0.0
            m.least_time_to_collision[0] = 0.0
            m.least_headway[0] = 0.0
            m.least_room[0] = 0.0
            return
        nearer = near <= (reach + m.least_distance[0]) * (reach + m.least_distance[0])
        ahead = m.rows[0] > 1 and may_be_ahead(p, st, m, ego, j, front) == 1
        if (not nearer and not ahead) or is_above(p, st, ego, j) == 1:
            continue
        see_heading(st, m, j)
        lay_corners(p, st, m, j, OTHER)
        if nearer and laid == 0:
            laid = 1
            lay_corners(p, st, m, ego, 0)
        if nearer:
            add_distance(p, st, m, ego, j)
        if ahead:
            add_ahead(p, st, m, ego, j, front)
