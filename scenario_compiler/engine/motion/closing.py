"""The speed at which an entity approaches another entity or a point, measured as the distance between them is.

"Time to collision is calculated as the distance divided by the relative speed. For the relative speed calculation the
same coordinate system and relative distance type applies as for the distance calculation" (TimeToCollisionCondition,
ASAM OpenSCENARIO 1.1). esmini 3.6 takes the difference of speeds along the other entity's velocity instead. Rotations
of the axes and changes of velocity do not count. All speeds are in m/s.
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.numbers import length_of
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.distances import along_axis, along_or_beside
from scenario_compiler.engine.motion.tracks import nearest_on_track, track_followed, track_pose
from scenario_compiler.marker import compiled
from scenario_compiler.roads.geometry import road_curvature, road_heading
from scenario_compiler.roads.lanes import lane_centre
from scenario_compiler.roads.tables import RoadTables
from scenario_compiler.roads.travel import centre_length

LEAST_STRETCH = 0.1
"""Least ratio of a length beside the reference line of a bend to that on the line."""


@compiled
def road_speed(n: RoadTables, st: State, i: int, road: int, s: float, direction: int, measure: int, lane: int) -> float:
    """Return the change per second of an entity's s (1) or -s (-1) at s of a road, or of its t to the left of that.

    With a lane, it is the change along the lane's centre line instead of s.
    """
    h = road_heading(n, road, s)
    speed = direction * along_axis(h, st.velocity_x[i], st.velocity_y[i], measure)
    if measure != op.MEASURE_ALONG or st.road[i] != road:
        return speed
    curvature = road_curvature(n, road, s)
    speed = speed / max(1.0 - curvature * st.t[i], LEAST_STRETCH)
    if lane == 0:
        return speed
    centre, slope = lane_centre(n, road, lane, s)
    return speed * centre_length(curvature, centre, slope)


@compiled
def plane_closing(st: State, i: int, j: int, x: float, y: float, z: float, mode: int) -> float:
    """Return the speed of i relative to j (at rest without one) towards a point, or along or across the axes."""
    vx = st.velocity_x[i]
    vy = st.velocity_y[i]
    vz = st.velocity_z[i]
    if j >= 0:
        vx = vx - st.velocity_x[j]
        vy = vy - st.velocity_y[j]
        vz = vz - st.velocity_z[j]
    measure = mode % 4
    if measure == op.MEASURE_STRAIGHT:
        dx = x - st.x[i]
        dy = y - st.y[i]
        dz = z - st.z[i]
        return (vx * dx + vy * dy + vz * dz) / max(length_of(length_of(dx, dy), dz), op.TOLERANCE)
    return along_axis(st.h[i] if mode // 4 != op.FRAME_WORLD else 0.0, vx, vy, measure)


@compiled
def track_closing(p: Program, st: State, i: int, j: int, k: int, measure: int) -> float:
    """Return the speed of i relative to j along or across the trajectory on which action k leads i."""
    track = p.action_other[k]
    _, _, _, along = track_pose(p, st, track, st.action_a[k], 0)
    own = along_axis(along, st.velocity_x[i], st.velocity_y[i], measure)
    if j < 0:
        return own
    _, _, _, along = track_pose(p, st, track, nearest_on_track(p, st, track, st.x[j], st.y[j]), 0)
    return own - along_axis(along, st.velocity_x[j], st.velocity_y[j], measure)


@compiled
def road_closing(
    n: RoadTables, st: State, i: int, j: int, road: int, s: float, direction: int, measure: int, frame: int
) -> float:
    """Return the speed of i relative to j along or across their roads; `road`, `s`, `direction`: j's place for i."""
    in_lane = 1 if frame == op.FRAME_LANE else 0
    if st.road[i] >= 0:
        own = road_speed(n, st, i, st.road[i], st.s[i], st.facing[i], measure, in_lane * st.lane[i])
    else:
        own = road_speed(n, st, i, road, s, direction, measure, 0)
    if j < 0:
        return own
    lane = st.lane[i] if st.road[i] == road else st.lane[j]
    return own - road_speed(n, st, j, road, s, direction, measure, in_lane * lane)


@compiled
def approach_speed(
    n: RoadTables,
    p: Program,
    st: State,
    i: int,
    j: int,
    road: int,
    s: float,
    t: float,
    x: float,
    y: float,
    z: float,
    mode: int,
    gap: float,
) -> float:
    """Return the speed at which i approaches entity j or, if j is NONE, a point; negative if it moves away.

    `road`, `s`, `t`, `x`, `y` and `z` are the place of the entity or point, `gap` is the distance to it that
    `distance_between` or `distance_to` return for the same mode, less than FAR.
    """
    frame = mode // 4
    measure = mode % 4
    if measure == op.MEASURE_STRAIGHT:
        return plane_closing(st, i, j, x, y, z, mode)
    k = track_followed(p, st, i)
    if frame in (op.FRAME_ENTITY, op.FRAME_WORLD):
        closing = plane_closing(st, i, j, x, y, z, mode)
    elif frame == op.FRAME_TRAJECTORY and k >= 0:
        closing = track_closing(p, st, i, j, k, measure)
    else:
        _, _, direction, at_road, at_s = along_or_beside(n, st, i, road, s, t, x, y)
        closing = road_closing(n, st, i, j, at_road, at_s, direction, measure, frame)
    return closing if gap >= 0.0 else -closing
