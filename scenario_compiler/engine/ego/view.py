"""The features of surrogate perception: numbers that describe what the ego's camera has in view.

They describe the paint on both sides, the road, the weather, the camera and the vehicles in the picture, as far as the
engine knows them (`columns.view` names the features). The surrogate was fitted to the same features of runs with a
camera, so that fit and use share this one function.
"""

from __future__ import annotations

from math import cos, exp, sin

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns import view as at
from scenario_compiler.engine.columns.extent import front_of
from scenario_compiler.engine.columns.numbers import clip
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.air_ahead import AHEAD_FROM, AHEAD_STEP, note_air, note_glare, note_lasting
from scenario_compiler.engine.ego.lane_confidence import note_even_marks, visibility_of
from scenario_compiler.engine.ego.paint_ahead import (
    CAMERA_AT,
    lay_even_lines,
    lay_lines,
    lay_way,
    note_clutter,
    see_side,
)
from scenario_compiler.engine.motion.collision import face
from scenario_compiler.engine.motion.path import path_ahead
from scenario_compiler.marker import compiled
from scenario_compiler.roads.geometry import road_grade
from scenario_compiler.roads.lane_types import MEDIAN, NONE, RAIL
from scenario_compiler.roads.lanes import lane_curvature, lane_direction, lane_inside, row_centre, row_width
from scenario_compiler.roads.marks import (
    MARK_BROKEN,
    MARK_BROKEN_BROKEN,
    MARK_COLOUR_CODES,
    MARK_SOLID_SOLID,
    mark_row,
    painted_colour,
    painted_share,
    painted_width,
    row_mark,
)
from scenario_compiler.roads.tables import POLYNOMIAL, RoadTables

SEEN_TO = CAMERA_AT + AHEAD_FROM + AHEAD_STEP * at.SAMPLES
"""Distance ahead of the reference point up to which features are computed, m."""

KIND_AT = 13.0
"""Distance ahead at which the kinds of both lines and the surface beside them are read, m."""

BEND_NEAR = 9.0
BEND_FAR = 19.0
BENDS_APART = 10.0
"""Distances ahead at which the curvature is read, and their difference, m."""

LEADER_REACH = 60.0
LEADER_SCALE = 12.0
"""Distance up to which objects ahead count, m, and the gap over which their weight falls to 1/e, m."""

COVERED = 0.6
"""An object covers a line that is at most this far outside its box, m."""

HALF_LANE = 1.75

OBSTACLE_HEIGHT = 1.0
OBSTACLE_REACH = 40.0
NEAREST_CORNER = 0.3
WIDEST_BEARING = 0.5
NOWHERE = 9.0
"""Least height of an obstacle that hides the ground, up to where it does, how near its corners may be, m, within which
directions to both sides it does, and one in which nothing is."""

BESIDE_LINE = 0.3
FARTHEST_RIVAL = 5.0
FARTHEST_EDGE = 6.0
LEAST_RIVAL = 0.02
LONG_RUN = 60.0
BESIDE_EVERY = 10.0
"""How far beside a line another counts as another, and up to where, m; how much of it is painted at least, on how many
metres; and after how many metres this is searched again."""

STEADY_SPEED = 0.5
STEADY_OFF = 0.05
STEADY_ANGLE = 0.01
STEADY_PITCH = 0.002
STEADY_VOTES = 0.05
"""Changes up to which a view is kept: of the speed, m/s, the offset, m, the heading and the body's pitch, rad, and how
far the running means of the votes may be from the votes."""

YELLOW = MARK_COLOUR_CODES["yellow"]


@compiled
def paint_stays(st: State) -> int:
    """Return 1 if the road marks are known not to change within the range of the view."""
    s = st.path_s[0]
    end = s + st.path_sense[0] * SEEN_TO
    if st.path_row[0] != st.even_row[0] or min(s, end) <= st.even_from[0] or max(s, end) >= st.even_to[0]:
        return 0
    return 1


@compiled
def note_mirrored(st: State, feature: int, value: float) -> None:
    """Note a side's feature whose sign is the other way round for the right side."""
    st.view[feature] = value
    st.view[at.SIDE_SIZE + feature] = -value


