"""The forward sensor: visible entities, widths of gaps, the end of the lane, and the gap in the neighbouring lane."""

from __future__ import annotations

from math import cos, pi

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.extent import front_of, rear_of
from scenario_compiler.engine.columns.numbers import clip, length_of, safe_sqrt
from scenario_compiler.engine.columns.presence import there_for
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.ahead import measure_on_way, walk, walk_route
from scenario_compiler.engine.motion.beside import neighbour_lane
from scenario_compiler.engine.motion.collision import face
from scenario_compiler.engine.motion.path import distance_on_route, preferred_road
from scenario_compiler.marker import compiled
from scenario_compiler.roads.lane_types import is_drivable
from scenario_compiler.roads.lanes import lane_direction, lane_type
from scenario_compiler.roads.tables import RoadTables
from scenario_compiler.roads.travel import distance_to_lane_end

SLOW = 2.0
"""Speed along the path below which an entity is not a leader, m/s."""

CROSSING = 0.5
"""Speed across the path from which an entity counts as crossing, m/s; chosen: slower than walking."""

CROSSING_TIME = 1.0
"""Time by which a crossing entity must have left before the ego arrives, s; chosen."""

LANE_END_HORIZON = 300.0
"""Distance up to which the end of the lane is searched ahead, m."""

LOOK_AGAIN = 50.0
"""Distance after which the end of the lane is searched again, m."""

THROUGH_MORE = 20.0
"""Least distance by which the neighbouring lane must continue beyond the end of the ending lane, m."""

GAP_HORIZON = 150.0
"""Distance ahead and behind within which vehicles in the neighbouring lane are considered, m."""

EDGE = 0.2
"""How far an object may reach over the edge of a neighbouring lane that still counts as free, m; chosen: half a cone.
"""

LEAST_GAP = 2.0
"""Distance to a vehicle in the neighbouring lane below which the gap is never free, m."""


@compiled
def open_eye(p: Program, st: State, i: int, reach: float, view: float) -> None:
    """Set the sensor of entity i, at its front bumper and along its heading: range, m, and full angle of view, rad."""
    front = front_of(p, i)
    face(st, i)
    c = st.box_cos[i]
    s = st.box_sin[i]
    st.eye_x[0] = st.x[i] + front * c
    st.eye_y[0] = st.y[i] + front * s
    st.eye_cos[0] = c
    st.eye_sin[0] = s
    st.eye_reach[0] = reach
    if view != st.eye_view[0]:
        st.eye_view[0] = view
        st.eye_edge[0] = cos(clip(0.5 * view, 0.0, pi))


@compiled
def ray_free(p: Program, st: State, i: int, j: int, dx: float, dy: float) -> int:
    """Return 1 if no box but those of i and j intersects the segment (dx, dy) that starts at the sensor.

    This is a separating-axis test. The cheap axes, of the segment and of the box's bounding circle, come first.
    """
    squared = dx * dx + dy * dy
    for k in range(p.entity_count[0]):
        if k in (i, j):
            continue
        x = st.eye_x[0] - st.middle_x[k]
        y = st.eye_y[0] - st.middle_y[k]
        beside = x * dy - y * dx
        within = st.reach[k] * st.reach[k] * squared
        if beside * beside > within:
            continue
        along = -x * dx - y * dy
        over = along - squared if along > squared else -along
        if (over > 0.0 and over * over > within) or there_for(st, k, op.SEEN_BY_SENSORS) == 0:
            continue
        face(st, k)
        c = st.box_cos[k]
        s = st.box_sin[k]
        u = 0.5 * (dx * c + dy * s)
        v = 0.5 * (dy * c - dx * s)
        base = p.entity_const[k]
        long = 0.5 * p.const[base + slot.E_LENGTH]
        wide = 0.5 * p.const[base + slot.E_WIDTH]
        if 0.5 * abs(beside) >= long * abs(v) + wide * abs(u):
            continue
        if abs(x * c + y * s + u) < long + abs(u) and abs(y * c - x * s + v) < wide + abs(v):
            return 0
    return 1


@compiled
def point_seen(p: Program, st: State, i: int, j: int, dx: float, dy: float) -> int:
    """Return 1 if a point of j at (dx, dy) from i's sensor is in range, within the angle of view and not hidden."""
    squared = dx * dx + dy * dy
    if squared > st.eye_reach[0] * st.eye_reach[0]:
        return 0
    if dx * st.eye_cos[0] + dy * st.eye_sin[0] < safe_sqrt(squared) * st.eye_edge[0]:
        return 0
    return ray_free(p, st, i, j, dx, dy)


