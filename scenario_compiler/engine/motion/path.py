"""The ego's path: the lane that it follows, and the ego's position along and beside it.

The path follows the links from lane to lane; at a junction it takes the next road of the plan's route, or goes straight
on. Where several connecting roads of a junction overlap, the path keeps the ego on one of them.
"""

from __future__ import annotations

from math import pi

from scenario_compiler.engine.columns.numbers import angle_between
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.marker import compiled
from scenario_compiler.roads.geometry import piece_heading
from scenario_compiler.roads.lane_types import is_drivable, is_roadside
from scenario_compiler.roads.lanes import (
    lane_at,
    lane_centre,
    lane_direction,
    lane_exists,
    lane_row,
    lane_type,
    row_centre,
    row_width,
)
from scenario_compiler.roads.locate import project_on_piece, project_on_road, track
from scenario_compiler.roads.tables import LINE, RoadTables
from scenario_compiler.roads.travel import HOP_LIMIT, advance, row_next, stretch_at, way_in, way_out

REJOINS = 150.0
"""Distance within which a lane that leaves the route may come back to it, m; chosen: the length of a large junction."""

STEP_OVER = 0.001
"""Distance beyond a road's end at which the next road is looked up, m."""

CLEARLY = 1.0e-3
"""Distance from the lane's borders above which a point is in the lane without a check of the neighbouring lanes, m."""


@compiled
def preferred_road(p: Program, st: State, road: int) -> int:
    """Return the road that the route takes after `road`, or -1 off the route."""
    for k in range(st.route_at[0], p.route_count[0] - 1):
        if p.route_road[k] == road:
            return p.route_road[k + 1]
    return -1


@compiled
def advance_route(p: Program, st: State, road: int) -> None:
    """Move the ego's place in the route on to `road`, if the rest of the route contains it."""
    for k in range(st.route_at[0], p.route_count[0]):
        if p.route_road[k] == road:
            st.route_at[0] = k
            return


@compiled
def on_rest_of_route(p: Program, st: State, road: int) -> int:
    """Return 1 if the rest of the route contains a road."""
    for k in range(st.route_at[0], p.route_count[0]):
        if p.route_road[k] == road:
            return 1
    return 0


@compiled
def distance_on_route(n: RoadTables, p: Program, st: State, road: int, lane: int, s: float, limit: float) -> float:
    """Return how far a lane leads along the route, m, at most `limit`; `limit` if the road is off the route.

    A lane that comes back to the route within `REJOINS` does not leave it: another connecting road of a junction.
    """
    row = lane_row(n, road, lane, s)
    if row < 0 or on_rest_of_route(p, st, road) == 0:
        return limit
    gone = 0.0
    left = -1.0
    at = s
    sense = n.lane_sense[row]
    for _ in range(HOP_LIMIT):
        wanted = preferred_road(p, st, n.section_road[n.lane_section[row]])
        if left < 0.0 and wanted < 0:
            return limit
        end, room = way_out(n, row, at, sense)
        gone += room
        if left < 0.0 and gone >= limit:
            return limit
        if left >= 0.0 and gone - left > REJOINS:
            return left
        row, contact = row_next(n, row, end, 1, wanted)
        if row < 0:
            return limit if left < 0.0 else left
        following = n.section_road[n.lane_section[row]]
        if on_rest_of_route(p, st, following) == 1:
            left = -1.0
        elif left < 0.0:
            left = gone
        sense, at = way_in(n, row, contact)
    return limit if left < 0.0 else left


@compiled
def section_holds(n: RoadTables, row: int, s: float) -> int:
    """Return 1 if the lane section of a lane's row contains s; its end belongs to the next section."""
    if row < 0:
        return 0
    section = n.lane_section[row]
    return 1 if s >= n.section_s[section] and s < n.section_end[section] else 0


@compiled
def path_ahead(n: RoadTables, p: Program, st: State, ds: float) -> tuple[int, int, int, float, float]:
    """Return (road, lane, the lane's row or -1, s, rest) at ds >= 0 ahead of the path's place, along the route.

    `rest` is the part of ds that lies beyond the end of the path, m.
    """
    s = st.path_s[0] + st.path_sense[0] * ds
    if section_holds(n, st.path_row[0], s) == 1:
        return st.path_road[0], st.path_lane[0], st.path_row[0], s, 0.0
    road, lane, s, rest = advance_routed(n, p, st, st.path_road[0], st.path_lane[0], st.path_s[0], ds)
    return road, lane, lane_row(n, road, lane, s), s, rest