@compiled
def note_line(n: RoadTables, st: State, base: int, road: int, lane: int, s: float) -> None:
    """Write the kind and the colour of the line that bounds one side."""
    mark = mark_row(n, road, lane, s)
    kind = n.mark_type[mark] if mark >= 0 else 0
    colour = painted_colour(n, mark)
    st.line_colour[1 if base > 0 else 0] = colour
    note_lasting(st, base + at.S_BROKEN, 1.0 if kind in (MARK_BROKEN, MARK_BROKEN_BROKEN) else 0.0)
    note_lasting(st, base + at.S_WIDTH, painted_width(n, mark))
    note_lasting(st, base + at.S_YELLOW, 1.0 if colour == YELLOW else 0.0)
    note_lasting(st, base + at.S_DOUBLE, 1.0 if kind >= MARK_SOLID_SOLID and kind <= MARK_BROKEN_BROKEN else 0.0)


@compiled
def note_rival(st: State, base: int, beyond: float, paint: float) -> None:
    """Note a painted line at a distance beyond the line of a side, m, if no nearer one has been noted."""
    if paint > LEAST_RIVAL and beyond > BESIDE_LINE and beyond < st.view[base + at.S_RIVAL]:
        st.view[base + at.S_RIVAL] = beyond
        st.view[base + at.S_RIVAL_PAINT] = paint


@compiled
def look_beside(n: RoadTables, p: Program, st: State, road: int, row: int, s: float) -> None:
    """Note the lines and the pavement beyond both sides of the lane, and how rough the ground looks.

    It is computed again after some metres only.
    """
    if row == st.beside_row[0] and abs(s - st.beside_s[0]) < BESIDE_EVERY and st.sigma[0] == st.beside_sigma[0]:
        return
    st.beside_row[0] = row
    st.beside_s[0] = s
    st.beside_sigma[0] = st.sigma[0]
    sense = n.lane_sense[row]
    centre, _ = row_centre(n, road, row, s)
    half = 0.5 * row_width(n, row, s)
    section = n.lane_section[row]
    left = half
    right = half
    st.lasting_anew[0] = 1
    for side in range(2):
        st.view[at.SIDE_SIZE * side + at.S_RIVAL] = FARTHEST_RIVAL
        st.view[at.SIDE_SIZE * side + at.S_RIVAL_PAINT] = 0.0
    for beside in range(n.section_lane[section], n.section_lane[section + 1]):
        lane = n.lane_id[beside]
        middle, _ = row_centre(n, road, beside, s)
        wide = 0.5 * row_width(n, beside, s) if lane != 0 else 0.0
        border = sense * (middle - centre + (wide if lane > 0 else -wide))
        if abs(border) > half + BESIDE_LINE and abs(border) - half < FARTHEST_RIVAL:
            mark = row_mark(n, beside, s)
            paint = painted_share(n, mark, s - LONG_RUN, s + LONG_RUN) * visibility_of(n, p, mark, road, lane, s)
            note_rival(st, 0, border - half, paint)
            note_rival(st, at.SIDE_SIZE, -border - half, paint)
        if wide > 0.0 and n.lane_type[beside] not in (NONE, MEDIAN, RAIL):
            left = max(left, sense * (middle - centre) + wide)
            right = max(right, wide - sense * (middle - centre))
    st.view[at.S_EDGE] = min(left - half, FARTHEST_EDGE)
    st.view[at.SIDE_SIZE + at.S_EDGE] = min(right - half, FARTHEST_EDGE)
    note_clutter(st, left, right)


@compiled
def look_at_lines(n: RoadTables, p: Program, st: State) -> None:
    """Write the visible paint of the lines of both sides, and their kinds."""
    road, lane, row, s, rest = path_ahead(n, p, st, KIND_AT)
    if rest > 0.0 or row < 0:
        road = st.path_road[0]
        lane = st.path_lane[0]
        row = st.path_row[0]
        s = st.path_s[0]
    look_beside(n, p, st, road, row, s)
    if paint_stays(st) == 0 or st.lines_laid[0] == 0:
        st.summed[0] = 0
        find_lines(n, p, st, road, lane, s)
    if paint_stays(st) == 1:
        lay_way(n, st)
    see_side(st, 0)
    see_side(st, at.SIDE_SIZE)
    st.summed[0] = 1


