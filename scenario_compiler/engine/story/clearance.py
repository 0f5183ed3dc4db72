"""Relative clearance: whether the lanes around an entity are free of other entities within a range.

The range begins at the entity's reference point: "longitudinal distance in front of reference point of the entity to be
checked" (distanceForward, ASAM OpenSCENARIO). esmini begins at the entity's box if the boxes of others count.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.rows import ConditionRow, ProgramDraft
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.ahead import row_on_way
from scenario_compiler.engine.motion.beside import neighbour_lane
from scenario_compiler.engine.motion.distances import along_or_beside, along_roads, reach_there
from scenario_compiler.engine.story.entry import Condition
from scenario_compiler.forms.declaration import Allowed, Of
from scenario_compiler.marker import compiled
from scenario_compiler.roads.lane_types import is_drivable
from scenario_compiler.roads.lanes import lane_borders, lane_direction, lane_type, section_at
from scenario_compiler.roads.tables import RoadTables
from scenario_compiler.roads.travel import advance

if TYPE_CHECKING:
    from scenario_compiler.vocabulary.conditions import RelativeClearanceCondition

CLEARANCE_FREESPACE = 1
CLEARANCE_OPPOSITE = 2
"""Bits of a clearance condition's flags: boxes of others count instead of reference points; lanes of the opposite
direction count.
"""

MOST_LANES = 16
"""Number of lanes on each side that are checked."""


@compiled
def is_member(p: Program, row: int, value: int) -> int:
    """Return 1 if a set of the program contains a value, or is empty."""
    if p.set_first[row] == p.set_first[row + 1]:
        return 1
    for k in range(p.set_first[row], p.set_first[row + 1]):
        if p.set_member[k] == value:
            return 1
    return 0


@compiled
def in_ranges(p: Program, row: int, value: int) -> int:
    """Return 1 if a set of pairs has a pair that encloses a value, or is empty."""
    if p.set_first[row] == p.set_first[row + 1]:
        return 1
    for k in range(p.set_first[row], p.set_first[row + 1] - 1, 2):
        if p.set_member[k] <= value <= p.set_member[k + 1]:
            return 1
    return 0


@compiled
def lanes_between(lane: int, other: int, direction: int) -> int:
    """Return how many lanes `other` is to the left of `lane`, as seen along s (1) or against it (-1).

    The centre lane is not counted.
    """
    count = other - lane
    if lane < 0 and other > 0:
        count = count - 1
    if lane > 0 and other < 0:
        count = count + 1
    return direction * count


@compiled
def lane_over(n: RoadTables, st: State, i: int, road: int, s: float, ahead: float) -> int:
    """Return the lane that continues i's own at a place `ahead` metres ahead, or i's own lane id if none leads there.

    The lane's id may change on the same road too, at its lane sections. Another road is one of the way that
    `along_roads` has walked to the place.
    """
    if road == st.road[i]:
        along = st.facing[i] * lane_direction(n, road, st.lane[i], st.s[i])
        at_road, at_lane, _, _ = advance(n, road, st.lane[i], st.s[i], along * ahead, -1)
        return at_lane if at_road == road else st.lane[i]
    for w in range(1, st.way_count[0]):
        if st.way_road[w] == road:
            _, row = row_on_way(n, st, w, s, abs(ahead) - st.way_from[w])
            return n.lane_id[row] if row >= 0 else st.lane[i]
    return st.lane[i]


@compiled
def lane_counts(n: RoadTables, p: Program, c: int, road: int, s: float, own: int, lane: int, direction: int) -> int:
    """Return 1 if a clearance condition refers to a lane of a road at s; `own` is the one there that continues i's."""
    if in_ranges(p, p.condition_other[c] + 1, lanes_between(own, lane, direction)) == 0:
        return 0
    same = lane_direction(n, road, own, s) == lane_direction(n, road, lane, s)
    return 1 if same or p.condition_flags[c] & CLEARANCE_OPPOSITE != 0 else 0


@compiled
def point_in_the_way(n: RoadTables, p: Program, st: State, c: int, i: int, j: int) -> int:
    """Return 1 if the reference point of entity j is in the area of a clearance condition of entity i."""
    road = st.road[j]
    if road < 0:
        return 0
    ahead, _, direction = along_roads(n, st, i, road, st.s[j], st.t[j], st.x[j], st.y[j])
    base = p.condition_const[c]
    if ahead < -p.const[base + slot.C_BACKWARD] or ahead > p.const[base + slot.C_FORWARD]:
        return 0
    own = lane_over(n, st, i, road, st.s[j], ahead)
    return lane_counts(n, p, c, road, st.s[j], own, st.lane[j], direction)


