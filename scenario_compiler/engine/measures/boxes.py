"""The least distance of the ego's box from others, and the least time to collision on the circle that it drives.

The same formulas, in the same order of operations, are in `recording.boxes` and `recording.on_path`, over arrays. The
exact computation is slow, so it is done only if a bound does not rule out a new least value. While the ego approaches
something, every row may have a new least value. So what no bound rules out waits, and the last row is measured first:
its values rule out most of those before it. The order of the rows does not change a least value.
"""

from __future__ import annotations

from math import atan2, copysign, cos, pi, sin, sqrt

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.extent import front_of
from scenario_compiler.engine.columns.numbers import length_of
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.columns.totals import WAITING, Totals
from scenario_compiler.engine.motion.collision import SLACK, is_above, overlap
from scenario_compiler.engine.motion.trailers import coupled
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
def lay_corners(p: Program, m: Totals, i: int, x: float, y: float, c: float, s: float, base: int) -> None:
    """Write the corners of the box of i at a pose to `corner_x` and `corner_y` from index `base`.

    `c` and `s` are cosine and sine of the heading. The order is front left, rear left, rear right, front right.
    """
    at = p.entity_const[i]
    long = 0.5 * p.const[at + slot.E_LENGTH]
    wide = 0.5 * p.const[at + slot.E_WIDTH]
    center = p.const[at + slot.E_CENTER]
    for corner in range(4):
        along = center + (long if corner in (0, 3) else -long)
        across = wide if corner < 2 else -wide
        m.corner_x[base + corner] = x + along * c - across * s
        m.corner_y[base + corner] = y + along * s + across * c


@compiled
def squared_distance_to_corners(
    p: Program, m: Totals, i: int, x: float, y: float, c: float, s: float, base: int
) -> float:
    """Return the least squared distance from the box of i at a pose to four corners, m2."""
    at = p.entity_const[i]
    center = p.const[at + slot.E_CENTER]
    long = 0.5 * p.const[at + slot.E_LENGTH]
    wide = 0.5 * p.const[at + slot.E_WIDTH]
    least = op.FAR * op.FAR
    for corner in range(base, base + 4):
        dx = m.corner_x[corner] - x
        dy = m.corner_y[corner] - y
        along = max(abs(dx * c + dy * s - center) - long, 0.0)
        across = max(abs(dy * c - dx * s) - wide, 0.0)
        least = min(least, along * along + across * across)
    return least


@compiled
def across_circle(ahead: float, left: float, bend: float) -> float:
    """Return how far a point is from the circle that the ego drives, m, positive to the left.

    The point is given relative to the ego's reference point, where the circle of curvature `bend` begins.
    """
    if abs(bend) <= STRAIGHT:
        return left
    side = -1.0 if bend < 0.0 else 1.0
    radius = 1.0 / abs(bend)
    return side * (radius - length_of(ahead, radius - side * left))


@compiled
def along_circle(ahead: float, left: float, bend: float) -> float:
    """Return the distance along that circle to the place beside a point, m."""
    if abs(bend) <= STRAIGHT:
        return ahead
    side = -1.0 if bend < 0.0 else 1.0
    radius = 1.0 / abs(bend)
    return atan2(ahead, radius - side * left) * radius


@compiled
def lay_across_circle(m: Totals, k: int) -> None:
    """Write the other box's corners relative to the ego, and across the circle that it drives.

    `k` is the waiting pair.
    """
    c = m.own_cos[k]
    s = m.own_sin[k]
    for corner in range(4):
        dx = m.corner_x[OTHER + corner] - m.own_x[k]
        dy = m.corner_y[OTHER + corner] - m.own_y[k]
        ahead = c * dx + s * dy
        left = c * dy - s * dx
        m.corner_ahead[corner] = ahead
        m.corner_left[corner] = left
        m.corner_across[corner] = across_circle(ahead, left, m.pair_bend[k])


@compiled
def curved_by(bend: float) -> float:
    """Return a path's curvature, 0 if it counts as straight, 1/m."""
    return bend if abs(bend) > STRAIGHT else 0.0