@compiled
def find_lines(n: RoadTables, p: Program, st: State, road: int, lane: int, s: float) -> None:
    """Write the kinds of the lines on both sides, which are read at a place ahead, and note their paint."""
    outer = 0 if (lane > 0) == (lane_direction(n, road, lane, s) > 0) else at.SIDE_SIZE
    note_line(n, st, outer, road, lane, s)
    note_line(n, st, at.SIDE_SIZE - outer, road, lane_inside(lane), s)
    if paint_stays(st) == 0:
        note_even_marks(n, p, st)
        st.lines_laid[0] = 0
    if paint_stays(st) == 1:
        lay_even_lines(n, st)
    else:
        lay_lines(n, p, st)


@compiled
def look_at_way(n: RoadTables, p: Program, st: State, i: int) -> None:
    """Note the bend, the tilt, the change of grade and the lane's width ahead."""
    here = st.path_sense[0] * road_grade(n, st.path_road[0], st.path_s[0])
    road, lane, row, s, _ = path_ahead(n, p, st, BEND_NEAR)
    near = lane_curvature(n, road, lane, row, s)
    grade = lane_direction(n, road, lane, s) * road_grade(n, road, s)
    width = row_width(n, row, s) if row >= 0 else 0.0
    road, lane, row, s, _ = path_ahead(n, p, st, BEND_FAR)
    far = lane_curvature(n, road, lane, row, s)
    tilt = 50.0 * clip(grade - here + st.body_pitch[i], -0.2, 0.2)
    change = lane_direction(n, road, lane, s) * road_grade(n, road, s) - grade
    st.way_bend_rate[0] = (far - near) / BENDS_APART
    st.way_bend[0] = near - BEND_NEAR * st.way_bend_rate[0]
    note_mirrored(st, at.S_BEND_NEAR, 40.0 * near)
    note_mirrored(st, at.S_BEND_FAR, 40.0 * far)
    st.view[at.V_CURVED_NEAR] = 40.0 * abs(near)
    st.view[at.V_CURVED_FAR] = 40.0 * abs(far)
    st.view[at.V_TILT] = tilt
    st.view[at.V_TILT_SIZE] = abs(tilt)
    st.view[at.V_GRADE_CHANGE] = 50.0 * clip(change, -0.2, 0.2)
    st.view[at.V_LANE_WIDTH] = width
    st.view[at.V_WIDENING] = abs(row_width(n, row, s) - width) if row >= 0 else width


@compiled
def look_at_camera(st: State) -> None:
    """Write the failures of the camera."""
    note_lasting(st, at.V_NOISE, 0.025 * st.sigma[0])
    note_lasting(st, at.V_BLACKOUT, st.failure_now[op.FAILURE_BLACKOUT])
    note_lasting(st, at.V_BLUR, st.failure_now[op.FAILURE_BLUR])
    note_lasting(st, at.V_DIRT, st.failure_now[op.FAILURE_DIRT])
    note_lasting(st, at.V_IMPULSES, st.failure_now[op.FAILURE_IMPULSE_NOISE])
    note_lasting(st, at.V_OVEREXPOSURE, st.failure_now[op.FAILURE_OVEREXPOSURE])
    note_lasting(st, at.V_DEAD_ROWS, st.failure_now[op.FAILURE_DEAD_ROWS])
    note_lasting(st, at.V_QUANTISATION, st.failure_now[op.FAILURE_QUANTISATION])
    note_lasting(st, at.V_LATENCY, st.failure_now[op.FAILURE_LATENCY])


