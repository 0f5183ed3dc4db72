"""Collisions: oriented boxes in the plane, with a sweep along x as broad phase."""

from __future__ import annotations

from math import cos, sin

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.log import log_event
from scenario_compiler.engine.columns.numbers import safe_sqrt
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.trailers import coupled
from scenario_compiler.marker import compiled

SLACK = 1.0e-3
"""Distance between two circles above which they surely do not meet, m."""


@compiled
def reported_entity(p: Program) -> int:
    """Return the entity whose collisions count: the ego, or the first entity if there is no ego."""
    return p.ego[0] if p.ego[0] >= 0 else 0


@compiled
def face(st: State, i: int) -> None:
    """Keep the cosine and sine of an entity's heading in `box_cos` and `box_sin`; most drive straight on."""
    h = st.h[i]
    if h != st.box_h[i]:
        st.box_h[i] = h
        st.box_cos[i] = cos(h)
        st.box_sin[i] = sin(h)


@compiled
def update_boxes(p: Program, st: State) -> int:
    """Update the centre of every entity's box, and sort the entities by the left end of their boxes' x range.

    Insertion sort is used because they are nearly sorted. Cosine and sine are kept while a heading does not change.
    The result is 0 if no two x ranges overlap, so that there is no collision.
    """
    for i in range(p.entity_count[0]):
        face(st, i)
        center = p.const[p.entity_const[i] + slot.E_CENTER]
        st.middle_x[i] = st.x[i] + center * st.box_cos[i]
        st.middle_y[i] = st.y[i] + center * st.box_sin[i]
    before = -op.FAR
    right = -op.FAR
    overlaps = 0
    for k in range(p.entity_count[0]):
        i = st.order[k]
        left = st.middle_x[i] - st.reach[i]
        if left <= right:
            overlaps = 1
        right = max(right, st.middle_x[i] + st.reach[i])
        if left >= before:
            before = left
            continue
        at = k
        while at > 0 and st.middle_x[st.order[at - 1]] - st.reach[st.order[at - 1]] > left:
            st.order[at] = st.order[at - 1]
            at = at - 1
        st.order[at] = i
    return overlaps


@compiled
def separated(p: Program, st: State, i: int, j: int, dx: float, dy: float, c_turned: float, s_turned: float) -> int:
    """Return 1 if an axis of box i separates it from box j.

    (dx, dy) is the vector between the centres; `c_turned` and `s_turned` are the absolute cosine and sine of the angle
    between the boxes.
    """
    c = st.box_cos[i]
    s = st.box_sin[i]
    a = p.entity_const[i]
    b = p.entity_const[j]
    long = 0.5 * p.const[b + slot.E_LENGTH]
    wide = 0.5 * p.const[b + slot.E_WIDTH]
    if abs(dx * c + dy * s) > 0.5 * p.const[a + slot.E_LENGTH] + long * c_turned + wide * s_turned:
        return 1
    if abs(dy * c - dx * s) > 0.5 * p.const[a + slot.E_WIDTH] + long * s_turned + wide * c_turned:
        return 1
    return 0


@compiled
def is_above(p: Program, st: State, i: int, j: int) -> int:
    """Return 1 if one of two entities is entirely above the other, as on a bridge."""
    above = st.z[j] - st.z[i]
    if above > p.const[p.entity_const[i] + slot.E_HEIGHT] or -above > p.const[p.entity_const[j] + slot.E_HEIGHT]:
        return 1
    return 0


@compiled
def overlap(p: Program, st: State, i: int, j: int) -> int:
    """Return 1 if the boxes of two present entities overlap, neither above the other."""
    if st.present[i] == 0 or st.present[j] == 0 or overlap_from_above(p, st, i, j) == 0:
        return 0
    return 1 - is_above(p, st, i, j)


@compiled
def overlap_from_above(p: Program, st: State, i: int, j: int) -> int:
    """Return 1 if two boxes overlap as seen from above (separating axis theorem)."""
    dx = st.middle_x[j] - st.middle_x[i]
    dy = st.middle_y[j] - st.middle_y[i]
    reach = st.reach[i] + st.reach[j]
    if dx * dx + dy * dy > reach * reach:
        return 0
    turned = st.box_h[j] - st.box_h[i]
    c = abs(cos(turned))
    s = abs(sin(turned))
    if separated(p, st, i, j, dx, dy, c, s) == 1 or separated(p, st, j, i, dx, dy, c, s) == 1:
        return 0
    return 1