@compiled
def advance_routed(
    n: RoadTables, p: Program, st: State, road: int, lane: int, s: float, ds: float
) -> tuple[int, int, float, float]:
    """Return (road, lane, s, rest) after ds >= 0 in the direction of travel, along the ego's route."""
    left = ds
    for _ in range(64):
        room = n.road_length[road] - s
        if lane_direction(n, road, lane, s) < 0:
            room = s
        step = min(left, room)
        following = preferred_road(p, st, road)
        road, lane, s, rest = advance(n, road, lane, s, step, following)
        left = left - step
        if left <= 0.0 or rest > 0.0:
            return road, lane, s, left + rest
        road, lane, s, rest = advance(n, road, lane, s, STEP_OVER, following)
        if rest > 0.0:
            return road, lane, s, left
        left = max(left - STEP_OVER, 0.0)
    return road, lane, s, left


@compiled
def set_path(n: RoadTables, st: State, road: int, lane: int, s: float) -> None:
    """Put the path on a lane, and find the lane's row, its direction and the road's piece there."""
    st.looked[0] = 0
    st.path_road[0] = road
    st.path_lane[0] = lane
    st.path_s[0] = s
    st.path_row[0] = -1
    st.path_sense[0] = 1
    st.path_from[0] = 0.0
    st.path_to[0] = 0.0
    if road < 0:
        return
    row, piece, begin, end = stretch_at(n, road, lane, s)
    st.path_row[0] = row
    st.path_piece[0] = piece
    st.path_sense[0] = lane_direction(n, road, lane, s)
    st.path_from[0] = begin
    st.path_to[0] = end


@compiled
def project_on_path(n: RoadTables, st: State, x: float, y: float) -> tuple[float, float]:
    """Return (s, t) of a point near the path on the reference line of the path's road, extended beyond its ends."""
    road = st.path_road[0]
    piece = st.path_piece[0]
    if n.piece_kind[piece] == LINE and n.road_superelevation_first[road] >= n.road_superelevation_last[road]:
        s, t = project_on_piece(n, piece, 0.0, 0.0, x, y)
        if s >= st.path_from[0] and s < st.path_to[0]:
            return s, t
    return project_on_road(n, road, st.path_s[0], x, y)


@compiled
def follow_path(n: RoadTables, p: Program, st: State, i: int) -> tuple[float, float]:
    """Move the path's place to the ego's projection, to the next road if necessary; return (s, t) there.

    s may be outside of the path's road.
    """
    road = st.path_road[0]
    s, t = project_on_path(n, st, st.x[i], st.y[i])
    if s >= st.path_from[0] and s < st.path_to[0]:
        st.path_s[0] = s
        return s, t
    lane = st.path_lane[0]
    direction = st.path_sense[0]
    limit = n.road_length[road]
    beyond = s - limit if direction > 0 else -s
    inside = min(max(s, 0.0), limit)
    ahead = direction * (inside - st.path_s[0])
    road, lane, at, rest = advance(n, road, lane, st.path_s[0], ahead, -1)
    if rest > 0.0 or road != st.path_road[0]:
        road = st.path_road[0]
        lane = lane_at(n, road, inside, t)
        if lane == 0:
            lane = st.path_lane[0]
    set_path(n, st, road, lane, inside)
    if beyond > 0.0:
        road, lane, at, rest = advance(n, road, lane, inside, beyond + STEP_OVER, preferred_road(p, st, road))
        if rest <= 0.0:
            s, t = project_on_road(n, road, at, st.x[i], st.y[i])
            set_path(n, st, road, lane, min(max(s, 0.0), n.road_length[road]))
            advance_route(p, st, road)
    return s, t


@compiled
def leave_road(st: State, i: int) -> None:
    """Record that an entity is off every road."""
    st.road[i] = -1
    st.lane[i] = 0
    st.s[i] = 0.0
    st.off[i] = 0.0
    st.t[i] = 0.0


@compiled
def note_lane(n: RoadTables, st: State, i: int, road: int, s: float, t: float, lane: int) -> None:
    """Write an entity's position on the road, with the offset from the lane's centre computed from t."""
    centre, _ = lane_centre(n, road, lane, s)
    note_place(st, i, road, s, t, lane, t - centre)


@compiled
def note_place(st: State, i: int, road: int, s: float, t: float, lane: int, off: float) -> None:
    """Write an entity's position on the road, with its offset from the lane's centre."""
    st.road[i] = road
    st.lane[i] = lane
    st.s[i] = s
    st.t[i] = t
    st.off[i] = off


