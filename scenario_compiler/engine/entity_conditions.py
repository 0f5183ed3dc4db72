"""Conditions on an entity: what they measure of it, on the states before the step.

As in esmini 3.6, what is not defined (the time gap to an entity behind, the time to a collision that does not come)
fulfils no condition, and where no road leads to is far away.
"""

from __future__ import annotations

from math import cos, pi, sin

from scenario_compiler.engine.clearance import is_clear
from scenario_compiler.engine.collision import overlap
from scenario_compiler.engine.comparing import compare
from scenario_compiler.engine.distances import distance_between, distance_to
from scenario_compiler.engine.faults import fault
from scenario_compiler.engine.numbers import angle_between, length_of, safe_sqrt
from scenario_compiler.engine.on_tracks import point_at
from scenario_compiler.engine.opcodes import (
    ANGLE_HEADING,
    ANGLE_PITCH,
    CONDITION_ACCELERATION,
    CONDITION_ANGLE,
    CONDITION_CLEARANCE,
    CONDITION_COLLISION,
    CONDITION_DISTANCE,
    CONDITION_END_OF_ROAD,
    CONDITION_POSITION_DISTANCE,
    CONDITION_RELATIVE_ANGLE,
    CONDITION_RELATIVE_SPEED,
    CONDITION_SPEED,
    CONDITION_STANDSTILL,
    CONDITION_TIME_HEADWAY,
    CONDITION_TIME_TO_COLLISION,
    CONDITION_TRAVELED_DISTANCE,
    CONDITIONS_BETWEEN,
    CONDITIONS_OF_STATE,
    FAR,
    FAULT_UNKNOWN_CONDITION,
    FIRST_TIME_MEASURED,
    FRAME_ENTITY,
    FRAME_ROAD,
    FRAME_WORLD,
    LAST_TIME_MEASURED,
    PART_ACROSS,
    PART_ALONG,
    PART_TOTAL,
    TOLERANCE,
)
from scenario_compiler.engine.slots import C_TOLERANCE, C_VALUE
from scenario_compiler.engine.state import State
from scenario_compiler.engine.tables import Program
from scenario_compiler.marker import compiled
from scenario_compiler.roads.lanes import lane_direction, lane_pose
from scenario_compiler.roads.tables import RoadTables


@compiled
def headway(n: RoadTables, p: Program, st: State, c: int, i: int) -> float:
    """Return the time gap to the other entity ahead, s; -1 where it is behind, or i stands or drives backwards."""
    gap = distance_between(n, p, st, i, p.condition_other[c], p.condition_mode[c], p.condition_flags[c] & 1)
    if gap < 0.0 or st.v[i] < TOLERANCE:
        return -1.0
    return min(gap / st.v[i], FAR)


@compiled
def closing_speed(st: State, i: int, j: int) -> float:
    """Return how fast entity i comes up to j: the difference of speeds along the velocity of j (esmini 3.6), m/s.

    Where j stands, or is none, it is the speed of i.
    """
    if j < 0:
        return st.v[i]
    speed = length_of(st.velocity_x[j], st.velocity_y[j])
    if speed < TOLERANCE:
        return st.v[i]
    along = (st.velocity_x[i] * st.velocity_x[j] + st.velocity_y[i] * st.velocity_y[j]) / speed
    closing = along - abs(st.v[j]) if along >= 0.0 else abs(st.v[j]) - along
    return closing if st.v[i] >= 0.0 else -closing


@compiled
def time_to_collision(n: RoadTables, p: Program, st: State, c: int, i: int) -> float:
    """Return the distance to the other entity, or the position, over the closing speed, s; -1 where there is none."""
    other = p.condition_other[c]
    if other >= 0:
        gap = distance_between(n, p, st, i, other, p.condition_mode[c], p.condition_flags[c] & 1)
    else:
        gap = distance_to(n, p, st, i, p.condition_position[c], p.condition_mode[c], p.condition_flags[c] & 1)
    closing = closing_speed(st, i, other)
    if abs(gap) < TOLERANCE or abs(closing) < TOLERANCE:
        return -1.0
    time = gap / closing
    return min(time, FAR) if time >= 0.0 else -1.0


@compiled
def part_of(st: State, i: int, x: float, y: float, z: float, part: int) -> float:
    """Return the part of a vector of the world that is asked for, in an entity's own axes, or the vector's length."""
    if part == PART_ALONG:
        return x * cos(st.h[i]) + y * sin(st.h[i])
    if part == PART_ACROSS:
        return y * cos(st.h[i]) - x * sin(st.h[i])
    if part == PART_TOTAL:
        return safe_sqrt(x * x + y * y + z * z)
    return z


@compiled
def relative_speed(st: State, i: int, j: int, part: int) -> float:
    """Return how much faster i is than j: by their speeds, or by a part of the relative velocity in i's axes."""
    if part == PART_TOTAL:
        return st.v[i] - st.v[j]
    x = st.velocity_x[i] - st.velocity_x[j]
    y = st.velocity_y[i] - st.velocity_y[j]
    return part_of(st, i, x, y, st.velocity_z[i] - st.velocity_z[j], part)