@compiled
def side_at(m: Totals, k: int, bend: float) -> tuple[float, float, float, float, float, float]:
    """Return where the side of the box behind corner k begins and how far it leads, ahead and to the left, m.

    The last two are square and slope, m: up to the share u of the side, 2 left - bend (ahead^2 + left^2) changes by
    square u^2 + 2 slope u. It tells on which side of the circle a place is, and the side of the box is nearest to the
    circle's centre where slope + square u is 0.
    """
    curved = curved_by(bend)
    following = (k + 1) % 4
    ahead = m.corner_ahead[k]
    left = m.corner_left[k]
    long = m.corner_ahead[following] - ahead
    wide = m.corner_left[following] - left
    square = -curved * (long * long + wide * wide)
    slope = wide - curved * (ahead * long + left * wide)
    return ahead, left, long, wide, square, slope


@compiled
def is_off_circle(m: Totals, bend: float, half: float) -> int:
    """Return 1 if the whole box is on one side of the circle, `half` or more away from it, m.

    Its corners must have been written by `lay_across_circle`.
    """
    low = op.FAR
    high = -op.FAR
    for k in range(4):
        low = min(low, m.corner_across[k])
        high = max(high, m.corner_across[k])
    for k in range(4):
        ahead, left, long, wide, square, slope = side_at(m, k, bend)
        if square != 0.0 and 0.0 < -slope / square < 1.0:
            foot = -slope / square
            across = across_circle(ahead + foot * long, left + foot * wide, bend)
            low = min(low, across)
            high = max(high, across)
    return 1 if low >= half or high <= -half else 0


@compiled
def lay_along_circle(m: Totals, bend: float) -> None:
    """Write the corners that `lay_across_circle` wrote along the circle."""
    for k in range(4):
        m.corner_along[k] = along_circle(m.corner_ahead[k], m.corner_left[k], bend)


@compiled
def least_along(m: Totals, bend: float, half: float) -> float:
    """Return the least distance along the circle of the part of the box within `half` of the circle, m, or FAR.

    The angle grows or falls all along a side of the box. The least one is therefore at a corner, or where a side
    crosses a border of the strip. At the share u of a side, square u^2 + 2 slope u + start is 0 on the border at the
    offset e; it is 2 (left - e) - bend (ahead^2 + left^2 - e^2).
    """
    curved = curved_by(bend)
    least = op.FAR
    for k in range(4):
        if abs(m.corner_across[k]) <= half:
            least = min(least, m.corner_along[k])
    for k in range(4):
        ahead, left, long, wide, square, slope = side_at(m, k, bend)
        for number in range(4):
            edge = half if number >= 2 else -half
            start = 2.0 * (left - edge) - curved * (ahead * ahead + left * left - edge * edge)
            root = slope * slope - square * start
            if root < 0.0:
                continue
            both = -(slope + copysign(sqrt(root), slope))
            over = start if number % 2 == 0 else both
            under = both if number % 2 == 0 else square
            share = over / under if under != 0.0 else -1.0
            if 0.0 <= share <= 1.0:
                least = min(least, along_circle(ahead + share * long, left + share * wide, bend))
    return least


@compiled
def add_ahead(p: Program, m: Totals, ego: int, k: int) -> None:
    """Add an entity that is in the path ahead; its corners must have been written.

    A box on the far side of the circle, where ahead and behind meet, and one around its centre do not count as ahead.
    Most boxes that wait are beside the path, so their places along it are not needed.
    """
    half = 0.5 * p.const[p.entity_const[ego] + slot.E_WIDTH]
    bend = m.pair_bend[k]
    lay_across_circle(m, k)
    if is_off_circle(m, bend, half) == 1:
        return
    lay_along_circle(m, bend)
    along = least_along(m, bend, half)
    gap = along - front_of(p, ego)
    if along >= op.FAR or gap < 0.0:
        return
    a = m.corner_along[0]
    b = m.corner_along[1]
    c = m.corner_along[2]
    d = m.corner_along[3]
    if (max(a, b, c, d) - min(a, b, c, d)) * abs(m.pair_bend[k]) >= pi:
        return
    v = m.own_v[k]
    m.least_headway[0] = min(m.least_headway[0], gap / v if v > 0.0 else op.FAR)
    tangent = m.own_h[k] + m.pair_bend[k] * ((a + b + c + d) / 4.0)
    closing = v - m.other_v[k] * cos(m.other_h[k] - tangent)
    time = gap / closing if closing > 0.0 else op.FAR
    m.least_time_to_collision[0] = min(m.least_time_to_collision[0], time)
    square = closing * closing
    if time < HORIZON:
        m.least_room[0] = min(m.least_room[0], 2.0 * gap / square if square > 0.0 else op.FAR)


