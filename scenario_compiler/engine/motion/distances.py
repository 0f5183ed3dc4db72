"""The distances of conditions: from an entity to another entity or to a point.

A distance is Euclidean, along or across. A Euclidean one includes the height: "if not otherwise stated, the
three-dimensional Euclidean space is used" (Distances, ASAM OpenSCENARIO). Along and across refer to the entity's own
axes, the world's axes, the road, the centre line of the entity's lane (across: the road; esmini 3.6 takes the road for
both), or the trajectory that it follows (the road if it follows none). With `freespace`, it is measured between the
boxes, and is 0 if they overlap in that direction; along and across a road, between the places of their corners on it.
Along is positive ahead, across positive to the left; a Euclidean distance is negative if the target is not ahead. A
target off every road is measured at its foot on the entity's way, and an entity off every road at its foot on the
target's road. The distance is FAR if no road leads to the target. All distances are in m.
"""

from __future__ import annotations

from math import atan2, cos, pi, sin

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.numbers import angle_between, length_of
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.ahead import point_on_way, walk
from scenario_compiler.engine.motion.collision import overlap_from_above
from scenario_compiler.engine.motion.on_tracks import place_anywhere
from scenario_compiler.engine.motion.path import STEP_OVER
from scenario_compiler.engine.motion.places import resolve_position
from scenario_compiler.engine.motion.positions import PLACE_NONE
from scenario_compiler.engine.motion.tracks import nearest_on_track, track_followed, track_pose
from scenario_compiler.marker import compiled
from scenario_compiler.roads.geometry import road_curvature, road_heading
from scenario_compiler.roads.lanes import lane_centre, lane_direction, lane_pose, lane_row_in
from scenario_compiler.roads.locate import locate_lane, project_on_road
from scenario_compiler.roads.tables import RoadTables
from scenario_compiler.roads.travel import LANE_STEP, advance, centre_length

ROAD_HORIZON = 1000.0
"""Greatest distance along the roads that is searched, m."""


@compiled
def half_extent(p: Program, i: int, turned: float) -> float:
    """Return half the extent of an entity's box, m, along an axis to which the box is turned by an angle, rad."""
    base = p.entity_const[i]
    return 0.5 * (abs(cos(turned)) * p.const[base + slot.E_LENGTH] + abs(sin(turned)) * p.const[base + slot.E_WIDTH])


@compiled
def gap_beyond(centre: float, reach: float) -> float:
    """Return the signed gap between two boxes whose half extents sum to `reach`; 0 if they overlap."""
    if centre > reach:
        return centre - reach
    if centre < -reach:
        return centre + reach
    return 0.0


@compiled
def distance_to_box(p: Program, st: State, i: int, x: float, y: float) -> float:
    """Return the distance from a point to an entity's box, m; 0 inside it."""
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
    """Return the least distance from a corner of j's box to i's box, m."""
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
    """Return the distance between two boxes as seen from above, m; 0 if they overlap there.

    For disjoint convex shapes a corner is nearest.
    """
    if overlap_from_above(p, st, i, j) == 1:
        return 0.0
    return min(nearest_corner(p, st, i, j), nearest_corner(p, st, j, i))


@compiled
def height_of(p: Program, i: int) -> float:
    """Return the height of an entity's box, m."""
    return p.const[p.entity_const[i] + slot.E_HEIGHT]


@compiled
def height_between(z: float, height: float, other_z: float, other_height: float) -> float:
    """Return the vertical gap between two boxes that stand at z, m; 0 if they share a height."""
    return max(0.0, other_z - z - height, z - other_z - other_height)


@compiled
def behind(st: State, i: int, x: float, y: float) -> int:
    """Return 1 if a point is not ahead of an entity's reference point."""
    return 1 if (x - st.x[i]) * cos(st.h[i]) + (y - st.y[i]) * sin(st.h[i]) < op.TOLERANCE else 0


@compiled
def along_axis(axis: float, dx: float, dy: float, measure: int) -> float:
    """Return a vector's component along an axis with the heading `axis`, or across it to the left."""
    if measure == op.MEASURE_ALONG:
        return dx * cos(axis) + dy * sin(axis)
    return dy * cos(axis) - dx * sin(axis)


