"""The forward sensor: what is seen, how wide the path is, where the lane ends, whether the gap beside is free."""

from __future__ import annotations

from math import cos, pi, sin

from scenario_compiler.engine.ahead import measure_on_way, walk, walk_route
from scenario_compiler.engine.lane_changes import neighbour_lane
from scenario_compiler.engine.numbers import angle_between, bearing, clip, length_of
from scenario_compiler.engine.opcodes import FAR, SEEN_BY_SENSORS
from scenario_compiler.engine.path import preferred_road
from scenario_compiler.engine.presence import there_for
from scenario_compiler.engine.slots import (
    E_CENTER,
    E_LENGTH,
    E_WIDTH,
    K_BLOCKED_MARGIN,
    K_GAP_FRONT,
    K_GAP_REAR,
)
from scenario_compiler.engine.state import State
from scenario_compiler.engine.tables import Program
from scenario_compiler.marker import compiled
from scenario_compiler.roads.lane_types import is_drivable
from scenario_compiler.roads.lanes import lane_direction, lane_type
from scenario_compiler.roads.tables import RoadTables
from scenario_compiler.roads.travel import distance_to_lane_end

SLOW = 2.0
"""Speed along the way below which an entity blocks rather than leads, m/s."""

LANE_END_HORIZON = 300.0
"""How far ahead the end of the lane is looked for, m."""

THROUGH_MORE = 20.0
"""How much further than an ending lane the lane beside must go on, m."""

GAP_HORIZON = 150.0
"""How far ahead and behind vehicles in the lane beside are looked for, m."""

LEAST_GAP = 2.0
"""Distance to a vehicle in the lane beside that is never free, m."""


@compiled
def ray_free(p: Program, st: State, i: int, j: int, px: float, py: float, qx: float, qy: float) -> int:
    """Return 1 where no box but those of i and j cuts the segment from P to Q (slab test in each box's axes)."""
    rx = qx - px
    ry = qy - py
    squared = rx * rx + ry * ry
    for k in range(p.entity_count[0]):
        dx = px - st.middle_x[k]
        dy = py - st.middle_y[k]
        beside = dx * ry - dy * rx
        if beside * beside > st.reach[k] * st.reach[k] * squared:
            continue
        if k in (i, j) or there_for(st, k, SEEN_BY_SENSORS) == 0:
            continue
        c = cos(st.h[k])
        s = sin(st.h[k])
        u = dx * c + dy * s
        v = dy * c - dx * s
        du = rx * c + ry * s
        dv = ry * c - rx * s
        base = p.entity_const[k]
        long = 0.5 * p.const[base + E_LENGTH]
        wide = 0.5 * p.const[base + E_WIDTH]
        enter = 0.0
        leave = 1.0
        if abs(du) < 1.0e-9:
            if abs(u) > long:
                continue
        else:
            enter = max(enter, min((-long - u) / du, (long - u) / du))
            leave = min(leave, max((-long - u) / du, (long - u) / du))
        if abs(dv) < 1.0e-9:
            if abs(v) > wide:
                continue
        else:
            enter = max(enter, min((-wide - v) / dv, (wide - v) / dv))
            leave = min(leave, max((-wide - v) / dv, (wide - v) / dv))
        if enter < leave:
            return 0
    return 1


@compiled
def out_of_view(ahead: float, aside: float, reach: float, c_view: float, s_view: float) -> float:
    """Return how far a point lies outside a sensor's range and field of view, m, no more; not above 0 within both.

    The point is `ahead` of the sensor and `aside` of its axis; c_view and s_view are cosine and sine of half the angle.
    """
    beside = abs(aside) * c_view - ahead * s_view
    beyond = length_of(ahead, aside) - reach
    return beyond if beyond > beside else beside


@compiled
def outermost_corners(p: Program, st: State, i: int, j: int) -> tuple[float, float, float, float]:
    """Return (x, y of the left, x, y of the right one) of the corners of j's box that i sees furthest apart."""
    towards = bearing(st.middle_x[j] - st.x[i], st.middle_y[j] - st.y[i])
    c = cos(st.h[j])
    s = sin(st.h[j])
    base = p.entity_const[j]
    long = 0.5 * p.const[base + E_LENGTH]
    wide = 0.5 * p.const[base + E_WIDTH]
    most = -FAR
    least = FAR
    left_x = st.middle_x[j]
    left_y = st.middle_y[j]
    right_x = left_x
    right_y = left_y
    for corner in range(4):
        u = long if corner < 2 else -long
        v = wide if corner % 2 == 0 else -wide
        x = st.middle_x[j] + u * c - v * s
        y = st.middle_y[j] + u * s + v * c
        aside = angle_between(bearing(x - st.x[i], y - st.y[i]), towards)
        if aside > most:
            most = aside
            left_x = x
            left_y = y
        if aside < least:
            least = aside
            right_x = x
            right_y = y
    return left_x, left_y, right_x, right_y