@compiled
def add_distance(p: Program, m: Totals, ego: int, k: int) -> None:
    """Add the distance to the other box; its corners must have been written."""
    j = m.pair_other[k]
    lay_corners(p, m, ego, m.own_x[k], m.own_y[k], m.own_cos[k], m.own_sin[k], 0)
    of_ego = squared_distance_to_corners(p, m, ego, m.own_x[k], m.own_y[k], m.own_cos[k], m.own_sin[k], OTHER)
    of_other = squared_distance_to_corners(p, m, j, m.other_x[k], m.other_y[k], m.other_cos[k], m.other_sin[k], 0)
    m.least_distance[0] = min(m.least_distance[0], sqrt(min(of_ego, of_other)))


@compiled
def widest_gap(m: Totals, v: float, other: float) -> float:
    """Return the gap, m, above which the ego gets no new least time to collision, headway or room to brake.

    `v` is its speed and `other` that of the entity ahead, m/s.
    """
    fastest = v + abs(other)
    braking = min(0.5 * m.least_room[0] * fastest, HORIZON) * fastest
    return max(m.least_time_to_collision[0] * fastest, m.least_headway[0] * v, braking)


@compiled
def measure_waiting(p: Program, m: Totals, ego: int) -> None:
    """Add the waiting pairs, the last one first."""
    for later in range(m.waiting[0]):
        k = m.waiting[0] - 1 - later
        nearer = m.pair_apart[k] <= m.least_distance[0]
        ahead = m.pair_ahead[k] == 1 and m.pair_gap[k] <= widest_gap(m, m.own_v[k], m.other_v[k])
        if nearer or ahead:
            lay_corners(p, m, m.pair_other[k], m.other_x[k], m.other_y[k], m.other_cos[k], m.other_sin[k], OTHER)
        if nearer:
            add_distance(p, m, ego, k)
        if ahead:
            add_ahead(p, m, ego, k)
    m.waiting[0] = 0


@compiled
def let_wait(p: Program, st: State, m: Totals, ego: int, j: int, apart: float, ahead: int, gap: float) -> None:
    """Keep the poses of the ego and of j in this row until they are measured.

    `apart` is a lower bound of their distance. `ahead` is 1 if j may be in the path ahead, and `gap` then a lower bound
    of the gap to it, m.
    """
    see_heading(st, m, j)
    k = m.waiting[0]
    m.pair_other[k] = j
    m.pair_apart[k] = apart
    m.pair_ahead[k] = ahead
    m.pair_gap[k] = gap
    m.pair_bend[k] = m.curvature[0]
    m.own_x[k] = st.x[ego]
    m.own_y[k] = st.y[ego]
    m.own_h[k] = m.seen_h[ego]
    m.own_cos[k] = m.seen_cos[ego]
    m.own_sin[k] = m.seen_sin[ego]
    m.own_v[k] = st.v[ego]
    m.other_x[k] = st.x[j]
    m.other_y[k] = st.y[j]
    m.other_h[k] = m.seen_h[j]
    m.other_cos[k] = m.seen_cos[j]
    m.other_sin[k] = m.seen_sin[j]
    m.other_v[k] = st.v[j]
    m.waiting[0] = k + 1
    if k + 1 == WAITING:
        measure_waiting(p, m, ego)