@compiled
def plane_distance_between(p: Program, st: State, i: int, j: int, frame: int, measure: int, freespace: int) -> float:
    """Return the distance from entity i to entity j, straight or along axes of the plane, m."""
    if measure == op.MEASURE_STRAIGHT:
        between = length_of(st.x[j] - st.x[i], st.y[j] - st.y[i])
        up = st.z[j] - st.z[i]
        if freespace == 1:
            between = box_distance(p, st, i, j)
            up = height_between(st.z[i], height_of(p, i), st.z[j], height_of(p, j))
        between = length_of(between, up)
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
    p: Program, st: State, i: int, x: float, y: float, z: float, frame: int, measure: int, freespace: int
) -> float:
    """Return the distance from entity i to a point, m."""
    if measure == op.MEASURE_STRAIGHT:
        between = length_of(x - st.x[i], y - st.y[i])
        up = z - st.z[i]
        if freespace == 1:
            between = distance_to_box(p, st, i, x, y)
            up = height_between(st.z[i], height_of(p, i), z, 0.0)
        between = length_of(between, up)
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
    """Search a place by each turn at the first junction of the last walked way; return (way row or -1, t, distance).

    Afterwards the way to the place is the last walked way.
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
    """Return (distance, t, sign) of a place on i's way; the distance is FAR if the way does not lead there.

    The way follows the lane's direction of travel (`along` 1) or goes against it (-1). It goes straight on; if it does
    not lead to the place, each turn at its first junction is tried. `sign` is 1 if it goes along s at the place, else
    -1.
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
    """Return (ahead, left, direction) of a place on a road as seen from entity i along the roads; ahead may be FAR.

    `direction` is 1 if i's way goes along s there, else -1. The place is searched forwards first, then backwards. If no
    road leads there, ahead is FAR.
    """
    here = st.road[i]
    if here < 0 or road < 0:
        return op.FAR, 0.0, 1
    if here == road:
        return st.facing[i] * (s - st.s[i]), st.facing[i] * (t - st.t[i]), st.facing[i]
    along = st.facing[i] * lane_direction(n, here, st.lane[i], st.s[i])
    distance, at_t, sign = along_way(n, st, i, along, road, s, t, x, y)
    if distance < op.FAR:
        return distance, sign * at_t - st.facing[i] * st.t[i], sign
    distance, at_t, sign = along_way(n, st, i, -along, road, s, t, x, y)
    if distance < op.FAR:
        return -distance, -sign * at_t - st.facing[i] * st.t[i], -sign
    return op.FAR, 0.0, 1


@compiled
def nearest_foot(n: RoadTables, st: State, i: int, along: int, x: float, y: float) -> tuple[int, float, float]:
    """Return (road or -1, s, t) of the nearest foot of a point on i's way, as travelled (`along` 1) or against it."""
    found = op.NONE
    at_s = 0.0
    at_t = op.FAR
    walk(n, st, st.road[i], st.lane[i], st.s[i], along, ROAD_HORIZON, -1)
    for w in range(st.way_count[0]):
        road = st.way_road[w]
        s, t = project_on_road(n, road, 0.5 * n.road_length[road], x, y)
        if s >= 0.0 and s <= n.road_length[road] and abs(t) < abs(at_t):
            found = road
            at_s = s
            at_t = t
    return found, at_s, at_t


@compiled
def along_or_beside(
    n: RoadTables, st: State, i: int, road: int, s: float, t: float, x: float, y: float
) -> tuple[float, float, int, int, float]:
    """Return (ahead, left, direction, road, s): the result of `along_roads`, and the place there, a foot if off roads.

    The road of the place is -1 if both are off every road.
    """
    if st.road[i] >= 0:
        if road < 0:
            road, s, t = nearest_foot(n, st, i, 1, x, y)
            other, other_s, other_t = nearest_foot(n, st, i, -1, x, y)
            if other >= 0 and abs(other_t) < abs(t):
                road, s, t = other, other_s, other_t
        ahead, left, direction = along_roads(n, st, i, road, s, t, x, y)
        return ahead, left, direction, road, s
    if road < 0:
        return op.FAR, 0.0, 1, road, s
    own_s, own_t = project_on_road(n, road, s, st.x[i], st.y[i])
    if own_s < 0.0 or own_s > n.road_length[road]:
        return op.FAR, 0.0, 1, road, s
    facing = 1 if cos(st.h[i] - road_heading(n, road, own_s)) >= 0.0 else -1
    return facing * (s - own_s), facing * (t - own_t), facing, road, s