@compiled
def touches(p: Program, st: State, c: int, i: int) -> int:
    """Return 1 where the box of i overlaps that of the entity meant, or of any of the kind that is meant."""
    other = p.condition_other[c]
    if other >= 0:
        return overlap(p, st, i, other)
    kind = p.condition_mode[c]
    for j in range(p.entity_count[0]):
        if j != i and (kind == 0 or p.entity_type[j] == kind) and overlap(p, st, i, j) == 1:
            return 1
    return 0


@compiled
def own_angle(st: State, i: int, kind: int) -> float:
    """Return an entity's heading, pitch or roll in the world."""
    if kind == ANGLE_HEADING:
        return st.h[i]
    return st.pitch[i] if kind == ANGLE_PITCH else st.roll[i]


@compiled
def angle_of(n: RoadTables, st: State, i: int, kind: int, frame: int) -> float:
    """Return an entity's angle in the world, or against the road (along s) or the lane (its travel) below it."""
    angle = own_angle(st, i, kind)
    if frame in (FRAME_WORLD, FRAME_ENTITY) or st.road[i] < 0:
        return angle
    _, _, _, h, pitch, roll = lane_pose(n, st.road[i], st.lane[i], st.s[i], st.off[i])
    sense = 1.0
    if frame != FRAME_ROAD and lane_direction(n, st.road[i], st.lane[i]) < 0:
        h = h + pi
        sense = -1.0
    if kind == ANGLE_HEADING:
        return angle - h
    return angle - sense * (pitch if kind == ANGLE_PITCH else roll)


@compiled
def angle_holds(p: Program, c: int, angle: float) -> int:
    """Return 1 where an angle is the condition's, within its tolerance."""
    base = p.condition_const[c]
    away = abs(angle_between(angle, p.const[base + C_VALUE]))
    return 1 if away <= p.const[base + C_TOLERANCE] + TOLERANCE else 0


@compiled
def state_holds(n: RoadTables, p: Program, st: State, c: int, i: int) -> int:
    """Return 1 where a condition on an entity that compares no single number holds for entity i."""
    op = p.condition_op[c]
    if op == CONDITION_COLLISION:
        return touches(p, st, c, i)
    if op == CONDITION_CLEARANCE:
        return is_clear(n, p, st, c, i)
    if op == CONDITION_ANGLE:
        return angle_holds(p, c, angle_of(n, st, i, p.condition_mode[c] % 4, p.condition_mode[c] // 4))
    if op == CONDITION_RELATIVE_ANGLE:
        other = p.condition_other[c]
        if st.present[other] == 0:
            return 0
        kind = p.condition_mode[c]
        return angle_holds(p, c, own_angle(st, other, kind) - own_angle(st, i, kind))
    fault(st, FAULT_UNKNOWN_CONDITION, c)
    return 0


@compiled
def measured_between(n: RoadTables, p: Program, st: State, c: int, i: int) -> float:
    """Return what a condition measures between entity i and another or a position; FAR where no road leads there.

    Times are -1 where they are not defined.
    """
    op = p.condition_op[c]
    mode = p.condition_mode[c]
    freespace = p.condition_flags[c] & 1
    if op == CONDITION_TIME_HEADWAY:
        return headway(n, p, st, c, i)
    if op == CONDITION_TIME_TO_COLLISION:
        return time_to_collision(n, p, st, c, i)
    if op == CONDITION_DISTANCE:
        return abs(distance_between(n, p, st, i, p.condition_other[c], mode, freespace))
    if op == CONDITION_POSITION_DISTANCE:
        return abs(distance_to(n, p, st, i, p.condition_position[c], mode, freespace))
    if op == CONDITION_RELATIVE_SPEED:
        return relative_speed(st, i, p.condition_other[c], mode)
    found, x, y = point_at(n, p, st, p.condition_position[c], i)
    if found == 0:
        return FAR
    return length_of(st.x[i] - x, st.y[i] - y)


@compiled
def measured_of(st: State, op: int, mode: int, i: int) -> float:
    """Return what a condition measures of entity i alone; times are -1 while what they count is not so."""
    if op == CONDITION_SPEED:
        if mode == PART_TOTAL:
            return st.v[i]
        return part_of(st, i, st.velocity_x[i], st.velocity_y[i], st.velocity_z[i], mode)
    if op == CONDITION_TRAVELED_DISTANCE:
        return st.odometer[i]
    if op == CONDITION_ACCELERATION:
        return part_of(st, i, st.acceleration_x[i], st.acceleration_y[i], st.acceleration_z[i], mode)
    if op == CONDITION_STANDSTILL:
        return st.still[i]
    if op == CONDITION_END_OF_ROAD:
        return st.at_end[i]
    return st.off_road[i]


@compiled
def holds_for(n: RoadTables, p: Program, st: State, c: int, i: int) -> int:
    """Return 1 where a condition on an entity holds for entity i; where it or the other is not there, none does."""
    if st.present[i] == 0:
        return 0
    op = p.condition_op[c]
    if op < CONDITIONS_BETWEEN:
        value = measured_of(st, op, p.condition_mode[c], i)
    elif op < CONDITIONS_OF_STATE:
        other = p.condition_other[c]
        if other >= 0 and st.present[other] == 0:
            return 0
        value = measured_between(n, p, st, c, i)
    else:
        return state_holds(n, p, st, c, i)
    if value < 0.0 and op >= FIRST_TIME_MEASURED and op <= LAST_TIME_MEASURED:
        return 0
    return compare(st, p.condition_rule[c], value, p.const[p.condition_const[c] + C_VALUE])