@compiled
def outermost_corners(p: Program, st: State, j: int, dx: float, dy: float) -> tuple[float, float, float, float]:
    """Return the vectors (x, y, x, y) from the sensor to the two corners of j's box that bound its outline.

    (dx, dy) is the vector from the sensor to the centre of the box. The corners belong to one side if the sensor is
    within the strip of that side; otherwise they are opposite.
    """
    face(st, j)
    c = st.box_cos[j]
    s = st.box_sin[j]
    base = p.entity_const[j]
    long = 0.5 * p.const[base + slot.E_LENGTH]
    wide = 0.5 * p.const[base + slot.E_WIDTH]
    u = -dx * c - dy * s
    v = dx * s - dy * c
    first_u = long if u > 0.0 else -long
    first_v = -wide if v > 0.0 else wide
    second_u = -first_u
    second_v = -first_v
    if abs(u) <= long:
        first_v = second_v
    elif abs(v) <= wide:
        second_u = first_u
    return (
        dx + first_u * c - first_v * s,
        dy + first_u * s + first_v * c,
        dx + second_u * c - second_v * s,
        dy + second_u * s + second_v * c,
    )


@compiled
def sees(p: Program, st: State, i: int, j: int) -> int:
    """Return 1 if i's sensor sees the centre of j's box or one of the two corners that bound its outline."""
    if there_for(st, j, op.SEEN_BY_SENSORS) == 0:
        return 0
    dx = st.middle_x[j] - st.eye_x[0]
    dy = st.middle_y[j] - st.eye_y[0]
    if point_seen(p, st, i, j, dx, dy) == 1:
        return 1
    first_x, first_y, second_x, second_y = outermost_corners(p, st, j, dx, dy)
    if point_seen(p, st, i, j, first_x, first_y) == 1:
        return 1
    return point_seen(p, st, i, j, second_x, second_y)


@compiled
def foresee(st: State, i: int, j: int, front: float) -> None:
    """Shift the box of a slow, crossing or oncoming entity sideways by the distance that it moves until i arrives.

    The box of a crossing entity is also extended backwards by the distance of CROSSING_TIME.
    """
    gap = st.near[j] - front
    if gap <= 0.0:
        return
    closing = max(st.v[i] - st.along[j], 1.0)
    shift = st.across[j] * gap / closing
    st.low[j] += shift
    st.high[j] += shift
    if st.across[j] >= CROSSING:
        st.low[j] -= CROSSING_TIME * st.across[j]
    elif st.across[j] <= -CROSSING:
        st.high[j] -= CROSSING_TIME * st.across[j]


@compiled
def look_ahead(n: RoadTables, p: Program, st: State, i: int, reach: float, view: float) -> None:
    """Measure every entity along the ego's path, and mark those ahead that are within range, in view and not hidden.

    Nothing is measured again if the last look in this control step was the same, and no other way was walked since.
    """
    if st.looked[0] == 1 and reach == st.eye_reach[0] and view == st.eye_view[0]:
        return
    front = front_of(p, i)
    far = reach + 50.0
    open_eye(p, st, i, reach, view)
    walk_route(n, p, st, far)
    st.looked[0] = 1
    for j in range(p.entity_count[0]):
        st.seen[j] = 0
        st.on_way[j] = 0
        dx = st.x[j] - st.x[i]
        dy = st.y[j] - st.y[i]
        if j != i and dx * dx + dy * dy < far * far and measure_on_way(n, p, st, j) == 1 and st.far[j] >= front:
            if st.along[j] < SLOW:
                foresee(st, i, j, front)
            st.seen[j] = sees(p, st, i, j)


@compiled
def obstructs(st: State, j: int, front: float) -> int:
    """Return 1 if an entity is seen ahead on the path and is slow, crossing or oncoming."""
    if st.seen[j] == 1 and st.on_way[j] == 1 and st.along[j] < SLOW and st.far[j] > front:
        return 1
    return 0


@compiled
def gap_between(
    p: Program, st: State, begin: float, end: float, front: float, right: float, left: float, need: float, wish: float
) -> tuple[int, float, float]:
    """Return (found, centre, width) of a gap between `right` and `left` beside all obstacles from `begin` to `end`.

    `begin` and `end` are distances along the path, the others offsets from its centre, m. Of the gaps that are at least
    `need` wide, the one with an admissible centre nearest to `wish` is chosen. Without one, found is 0; width is always
    that of the widest gap.
    """
    found = 0
    best = 0.0
    widest = 0.0
    for c in range(-1, p.entity_count[0]):
        start = right
        if c >= 0:
            if obstructs(st, c, front) == 0 or st.near[c] > end or st.far[c] < begin:
                continue
            start = max(st.high[c], right)
        stop = left
        for k in range(p.entity_count[0]):
            if obstructs(st, k, front) == 1 and st.near[k] <= end and st.far[k] >= begin:
                if st.low[k] <= start and st.high[k] > start:
                    stop = start
                elif st.low[k] > start and st.low[k] < stop:
                    stop = st.low[k]
        width = max(stop - start, 0.0)
        if width >= need:
            centre = min(max(wish, start + 0.5 * need), stop - 0.5 * need)
            if found == 0 or abs(centre - wish) < abs(best - wish):
                best = centre
                found = 1
        widest = max(widest, width)
    return found, best, widest