@compiled
def along_lane(n: RoadTables, st: State, i: int, ahead: float) -> float:
    """Return the length of the centre line of i's lane over a distance along the reference lines of its way, m.

    The way is the last walked one, which leads there; off every road the distance is returned as it is.
    """
    road = st.road[i]
    lane = st.lane[i]
    if road < 0 or lane == 0:
        return ahead
    s = st.s[i]
    along = st.facing[i] * lane_direction(n, road, lane, s)
    if ahead < 0.0:
        along = -along
    length = 0.0
    left = abs(ahead)
    w = 0
    while left > 0.0:
        sense = along * lane_direction(n, road, lane, s)
        room = n.road_length[road] - s if sense > 0.0 else s
        step = min(left, LANE_STEP, max(room, STEP_OVER))
        middle = min(max(s + 0.5 * sense * step, 0.0), n.road_length[road])
        centre, slope = lane_centre(n, road, lane, middle)
        length = length + step * centre_length(road_curvature(n, road, middle), centre, slope)
        left = left - step
        turn = st.way_road[w + 1] if w + 1 < st.way_count[0] else op.NONE
        before = road
        road, lane, s, rest = advance(n, road, lane, s, along * step, turn)
        if rest > 0.0:
            return (length + left) * (1.0 if ahead > 0.0 else -1.0)
        if road != before and w + 1 < st.way_count[0]:
            w = w + 1
    return length if ahead > 0.0 else -length


@compiled
def way_in_lane(n: RoadTables, st: State, i: int, road: int, ahead: float) -> float:
    """Return a distance that `along_or_beside` has measured to a place on a road, along the centre line of i's lane."""
    if st.road[i] == road:
        walk(n, st, st.road[i], st.lane[i], st.s[i], 1, 0.0, -1)
    return along_lane(n, st, i, ahead)


@compiled
def turned_on_road(n: RoadTables, st: State, i: int, road: int, direction: int) -> float:
    """Return i's heading relative to its motion along its road; off every road, to a direction of another road."""
    if st.road[i] >= 0:
        return turned_against(n, st.road[i], st.s[i], st.facing[i], st.h[i])
    s, _ = project_on_road(n, road, 0.5 * n.road_length[road], st.x[i], st.y[i])
    return turned_against(n, road, s, direction, st.h[i])


@compiled
def turned_against(n: RoadTables, road: int, s: float, direction: int, h: float) -> float:
    """Return a heading relative to the road's direction at s, rad; `direction` is -1 for travel against s."""
    along = road_heading(n, road, s)
    return angle_between(h, along if direction > 0 else along + pi)


@compiled
def corner_on_road(bend: float, t: float, forward: float, left: float) -> tuple[float, float]:
    """Return how far a point lies along and across a road from a point at t on it, given by the tangent and the normal.

    `bend` is the road's curvature; it, t and the results refer to one direction on the road.
    """
    rest = 1.0 - bend * (t + left)
    if abs(bend) < op.TOLERANCE or rest < op.TOLERANCE:
        return forward, left
    return atan2(bend * forward, rest) / bend, (1.0 - length_of(bend * forward, rest)) / bend - t


@compiled
def reach_on_road(p: Program, i: int, turned: float, bend: float, t: float, measure: int) -> tuple[float, float]:
    """Return (middle, half extent) of a box along or across a road, m, the middle from the entity's reference point.

    `turned` is the entity's heading relative to the direction to which `bend`, t and the result refer.
    """
    base = p.entity_const[i]
    least = op.FAR
    most = -op.FAR
    for corner in range(4):
        along = p.const[base + slot.E_CENTER] + p.const[base + slot.E_LENGTH] * (0.5 if corner < 2 else -0.5)
        across = p.const[base + slot.E_WIDTH] * (0.5 if corner in (0, 3) else -0.5)
        forward = along * cos(turned) - across * sin(turned)
        left = along * sin(turned) + across * cos(turned)
        forward, left = corner_on_road(bend, t, forward, left)
        value = forward if measure == op.MEASURE_ALONG else left
        least = min(least, value)
        most = max(most, value)
    return 0.5 * (least + most), 0.5 * (most - least)


