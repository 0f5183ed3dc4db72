"""Following a trajectory: at the entity's own speed, or by the trajectory's times.

Without timing the distance along it grows by speed times step, and what is left over at its end goes straight on. With
timing the place is that of the time after the step, and the speed is what the entity has moved by, over the step. It
ends at its end, or at its last time. After esmini 3.6.
"""

from __future__ import annotations

from scenario_compiler.engine.numbers import heading_in_circle
from scenario_compiler.engine.opcodes import (
    FOLLOW_SMOOTHLY,
    MOTION_SCRIPTED,
    TIMING_ABSOLUTE,
    TIMING_NONE,
    TOLERANCE,
)
from scenario_compiler.engine.own_path import place_free
from scenario_compiler.engine.slots import J_BEGIN, J_OFFSET, J_SCALE
from scenario_compiler.engine.state import State
from scenario_compiler.engine.tables import Program
from scenario_compiler.engine.tracks import distance_at_time, fill_track, track_length, track_pose
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables


@compiled
def start_trajectory(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Lay the trajectory for its entity, which is on it from then on."""
    i = p.action_entity[k]
    if p.entity_motion[i] != MOTION_SCRIPTED:
        return
    fill_track(n, p, st, p.action_other[k], i)
    st.lateral[i] = k
    if p.action_mode[k] != TIMING_NONE:
        st.longitudinal[i] = k
    st.action_a[k] = p.const[p.action_const[k] + J_BEGIN]
    st.action_b[k] = 0.0
    st.ended[i] = 0


@compiled
def timed_distance(p: Program, st: State, k: int, dt: float) -> tuple[float, int]:
    """Return (distance along the trajectory, 1 where its last time has come) after dt."""
    track = p.action_other[k]
    base = p.action_const[k]
    st.action_b[k] += dt
    time = st.action_b[k]
    if p.action_mode[k] == TIMING_ABSOLUTE:
        time = st.clock[0] + dt
    scale = p.const[base + J_SCALE]
    time = (time - p.const[base + J_OFFSET]) / scale if abs(scale) > TOLERANCE else time
    last = p.track_vertex[track + 1] - 1
    over = 1 if time >= st.track_time[last] - TOLERANCE else 0
    return distance_at_time(p, st, track, time), over


@compiled
def step_trajectory(n: RoadTables, p: Program, st: State, k: int, dt: float) -> int:
    """Move an entity along its trajectory; return 1 where it has come to the end."""
    i = p.action_entity[k]
    if p.entity_motion[i] != MOTION_SCRIPTED:
        return 1
    track = p.action_other[k]
    smooth = 1 if p.action_flags[k] & FOLLOW_SMOOTHLY != 0 else 0
    before = st.action_a[k]
    done = 0
    if p.action_mode[k] == TIMING_NONE:
        s = before + st.v[i] * dt
        if s >= track_length(p, st, track) - TOLERANCE or s < -TOLERANCE:
            done = 1
    else:
        s, done = timed_distance(p, st, k, dt)
        if dt > 0.0:
            st.v[i] = (s - before) / dt
    st.action_a[k] = s
    x, y, h = track_pose(p, st, track, s, smooth)
    st.x[i] = x
    st.y[i] = y
    st.h[i] = heading_in_circle(h)
    place_free(n, st, i)
    st.moved[i] = 1
    return done
