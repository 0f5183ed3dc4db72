"""The features of surrogate perception: numbers that describe what the ego's camera has in view.

They describe the paint on both sides, the road, the weather, the camera and the vehicles in the picture, as far as the
engine knows them (`columns.view` names the features). The surrogate was fitted to the same features of runs with a
camera, so that fit and use share this one function.
"""

from __future__ import annotations

from math import exp, log

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import view as at
from scenario_compiler.engine.columns.extent import front_of
from scenario_compiler.engine.columns.numbers import clip
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.lane_confidence import mark_visibility, note_even_marks
from scenario_compiler.engine.ego.visibility import (
    LEAST_CONTRAST,
    W_DUST_STORM,
    W_FOG_DENSITY,
    W_FOG_FALLOFF,
    W_PRECIPITATION,
    W_SUN_ALTITUDE,
    haze_extinction,
    weather_contrast,
)
from scenario_compiler.engine.motion.path import path_ahead
from scenario_compiler.marker import compiled
from scenario_compiler.roads.geometry import road_curvature, road_grade
from scenario_compiler.roads.lanes import lane_direction, lane_inside, row_centre, row_width
from scenario_compiler.roads.marks import MARK_BROKEN, MARK_BROKEN_BROKEN, MARK_COLOUR_CODES, MARK_NONE, mark_at
from scenario_compiler.roads.tables import POLYNOMIAL, RoadTables

SAMPLES = 13
SAMPLE_FROM = 1.0
SAMPLE_STEP = 2.0
SAMPLE_TO = 25.0
"""The paint is sampled from 1 m to 25 m ahead of the reference point, every 2 m."""

KIND_AT = 11.0
"""Distance ahead at which the kind of both lines is looked up, m."""

BEND_NEAR = 9.0
BEND_FAR = 19.0
"""Distances ahead at which the curvature is taken, m; the change of the grade is taken between the two."""

LEADER_REACH = 60.0
LEADER_SCALE = 12.0
"""Distance up to which objects ahead count, m, and the gap over which their weight falls to 1/e, m."""

COVERED = 0.6
"""An object covers a line that is at most this far outside its box, m."""

HALF_LANE = 1.75

STEADY_SPEED = 0.5
STEADY_OFF = 0.05
STEADY_ANGLE = 0.01
STEADY_PITCH = 0.002
"""Changes up to which a view is kept: of the speed, m/s, the offset, m, the heading, rad, and the body's pitch, rad."""

LEAST_PAINT = 0.02
"""Lower bound of the quality before its logarithm is taken."""

YELLOW = MARK_COLOUR_CODES["yellow"]


@compiled
def lane_bend(n: RoadTables, road: int, lane: int, row: int, s: float) -> float:
    """Return the curvature of a lane's centre in the direction of travel, 1/m, positive to the left."""
    if row < 0:
        return 0.0
    k = road_curvature(n, road, s)
    if k == 0.0:
        return 0.0
    t, _ = row_centre(n, road, row, s)
    return lane_direction(n, road, lane) * k / max(1.0 - k * t, 0.1)