@compiled
def own_reach(
    n: RoadTables, p: Program, st: State, i: int, turned: float, frame: int, measure: int
) -> tuple[float, float]:
    """Return (middle, half extent) of i's box along or across its road; along its lane as if that were straight."""
    bend = 0.0
    if st.road[i] >= 0 and frame != op.FRAME_LANE:
        bend = st.facing[i] * road_curvature(n, st.road[i], st.s[i])
    return reach_on_road(p, i, turned, bend, st.facing[i] * st.t[i], measure)


@compiled
def reach_there(
    n: RoadTables,
    p: Program,
    st: State,
    i: int,
    j: int,
    road: int,
    s: float,
    left: float,
    direction: int,
    frame: int,
    measure: int,
) -> tuple[float, float]:
    """Return (middle, half extent) of j's box at s on a road, `left` of i, as `along_or_beside` has found it."""
    bend = 0.0
    t = 0.0
    if st.road[i] >= 0 and frame != op.FRAME_LANE:
        bend = direction * road_curvature(n, road, s)
        t = left + st.facing[i] * st.t[i]
    return reach_on_road(p, j, turned_against(n, road, s, direction, st.h[j]), bend, t, measure)


@compiled
def road_distance_between(
    n: RoadTables, p: Program, st: State, i: int, j: int, frame: int, measure: int, freespace: int
) -> float:
    """Return the distance from entity i to entity j along or across the road, or along i's lane, m."""
    ahead, left, direction, road, s = along_or_beside(n, st, i, st.road[j], st.s[j], st.t[j], st.x[j], st.y[j])
    if ahead >= op.FAR:
        return op.FAR
    if frame == op.FRAME_LANE and measure == op.MEASURE_ALONG:
        ahead = way_in_lane(n, st, i, road, ahead)
    if freespace == 0:
        return ahead if measure == op.MEASURE_ALONG else left
    own, own_reached = own_reach(n, p, st, i, turned_on_road(n, st, i, road, direction), frame, measure)
    other, other_reached = reach_there(n, p, st, i, j, road, s, left, direction, frame, measure)
    between = ahead if measure == op.MEASURE_ALONG else left
    return gap_beyond(between + other - own, own_reached + other_reached)


@compiled
def track_distance(p: Program, st: State, k: int, x: float, y: float, measure: int) -> tuple[float, float]:
    """Return (distance of a point from the entity of action k, the direction there); k leads it along a trajectory.

    The distance along ends at the point of the trajectory that is nearest; the one across is measured from there.
    """
    track = p.action_other[k]
    s = nearest_on_track(p, st, track, x, y)
    at_x, at_y, _, along = track_pose(p, st, track, s, 0)
    if measure == op.MEASURE_ALONG:
        return s - st.action_a[k], along
    return along_axis(along, x - at_x, y - at_y, measure), along


@compiled
def reach_across(p: Program, st: State, i: int, along: float, measure: int) -> float:
    """Return half the extent of i's box along a direction or, for the measure across, perpendicular to it, m."""
    return half_extent(p, i, st.h[i] - along - (0.0 if measure == op.MEASURE_ALONG else 0.5 * pi))


@compiled
def track_distance_between(
    p: Program, st: State, i: int, j: int, k: int, measure: int, freespace: int
) -> tuple[float, float]:
    """Return (distance, part of it that the boxes cover) from i to j by the trajectory on which action k leads i, m.

    With `freespace` it is measured between the centres of the boxes, otherwise between the reference points.
    """
    if freespace == 0:
        gap, _ = track_distance(p, st, k, st.x[j], st.y[j], measure)
        return gap, 0.0
    gap, along = track_distance(p, st, k, st.middle_x[j], st.middle_y[j], measure)
    gap = gap - along_axis(along, st.middle_x[i] - st.x[i], st.middle_y[i] - st.y[i], measure)
    return gap, reach_across(p, st, i, along, measure) + reach_across(p, st, j, along, measure)


