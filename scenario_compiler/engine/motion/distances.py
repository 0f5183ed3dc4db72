"""The distances of conditions: from an entity to another entity or to a point.

Each is straight, along or across; along and across are meant in the entity's own axes, in the world's, along the road
(so in a lane's system too), or along the trajectory that the entity follows; along the road where it follows none. With
`freespace` it lies between the boxes and is 0 where they overlap in that direction. Along is positive ahead, across
positive to the left; a straight one is negative for what is not ahead. FAR where there is none: no road leads there.
"""

from __future__ import annotations

from math import cos, pi, sin

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.numbers import angle_between, length_of
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.ahead import point_on_way, walk
from scenario_compiler.engine.motion.collision import overlap
from scenario_compiler.engine.motion.on_tracks import place_anywhere
from scenario_compiler.engine.motion.positions import PLACE_NONE
from scenario_compiler.engine.motion.tracks import nearest_on_track, track_followed, track_pose
from scenario_compiler.marker import compiled
from scenario_compiler.roads.geometry import road_heading
from scenario_compiler.roads.lanes import lane_centre, lane_direction, lane_row_in
from scenario_compiler.roads.locate import locate_lane
from scenario_compiler.roads.tables import RoadTables
from scenario_compiler.roads.travel import advance

ROAD_HORIZON = 1000.0
"""How far along the roads a distance is looked for, m."""


@compiled
def half_extent(p: Program, i: int, turned: float) -> float:
    """Return how far an entity's box reaches from its centre along an axis that it is turned against by an angle."""
    base = p.entity_const[i]
    return 0.5 * (abs(cos(turned)) * p.const[base + slot.E_LENGTH] + abs(sin(turned)) * p.const[base + slot.E_WIDTH])


@compiled
def gap_beyond(centre: float, reach: float) -> float:
    """Return what is left of a signed distance of centres between boxes that reach towards each other, 0 within."""
    if centre > reach:
        return centre - reach
    if centre < -reach:
        return centre + reach
    return 0.0


@compiled
def distance_to_box(p: Program, st: State, i: int, x: float, y: float) -> float:
    """Return the distance of a point from an entity's box, 0 inside it."""
    base = p.entity_const[i]
    c = st.box_cos[i]
    s = st.box_sin[i]
    ahead = (x - st.middle_x[i]) * c + (y - st.middle_y[i]) * s
    left = (y - st.middle_y[i]) * c - (x - st.middle_x[i]) * s
    return length_of(
        gap_beyond(ahead, 0.5 * p.const[base + slot.E_LENGTH]), gap_beyond(left, 0.5 * p.const[base + slot.E_WIDTH])
    )


@compiled
def nearest_corner(p: Program, st: State, i: int, j: int) -> float:
    """Return the least distance of a corner of j's box from i's box."""
    base = p.entity_const[j]
    c = st.box_cos[j]
    s = st.box_sin[j]
    least = op.FAR
    for corner in range(4):
        along = p.const[base + slot.E_LENGTH] * (0.5 if corner < 2 else -0.5)
        across = p.const[base + slot.E_WIDTH] * (0.5 if corner in (0, 3) else -0.5)
        x = st.middle_x[j] + along * c - across * s
        y = st.middle_y[j] + along * s + across * c
        least = min(least, distance_to_box(p, st, i, x, y))
    return least


@compiled
def box_distance(p: Program, st: State, i: int, j: int) -> float:
    """Return the distance between two boxes, 0 where they overlap: of convex shapes apart, one's corner is nearest."""
    if overlap(p, st, i, j) == 1:
        return 0.0
    return min(nearest_corner(p, st, i, j), nearest_corner(p, st, j, i))


@compiled
def behind(st: State, i: int, x: float, y: float) -> int:
    """Return 1 where a point does not lie ahead of an entity's reference point."""
    return 1 if (x - st.x[i]) * cos(st.h[i]) + (y - st.y[i]) * sin(st.h[i]) < op.TOLERANCE else 0


