"""Lane keeping by the map: pure pursuit of the path with a planned offset, and pedals from an acceleration.

Pure pursuit is Coulter's (1992, CMU-RI-TR-92-01): steer = atan(2 L sin(alpha) / d) towards a point of the path at the
distance d. A lateral move is planned over the distance driven: a cosine from one offset to another between two odometer
readings.
"""

from __future__ import annotations

from math import atan, cos, pi, sin

from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.numbers import clip, safe_sqrt
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.collision import face
from scenario_compiler.engine.motion.path import path_ahead
from scenario_compiler.marker import compiled
from scenario_compiler.roads.geometry import road_piece_at
from scenario_compiler.roads.lanes import lane_direction, row_place
from scenario_compiler.roads.tables import RoadTables

PREVIEW_TIME = 0.8
PREVIEW_LEAST = 5.0
PREVIEW_MOST = 25.0
"""Distance to the preview point: the distance driven in PREVIEW_TIME, s, within these limits, m; chosen."""

CREEP = 0.2
HOLD = 0.1
HOLD_BRAKE = 1.0
"""Below the speed CREEP, m/s, a wanted acceleration below HOLD, m/s2, means to stand; then HOLD_BRAKE is applied;
chosen.
"""

SHIFT_PEAK = 4.934802200544679
"""pi^2 / 2: peak lateral acceleration of a cosine move of 1 m in 1 s, m/s2."""


@compiled
def planned_offset(st: State, odometer: float) -> float:
    """Return the planned offset from the path lane's centre at an odometer reading, m, positive to the left."""
    span = st.shift_end[0] - st.shift_begin[0]
    gone = odometer - st.shift_begin[0]
    if gone >= span or span <= 0.0:
        return st.shift_to[0]
    if gone <= 0.0:
        return st.shift_from[0]
    return st.shift_from[0] + (st.shift_to[0] - st.shift_from[0]) * 0.5 * (1.0 - cos(pi * gone / span))


@compiled
def shift_distance(v: float, change: float, acceleration: float) -> float:
    """Return the distance over which a change of offset keeps a lateral acceleration, m; at least twice the change."""
    time = safe_sqrt(SHIFT_PEAK * abs(change) / max(acceleration, 0.1))
    return max(v * time, 2.0 * abs(change) + 0.1)


@compiled
def plan_shift(st: State, i: int, target: float, distance: float) -> None:
    """Plan a move from the present offset to `target` over a distance from here, m."""
    st.shift_from[0] = st.path_off[0]
    st.shift_to[0] = target
    st.shift_begin[0] = st.odometer[i]
    st.shift_end[0] = st.odometer[i] + distance


@compiled
def preview_distance(st: State, i: int) -> float:
    """Return the distance to the preview point, m."""
    return clip(PREVIEW_TIME * st.v[i], PREVIEW_LEAST, PREVIEW_MOST)


@compiled
def path_point(
    n: RoadTables, p: Program, st: State, i: int, ahead: float, gone: float, aside: float
) -> tuple[float, float]:
    """Return the point (x, y) of the path `ahead` m ahead.

    Its offset is `aside` plus the one that is planned for when `gone` more metres have been driven.
    """
    road, lane, row, s, rest = path_ahead(n, p, st, ahead)
    direction = st.path_sense[0] if row == st.path_row[0] else lane_direction(n, road, lane, s)
    off = direction * (planned_offset(st, st.odometer[i] + gone) + aside)
    x, y, _, h, _, _, _ = row_place(n, road, row, road_piece_at(n, road, s), s, off)
    if rest > 0.0:
        x = x + direction * rest * cos(h)
        y = y + direction * rest * sin(h)
    return x, y


@compiled
def aim(p: Program, st: State, i: int, ahead: float, aside: float, most: float) -> float:
    """Return the angle of the front wheels that leads to a point ahead and to the left in the vehicle's axes, rad.

    `most` limits the lateral acceleration, m/s2.
    """
    squared = ahead * ahead + aside * aside
    if squared < 0.25:
        return 0.0
    if ahead < 0.0:
        aside = safe_sqrt(squared) if aside > 0.0 else -safe_sqrt(squared)
    sharpest = most / max(st.v[i] * st.v[i], 1.0)
    base = p.entity_const[i]
    angle = atan(p.const[base + slot.E_WHEELBASE] * clip(2.0 * aside / squared, -sharpest, sharpest))
    return clip(angle, -p.const[base + slot.E_MAX_STEER], p.const[base + slot.E_MAX_STEER])


@compiled
def pursuit_angle(n: RoadTables, p: Program, st: State, i: int, most: float) -> float:
    """Return the angle of the front wheels that follows the path with its planned offset plus `st.aside`, rad.

    `most` limits the lateral acceleration, m/s2.
    """
    if st.path_road[0] < 0:
        return 0.0
    preview = preview_distance(st, i)
    x, y = path_point(n, p, st, i, preview, preview, st.aside[0])
    dx = x - st.x[i]
    dy = y - st.y[i]
    face(st, i)
    c = st.box_cos[i]
    w = st.box_sin[i]
    return aim(p, st, i, dx * c + dy * w, dy * c - dx * w, most)


@compiled
def command_angle(p: Program, st: State, i: int, angle: float) -> None:
    """Command an angle of the front wheels, rad."""
    limit = p.const[p.entity_const[i] + slot.E_MAX_STEER]
    st.command_steer[i] = clip(angle / limit, -1.0, 1.0) if limit > 0.0 else 0.0


@compiled
def come_to_rest(v: float, wanted: float) -> float:
    """Return the acceleration to command, m/s2: a creeping vehicle that is not to accelerate is stopped and held."""
    if v < CREEP and wanted < HOLD:
        return -HOLD_BRAKE
    return wanted


@compiled
def command_acceleration(p: Program, st: State, i: int, acceleration: float) -> None:
    """Command an acceleration by throttle or brake, m/s2."""
    base = p.entity_const[i]
    st.command_throttle[i] = 0.0
    st.command_brake[i] = 0.0
    st.pedal[0] = acceleration
    if acceleration >= 0.0:
        most = p.const[base + slot.E_MAX_ACCELERATION]
        if most > 0.0:
            st.command_throttle[i] = min(acceleration / most, 1.0)
    else:
        most = p.const[base + slot.E_MAX_DECELERATION]
        if most > 0.0:
            st.command_brake[i] = min(-acceleration / most, 1.0)