@compiled
def box_in_the_way(n: RoadTables, p: Program, st: State, c: int, i: int, j: int) -> int:
    """Return 1 if a part of entity j's box is in the area of a clearance condition of entity i.

    "If false, then entityRefs are only considered to be on the lane if their reference point is within the checked
    area; otherwise the whole bounding box is considered" (freeSpace, ASAM OpenSCENARIO).
    """
    ahead, left, direction, road, s = along_or_beside(n, st, i, st.road[j], st.s[j], st.t[j], st.x[j], st.y[j])
    if road < 0 or ahead >= op.FAR:
        return 0
    own = lane_over(n, st, i, road, s, ahead)
    base = p.condition_const[c]
    middle, reach = reach_there(n, p, st, i, j, road, s, left, direction, op.FRAME_ROAD, op.MEASURE_ALONG)
    middle = ahead + middle
    if middle + reach < -p.const[base + slot.C_BACKWARD] or middle - reach > p.const[base + slot.C_FORWARD]:
        return 0
    middle, reach = reach_there(n, p, st, i, j, road, s, left, direction, op.FRAME_ROAD, op.MEASURE_ACROSS)
    t = direction * (left + st.facing[i] * st.t[i] + middle)
    section = section_at(n, road, s)
    for row in range(n.section_lane[section], n.section_lane[section + 1]):
        lane = n.lane_id[row]
        if lane == 0 or lane_counts(n, p, c, road, s, own, lane, direction) == 0:
            continue
        left_border, right_border = lane_borders(n, road, lane, s)
        if min(t + reach, left_border) - max(t - reach, right_border) > op.TOLERANCE:
            return 1
    return 0


@compiled
def in_the_way(n: RoadTables, p: Program, st: State, c: int, i: int, j: int) -> int:
    """Return 1 if entity j prevents a clearance condition of entity i from being true."""
    if st.road[i] < 0 or is_member(p, p.condition_other[c], j) == 0:
        return 0
    if p.condition_flags[c] & CLEARANCE_FREESPACE != 0:
        return box_in_the_way(n, p, st, c, i, j)
    return point_in_the_way(n, p, st, c, i, j)


@compiled
def has_lane(n: RoadTables, p: Program, st: State, c: int, i: int) -> int:
    """Return 1 if at least one of the lanes that a clearance condition requires exists, is for driving, and counts."""
    row = p.condition_other[c] + 1
    road = st.road[i]
    if road < 0 or p.set_first[row] == p.set_first[row + 1]:
        return 1
    for k in range(p.set_first[row], p.set_first[row + 1] - 1, 2):
        for by in range(max(p.set_member[k], -MOST_LANES), min(p.set_member[k + 1], MOST_LANES) + 1):
            lane = neighbour_lane(n, road, st.lane[i], st.s[i], by, st.facing[i])
            if lane == 0 or is_drivable(lane_type(n, road, lane, st.s[i])) == 0:
                continue
            same = lane_direction(n, road, lane, st.s[i]) == lane_direction(n, road, st.lane[i], st.s[i])
            if same or p.condition_flags[c] & CLEARANCE_OPPOSITE != 0:
                return 1
    return 0


@compiled
def is_clear(n: RoadTables, p: Program, st: State, c: int, i: int) -> int:
    """Return 1 if the lanes of a clearance condition of entity i exist and no entity is in the way (esmini)."""
    if has_lane(n, p, st, c, i) == 0:
        return 0
    for j in range(p.entity_count[0]):
        if j != i and st.present[j] == 1 and in_the_way(n, p, st, c, i, j) == 1:
            return 0
    return 1


ALL_LANES = 1 << 20
"""Lane number that no road has: an open end of a range."""


def clearance_row(draft: ProgramDraft, word: RelativeClearanceCondition) -> ConditionRow:
    """Return the row of a clearance condition; `other` is the set of entities, followed by that of lane ranges."""
    others = draft.members(draft.entities[one] for one in word.of)
    draft.members(
        end
        for lanes in word.lanes
        for end in (
            -ALL_LANES if lanes.least is None else lanes.least,
            ALL_LANES if lanes.greatest is None else lanes.greatest,
        )
    )
    flags = (CLEARANCE_FREESPACE if word.freespace else 0) | (CLEARANCE_OPPOSITE if word.opposite_lanes else 0)
    return ConditionRow(entity=word.entity, other=others, flags=flags, const=(word.forward, word.backward))


CLEARANCE = Condition(
    ("clearance",),
    clearance_row,
    is_clear,
    refers={"other": Allowed(Of("set that another follows", lambda p: len(p.set_first) - 2))},
)