@compiled
def find_lane_end(n: RoadTables, p: Program, st: State, i: int) -> None:
    """Write the distance to the end of the path's lane, and which neighbouring lane continues further, if any.

    A lane that leaves the planned route ends there: `lane_leaves` is then 1. The search covers LOOK_AGAIN more than
    needed; if the lane does not end there, no search is needed for a while.
    """
    st.lane_end_distance[0] = op.FAR
    st.lane_leaves[0] = 0
    st.through_lane[0] = 0
    st.through_side[0] = 0
    road = st.path_road[0]
    if road < 0:
        return
    s = st.path_s[0]
    direction = st.path_sense[0]
    if st.path_row[0] == st.clear_row[0] and direction * (st.clear_s[0] - s) > 0.0:
        return
    lane = st.path_lane[0]
    turns = preferred_road(p, st, road)
    rest = distance_to_lane_end(n, road, lane, s, LANE_END_HORIZON + LOOK_AGAIN, turns)
    along = distance_on_route(n, p, st, road, lane, s, LANE_END_HORIZON + LOOK_AGAIN)
    if along < rest:
        rest = along
        st.lane_leaves[0] = 1
    if rest >= LANE_END_HORIZON:
        st.clear_row[0] = st.path_row[0]
        st.clear_s[0] = s + direction * (rest - LANE_END_HORIZON)
        return
    base = p.entity_const[i]
    st.lane_end_distance[0] = max(rest - p.const[base + slot.E_CENTER] - 0.5 * p.const[base + slot.E_LENGTH], 0.0)
    for side in range(1, -2, -2):
        beside = neighbour_lane(n, road, lane, s, side, direction)
        if beside == 0 or lane_direction(n, road, beside, s) != direction:
            continue
        if is_drivable(lane_type(n, road, beside, s)) == 0:
            continue
        further = distance_to_lane_end(n, road, beside, s, LANE_END_HORIZON, turns)
        further = min(further, distance_on_route(n, p, st, road, beside, s, LANE_END_HORIZON))
        if further > rest + THROUGH_MORE:
            st.through_lane[0] = beside
            st.through_side[0] = side
            return


@compiled
def lane_closes(st: State) -> float:
    """Return the distance to the end of the lane, at which the ego must stop, m; FAR if it only leaves the route."""
    return op.FAR if st.lane_leaves[0] == 1 else st.lane_end_distance[0]


@compiled
def in_lane(st: State, j: int) -> int:
    """Return 1 if the box of an entity on the path reaches into the path's lane by more than the tolerance EDGE."""
    if st.on_way[j] == 1 and st.low[j] < st.border_left[j] - EDGE and st.high[j] > st.border_right[j] + EDGE:
        return 1
    return 0


@compiled
def gap_ahead_free(p: Program, st: State, i: int, front: float) -> int:
    """Return 1 if nothing in the searched lane is beside the ego or nearer ahead than the time gap requires."""
    rear = rear_of(p, i)
    keep = max(LEAST_GAP, p.const[slot.K_GAP_FRONT] * st.v[i])
    for j in range(p.entity_count[0]):
        if j != i and in_lane(st, j) == 1 and st.far[j] > -rear - LEAST_GAP and st.near[j] < front + keep:
            return 0
    return 1


@compiled
def gap_behind_free(p: Program, st: State, i: int) -> int:
    """Return 1 if nobody in the lane, searched backwards, approaches too fast from behind."""
    rear = rear_of(p, i)
    for j in range(p.entity_count[0]):
        if j != i and in_lane(st, j) == 1 and st.near[j] > rear:
            closing = max(-st.along[j] - st.v[i], 0.0)
            if st.near[j] - rear < max(LEAST_GAP, p.const[slot.K_GAP_REAR] * closing):
                return 0
    return 1


@compiled
def gap_is_free(n: RoadTables, p: Program, st: State, i: int, road: int, lane: int, s: float) -> int:
    """Return 1 if the ego may enter a lane beside it: by the time gap ahead, and by the time to close up behind.

    All vehicles count, because the side and rear sensors are assumed to be perfect. The function overwrites the
    measurements of the path ahead, and sets `used_beside` to 1 if there is anything but static objects in that lane.
    """
    st.used_beside[0] = 0
    front = front_of(p, i)
    for along in range(1, -2, -2):
        walk(n, st, road, lane, s, along, GAP_HORIZON, preferred_road(p, st, road))
        for j in range(p.entity_count[0]):
            st.on_way[j] = 0
            if j != i and length_of(st.x[j] - st.x[i], st.y[j] - st.y[i]) < GAP_HORIZON:
                measure_on_way(n, p, st, j)
                if p.entity_motion[j] != op.MOTION_STATIC:
                    st.used_beside[0] = max(st.used_beside[0], in_lane(st, j))
        free = gap_ahead_free(p, st, i, front) if along == 1 else gap_behind_free(p, st, i)
        if free == 0:
            return 0
    return 1
