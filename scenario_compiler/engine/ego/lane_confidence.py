"""Lane confidence without a camera, from the marks on both sides, the weather and the sensor's health."""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.numbers import clip
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.failures import health_of_camera
from scenario_compiler.engine.motion.path import path_ahead
from scenario_compiler.marker import compiled
from scenario_compiler.roads.lanes import lane_direction, lane_inside, lane_row_in
from scenario_compiler.roads.marks import MARK_NONE, mark_quality, mark_row, row_mark
from scenario_compiler.roads.tables import RoadTables

LOOK_FROM = 6.0
LOOK_STEP = 3.0
LOOK_COUNT = 5
LOOK_TO = 18.0
"""The marks are sampled from 6 m to 18 m ahead of the rear axle, every 3 m."""


@compiled
def mark_visibility(n: RoadTables, p: Program, road: int, lane: int, s: float) -> float:
    """Return the quality, 0 to 1, of the mark on a lane's outer border, the plan's rather than the map's; 0 if none."""
    return visibility_of(n, p, mark_row(n, road, lane, s), road, lane, s)


@compiled
def visibility_of(n: RoadTables, p: Program, mark: int, road: int, lane: int, s: float) -> float:
    """Return what `mark_visibility` does where the mark's row, or -1, is known."""
    if mark < 0 or n.mark_type[mark] == MARK_NONE:
        return 0.0
    quality = mark_quality(n, mark, s)
    for k in range(p.stretch_count[0]):
        base = p.stretch_const[k]
        begin = p.const[base + slot.M_FROM]
        end = p.const[base + slot.M_TO]
        of_mark = p.stretch_lane[k] == op.ALL_MARKS or p.stretch_lane[k] == lane
        if p.stretch_road[k] == road and of_mark and s >= begin and s <= end:
            share = (s - begin) / (end - begin) if end > begin else 0.0
            first = p.const[base + slot.M_QUALITY]
            if first >= 0.0:
                quality = first + share * (p.const[base + slot.M_QUALITY_TO] - first)
            quality = quality * (1.0 - clip(p.const[base + slot.M_COVERAGE], 0.0, 1.0))
    return clip(quality, 0.0, 1.0)


@compiled
def mark_changes(n: RoadTables, st: State, row: int, s: float) -> int:
    """Return 1 if the quality that the map gives the mark on the outer border of a lane's row at s changes along s.

    The stretch from `even_from` to `even_to` is narrowed to where this mark holds.
    """
    if row < 0:
        return 0
    mark = row_mark(n, row, s)
    following = n.lane_mark[row] if mark < 0 else mark + 1
    if following < n.lane_mark[row + 1]:
        st.even_to[0] = min(st.even_to[0], n.mark_s[following])
    if mark < 0:
        return 0
    st.even_from[0] = max(st.even_from[0], n.mark_s[mark])
    return 1 if n.mark_type[mark] != MARK_NONE and n.mark_quality_to[mark] != n.mark_quality_from[mark] else 0


@compiled
def keep_to_stretches(p: Program, st: State, s: float) -> int:
    """Narrow the stretch from `even_from` to `even_to` to where the plan's statements on marks stay the same.

    Return 1 if a statement that holds at s lets the quality change along s.
    """
    changes = 0
    for k in range(p.stretch_count[0]):
        if p.stretch_road[k] != st.path_road[0]:
            continue
        base = p.stretch_const[k]
        begin = p.const[base + slot.M_FROM]
        end = p.const[base + slot.M_TO]
        if end < s:
            st.even_from[0] = max(st.even_from[0], end)
        elif begin > s:
            st.even_to[0] = min(st.even_to[0], begin)
        else:
            st.even_from[0] = max(st.even_from[0], begin)
            st.even_to[0] = min(st.even_to[0], end)
            first = p.const[base + slot.M_QUALITY]
            if first >= 0.0 and first != p.const[base + slot.M_QUALITY_TO]:
                changes = 1
    return changes


@compiled
def note_even_marks(n: RoadTables, p: Program, st: State) -> None:
    """Write the stretch of s around the ego on which the marks of both sides do not change, and their qualities."""
    row = st.path_row[0]
    s = st.path_s[0]
    road = st.path_road[0]
    lane = st.path_lane[0]
    inside = lane_inside(lane)
    section = n.lane_section[row]
    st.even_row[0] = row
    st.even_from[0] = n.section_s[section]
    st.even_to[0] = n.section_end[section]
    outer_changes = mark_changes(n, st, row, s)
    inner_changes = mark_changes(n, st, lane_row_in(n, section, inside), s)
    if keep_to_stretches(p, st, s) == 1 or outer_changes == 1 or inner_changes == 1:
        st.even_row[0] = op.NONE
        return
    outer = mark_visibility(n, p, road, lane, s)
    inner = mark_visibility(n, p, road, inside, s)
    outer_is_left = (lane > 0) == (st.path_sense[0] > 0)
    st.even_left[0] = outer if outer_is_left else inner
    st.even_right[0] = inner if outer_is_left else outer


@compiled
def marks_stay(st: State) -> int:
    """Return 1 if the marks are known not to change up to the farthest sample."""
    s = st.path_s[0]
    end = s + st.path_sense[0] * LOOK_TO
    if st.path_row[0] != st.even_row[0] or min(s, end) <= st.even_from[0] or max(s, end) >= st.even_to[0]:
        return 0
    return 1


@compiled
def looked_at_sides(n: RoadTables, p: Program, st: State) -> tuple[float, float]:
    """Return the mean qualities of the (left, right) mark over the samples."""
    left = 0.0
    right = 0.0
    for k in range(LOOK_COUNT):
        ahead = LOOK_FROM + LOOK_STEP * k
        road, lane, _, s, rest = path_ahead(n, p, st, ahead)
        if rest > 0.0:
            continue
        inner = lane_inside(lane)
        outer_quality = mark_visibility(n, p, road, lane, s)
        inner_quality = mark_visibility(n, p, road, inner, s)
        if (lane > 0) == (lane_direction(n, road, lane, s) > 0):
            left += outer_quality
            right += inner_quality
        else:
            left += inner_quality
            right += outer_quality
    return left / LOOK_COUNT, right / LOOK_COUNT


@compiled
def ideal_confidence(n: RoadTables, p: Program, st: State) -> None:
    """Write the confidence of both sides of the path's lane and the sensor's health."""
    health = health_of_camera(p, st)
    left = 0.0
    right = 0.0
    if st.path_found[0] == 1 and st.path_row[0] >= 0:
        stay = marks_stay(st)
        if stay == 0:
            note_even_marks(n, p, st)
            stay = marks_stay(st)
        if stay == 1:
            left = st.even_left[0]
            right = st.even_right[0]
        else:
            left, right = looked_at_sides(n, p, st)
    seen = health * st.lines_left[0] * st.paint_seen[0]
    st.health[0] = health
    st.conf_left[0] = seen * left
    st.conf_right[0] = seen * right
