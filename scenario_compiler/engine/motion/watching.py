"""Quantities of entities that are measured after each step because conditions use them.

The times of standing, of being off the roads and of standing at the end of a road count from the first step in which
this holds; they are -1 while it does not. Velocity and acceleration are differences of positions over a step, as in
esmini 3.6; at the start and after a leap they are computed from the speed along the heading.
"""

from __future__ import annotations

from math import cos, sin, sqrt, tan

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.numbers import clip
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.marker import compiled
from scenario_compiler.roads.lane_types import is_road
from scenario_compiler.roads.lanes import lane_at, lane_type
from scenario_compiler.roads.tables import RoadTables

WATCH_MOTION = 1
WATCH_ACCELERATION = 2
WATCH_STILL = 4
WATCH_OFF_ROAD = 8
WATCH_AT_END = 16
"""Bits of `Program.watches`: quantities that conditions use. The acceleration needs the motion; the times come last."""

STEEPEST = 1.0
"""Greatest pitch that counts as that of the ground, rad; chosen."""

LEAP = 3.0
"""A displacement of more than this many times the speed times the step is a leap: the entity was put somewhere else."""


@compiled
def held_for(so: int, before: float, dt: float) -> float:
    """Return how long a state has held, s, from the duration before the step; -1 while it does not hold."""
    if so == 0:
        return -1.0
    return 0.0 if before < 0.0 else before + dt


@compiled
def is_off_road(n: RoadTables, st: State, i: int) -> int:
    """Return 1 if an entity's reference point lies on no lane of any road, or on a lane of the type "none" (esmini)."""
    road = st.road[i]
    if road < 0:
        return 1
    if abs(st.t[i]) < 1.0e-9:
        return 0
    lane = lane_at(n, road, st.s[i], st.t[i])
    if lane == 0:
        return 1
    return 1 - is_road(lane_type(n, road, lane, st.s[i]))


@compiled
def heads_at_speed(v: float, heading: float, pitch: float) -> tuple[float, float, float]:
    """Return the velocity (x, y, z), m/s, at a speed in the plane along a heading; `pitch` is that of the ground."""
    slope = clip(pitch, -STEEPEST, STEEPEST)
    return v * cos(heading), v * sin(heading), -v * tan(slope)


@compiled
def farthest_without_leap(v: float, dt: float) -> float:
    """Return the greatest displacement in a step that is not a leap, m."""
    return LEAP * abs(v) * dt + 0.1


@compiled
def measure_motion(st: State, i: int, watches: int, dt: float) -> None:
    """Write an entity's velocity, and its acceleration if a condition uses it."""
    x = st.x[i] - st.before_x[i]
    y = st.y[i] - st.before_y[i]
    z = st.z[i] - st.before_z[i]
    if dt > 0.0 and sqrt(x * x + y * y) <= farthest_without_leap(st.v[i], dt):
        x = x / dt
        y = y / dt
        z = z / dt
    else:
        x, y, z = heads_at_speed(st.v[i], st.h[i], st.pitch[i] - st.body_pitch[i])
    if watches & WATCH_ACCELERATION != 0 and dt > 0.0:
        st.acceleration_x[i] = (x - st.velocity_x[i]) / dt
        st.acceleration_y[i] = (y - st.velocity_y[i]) / dt
        st.acceleration_z[i] = (z - st.velocity_z[i]) / dt
    st.velocity_x[i] = x
    st.velocity_y[i] = y
    st.velocity_z[i] = z
    st.before_x[i] = st.x[i]
    st.before_y[i] = st.y[i]
    st.before_z[i] = st.z[i]


@compiled
def watch_entity(n: RoadTables, st: State, i: int, watches: int, dt: float) -> None:
    """Update the times of a present entity; it is at its road's end from the step that took it there."""
    if watches & WATCH_STILL != 0:
        st.still[i] = held_for(1 if abs(st.v[i]) < op.AT_REST else 0, st.still[i], dt)
    if watches & WATCH_AT_END != 0:
        at_end = st.ended[i] if st.road[i] >= 0 else 0
        st.at_end[i] = held_for(at_end, max(st.at_end[i], 0.0), dt)
    if watches & WATCH_OFF_ROAD != 0:
        st.off_road[i] = held_for(is_off_road(n, st, i), st.off_road[i], dt)


@compiled
def begin_watches(p: Program, st: State) -> None:
    """Write the initial motion of the entities, after the actions of the init have set it."""
    if p.watches[0] & WATCH_MOTION != 0:
        for i in range(p.entity_count[0]):
            measure_motion(st, i, WATCH_MOTION, 0.0)