@compiled
def distance_between(n: RoadTables, p: Program, st: State, i: int, j: int, mode: int, freespace: int) -> float:
    """Return the distance from entity i to entity j, m; `mode` combines FRAME_... and MEASURE_... (`measure_mode`)."""
    frame = mode // 4
    measure = mode % 4
    if measure == op.MEASURE_STRAIGHT or frame in (op.FRAME_ENTITY, op.FRAME_WORLD):
        return plane_distance_between(p, st, i, j, frame, measure, freespace)
    k = track_followed(p, st, i)
    if frame == op.FRAME_TRAJECTORY and k >= 0:
        gap, reach = track_distance_between(p, st, i, j, k, measure, freespace)
        return gap_beyond(gap, reach) if freespace == 1 else gap
    return road_distance_between(n, p, st, i, j, frame, measure, freespace)


@compiled
def place_now(
    n: RoadTables, p: Program, st: State, k: int, i: int
) -> tuple[int, float, float, float, int, float, float]:
    """Return (found, x, y, z, road, s, t) of a position now, for entity i; random positions keep their drawn place."""
    road = op.NONE
    lane = 0
    s = 0.0
    offset = 0.0
    x = st.position_x[k]
    y = st.position_y[k]
    z = 0.0
    if p.position_op[k] == op.POSITION_LANE:
        road, lane, s, offset, _ = resolve_position(n, p, st, k)
        if road < 0:
            return 0, 0.0, 0.0, 0.0, -1, 0.0, 0.0
    elif p.position_op[k] >= op.POSITION_FREE:
        kind, road, lane, s, offset, x, y, z, _ = place_anywhere(n, p, st, k, i)
        if kind == PLACE_NONE:
            return 0, 0.0, 0.0, 0.0, -1, 0.0, 0.0
    else:
        if x >= op.FAR:
            return 0, 0.0, 0.0, 0.0, -1, 0.0, 0.0
        at_lane, road, lane, s, offset = locate_lane(n, x, y)
        if at_lane == 0:
            road = op.NONE
    if road < 0:
        return 1, x, y, z, -1, 0.0, 0.0
    centre, _ = lane_centre(n, road, lane, s)
    if p.position_op[k] < op.POSITION_FREE:
        x, y, z, _, _, _ = lane_pose(n, road, lane, s, offset)
    return 1, x, y, z, road, s, centre + offset


@compiled
def distance_to(n: RoadTables, p: Program, st: State, i: int, k: int, mode: int, freespace: int) -> float:
    """Return the distance from entity i to position k, m; `mode` as in `distance_between`; FAR if it lies nowhere."""
    found, x, y, z, road, s, t = place_now(n, p, st, k, i)
    if found == 0:
        return op.FAR
    frame = mode // 4
    measure = mode % 4
    if measure == op.MEASURE_STRAIGHT or frame in (op.FRAME_ENTITY, op.FRAME_WORLD):
        return plane_distance_to(p, st, i, x, y, z, frame, measure, freespace)
    follows = track_followed(p, st, i)
    if frame == op.FRAME_TRAJECTORY and follows >= 0:
        gap, along = track_distance(p, st, follows, x, y, measure)
        if freespace == 0:
            return gap
        gap = gap - along_axis(along, st.middle_x[i] - st.x[i], st.middle_y[i] - st.y[i], measure)
        return gap_beyond(gap, reach_across(p, st, i, along, measure))
    ahead, left, direction, road, s = along_or_beside(n, st, i, road, s, t, x, y)
    if ahead >= op.FAR:
        return op.FAR
    if frame == op.FRAME_LANE and measure == op.MEASURE_ALONG:
        ahead = way_in_lane(n, st, i, road, ahead)
    value = ahead if measure == op.MEASURE_ALONG else left
    if freespace == 0:
        return value
    own, reached = own_reach(n, p, st, i, turned_on_road(n, st, i, road, direction), frame, measure)
    return gap_beyond(value - own, reached)