@compiled
def look_at_others(p: Program, st: State, i: int) -> None:
    """Note how near the other entities on the way are, and whether they cover a line of the lane.

    The positions along the path are those of the last look ahead.
    """
    front = front_of(p, i)
    half = max(0.5 * st.lane_width[0], HALF_LANE)
    leader = 0.0
    left = 0.0
    right = 0.0
    st.hides_at[0] = op.FAR
    for j in range(p.entity_count[0]):
        if j == i or st.present[j] == 0:
            continue
        note_obstacle(p, st, i, j)
        if st.on_way[j] == 0 or st.far[j] <= front or st.near[j] - front > LEADER_REACH:
            continue
        weight = exp(clip((front - st.near[j]) / LEADER_SCALE, -50.0, 0.0))
        if st.low[j] < HALF_LANE and st.high[j] > -HALF_LANE:
            leader = max(leader, weight)
        if st.low[j] < half + COVERED and st.high[j] > half - COVERED:
            left = max(left, weight)
        if st.low[j] < COVERED - half and st.high[j] > -half - COVERED:
            right = max(right, weight)
    st.view[at.V_LEADER] = leader
    st.view[at.S_COVERED] = left
    st.view[at.SIDE_SIZE + at.S_COVERED] = right
    near = 0.0
    width = 0.0
    bearing = 0.0
    if st.hides_at[0] < op.FAR:
        near = exp(clip(-st.hides_at[0] / LEADER_SCALE, -50.0, 0.0))
        width = min(st.hides_to[0] - st.hides_from[0], 2.0)
        bearing = clip(0.5 * (st.hides_from[0] + st.hides_to[0]), -1.0, 1.0)
    st.view[at.V_OBSTACLE] = near
    st.view[at.V_OBSTACLE_WIDTH] = width
    note_mirrored(st, at.S_BEARING, bearing)


@compiled
def may_hide(st: State, ahead: float, beside: float, center: float, around: float) -> int:
    """Return 0 if an entity cannot be the nearest that hides the ground, whichever way it is turned.

    Args:
        st: The state, with the nearest so far.
        ahead: Distance of its reference point ahead of the camera, m.
        beside: Distance of its reference point from the ego's axis, m.
        center: Distance of its box's centre from its reference point, m.
        around: Length and width of its box together, m.
    """
    reach = center + 0.5 * around
    if ahead + center <= NEAREST_CORNER or ahead - reach >= st.hides_at[0] or ahead - reach >= OBSTACLE_REACH:
        return 0
    return 1 if beside - reach < WIDEST_BEARING * max(ahead + reach, NEAREST_CORNER) else 0


@compiled
def note_obstacle(p: Program, st: State, i: int, j: int) -> None:
    """Note between which directions an entity hides the ground from the camera, where it is the nearest that does."""
    base = p.entity_const[j]
    if p.const[base + slot.E_HEIGHT] < OBSTACLE_HEIGHT:
        return
    dx = st.x[j] - st.x[i]
    dy = st.y[j] - st.y[i]
    reach = OBSTACLE_REACH + p.const[base + slot.E_LENGTH]
    if dx * dx + dy * dy > reach * reach:
        return
    face(st, i)
    c = st.box_cos[i]
    w = st.box_sin[i]
    ahead = c * dx + w * dy
    beside = c * dy - w * dx
    length = p.const[base + slot.E_LENGTH]
    width = p.const[base + slot.E_WIDTH]
    center = p.const[base + slot.E_CENTER]
    if may_hide(st, ahead - CAMERA_AT, abs(beside), abs(center), length + width) == 0:
        return
    along = cos(st.h[j] - st.h[i])
    across = sin(st.h[j] - st.h[i])
    x = ahead + center * along - CAMERA_AT
    y = beside + center * across
    nearest = op.FAR
    begin = NOWHERE
    end = -NOWHERE
    for corner in range(4):
        lengthwise = length * (0.5 if corner < 2 else -0.5)
        crosswise = width * (0.5 if corner % 2 == 0 else -0.5)
        at_x = x + lengthwise * along - crosswise * across
        bearing = (y + lengthwise * across + crosswise * along) / max(at_x, NEAREST_CORNER)
        nearest = min(nearest, at_x)
        begin = min(begin, bearing)
        end = max(end, bearing)
    if (
        nearest > NEAREST_CORNER
        and nearest < st.hides_at[0]
        and nearest < OBSTACLE_REACH
        and begin < WIDEST_BEARING
        and end > -WIDEST_BEARING
    ):
        st.hides_at[0] = nearest
        st.hides_from[0] = begin
        st.hides_to[0] = end