@compiled
def sees(p: Program, st: State, i: int, j: int, reach: float, half_view: float) -> int:
    """Return 1 where the centre of j's box or one of its two outermost corners is seen from i's front bumper."""
    if there_for(st, j, SEEN_BY_SENSORS) == 0:
        return 0
    base = p.entity_const[i]
    front = p.const[base + E_CENTER] + 0.5 * p.const[base + E_LENGTH]
    c = cos(st.h[i])
    s = sin(st.h[i])
    view = clip(half_view, 0.0, pi)
    c_view = cos(view)
    s_view = sin(view)
    px = st.x[i] + front * c
    py = st.y[i] + front * s
    dx = st.middle_x[j] - px
    dy = st.middle_y[j] - py
    aside = out_of_view(dx * c + dy * s, dy * c - dx * s, reach, c_view, s_view)
    if aside > st.reach[j]:
        return 0
    if aside <= 0.0 and ray_free(p, st, i, j, px, py, px + dx, py + dy) == 1:
        return 1
    left_x, left_y, right_x, right_y = outermost_corners(p, st, i, j)
    dx = left_x - px
    dy = left_y - py
    aside = out_of_view(dx * c + dy * s, dy * c - dx * s, reach, c_view, s_view)
    if aside <= 0.0 and ray_free(p, st, i, j, px, py, left_x, left_y) == 1:
        return 1
    dx = right_x - px
    dy = right_y - py
    aside = out_of_view(dx * c + dy * s, dy * c - dx * s, reach, c_view, s_view)
    if aside <= 0.0 and ray_free(p, st, i, j, px, py, right_x, right_y) == 1:
        return 1
    return 0


@compiled
def foresee(st: State, i: int, j: int, front: float) -> None:
    """Shift the box of a slow, crossing or oncoming entity to the side by what it moves until i is there."""
    gap = st.near[j] - front
    if gap <= 0.0:
        return
    closing = max(st.v[i] - st.along[j], 1.0)
    shift = st.across[j] * gap / closing
    st.low[j] += shift
    st.high[j] += shift


@compiled
def look_ahead(n: RoadTables, p: Program, st: State, i: int, reach: float, view: float) -> None:
    """Measure every entity on the ego's way and tell which of those ahead are seen in a range and an angle of view."""
    base = p.entity_const[i]
    front = p.const[base + E_CENTER] + 0.5 * p.const[base + E_LENGTH]
    far = reach + 50.0
    walk_route(n, p, st, far)
    for j in range(p.entity_count[0]):
        st.seen[j] = 0
        st.on_way[j] = 0
        dx = st.x[j] - st.x[i]
        dy = st.y[j] - st.y[i]
        if j != i and dx * dx + dy * dy < far * far and measure_on_way(n, p, st, j) == 1 and st.far[j] >= front:
            if st.along[j] < SLOW:
                foresee(st, i, j, front)
            st.seen[j] = sees(p, st, i, j, reach, 0.5 * view)


@compiled
def obstructs(st: State, j: int, front: float) -> int:
    """Return 1 for a seen entity ahead on the way that is slow, crossing or oncoming."""
    if st.seen[j] == 1 and st.on_way[j] == 1 and st.along[j] < SLOW and st.far[j] > front:
        return 1
    return 0


@compiled
def gap_between(
    p: Program, st: State, j: int, front: float, size: float, right: float, left: float, need: float, wish: float
) -> tuple[int, float, float]:
    """Return (found, centre, width) of a gap between `right` and `left` beside entity j and all that stands with it.

    Of the gaps at least `need` wide, the one is taken whose admissible centre lies nearest to `wish`; with none,
    found is 0 and width is that of the widest. Whatever stands within the ego's length `size` of j counts with it.
    """
    found = 0
    best = 0.0
    widest = 0.0
    for c in range(-1, p.entity_count[0]):
        start = right
        if c >= 0:
            if obstructs(st, c, front) == 0 or st.near[c] > st.far[j] + size or st.far[c] < st.near[j] - size:
                continue
            start = max(st.high[c], right)
        end = left
        for k in range(p.entity_count[0]):
            if obstructs(st, k, front) == 1 and st.near[k] <= st.far[j] + size and st.far[k] >= st.near[j] - size:
                if st.low[k] <= start and st.high[k] > start:
                    end = start
                elif st.low[k] > start and st.low[k] < end:
                    end = st.low[k]
        width = max(end - start, 0.0)
        if width >= need:
            centre = min(max(wish, start + 0.5 * need), end - 0.5 * need)
            if found == 0 or abs(centre - wish) < abs(best - wish):
                best = centre
                found = 1
        widest = max(widest, width)
    return found, best, widest