@compiled
def along_axis(axis: float, dx: float, dy: float, measure: int) -> float:
    """Return a vector's part along an axis, or across it to the left."""
    if measure == op.MEASURE_ALONG:
        return dx * cos(axis) + dy * sin(axis)
    return dy * cos(axis) - dx * sin(axis)


@compiled
def plane_distance_between(p: Program, st: State, i: int, j: int, frame: int, measure: int, freespace: int) -> float:
    """Return the distance of entity j from i in the plane."""
    if measure == op.MEASURE_STRAIGHT:
        between = length_of(st.x[j] - st.x[i], st.y[j] - st.y[i])
        if freespace == 1:
            between = box_distance(p, st, i, j)
        return -between if behind(st, i, st.x[j], st.y[j]) == 1 else between
    axis = st.h[i] if frame != op.FRAME_WORLD else 0.0
    if freespace == 0:
        return along_axis(axis, st.x[j] - st.x[i], st.y[j] - st.y[i], measure)
    dx = st.middle_x[j] - st.middle_x[i]
    dy = st.middle_y[j] - st.middle_y[i]
    turned = 0.0 if measure == op.MEASURE_ALONG else 0.5 * pi
    reach = half_extent(p, i, st.h[i] - axis - turned) + half_extent(p, j, st.h[j] - axis - turned)
    return gap_beyond(along_axis(axis, dx, dy, measure), reach)


@compiled
def plane_distance_to(
    p: Program, st: State, i: int, x: float, y: float, frame: int, measure: int, freespace: int
) -> float:
    """Return the distance of a point from entity i in the plane."""
    if measure == op.MEASURE_STRAIGHT:
        between = length_of(x - st.x[i], y - st.y[i])
        if freespace == 1:
            between = distance_to_box(p, st, i, x, y)
        return -between if behind(st, i, x, y) == 1 else between
    axis = st.h[i] if frame != op.FRAME_WORLD else 0.0
    if freespace == 0:
        return along_axis(axis, x - st.x[i], y - st.y[i], measure)
    dx = x - st.middle_x[i]
    dy = y - st.middle_y[i]
    turned = 0.0 if measure == op.MEASURE_ALONG else 0.5 * pi
    return gap_beyond(along_axis(axis, dx, dy, measure), half_extent(p, i, st.h[i] - axis - turned))


@compiled
def along_branches(
    n: RoadTables, st: State, i: int, along: int, road: int, s: float, t: float, x: float, y: float
) -> tuple[int, float, float]:
    """Look for a place by each turn at the first junction of the way that was walked last: (row or -1, t, distance).

    The way to the place is then the one walked last.
    """
    count = st.way_count[0]
    w = 0
    while w + 1 < count and n.road_junction[st.way_road[w + 1]] < 0:
        w = w + 1
    if w + 1 >= count:
        return -1, 0.0, 0.0
    before = st.way_road[w]
    sign = st.way_sign[w]
    rest = n.road_length[before] - st.way_s[w] if sign > 0 else st.way_s[w]
    _, lane, _, _ = advance(n, before, st.way_lane[w], st.way_s[w], along * max(rest - op.TOLERANCE, 0.0), -1)
    section = n.road_section[before + 1] - 1 if sign > 0 else n.road_section[before]
    row = lane_row_in(n, section, lane)
    if row < 0:
        return -1, 0.0, 0.0
    end = 2 * row + (1 if sign > 0 else 0)
    for link in range(n.lane_link[end], n.lane_link[end + 1]):
        turn = n.section_road[n.lane_section[n.link_lane[link]]]
        walk(n, st, st.road[i], st.lane[i], st.s[i], along, ROAD_HORIZON, turn)
        k, _, at_t, distance = point_on_way(n, st, road, s, t, x, y)
        if k >= 0:
            return k, at_t, distance
    return -1, 0.0, 0.0