@compiled
def locate_ego(n: RoadTables, p: Program, st: State, i: int) -> None:
    """Find the ego's road, lane, s and offset from its reference point, first on its path, then on any road."""
    if st.path_road[0] >= 0:
        beside, t = follow_path(n, p, st, i)
        road = st.path_road[0]
        s = st.path_s[0]
        off = t - measure_path_at(n, st, i, t)
        inside = 1 if beside > -1.0 and beside < n.road_length[road] + 1.0 else 0
        row = st.path_row[0]
        if inside == 1 and row >= 0:
            wide = row_width(n, row, s)
            if abs(off) < 0.5 * wide - CLEARLY:
                note_place(st, i, road, s, t, st.path_lane[0], off)
                note_ground(n, st, row, wide)
                st.path_found[0] = 1
                return
        lane = lane_at(n, road, s, t)
        if inside == 1 and lane != 0:
            note_lane(n, st, i, road, s, t, lane)
            note_ground_below(n, st, road, lane, s)
            st.path_found[0] = 1
            return
    locate_anew(n, st, i)
    measure_path(n, st, i)


@compiled
def locate_free(n: RoadTables, st: State, i: int) -> int:
    """Find the road, lane, s and offset of an entity without a path; return 0 if it is off every lane."""
    found, road, s, t = track(n, st.x[i], st.y[i], st.road[i], st.s[i])
    lane = 0
    if found == 1:
        lane = lane_at(n, road, s, t)
    if lane == 0:
        leave_road(st, i)
        return 0
    note_lane(n, st, i, road, s, t, lane)
    return 1


@compiled
def note_ground(n: RoadTables, st: State, row: int, wide: float) -> None:
    """Write the width of the ego's lane, and whether the lane is for motor traffic or a roadside lane."""
    st.lane_width[0] = wide
    kind = n.lane_type[row]
    st.on_road[0] = 1 if is_drivable(kind) == 1 or is_roadside(kind) == 1 else 0


@compiled
def note_ground_below(n: RoadTables, st: State, road: int, lane: int, s: float) -> None:
    """Write what `note_ground` writes for a lane; for lane 0, off every lane, no width and no road."""
    row = lane_row(n, road, lane, s) if lane != 0 else -1
    if row < 0:
        st.lane_width[0] = 0.0
        st.on_road[0] = 0
        return
    note_ground(n, st, row, row_width(n, row, s))


@compiled
def locate_anew(n: RoadTables, st: State, i: int) -> None:
    """Find the ego on any road; its path continues from there if the lane is for driving."""
    found, road, s, t = track(n, st.x[i], st.y[i], st.path_road[0], st.path_s[0])
    lane = 0
    st.path_anew[0] = 1
    if found == 1:
        lane = lane_at(n, road, s, t)
    note_ground_below(n, st, road, lane, s)
    if lane == 0:
        leave_road(st, i)
        st.path_found[0] = 0
        return
    if is_drivable(lane_type(n, road, lane, s)) == 1:
        set_path(n, st, road, lane, s)
    note_lane(n, st, i, road, s, t, lane)
    st.path_found[0] = 1


@compiled
def measure_path(n: RoadTables, st: State, i: int) -> None:
    """Measure the ego's offset and heading relative to its path, positive to the left of the direction of travel."""
    road = st.path_road[0]
    if road < 0:
        st.path_off[0] = 0.0
        st.path_heading[0] = 0.0
        return
    _, t = project_on_path(n, st, st.x[i], st.y[i])
    measure_path_at(n, st, i, t)


@compiled
def measure_path_at(n: RoadTables, st: State, i: int, t: float) -> float:
    """Measure as `measure_path` does if the ego's t on the path's road is known; return t of the lane's centre."""
    road = st.path_road[0]
    s = st.path_s[0]
    direction = st.path_sense[0]
    h = piece_heading(n, st.path_piece[0], s)
    row = st.path_row[0]
    if row >= 0:
        centre, slope = row_centre(n, road, row, s)
    else:
        centre, slope = lane_centre(n, road, st.path_lane[0], s)
    st.path_off[0] = direction * (t - centre)
    along = h + slope if direction > 0 else h + slope + pi
    st.path_heading[0] = angle_between(st.h[i], along)
    st.facing[i] = direction if abs(st.path_heading[0]) < 0.5 * pi else -direction
    return centre


@compiled
def take_present_lane(n: RoadTables, st: State, i: int) -> None:
    """Let the path follow the lane that the ego is in, if it is for driving and has the same direction of travel."""
    road = st.road[i]
    if road < 0 or road != st.path_road[0] or st.lane[i] == st.path_lane[0]:
        return
    lane = st.lane[i]
    same = lane_direction(n, road, lane, st.s[i]) == st.path_sense[0]
    if same and lane_exists(n, road, lane, st.s[i]) == 1 and is_drivable(lane_type(n, road, lane, st.s[i])) == 1:
        set_path(n, st, road, lane, st.s[i])
