"""The speed in bends: the law by which the automation, and a driver who has taken over, slow down for bends ahead.

A bend with the curvature k is driven at most at the speed v with v^2 = a / k, where a is a lateral acceleration. At the
distance d before it, comfortable braking by b allows the speed sqrt(v^2 + 2 b d). The curvature is that of the lane's
centre. On a slippery road both accelerations are smaller (`comfort`).

A bend may be drawn as straight lines with corners. Its curvature is the change of heading over 8 m. A single corner may
be cut by e: an arc with the radius R that turns by the small angle w passes the corner at R w^2 / 8, so that its
curvature is w^2 / (8 e). The smaller of the two curvatures counts. The joint of two roads may be such a corner.
"""

from __future__ import annotations

from math import atan, pi

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.numbers import clip, safe_sqrt
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.path import path_ahead, preferred_road
from scenario_compiler.engine.motion.surroundings import comfort
from scenario_compiler.marker import compiled
from scenario_compiler.roads.geometry import CORNER, corners_near, road_heading, wrap_angle
from scenario_compiler.roads.lanes import curvature_ahead, curvature_in_lane, lane_curvature, lane_row, row_centre
from scenario_compiler.roads.tables import RoadTables
from scenario_compiler.roads.travel import HOP_LIMIT, row_next, way_in, way_out
from scenario_compiler.vocabulary.horizon import TYRES_HOLD

NEAREST = 4.0
STEP = 3.2
"""Distance ahead at which the search for bends begins, and from one place to the next, m: `lane_detection` measures a
bend over 4 m of its route on either side."""

CUT = 0.15
"""By how much a corner may be cut, m; chosen: a sixth of the space that a lane of 3.5 m leaves beside a car."""

KNOWN_FOR = 2.0
"""Distance after which bends that limit the speed are searched again, m; chosen."""

COARSER = 0.1
"""Distance between two places in a spiral or polynomial, as a share of their distance ahead; at least STEP."""

FARTHER = 200.0
"""Distance beyond that of comfortable braking up to which bends are searched, so that it is seldom done, m; chosen."""

STRAIGHT = 1.0e-4
"""Curvature below which a lane counts as straight, 1/m."""

DRIVER_LATERAL = 2.5
DRIVER_BRAKING = 2.0
"""Lateral acceleration with which a driver drives bends, and braking before them, m/s2; chosen: those of the automation
unless its parameters change them."""

SETTLING = 0.5
"""Time in which a difference to the speed for the bends decreases to a third (1 / e), s; chosen."""


@compiled
def heading_in_row(n: RoadTables, row: int, s: float) -> float:
    """Return the heading of a lane's centre in the direction of travel, rad, not wrapped."""
    road = n.section_road[n.lane_section[row]]
    _, slope = row_centre(n, road, row, s)
    along = road_heading(n, road, s) + atan(slope)
    return along if n.lane_sense[row] == 1 else along + pi


@compiled
def turned_at_joints(n: RoadTables, p: Program, st: State, road: int, lane: int, s: float, within: float) -> float:
    """Return by how much the path turns at the joints of roads within a distance of a place, rad, positive to the left.

    Only joints that are corners count, those with more than CORNER.
    """
    row = lane_row(n, road, lane, s)
    if row < 0:
        return 0.0
    sense = n.lane_sense[row]
    gone = 0.0
    turned = 0.0
    at = s
    for _ in range(HOP_LIMIT):
        end, room = way_out(n, row, at, sense)
        gone += room
        if gone >= within:
            return turned
        section = n.lane_section[row]
        left = n.section_road[section]
        before = heading_in_row(n, row, at + sense * room)
        row, contact = row_next(n, row, end, 1, preferred_road(p, st, left))
        if row < 0:
            return turned
        within_road = 1 if n.lane_section[row] == section + sense else 0
        sense, at = way_in(n, row, contact)
        if n.section_road[n.lane_section[row]] != left or within_road == 0:
            corner = wrap_angle(heading_in_row(n, row, at) - before)
            turned += corner if abs(corner) > CORNER else 0.0
    return turned


@compiled
def corner_curvature(n: RoadTables, road: int, row: int, s: float, joints: float) -> float:
    """Return the curvature of a lane's centre that belongs to the corners of the road near s, 1/m, at least 0.

    `joints` is the angle of the corners at joints near s, positive to the left in the direction of travel, rad.
    """
    if row < 0:
        return 0.0
    turned = corners_near(n, road, s, NEAREST) + n.lane_sense[row] * joints
    if turned == 0.0:
        return 0.0
    k = min(abs(turned) / (2.0 * NEAREST), turned * turned / (8.0 * CUT))
    return abs(curvature_in_lane(n, road, row, s, k if turned > 0.0 else -k))


