"""What is measured of every entity after each step for the conditions that ask for it.

How long it has stood, been off the roads or stood at the end of one: time since it was first so, -1 while it is not.
Velocity and acceleration are differences of positions over a step, as in esmini 3.6; in the frame of length 0 and
after a leap they are those of the speed along the heading.
"""

from __future__ import annotations

from math import cos, sin

from scenario_compiler.engine.numbers import length_of
from scenario_compiler.engine.opcodes import AT_REST
from scenario_compiler.engine.state import State
from scenario_compiler.engine.tables import Program
from scenario_compiler.marker import compiled
from scenario_compiler.roads.lane_types import is_road
from scenario_compiler.roads.lanes import lane_at, lane_type
from scenario_compiler.roads.tables import RoadTables

WATCH_MOTION = 1
WATCH_OFF_ROAD = 2
"""Bits of `Program.watches`: what some condition asks for."""

LEAP = 3.0
"""How many times farther than its speed takes it an entity has moved that was put somewhere else."""


@compiled
def held_for(so: int, before: float, dt: float) -> float:
    """Return how long something has been so, from how long it had been before; -1 while it is not."""
    if so == 0:
        return -1.0
    return 0.0 if before < 0.0 else before + dt


@compiled
def is_off_road(n: RoadTables, st: State, i: int) -> int:
    """Return 1 where an entity's reference point lies on no lane of any road, or on one of the type none (esmini)."""
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
def measure_motion(st: State, i: int, dt: float) -> None:
    """Take an entity's velocity and acceleration."""
    x = st.v[i] * cos(st.pitch[i]) * cos(st.h[i])
    y = st.v[i] * cos(st.pitch[i]) * sin(st.h[i])
    z = -st.v[i] * sin(st.pitch[i])
    if dt > 0.0:
        moved_x = st.x[i] - st.before_x[i]
        moved_y = st.y[i] - st.before_y[i]
        moved_z = st.z[i] - st.before_z[i]
        if length_of(moved_x, moved_y) <= LEAP * abs(st.v[i]) * dt + 0.1:
            x = moved_x / dt
            y = moved_y / dt
            z = moved_z / dt
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
def watch_entities(n: RoadTables, p: Program, st: State, dt: float) -> None:
    """Take the measures of all entities that are there; one is at its road's end from the step that took it there."""
    for i in range(p.entity_count[0]):
        if st.present[i] == 0:
            continue
        st.still[i] = held_for(1 if abs(st.v[i]) < AT_REST else 0, st.still[i], dt)
        at_end = st.ended[i] if st.road[i] >= 0 else 0
        st.at_end[i] = held_for(at_end, max(st.at_end[i], 0.0), dt)
        if p.watches[0] & WATCH_OFF_ROAD != 0:
            st.off_road[i] = held_for(is_off_road(n, st, i), st.off_road[i], dt)
        if p.watches[0] & WATCH_MOTION != 0:
            measure_motion(st, i, dt)


@compiled
def begin_watches(p: Program, st: State) -> None:
    """Take the motion that entities begin with, once the init's actions have set it."""
    if p.watches[0] & WATCH_MOTION != 0:
        for i in range(p.entity_count[0]):
            measure_motion(st, i, 0.0)


@compiled
def reset_watches(p: Program, st: State) -> None:
    """Begin with nothing measured."""
    for i in range(p.entity_count[0]):
        st.still[i] = -1.0
        st.at_end[i] = -1.0
        st.off_road[i] = -1.0
        st.velocity_x[i] = 0.0
        st.velocity_y[i] = 0.0
        st.velocity_z[i] = 0.0
        st.acceleration_x[i] = 0.0
        st.acceleration_y[i] = 0.0
        st.acceleration_z[i] = 0.0
        st.before_x[i] = 0.0
        st.before_y[i] = 0.0
        st.before_z[i] = 0.0