@compiled
def look_at_view(n: RoadTables, p: Program, st: State) -> int:
    """Write the features of both sides and return 1; return 0 and write nothing if the ego is on no lane."""
    i = p.ego[0]
    if i < 0 or st.path_found[0] == 0 or st.path_row[0] < 0:
        return 0
    note_air(st)
    note_glare(st, st.h[i])
    look_at_camera(st)
    look_at_others(p, st, i)
    look_at_way(n, p, st, i)
    look_at_lines(n, p, st)
    st.view[at.V_SPEED] = 0.05 * st.v[i]
    st.view[at.V_PITCH] = 50.0 * st.body_pitch[i]
    note_mirrored(st, at.S_OFFSET, st.path_off[0])
    note_mirrored(st, at.S_HEADING, 5.0 * st.path_heading[0])
    st.view_looks[0] += 1
    return 1


@compiled
def way_stays(n: RoadTables, st: State) -> int:
    """Return 1 if lines, curvature, grade and width do not change within the range of the view."""
    road = st.path_road[0]
    row = st.path_row[0]
    piece = st.path_piece[0]
    s = st.path_s[0]
    end = s + st.path_sense[0] * SEEN_TO
    if min(s, end) < st.path_from[0] or max(s, end) >= st.path_to[0] or paint_stays(st) == 0:
        return 0
    if n.piece_kind[piece] == POLYNOMIAL or n.piece_dk[piece] != 0.0 or st.view_dashed[0] == 1:
        return 0
    if st.air_glare[0] > 0.0 and n.piece_k[piece] != 0.0:
        return 0
    return 1 if n.road_flat[road] == 1 and n.lane_steady[row] == 1 else 0


@compiled
def alone(p: Program, st: State, i: int) -> int:
    """Return 1 if nothing ahead is near enough to be a feature."""
    front = front_of(p, i)
    for j in range(p.entity_count[0]):
        if j != i and st.on_way[j] == 1 and st.far[j] > front and st.near[j] - front <= LEADER_REACH:
            return 0
    return 1


@compiled
def view_stays(n: RoadTables, p: Program, st: State) -> int:
    """Return 1 if the features of the last view still hold, apart from negligible changes.

    `view_row` is NONE if that view must not be kept.
    """
    i = p.ego[0]
    if i < 0 or st.view_row[0] == op.NONE or st.view_row[0] != st.path_row[0] or st.view_piece[0] != st.path_piece[0]:
        return 0
    if abs(st.v[i] - st.view_speed[0]) > STEADY_SPEED or abs(st.path_off[0] - st.view_off[0]) > STEADY_OFF:
        return 0
    if (
        abs(st.path_heading[0] - st.view_heading[0]) > STEADY_ANGLE
        or abs(st.body_pitch[i] - st.view_pitch[0]) > STEADY_PITCH
    ):
        return 0
    if st.sigma[0] != st.view_sigma[0] or st.path_found[0] == 0:
        return 0
    return may_keep(n, p, st)


@compiled
def may_keep(n: RoadTables, p: Program, st: State) -> int:
    """Return 1 if road, weather and camera are constant and nothing ahead is near enough to be a feature."""
    if st.weather_to[0] != op.NONE or p.failure_count[0] > 0 or way_stays(n, st) == 0:
        return 0
    return alone(p, st, p.ego[0])


@compiled
def votes_settled(st: State) -> int:
    """Return 1 where the running means of the votes have come to the votes."""
    for side in range(2):
        base = at.SIDE_SIZE * side
        if abs(st.view[base + at.S_VOTES] - st.view[base + at.S_VOTES_LATELY]) > STEADY_VOTES:
            return 0
    return 1


@compiled
def keep_view(n: RoadTables, p: Program, st: State) -> None:
    """Write whether the view that was just computed may be kept, and the state of the ego that it belongs to."""
    i = p.ego[0]
    st.view_row[0] = st.path_row[0] if may_keep(n, p, st) == 1 and votes_settled(st) == 1 else op.NONE
    st.view_piece[0] = st.path_piece[0]
    st.view_speed[0] = st.v[i]
    st.view_off[0] = st.path_off[0]
    st.view_heading[0] = st.path_heading[0]
    st.view_pitch[0] = st.body_pitch[i]
    st.view_sigma[0] = st.sigma[0]