@compiled
def along_way(
    n: RoadTables, st: State, i: int, along: int, road: int, s: float, t: float, x: float, y: float
) -> tuple[float, float, int]:
    """Return (distance, t, sign) of a place on i's way with (1) or against (-1) its lane's travel, FAR for none.

    The way goes straight on; where it does not lead to the place, each turn at its first junction is tried.
    """
    walk(n, st, st.road[i], st.lane[i], st.s[i], along, ROAD_HORIZON, -1)
    w, _, at_t, distance = point_on_way(n, st, road, s, t, x, y)
    if w < 0:
        w, at_t, distance = along_branches(n, st, i, along, road, s, t, x, y)
    if w < 0:
        return op.FAR, 0.0, 1
    return distance, at_t, st.way_sign[w]


@compiled
def along_roads(
    n: RoadTables, st: State, i: int, road: int, s: float, t: float, x: float, y: float
) -> tuple[float, float, int]:
    """Return (ahead, left, direction) of a place on a road as seen from entity i along the roads, FAR ahead for none.

    `direction` is 1 where i's way goes along s there, else -1. It is looked for forwards, then back.
    """
    here = st.road[i]
    if here < 0 or road < 0:
        return op.FAR, 0.0, 1
    if here == road:
        return st.facing[i] * (s - st.s[i]), st.facing[i] * (t - st.t[i]), st.facing[i]
    along = st.facing[i] * lane_direction(n, here, st.lane[i])
    distance, at_t, sign = along_way(n, st, i, along, road, s, t, x, y)
    if distance < op.FAR:
        return distance, sign * at_t - st.facing[i] * st.t[i], sign
    distance, at_t, sign = along_way(n, st, i, -along, road, s, t, x, y)
    if distance < op.FAR:
        return -distance, -sign * at_t - st.facing[i] * st.t[i], -sign
    return op.FAR, 0.0, 1


@compiled
def turned_against(n: RoadTables, road: int, s: float, direction: int, h: float) -> float:
    """Return a heading relative to a road's direction at s, as it is travelled."""
    along = road_heading(n, road, s)
    return angle_between(h, along if direction > 0 else along + pi)


@compiled
def road_distance_between(n: RoadTables, p: Program, st: State, i: int, j: int, measure: int, freespace: int) -> float:
    """Return the distance of entity j from i along or across the road."""
    ahead, left, direction = along_roads(n, st, i, st.road[j], st.s[j], st.t[j], st.x[j], st.y[j])
    if ahead >= op.FAR:
        return op.FAR
    if freespace == 0:
        return ahead if measure == op.MEASURE_ALONG else left
    own = turned_against(n, st.road[i], st.s[i], st.facing[i], st.h[i])
    other = turned_against(n, st.road[j], st.s[j], direction, st.h[j])
    own_forward = p.const[p.entity_const[i] + slot.E_CENTER]
    other_forward = p.const[p.entity_const[j] + slot.E_CENTER]
    if measure == op.MEASURE_ALONG:
        middle = ahead + other_forward * cos(other) - own_forward * cos(own)
        return gap_beyond(middle, half_extent(p, i, own) + half_extent(p, j, other))
    middle = left + other_forward * sin(other) - own_forward * sin(own)
    return gap_beyond(middle, half_extent(p, i, own - 0.5 * pi) + half_extent(p, j, other - 0.5 * pi))


@compiled
def track_distance(p: Program, st: State, i: int, k: int, x: float, y: float, measure: int) -> tuple[float, float]:
    """Return the distance of a point from entity i, which action k leads along a trajectory, and the direction there.

    Along is to the point of the trajectory that is nearest, across from there to the left.
    """
    track = p.action_other[k]
    s = nearest_on_track(p, st, track, x, y)
    at_x, at_y, _, along = track_pose(p, st, track, s, 0)
    if measure == op.MEASURE_ALONG:
        return s - st.action_a[k], along
    return along_axis(along, x - at_x, y - at_y, measure), along


@compiled
def reach_across(p: Program, st: State, i: int, along: float, measure: int) -> float:
    """Return how far i's box reaches from its centre along a direction, or across it."""
    return half_extent(p, i, st.h[i] - along - (0.0 if measure == op.MEASURE_ALONG else 0.5 * pi))