@compiled
def window_of(sample: int) -> int:
    """Return the window, 0 to WINDOWS - 1, that a sample of the paint belongs to."""
    if sample < 3:
        return 0
    return min(1 + (sample - 3) // 2, at.WINDOWS - 1)


@compiled
def share_of(sample: int) -> float:
    """Return the weight of a sample in its window's mean."""
    window = window_of(sample)
    if window == 0:
        return 1.0 / 3.0
    return 0.5 if window < at.WINDOWS - 1 else 0.25


@compiled
def paint_stays(st: State) -> int:
    """Return 1 if the road marks are known not to change within the range of the view."""
    s = st.path_s[0]
    end = s + st.path_sense[0] * SAMPLE_TO
    if st.path_row[0] != st.even_row[0] or min(s, end) <= st.even_from[0] or max(s, end) >= st.even_to[0]:
        return 0
    return 1


@compiled
def add_paint(st: State, window: int, left: float, right: float) -> None:
    """Add the quality of the left and the right mark to a window of both sides' features."""
    st.view[at.V_PAINT + window] += left
    st.view[at.V_OTHER_PAINT + window] += right
    st.view[at.VIEW_SIZE + at.V_PAINT + window] += right
    st.view[at.VIEW_SIZE + at.V_OTHER_PAINT + window] += left


@compiled
def look_at_paint(n: RoadTables, p: Program, st: State) -> None:
    """Write the paint's quality on both sides by windows, and which share of the path ahead is in junctions."""
    if paint_stays(st) == 0:
        note_even_marks(n, p, st)
    if paint_stays(st) == 1:
        for window in range(at.WINDOWS):
            add_paint(st, window, st.even_left[0], st.even_right[0])
        if n.road_junction[st.path_road[0]] >= 0:
            note_both(st, at.V_JUNCTION_NEAR, 1.0)
            note_both(st, at.V_JUNCTION_FAR, 1.0)
        return
    near = 0.0
    far = 0.0
    for k in range(SAMPLES):
        road, lane, _, s, rest = path_ahead(n, p, st, SAMPLE_FROM + SAMPLE_STEP * k)
        if rest > 0.0:
            continue
        window = window_of(k)
        share = share_of(k)
        outer = share * mark_visibility(n, p, road, lane, s)
        inner = share * mark_visibility(n, p, road, lane_inside(lane), s)
        if (lane > 0) == (lane_direction(n, road, lane) > 0):
            add_paint(st, window, outer, inner)
        else:
            add_paint(st, window, inner, outer)
        if n.road_junction[road] >= 0:
            if window < 3:
                near += 1.0 / 7.0
            else:
                far += 1.0 / 6.0
    note_both(st, at.V_JUNCTION_NEAR, near)
    note_both(st, at.V_JUNCTION_FAR, far)


@compiled
def note_both(st: State, feature: int, value: float) -> None:
    """Write a feature that is the same for both sides."""
    st.view[feature] = value
    st.view[at.VIEW_SIZE + feature] = value


@compiled
def note_mirrored(st: State, feature: int, value: float) -> None:
    """Write a feature that has the opposite sign for the right side."""
    st.view[feature] = value
    st.view[at.VIEW_SIZE + feature] = -value


@compiled
def note_line(n: RoadTables, st: State, base: int, other: int, road: int, lane: int, s: float) -> None:
    """Write the kind, width and colour of the line on one side; `other` is where the other side's features begin."""
    kind, _, colour, width = mark_at(n, road, lane, s)
    broken = 1.0 if kind in (MARK_BROKEN, MARK_BROKEN_BROKEN) else 0.0
    st.view[base + at.V_BROKEN] = broken
    st.view[other + at.V_OTHER_BROKEN] = broken
    st.view[base + at.V_WIDTH] = 0.0 if kind == MARK_NONE else width
    st.view[base + at.V_YELLOW] = 1.0 if colour == YELLOW else 0.0


@compiled
def look_at_way(n: RoadTables, p: Program, st: State) -> None:
    """Write the kinds of the lines, the curvature, the change of the grade and the lane's width ahead."""
    road, lane, row, s, _ = path_ahead(n, p, st, KIND_AT)
    inner = lane_inside(lane)
    if (lane > 0) == (lane_direction(n, road, lane) > 0):
        note_line(n, st, 0, at.VIEW_SIZE, road, lane, s)
        note_line(n, st, at.VIEW_SIZE, 0, road, inner, s)
    else:
        note_line(n, st, 0, at.VIEW_SIZE, road, inner, s)
        note_line(n, st, at.VIEW_SIZE, 0, road, lane, s)
    road, lane, row, s, _ = path_ahead(n, p, st, BEND_NEAR)
    bend = 40.0 * lane_bend(n, road, lane, row, s)
    grade = lane_direction(n, road, lane) * road_grade(n, road, s)
    width = row_width(n, row, s) if row >= 0 else 0.0
    note_both(st, at.V_BEND_NEAR, abs(bend))
    note_mirrored(st, at.V_TOWARDS_NEAR, bend)
    note_both(st, at.V_LANE_WIDTH, width)
    road, lane, row, s, _ = path_ahead(n, p, st, BEND_FAR)
    bend = 40.0 * lane_bend(n, road, lane, row, s)
    change = lane_direction(n, road, lane) * road_grade(n, road, s) - grade
    note_both(st, at.V_BEND_FAR, abs(bend))
    note_mirrored(st, at.V_TOWARDS_FAR, bend)
    note_both(st, at.V_GRADE_CHANGE, 10.0 * abs(change))
    note_both(st, at.V_WIDENING, abs(row_width(n, row, s) - width) if row >= 0 else width)


@compiled
def seen_paint(st: State, first: int) -> float:
    """Return the mean quality of the three windows in which the detector looks for a line, from 6 to 18 m."""
    return (st.view[first + 1] + st.view[first + 2] + st.view[first + 3]) / 3.0


@compiled
def look_at_air(st: State) -> None:
    """Write the light, the weather and the faults of the camera."""
    note_both(st, at.V_CONTRAST, log(max(weather_contrast(st), LEAST_CONTRAST)))
    note_both(st, at.V_DARKNESS, clip(-0.1 * st.weather[W_SUN_ALTITUDE], -1.0, 1.0))
    note_both(st, at.V_RAIN, clip(0.01 * st.weather[W_PRECIPITATION], 0.0, 1.0))
    fog = clip(0.01 * st.weather[W_FOG_DENSITY], 0.0, 1.0)
    dust = clip(0.01 * st.weather[W_DUST_STORM], 0.0, 1.0)
    note_both(st, at.V_HAZE, 10.0 * haze_extinction(fog, st.weather[W_FOG_FALLOFF], dust))
    note_both(st, at.V_NOISE, 0.025 * st.sigma[0])
    note_both(st, at.V_BLACKOUT, st.failure_now[op.FAILURE_BLACKOUT])
    note_both(st, at.V_BLUR, st.failure_now[op.FAILURE_BLUR])
    note_both(st, at.V_DIRT, st.failure_now[op.FAILURE_DIRT])
    note_both(st, at.V_IMPULSES, st.failure_now[op.FAILURE_IMPULSE_NOISE])
    note_both(st, at.V_OVEREXPOSURE, st.failure_now[op.FAILURE_OVEREXPOSURE])
    note_both(st, at.V_DEAD_ROWS, st.failure_now[op.FAILURE_DEAD_ROWS])
    note_both(st, at.V_QUANTISATION, st.failure_now[op.FAILURE_QUANTISATION])
    note_both(st, at.V_LATENCY, st.failure_now[op.FAILURE_LATENCY])


@compiled
def look_at_others(p: Program, st: State, i: int) -> None:
    """Write how near the objects in the picture are, and whether they cover a line of the lane.

    The positions along the path are those of the last look ahead.
    """
    front = front_of(p, i)
    half = max(0.5 * st.lane_width[0], HALF_LANE)
    leader = 0.0
    left = 0.0
    right = 0.0
    for j in range(p.entity_count[0]):
        if j == i or st.on_way[j] == 0 or st.far[j] <= front or st.near[j] - front > LEADER_REACH:
            continue
        weight = exp(clip((front - st.near[j]) / LEADER_SCALE, -50.0, 0.0))
        if st.low[j] < HALF_LANE and st.high[j] > -HALF_LANE:
            leader = max(leader, weight)
        if st.low[j] < half + COVERED and st.high[j] > half - COVERED:
            left = max(left, weight)
        if st.low[j] < COVERED - half and st.high[j] > -half - COVERED:
            right = max(right, weight)
    note_both(st, at.V_LEADER, leader)
    st.view[at.V_COVERED] = left
    st.view[at.V_OTHER_COVERED] = right
    st.view[at.VIEW_SIZE + at.V_COVERED] = right
    st.view[at.VIEW_SIZE + at.V_OTHER_COVERED] = left


@compiled
def look_at_view(n: RoadTables, p: Program, st: State) -> int:
    """Write the features of both sides and return 1; return 0 and write nothing if the ego is on no lane."""
    i = p.ego[0]
    if i < 0 or st.path_found[0] == 0 or st.path_row[0] < 0:
        return 0
    for k in range(at.WINDOWS):
        note_both(st, at.V_PAINT + k, 0.0)
        note_both(st, at.V_OTHER_PAINT + k, 0.0)
    note_both(st, at.V_JUNCTION_NEAR, 0.0)
    note_both(st, at.V_JUNCTION_FAR, 0.0)
    look_at_paint(n, p, st)
    look_at_way(n, p, st)
    look_at_air(st)
    look_at_others(p, st, i)
    left = log(max(seen_paint(st, at.V_PAINT), LEAST_PAINT))
    right = log(max(seen_paint(st, at.V_OTHER_PAINT), LEAST_PAINT))
    st.view[at.V_SEEN] = left
    st.view[at.V_OTHER_SEEN] = right
    st.view[at.VIEW_SIZE + at.V_SEEN] = right
    st.view[at.VIEW_SIZE + at.V_OTHER_SEEN] = left
    note_both(st, at.V_SPEED, 0.05 * st.v[i])
    note_mirrored(st, at.V_OFFSET, st.path_off[0])
    note_mirrored(st, at.V_HEADING, 5.0 * st.path_heading[0])
    note_both(st, at.V_PITCH, 50.0 * st.body_pitch[i])
    return 1


@compiled
def way_stays(n: RoadTables, st: State) -> int:
    """Return 1 if lines, curvature, grade and width do not change within the range of the view."""
    road = st.path_road[0]
    row = st.path_row[0]
    piece = st.path_piece[0]
    s = st.path_s[0]
    end = s + st.path_sense[0] * SAMPLE_TO
    if min(s, end) < st.path_from[0] or max(s, end) >= st.path_to[0] or paint_stays(st) == 0:
        return 0
    if n.piece_kind[piece] == POLYNOMIAL or n.piece_dk[piece] != 0.0:
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
def keep_view(n: RoadTables, p: Program, st: State) -> None:
    """Write whether the view that was just computed may be kept, and the state of the ego that it belongs to."""
    i = p.ego[0]
    st.view_row[0] = st.path_row[0] if may_keep(n, p, st) == 1 else op.NONE
    st.view_piece[0] = st.path_piece[0]
    st.view_speed[0] = st.v[i]
    st.view_off[0] = st.path_off[0]
    st.view_heading[0] = st.path_heading[0]
    st.view_pitch[0] = st.body_pitch[i]
    st.view_sigma[0] = st.sigma[0]