@compiled
def look_for_bends(n: RoadTables, p: Program, st: State, i: int, lateral: float, braking: float) -> None:
    """Find the bend that limits the speed most, as far ahead as comfortable braking from the present speed needs.

    Bends that allow every speed do not count, nor do those so far ahead that braking for any bend there suffices.
    """
    base = p.entity_const[i]
    fastest = p.const[base + slot.E_MAX_SPEED]
    reach = NEAREST + 0.5 * st.v[i] * st.v[i] / max(braking, 0.1) + FARTHER
    st.slow_row[0] = st.path_row[0]
    st.slow_lateral[0] = lateral
    st.slow_braking[0] = braking
    st.slow_square[0] = op.FAR
    st.slow_at[0] = st.odometer[i]
    st.slow_until[0] = st.odometer[i] + KNOWN_FOR
    st.slow_known[0] = op.FAR
    if st.path_road[0] < 0:
        return
    least = op.FAR
    place = 0
    clear = 0.0
    constant = 0
    passed = turned_at_joints(n, p, st, st.path_road[0], st.path_lane[0], st.path_s[0], NEAREST)
    while NEAREST + STEP * place <= reach and 2.0 * braking * STEP * place < least:
        beyond = STEP * place
        road, lane, row, s, over = path_ahead(n, p, st, NEAREST + beyond)
        if over > 0.0:
            return
        joints = passed + turned_at_joints(n, p, st, road, lane, s, NEAREST)
        bend = max(abs(lane_curvature(n, road, lane, row, s)), corner_curvature(n, road, row, s, joints))
        if bend > STRAIGHT:
            square = lateral / bend
            if square < fastest * fastest and square + 2.0 * braking * beyond < least:
                least = square + 2.0 * braking * beyond
                st.slow_square[0] = square
                st.slow_at[0] = st.odometer[i] + beyond
        rest, constant = curvature_ahead(n, road, lane, row, s)
        if constant == 0:
            rest = min(rest, COARSER * beyond)
        clear = beyond + rest
        places = 1 + int(clip(rest / STEP, 0.0, 1.0e6))
        passed = turned_at_joints(n, p, st, road, lane, s, STEP * places)
        place = place + places
    st.slow_known[0] = st.odometer[i] + clear
    if least >= op.FAR and constant == 1 and NEAREST + clear > reach:
        faster = p.const[base + slot.E_MAX_ACCELERATION] / max(braking, 0.1)
        st.slow_until[0] = st.odometer[i] + (NEAREST + clear - reach) / (1.0 + max(faster, 0.0))


@compiled
def bends_are_known(st: State, lateral: float, braking: float) -> int:
    """Return 1 if the last search for bends was on this row of the path and for these numbers."""
    if st.slow_row[0] != st.path_row[0] or st.slow_lateral[0] != lateral or st.slow_braking[0] != braking:
        return 0
    return 1


@compiled
def comfort_in_bends(p: Program, st: State, i: int, lateral: float, braking: float) -> tuple[float, float]:
    """Return the lateral acceleration in bends and the braking before them that are comfortable on this road, m/s2."""
    hardest = p.const[p.entity_const[i] + slot.E_MAX_DECELERATION]
    return comfort(st, lateral, TYRES_HOLD), comfort(st, braking, hardest)


@compiled
def speed_for_bends(n: RoadTables, p: Program, st: State, i: int, lateral: float, braking: float) -> float:
    """Return the greatest speed from which comfortable braking suffices for the bends ahead, m/s.

    It is FAR where no bend limits the speed. The bend is kept for some metres; where none is within reach, until the
    ego can be near one, at its greatest acceleration.

    Args:
        n: The roads.
        p: The program.
        st: The state.
        i: The ego.
        lateral: Lateral acceleration in bends on a dry road, m/s2.
        braking: Comfortable deceleration on a dry road, m/s2.
    """
    held, slowing = comfort_in_bends(p, st, i, lateral, braking)
    if st.odometer[i] >= st.slow_until[0] or bends_are_known(st, held, slowing) == 0:
        look_for_bends(n, p, st, i, held, slowing)
    if st.slow_square[0] >= op.FAR:
        return op.FAR
    before = max(st.slow_at[0] - st.odometer[i], 0.0)
    return safe_sqrt(st.slow_square[0] + 2.0 * slowing * before)


@compiled
def acceleration_for_bends(n: RoadTables, p: Program, st: State, i: int, lateral: float, braking: float) -> float:
    """Return the acceleration that the bends ahead allow, m/s2; FAR where no bend can limit the speed.

    `lateral` and `braking` hold on a dry road. All bends that limit the present speed are known. The car brakes
    comfortably, not below the speed in the bend, and harder only if it is too fast for that. Where the bends allow more
    than the present speed, they are not considered again before the car can have become too fast for them.
    """
    held, slowing = comfort_in_bends(p, st, i, lateral, braking)
    if st.odometer[i] < st.free_until[0] and bends_are_known(st, held, slowing) == 1:
        return op.FAR
    v = st.v[i]
    allowed = speed_for_bends(n, p, st, i, lateral, braking)
    most = max(p.const[p.entity_const[i] + slot.E_MAX_ACCELERATION], 0.0)
    free = min(allowed * allowed, 2.0 * slowing * (st.slow_known[0] - st.odometer[i]))
    minded = v + SETTLING * (most + slowing)
    st.free_until[0] = st.odometer[i] + (free - minded * minded) / max(2.0 * (most + slowing), 0.1)
    if st.slow_at[0] <= st.odometer[i]:
        return (allowed - v) / SETTLING
    return max((allowed - v) / SETTLING - slowing, (safe_sqrt(st.slow_square[0]) - v) / SETTLING)