@compiled
def may_overlap(p: Program, st: State) -> int:
    """Return 1 if the circles around two boxes meet, also of absent entities; if they do not, no boxes overlap."""
    count = p.entity_count[0]
    for a in range(count):
        i = st.order[a]
        b = a + 1
        while b < count:
            j = st.order[b]
            reach = st.reach[i] + st.reach[j] + SLACK
            dx = st.middle_x[j] - st.middle_x[i]
            dy = st.middle_y[j] - st.middle_y[i]
            if dx > reach:
                break
            if dx * dx + dy * dy <= reach * reach:
                return 1
            b = b + 1
    return 0


@compiled
def note_crash(st: State, other: int) -> None:
    """Store the time and the other entity of the reported vehicle's first collision; NONE for no entity."""
    if st.crashed[0] == 0:
        st.crashed[0] = 1
        st.time_collision[0] = st.clock[0]
        st.collided_with[0] = other


@compiled
def note_collision(p: Program, st: State, i: int, j: int) -> None:
    """Log each new contact of the reported vehicle, and the first contact of any two others.

    Contacts within a combination of trailers do not count; two standing entities were placed that way.
    """
    if coupled(p, st, i, j) == 1:
        return
    ego = reported_entity(p)
    if ego in (i, j):
        other = j if i == ego else i
        if st.contact[other] == 0:
            log_event(st, op.EVENT_COLLISION, 1.0 * other)
        st.contact[other] = 2
        note_crash(st, other)
        return
    known = st.struck[i] == 1 and st.struck[j] == 1
    if known or (st.v[i] == 0.0 and st.v[j] == 0.0):
        return
    st.struck[i] = 1
    st.struck[j] = 1
    log_event(st, op.EVENT_CONTACT, 1.0 * (min(i, j) * p.entity_count[0] + max(i, j)))


@compiled
def note_world_collision(p: Program, st: State, other: int) -> None:
    """Log a collision of the reported vehicle that the world's own physics found, as one that the boxes show.

    `other` is the other entity, NONE for something else in the world, of which only the first collision is logged.
    """
    if other < 0:
        if st.crashed[0] == 0:
            log_event(st, op.EVENT_COLLISION, 1.0 * op.NONE)
        note_crash(st, op.NONE)
    elif other != reported_entity(p):
        note_collision(p, st, reported_entity(p), other)


@compiled
def in_contact(p: Program, st: State, i: int, j: int) -> int:
    """Return 1 if two present entities touch: their boxes overlap, or the world's physics reported it in this step."""
    ego = reported_entity(p)
    if ego in (i, j) and st.present[i] == 1 and st.present[j] == 1 and st.contact[j if i == ego else i] == 1:
        return 1
    return overlap(p, st, i, j)


@compiled
def check_collisions(p: Program, st: State) -> None:
    """Find all overlapping pairs."""
    count = p.entity_count[0]
    for a in range(count):
        i = st.order[a]
        if st.present[i] == 0:
            continue
        right = st.middle_x[i] + st.reach[i]
        b = a + 1
        while b < count and st.middle_x[st.order[b]] - st.reach[st.order[b]] <= right:
            if overlap(p, st, i, st.order[b]) == 1:
                note_collision(p, st, i, st.order[b])
            b = b + 1
    if st.crashed[0] == 1:
        for i in range(count):
            st.contact[i] = 1 if st.contact[i] == 2 else 0


@compiled
def find_contacts(p: Program, st: State, pairs: list[int]) -> int:
    """Write the pairs of entities whose boxes overlap, lower index first, while there is room; return their number."""
    count = p.entity_count[0]
    found = 0
    for a in range(count):
        i = st.order[a]
        if st.present[i] == 0:
            continue
        right = st.middle_x[i] + st.reach[i]
        b = a + 1
        while b < count and st.middle_x[st.order[b]] - st.reach[st.order[b]] <= right:
            j = st.order[b]
            if overlap(p, st, i, j) == 1 and 2 * found + 1 < len(pairs):
                pairs[2 * found] = min(i, j)
                pairs[2 * found + 1] = max(i, j)
                found = found + 1
            b = b + 1
    return found


@compiled
def find_touched(p: Program, st: State, i: int) -> int:
    """Return an entity whose box overlaps that of entity i at the present poses, or NONE."""
    update_boxes(p, st)
    for j in range(p.entity_count[0]):
        if j != i and overlap(p, st, i, j) == 1:
            return j
    return op.NONE


@compiled
def measure_reach(p: Program, st: State, i: int) -> None:
    """Write half the diagonal of an entity's box."""
    base = p.entity_const[i]
    long = p.const[base + slot.E_LENGTH]
    wide = p.const[base + slot.E_WIDTH]
    st.reach[i] = 0.5 * safe_sqrt(long * long + wide * wide)


@compiled
def prepare_boxes(p: Program, st: State) -> None:
    """Write the constant values of the boxes."""
    for i in range(p.entity_count[0]):
        measure_reach(p, st, i)
        st.order[i] = i
