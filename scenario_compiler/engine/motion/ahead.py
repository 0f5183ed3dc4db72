"""The way of an entity: the lanes ahead that it will follow, and the boxes of other entities along and across them.

A way is a list of roads in scratch columns (`way_...`), which each walk overwrites. Distances along it start at the
walking entity's reference point; left is relative to the direction of the walk.
"""

from __future__ import annotations

from math import cos, sin

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.path import STEP_OVER, preferred_road, section_holds
from scenario_compiler.marker import compiled
from scenario_compiler.roads.geometry import road_heading
from scenario_compiler.roads.lanes import lane_direction, lane_offset, lane_row, row_centre, row_width
from scenario_compiler.roads.locate import project_on_road
from scenario_compiler.roads.tables import RoadTables
from scenario_compiler.roads.travel import advance, advance_row

BESIDE = 25.0
"""How far behind the start of the way, or to the side in a junction, an entity may be and still count, m."""


@compiled
def note_way(st: State, w: int, road: int, lane: int, row: int, s: float, sign: int, begin: float) -> None:
    """Write row w of the way: a lane, the s at which it is entered, the sense along s, and where it begins, m."""
    st.way_road[w] = road
    st.way_lane[w] = lane
    st.way_row[w] = row
    st.way_s[w] = s
    st.way_sign[w] = sign
    st.way_from[w] = begin


@compiled
def walk(n: RoadTables, st: State, road: int, lane: int, s: float, along: int, horizon: float, turns: int) -> None:
    """Write the way from a place in a lane, in its direction of travel (`along` 1) or against it (-1), for `horizon` m.

    `turns` is the road to take at the first junction, or -1 for straight on.
    """
    st.looked[0] = 0
    count = 0
    covered = 0.0
    while count < op.WAY_SIZE and road >= 0:
        sign = lane_direction(n, road, lane, s) * along
        note_way(st, count, road, lane, lane_row(n, road, lane, s), s, sign, covered)
        count = count + 1
        rest = n.road_length[road] - s if sign > 0 else s
        covered = covered + rest + STEP_OVER
        if covered > horizon:
            break
        road, lane, s, left = advance(n, road, lane, s, along * (rest + STEP_OVER), turns)
        if left > 0.0:
            break
    st.way_count[0] = count


@compiled
def walk_route(n: RoadTables, p: Program, st: State, horizon: float) -> None:
    """Write the ego's way from its place on the path along its route, up to `horizon`, m."""
    st.looked[0] = 0
    road = st.path_road[0]
    lane = st.path_lane[0]
    s = st.path_s[0]
    row = st.path_row[0]
    sign = st.path_sense[0]
    count = 0
    covered = 0.0
    while count < op.WAY_SIZE and road >= 0:
        note_way(st, count, road, lane, row, s, sign, covered)
        count = count + 1
        rest = n.road_length[road] - s if sign > 0 else s
        covered = covered + rest + STEP_OVER
        if covered > horizon:
            break
        if row < 0:
            break
        row, s, left = advance_row(n, row, s, rest + STEP_OVER, preferred_road(p, st, road))
        road = n.section_road[n.lane_section[row]]
        if left > 0.0:
            break
        lane = n.lane_id[row]
        if section_holds(n, row, s) == 0:
            row = lane_row(n, road, lane, s)
        sign = n.lane_sense[row] if row >= 0 else lane_direction(n, road, lane, s)
    st.way_count[0] = count


@compiled
def point_on_way(
    n: RoadTables, st: State, road: int, at_s: float, at_t: float, x: float, y: float
) -> tuple[int, float, float, float]:
    """Return (row of the way or -1, s, t, distance along the way) of a point at a place on a road.

    A point on another of the overlapping roads of a junction is projected onto the way's road there.
    """
    if road < 0:
        return -1, 0.0, 0.0, 0.0
    for w in range(st.way_count[0]):
        at = st.way_road[w]
        s = at_s
        t = at_t
        on = 1
        if at != road:
            on = 0
            if n.road_junction[at] >= 0 and n.road_junction[at] == n.road_junction[road]:
                s, t = project_on_road(n, at, 0.5 * n.road_length[at], x, y)
                if s >= 0.0 and s <= n.road_length[at] and abs(t) < BESIDE:
                    on = 1
        if on == 1:
            covered = st.way_sign[w] * (s - st.way_s[w])
            if covered >= 0.0 or (w == 0 and covered > -BESIDE):
                return w, s, t, st.way_from[w] + covered
    return -1, 0.0, 0.0, 0.0


@compiled
def row_on_way(n: RoadTables, st: State, w: int, s: float, ahead: float) -> tuple[int, int]:
    """Return (1, row of the lane or -1) at s on the way's row w, `ahead` m after its start; (0, -1) beyond its end."""
    road = st.way_road[w]
    lane = st.way_lane[w]
    if ahead > 0.0:
        along = st.way_sign[w] * lane_direction(n, road, lane, st.way_s[w])
        _, lane, _, left = advance(n, road, lane, st.way_s[w], along * ahead, -1)
        if left > 0.0:
            return 0, -1
    return 1, lane_row(n, road, lane, s)


@compiled
def measure_on_way(n: RoadTables, p: Program, st: State, j: int) -> int:
    """Measure an entity's box along and across the way; return 1 if the entity is on it.

    Most entities keep their angle to the road, and so its cosine and sine.
    """
    st.on_way[j] = 0
    if st.present[j] == 0:
        return 0
    w, s, t, distance = point_on_way(n, st, st.road[j], st.s[j], st.t[j], st.x[j], st.y[j])
    if w < 0:
        return 0
    road = st.way_road[w]
    sign = st.way_sign[w]
    row = st.way_row[w]
    if section_holds(n, row, s) == 0:
        goes_on, row = row_on_way(n, st, w, s, distance - st.way_from[w])
        if goes_on == 0:
            return 0
    if row >= 0:
        lane_t, _ = row_centre(n, road, row, s)
        half = 0.5 * row_width(n, row, s)
    else:
        lane_t = lane_offset(n, road, s)
        half = 0.0
    relative = st.h[j] - road_heading(n, road, s)
    if relative != st.way_angle[j]:
        st.way_angle[j] = relative
        st.way_cos[j] = cos(relative)
        st.way_sin[j] = sin(relative)
    c = sign * st.way_cos[j]
    w_side = sign * st.way_sin[j]
    base = p.entity_const[j]
    lengthwise = abs(c)
    crosswise = abs(w_side)
    half_length = 0.5 * p.const[base + slot.E_LENGTH]
    half_width = 0.5 * p.const[base + slot.E_WIDTH]
    deep = lengthwise * half_length + crosswise * half_width
    wide = crosswise * half_length + lengthwise * half_width
    centre = p.const[base + slot.E_CENTER]
    middle = distance + centre * c
    aside = sign * (t - lane_t) + centre * w_side
    st.near[j] = middle - deep
    st.far[j] = middle + deep
    st.low[j] = aside - wide
    st.high[j] = aside + wide
    st.along[j] = st.v[j] * c
    st.across[j] = st.v[j] * w_side
    st.border_left[j] = half
    st.border_right[j] = -half
    st.on_way[j] = 1
    return 1