@compiled
def track_distance_between(p: Program, st: State, i: int, j: int, k: int, measure: int, freespace: int) -> float:
    """Return the distance of entity j from i along or across the trajectory that action k leads i along."""
    if freespace == 0:
        gap, _ = track_distance(p, st, i, k, st.x[j], st.y[j], measure)
        return gap
    gap, along = track_distance(p, st, i, k, st.middle_x[j], st.middle_y[j], measure)
    gap = gap - along_axis(along, st.middle_x[i] - st.x[i], st.middle_y[i] - st.y[i], measure)
    return gap_beyond(gap, reach_across(p, st, i, along, measure) + reach_across(p, st, j, along, measure))


@compiled
def distance_between(n: RoadTables, p: Program, st: State, i: int, j: int, mode: int, freespace: int) -> float:
    """Return the distance of entity j from i; `mode` is FRAME_... and MEASURE_..., see `measure_mode`."""
    frame = mode // 4
    measure = mode % 4
    if measure == op.MEASURE_STRAIGHT or frame in (op.FRAME_ENTITY, op.FRAME_WORLD):
        return plane_distance_between(p, st, i, j, frame, measure, freespace)
    k = track_followed(p, st, i)
    if frame == op.FRAME_TRAJECTORY and k >= 0:
        return track_distance_between(p, st, i, j, k, measure, freespace)
    return road_distance_between(n, p, st, i, j, measure, freespace)


@compiled
def place_now(n: RoadTables, p: Program, st: State, k: int, i: int) -> tuple[int, float, float, int, float, float]:
    """Return (found, x, y, road, s, t) of a position now, for entity i; those of places that were drawn stay drawn."""
    if p.position_op[k] >= op.POSITION_FREE:
        kind, road, lane, s, offset, x, y, _, _ = place_anywhere(n, p, st, k, i)
        if kind == PLACE_NONE:
            return 0, 0.0, 0.0, -1, 0.0, 0.0
        t = 0.0
        if road >= 0:
            centre, _ = lane_centre(n, road, lane, s)
            t = centre + offset
        return 1, x, y, road, s, t
    x = st.position_x[k]
    y = st.position_y[k]
    if x >= op.FAR:
        return 0, 0.0, 0.0, -1, 0.0, 0.0
    at_lane, road, lane, s, offset = locate_lane(n, x, y)
    if at_lane == 0:
        return 1, x, y, -1, 0.0, 0.0
    centre, _ = lane_centre(n, road, lane, s)
    return 1, x, y, road, s, centre + offset


@compiled
def distance_to(n: RoadTables, p: Program, st: State, i: int, k: int, mode: int, freespace: int) -> float:
    """Return the distance of position k from entity i, `mode` as in `distance_between`; FAR where it is nowhere."""
    found, x, y, road, s, t = place_now(n, p, st, k, i)
    if found == 0:
        return op.FAR
    frame = mode // 4
    measure = mode % 4
    if measure == op.MEASURE_STRAIGHT or frame in (op.FRAME_ENTITY, op.FRAME_WORLD):
        return plane_distance_to(p, st, i, x, y, frame, measure, freespace)
    follows = track_followed(p, st, i)
    if frame == op.FRAME_TRAJECTORY and follows >= 0:
        gap, along = track_distance(p, st, i, follows, x, y, measure)
        if freespace == 0:
            return gap
        gap = gap - along_axis(along, st.middle_x[i] - st.x[i], st.middle_y[i] - st.y[i], measure)
        return gap_beyond(gap, reach_across(p, st, i, along, measure))
    ahead, left, _ = along_roads(n, st, i, road, s, t, x, y)
    if ahead >= op.FAR:
        return op.FAR
    value = ahead if measure == op.MEASURE_ALONG else left
    if freespace == 0:
        return value
    own = turned_against(n, st.road[i], st.s[i], st.facing[i], st.h[i])
    forward = p.const[p.entity_const[i] + slot.E_CENTER]
    if measure == op.MEASURE_ALONG:
        return gap_beyond(value - forward * cos(own), half_extent(p, i, own))
    return gap_beyond(value - forward * sin(own), half_extent(p, i, own - 0.5 * pi))
