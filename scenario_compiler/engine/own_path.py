"""Moving on a path of one's own: straight lines over points of the plane, by speed or by the points' times.

The entity's place on the road is looked up at each step, so that conditions and sensors know where it is; beside all
roads it has none.
"""

from __future__ import annotations

from math import pi

from scenario_compiler.engine.faults import fault
from scenario_compiler.engine.motion import settle
from scenario_compiler.engine.numbers import angle_between, bearing, clip, heading_in_circle, length_of
from scenario_compiler.engine.opcodes import FAR, FAULT_OFF_ROAD_START, MOTION_SCRIPTED, TOLERANCE
from scenario_compiler.engine.path import leave_road, note_lane
from scenario_compiler.engine.slots import G_TIME
from scenario_compiler.engine.state import State
from scenario_compiler.engine.tables import Program
from scenario_compiler.marker import compiled
from scenario_compiler.roads.lanes import lane_at, lane_direction, lane_pose
from scenario_compiler.roads.locate import track
from scenario_compiler.roads.tables import RoadTables


@compiled
def place_free(n: RoadTables, st: State, i: int) -> None:
    """Find the road and lane below an entity that moves freely, and what would lead it along the lane from here."""
    found, road, s, t = track(n, st.x[i], st.y[i], st.road[i], st.s[i])
    lane = 0
    if found == 1:
        lane = lane_at(n, road, s, t)
    if lane == 0:
        leave_road(st, i)
        return
    note_lane(n, st, i, road, s, t, lane)
    st.kept_lane[i] = lane
    st.kept_off[i] = st.off[i]
    _, _, _, along, _, _ = lane_pose(n, road, lane, s, st.off[i])
    direction = lane_direction(n, road, lane)
    away = angle_between(st.h[i], along if direction > 0 else along + pi)
    st.facing[i] = direction
    st.turn[i] = away
    if abs(away) > 0.5 * pi:
        st.facing[i] = -direction
        st.turn[i] = angle_between(away, pi)
    settle(n, st, i)


@compiled
def path_goes_on(p: Program, st: State, k: int, i: int, progress: float) -> int:
    """Put the entity where its path is after a distance, or a time, and say (1) that it goes on beyond or (0) not.

    Legs without length, or without time, are passed at once.
    """
    first = p.action_point[k]
    last = first + p.action_points[k]
    timed = 1 if p.const[p.point_const[first] + G_TIME] >= 0.0 else 0
    x = st.action_x[k]
    y = st.action_y[k]
    begin = 0.0
    for q in range(first, last):
        at = p.point_position[q]
        dx = st.position_x[at] - x
        dy = st.position_y[at] - y
        far = length_of(dx, dy)
        end = begin + far
        if timed == 1:
            end = max(begin, p.const[p.point_const[q] + G_TIME])
        span = end - begin
        if progress < end - TOLERANCE or q == last - 1:
            share = clip((progress - begin) / span, 0.0, 1.0) if span > TOLERANCE else 1.0
            st.x[i] = x + share * dx
            st.y[i] = y + share * dy
            if far > TOLERANCE:
                st.h[i] = heading_in_circle(bearing(dx, dy))
            if timed == 1:
                st.v[i] = far / span if span > TOLERANCE else 0.0
            return 1 if progress < end - TOLERANCE else 0
        x = x + dx
        y = y + dy
        begin = end
    return 0


@compiled
def start_follow_path(p: Program, st: State, k: int) -> None:
    """Begin a path where its entity is; one that stood at the end of another walks again."""
    i = p.action_entity[k]
    if p.entity_motion[i] != MOTION_SCRIPTED:
        return
    for q in range(p.action_point[k], p.action_point[k] + p.action_points[k]):
        if st.position_x[p.point_position[q]] >= FAR:
            fault(st, FAULT_OFF_ROAD_START, i)
    st.action_x[k] = st.x[i]
    st.action_y[k] = st.y[i]
    st.lateral[i] = k
    st.ended[i] = 0
    speed = p.const[p.action_const[k]]
    if speed >= 0.0:
        st.v[i] = speed


@compiled
def step_follow_path(n: RoadTables, p: Program, st: State, k: int, dt: float) -> int:
    """Move an entity on along its path; return 1 where it has come to the end."""
    i = p.action_entity[k]
    if p.entity_motion[i] != MOTION_SCRIPTED or p.action_points[k] <= 0:
        return 1
    by_time = p.const[p.point_const[p.action_point[k]] + G_TIME] >= 0.0
    st.action_progress[k] += dt if by_time else max(st.v[i], 0.0) * dt
    goes_on = path_goes_on(p, st, k, i, st.action_progress[k])
    place_free(n, st, i)
    st.moved[i] = 1
    if goes_on == 1:
        return 0
    if p.action_drives_on[k] == 1 and st.road[i] >= 0:
        st.turn[i] = 0.0
    else:
        st.v[i] = 0.0
        st.ended[i] = 1
    return 1