@compiled
def gap_at_least(p: Program, st: State, m: Totals, ego: int, j: int, front: float) -> float:
    """Return a lower bound of the gap to an entity in the path ahead, m; FAR if it is not in the path.

    No part of a box is farther from its centre than its half diagonal. A part within w of a circle and `a` along it is
    no farther away than a + w. The distance of the box's centre from the circle is (2 left - k (ahead^2 + left^2)) / (1
    + q), with q its distance from the circle's centre times the curvature k.
    """
    dx = st.middle_x[j] - st.x[ego]
    dy = st.middle_y[j] - st.y[ego]
    reach = st.reach[j] + SLACK
    ahead = dx * m.seen_cos[ego] + dy * m.seen_sin[ego]
    if ahead + reach < min(front, 0.0):
        return op.FAR
    beside = reach + 0.5 * p.const[p.entity_const[ego] + slot.E_WIDTH]
    near = dx * dx + dy * dy
    left = dy * m.seen_cos[ego] - dx * m.seen_sin[ego]
    bend = m.curvature[0]
    q = length_of(bend * ahead, 1.0 - bend * left)
    if not abs(2.0 * left - bend * near) <= (beside + SLACK) * (1.0 + q):
        return op.FAR
    return sqrt(near) - front - beside if near > 0.0 else 0.0


@compiled
def surely_beside(p: Program, st: State, m: Totals, ego: int, j: int) -> int:
    """Return 1 if a bound shows that no part of an entity's box is in the path.

    Let d be the distance from the centre of the circle to that of the box, r half the box's diagonal, and w half its
    extent along the line between both centres. The distances of its parts from the circle's centre are then between
    d - w and d + w + r^2 / (2 (d - r)).
    """
    dx = st.middle_x[j] - st.x[ego]
    dy = st.middle_y[j] - st.y[ego]
    c = m.seen_cos[ego]
    s = m.seen_sin[ego]
    ahead = dx * c + dy * s
    left = dy * c - dx * s
    bend = curved_by(m.curvature[0])
    along = bend * ahead
    across = bend * left - 1.0
    q = length_of(along, across)
    bound = abs(bend) * st.reach[j]
    if q <= bound:
        return 0
    turned_c = c * st.box_cos[j] + s * st.box_sin[j]
    turned_s = c * st.box_sin[j] - s * st.box_cos[j]
    base = p.entity_const[j]
    extent = 0.5 * p.const[base + slot.E_LENGTH] * abs(along * turned_c + across * turned_s)
    extent += 0.5 * p.const[base + slot.E_WIDTH] * abs(across * turned_c - along * turned_s)
    room = abs(2.0 * left - bend * (dx * dx + dy * dy)) / (1.0 + q)
    room -= 0.5 * p.const[p.entity_const[ego] + slot.E_WIDTH] + SLACK
    if bound > 0.0:
        room -= 0.5 * bound * st.reach[j] / (q - bound) if q - bound > 0.0 else op.FAR
    return 1 if room * q > extent else 0


@compiled
def measure_boxes(p: Program, st: State, m: Totals, ego: int) -> None:
    """Add the other entities' boxes in this row; after an overlap of boxes no smaller value is possible."""
    if m.touched[0] == 1:
        return
    front = front_of(p, ego)
    for j in range(p.entity_count[0]):
        if j == ego or st.present[j] == 0 or coupled(p, st, ego, j) == 1:
            continue
        between = length_of(st.middle_x[j] - st.middle_x[ego], st.middle_y[j] - st.middle_y[ego])
        apart = between - st.reach[ego] - st.reach[j] - SLACK
        if apart <= 0.0 and overlap(p, st, ego, j) == 1:
            m.touched[0] = 1
            m.waiting[0] = 0
            m.least_distance[0] = 0.0
            m.least_time_to_collision[0] = 0.0
            m.least_headway[0] = 0.0
            m.least_room[0] = 0.0
            return
        ahead = 0
        gap = op.FAR
        if m.rows[0] > 1:
            gap = gap_at_least(p, st, m, ego, j, front)
            if gap <= widest_gap(m, st.v[ego], st.v[j]) and surely_beside(p, st, m, ego, j) == 0:
                ahead = 1
        if (apart <= m.least_distance[0] or ahead == 1) and is_above(p, st, ego, j) == 0:
            let_wait(p, st, m, ego, j, apart, ahead, gap)