@compiled
def find_block(p: Program, st: State, i: int) -> int:
    """Write where the path is first blocked; return the entity that blocks it, -1 for a free path.

    It is blocked where the widest gap that the seen obstacles leave between the lane's borders is less than the ego's
    width and the margin.
    """
    base = p.entity_const[i]
    size = p.const[base + E_LENGTH]
    front = p.const[base + E_CENTER] + 0.5 * size
    need = p.const[base + E_WIDTH] + p.const[K_BLOCKED_MARGIN]
    st.blocked_distance[0] = FAR
    st.blocked_far[0] = FAR
    blocker = -1
    for j in range(p.entity_count[0]):
        if obstructs(st, j, front) == 0:
            continue
        left = st.border_left[j]
        right = st.border_right[j]
        if st.low[j] >= left or st.high[j] <= right or st.near[j] - front >= st.blocked_distance[0]:
            continue
        found, _, _ = gap_between(p, st, j, front, size, right, left, need, 0.0)
        if found == 0:
            st.blocked_distance[0] = max(st.near[j] - front, 0.0)
            blocker = j
    if blocker >= 0:
        far = st.far[blocker]
        for j in range(p.entity_count[0]):
            if obstructs(st, j, front) == 1 and st.near[j] <= st.far[blocker] + size and st.far[j] > far:
                far = st.far[j]
        st.blocked_far[0] = far - front
    return blocker


@compiled
def find_lane_end(n: RoadTables, p: Program, st: State, i: int) -> None:
    """Write how far the path's lane goes on, and which lane beside it goes on further, where one does."""
    st.lane_end_distance[0] = FAR
    st.through_lane[0] = 0
    st.through_side[0] = 0
    road = st.path_road[0]
    if road < 0:
        return
    lane = st.path_lane[0]
    s = st.path_s[0]
    turns = preferred_road(p, st, road)
    rest = distance_to_lane_end(n, road, lane, s, LANE_END_HORIZON, turns)
    if rest >= LANE_END_HORIZON:
        return
    base = p.entity_const[i]
    st.lane_end_distance[0] = max(rest - p.const[base + E_CENTER] - 0.5 * p.const[base + E_LENGTH], 0.0)
    direction = lane_direction(n, road, lane)
    for side in range(1, -2, -2):
        beside = neighbour_lane(n, road, lane, s, side, direction)
        if beside == 0 or lane_direction(n, road, beside) != direction:
            continue
        if is_drivable(lane_type(n, road, beside, s)) == 0:
            continue
        if distance_to_lane_end(n, road, beside, s, LANE_END_HORIZON, turns) > rest + THROUGH_MORE:
            st.through_lane[0] = beside
            st.through_side[0] = side
            return


@compiled
def in_lane(st: State, j: int) -> int:
    """Return 1 where the box of an entity on the way reaches into the way's lane."""
    if st.on_way[j] == 1 and st.low[j] < st.border_left[j] and st.high[j] > st.border_right[j]:
        return 1
    return 0


@compiled
def gap_ahead_free(p: Program, st: State, i: int, front: float) -> int:
    """Return 1 where nothing in the walked lane is beside the ego or nearer ahead than the time gap asks for."""
    base = p.entity_const[i]
    rear = 0.5 * p.const[base + E_LENGTH] - p.const[base + E_CENTER]
    keep = max(LEAST_GAP, p.const[K_GAP_FRONT] * st.v[i])
    for j in range(p.entity_count[0]):
        if j != i and in_lane(st, j) == 1 and st.far[j] > -rear - LEAST_GAP and st.near[j] < front + keep:
            return 0
    return 1


@compiled
def gap_behind_free(p: Program, st: State, i: int) -> int:
    """Return 1 where nobody in the lane walked backwards closes up too soon."""
    base = p.entity_const[i]
    rear = 0.5 * p.const[base + E_LENGTH] - p.const[base + E_CENTER]
    for j in range(p.entity_count[0]):
        if j != i and in_lane(st, j) == 1 and st.near[j] > rear:
            closing = max(-st.along[j] - st.v[i], 0.0)
            if st.near[j] - rear < max(LEAST_GAP, p.const[K_GAP_REAR] * closing):
                return 0
    return 1


@compiled
def gap_is_free(n: RoadTables, p: Program, st: State, i: int, road: int, lane: int, s: float) -> int:
    """Return 1 where the ego may enter a lane beside it: front by time gap, behind by the time to close up.

    All vehicles count: the sensors to the side and behind are taken as perfect. Writes the scratch columns anew.
    """
    base = p.entity_const[i]
    front = p.const[base + E_CENTER] + 0.5 * p.const[base + E_LENGTH]
    for along in range(1, -2, -2):
        walk(n, st, road, lane, s, along, GAP_HORIZON, preferred_road(p, st, road))
        for j in range(p.entity_count[0]):
            st.on_way[j] = 0
            if j != i and length_of(st.x[j] - st.x[i], st.y[j] - st.y[i]) < GAP_HORIZON:
                measure_on_way(n, p, st, j)
        free = gap_ahead_free(p, st, i, front) if along == 1 else gap_behind_free(p, st, i)
        if free == 0:
            return 0
    return 1
