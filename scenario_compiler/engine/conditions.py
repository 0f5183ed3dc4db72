"""Conditions: what a trigger measures, with rule, edge and delay (see `storyboard` for triggers).

A condition is evaluated on the states before the step. Comparisons have a tolerance of 1e-6, edges need an earlier
evaluation that is forgotten whenever the edge fires, and a delay shifts the record of the edge's results in time: all
as in esmini 3.6.
"""

from __future__ import annotations

from math import cos, sin

from scenario_compiler.engine.ahead import longitudinal_distance
from scenario_compiler.engine.faults import fault
from scenario_compiler.engine.numbers import length_of
from scenario_compiler.engine.opcodes import (
    CONDITION_DISTANCE,
    CONDITION_ELEMENT_STATE,
    CONDITION_LANE_CONFIDENCE,
    CONDITION_LONGITUDINAL_DISTANCE,
    CONDITION_REACH_POSITION,
    CONDITION_SENSOR_HEALTH,
    CONDITION_SPEED,
    CONDITION_STANDSTILL,
    CONDITION_TAKEOVER_STATE,
    CONDITION_TIME,
    CONDITION_TIME_HEADWAY,
    CONDITION_TIME_TO_COLLISION,
    CONDITION_TRAVELED_DISTANCE,
    DELAY_RECORDS,
    EDGE_BOTH,
    EDGE_FALLING,
    EDGE_NONE,
    EDGE_RISING,
    FAR,
    FAULT_DELAY_OVERFLOW,
    FAULT_UNKNOWN_CONDITION,
    FAULT_UNKNOWN_EDGE,
    FAULT_UNKNOWN_RULE,
    RULE_EQUAL,
    RULE_GREATER,
    RULE_GREATER_OR_EQUAL,
    RULE_LESS,
    RULE_LESS_OR_EQUAL,
    RULE_NOT_EQUAL,
    SIDE_EITHER,
    SIDE_LEFT,
    SIDE_RIGHT,
    STANDING,
    TOLERANCE,
)
from scenario_compiler.engine.slots import C_DELAY, C_VALUE
from scenario_compiler.engine.state import State
from scenario_compiler.engine.tables import Program
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables


@compiled
def compare(st: State, rule: int, value: float, limit: float) -> int:
    """Return 1 where the value stands to the limit as the rule says, with the tolerance of esmini."""
    if rule == RULE_LESS:
        return 1 if value < limit - TOLERANCE else 0
    if rule == RULE_LESS_OR_EQUAL:
        return 1 if value <= limit + TOLERANCE else 0
    if rule == RULE_GREATER:
        return 1 if value > limit + TOLERANCE else 0
    if rule == RULE_GREATER_OR_EQUAL:
        return 1 if value >= limit - TOLERANCE else 0
    near = 1 if abs(value - limit) <= TOLERANCE else 0
    if rule == RULE_EQUAL:
        return near
    if rule == RULE_NOT_EQUAL:
        return 1 - near
    fault(st, FAULT_UNKNOWN_RULE, rule)
    return 0


@compiled
def distance_between(st: State, i: int, j: int) -> float:
    """Return the straight distance between two reference points in the plane, m."""
    return length_of(st.x[j] - st.x[i], st.y[j] - st.y[i])


@compiled
def headway(n: RoadTables, st: State, i: int, j: int) -> float:
    """Return the time gap to an entity ahead along the road, s; FAR where it is behind or the speed is 0."""
    ahead = longitudinal_distance(n, st, i, j)
    speed = abs(st.v[i])
    if ahead <= 0.0 or ahead >= FAR or speed < TOLERANCE:
        return FAR
    return ahead / speed


@compiled
def time_to_collision(st: State, i: int, j: int) -> float:
    """Return distance over closing speed, FAR where the gap does not close.

    Distance is between the reference points, closing speed the difference of the velocities along the line between
    them.
    """
    dx = st.x[j] - st.x[i]
    dy = st.y[j] - st.y[i]
    between = length_of(dx, dy)
    if between < TOLERANCE:
        return 0.0
    ux = dx / between
    uy = dy / between
    vx = st.v[i] * cos(st.h[i]) - st.v[j] * cos(st.h[j])
    vy = st.v[i] * sin(st.h[i]) - st.v[j] * sin(st.h[j])
    closing = vx * ux + vy * uy
    if closing <= TOLERANCE:
        return FAR
    return between / closing


@compiled
def element_state_holds(p: Program, st: State, c: int) -> int:
    """Return 1 where the state of the element that a condition watches compares as it says: 1 runs, 2 is complete."""
    state = 1.0 * st.element_state[p.condition_other[c]]
    return compare(st, p.condition_rule[c], state, p.const[p.condition_const[c] + C_VALUE])


@compiled
def side_confidence(p: Program, st: State, c: int) -> float:
    """Return the lane confidence that a condition speaks of: a side's, the weaker side's, else the stronger side's."""
    side = p.condition_other[c]
    if side == SIDE_LEFT:
        return st.conf_left[0]
    if side == SIDE_RIGHT:
        return st.conf_right[0]
    if side == SIDE_EITHER:
        return min(st.conf_left[0], st.conf_right[0])
    return max(st.conf_left[0], st.conf_right[0])


@compiled
def holds_for(n: RoadTables, p: Program, st: State, c: int, i: int) -> int:
    """Return 1 where a condition on an entity holds for entity i."""
    op = p.condition_op[c]
    other = p.condition_other[c]
    value = 0.0
    if op == CONDITION_TIME_HEADWAY:
        value = headway(n, st, i, other)
        if value >= FAR:
            return 0
    elif op == CONDITION_DISTANCE:
        value = distance_between(st, i, other)
    elif op == CONDITION_SPEED:
        value = st.v[i]
    elif op == CONDITION_TIME_TO_COLLISION:
        value = time_to_collision(st, i, other)
        if value >= FAR:
            return 0
    elif op == CONDITION_LONGITUDINAL_DISTANCE:
        value = abs(longitudinal_distance(n, st, i, other))
        if value >= FAR:
            return 0
    elif op == CONDITION_REACH_POSITION:
        at = p.condition_position[c]
        if at < 0:
            return 0
        value = length_of(st.x[i] - st.position_x[at], st.y[i] - st.position_y[at])
    elif op == CONDITION_TRAVELED_DISTANCE:
        value = st.odometer[i]
    elif op == CONDITION_STANDSTILL:
        if abs(st.v[i]) >= STANDING:
            return 0
        value = st.still[i]
    else:
        fault(st, FAULT_UNKNOWN_CONDITION, c)
        return 0
    return compare(st, p.condition_rule[c], value, p.const[p.condition_const[c] + C_VALUE])


@compiled
def holds_now(n: RoadTables, p: Program, st: State, c: int) -> int:
    """Return 1 where a condition holds on the states of now, before edge and delay."""
    op = p.condition_op[c]
    limit = p.const[p.condition_const[c] + C_VALUE]
    if op == CONDITION_TIME:
        return compare(st, p.condition_rule[c], st.clock[0], limit)
    if op == CONDITION_LANE_CONFIDENCE:
        return compare(st, p.condition_rule[c], side_confidence(p, st, c), limit)
    if op == CONDITION_SENSOR_HEALTH:
        return compare(st, p.condition_rule[c], st.health[0], limit)
    if op == CONDITION_TAKEOVER_STATE:
        return 1 if st.takeover_state[0] == p.condition_other[c] else 0
    if op == CONDITION_ELEMENT_STATE:
        return element_state_holds(p, st, c)
    every = p.condition_all[c]
    for k in range(p.condition_first[c], p.condition_first[c + 1]):
        held = holds_for(n, p, st, c, p.condition_entity[k])
        if held != every:
            return held
    return every


@compiled
def edge_of(p: Program, st: State, c: int, now: int) -> int:
    """Return 1 where the wanted change of a condition's value has come; the first evaluation is never a change."""
    edge = p.condition_edge[c]
    if edge == EDGE_NONE:
        return now
    if edge > EDGE_BOTH:
        fault(st, FAULT_UNKNOWN_EDGE, c)
        return 0
    known = st.condition_known[c]
    before = st.condition_before[c]
    st.condition_known[c] = 1
    st.condition_before[c] = now
    fires = 0
    if known == 1 and before != now:
        if now == 1 and edge != EDGE_FALLING:
            fires = 1
        if now == 0 and edge != EDGE_RISING:
            fires = 1
    if fires == 1:
        st.condition_known[c] = 0
    return fires


@compiled
def delayed(p: Program, st: State, c: int, now: int) -> int:
    """Return what a condition's result was one delay ago; 0 before there was any.

    The record keeps changes only, in a ring of DELAY_RECORDS.
    """
    ring = p.condition_ring[c]
    base = ring * DELAY_RECORDS
    first = st.ring_first[ring]
    size = st.ring_size[ring]
    changed = 1
    if size > 0:
        changed = 1 if st.ring_value[base + (first + size - 1) % DELAY_RECORDS] != now else 0
    if changed == 1:
        if size == DELAY_RECORDS:
            fault(st, FAULT_DELAY_OVERFLOW, c)
            return 0
        slot = base + (first + size) % DELAY_RECORDS
        st.ring_time[slot] = st.clock[0]
        st.ring_value[slot] = now
        size = size + 1
    wanted = st.clock[0] - p.const[p.condition_const[c] + C_DELAY] + TOLERANCE
    while size > 1 and st.ring_time[base + (first + 1) % DELAY_RECORDS] <= wanted:
        first = (first + 1) % DELAY_RECORDS
        size = size - 1
    st.ring_first[ring] = first
    st.ring_size[ring] = size
    if st.ring_time[base + first] <= wanted:
        return st.ring_value[base + first]
    return 0


@compiled
def condition_fires(n: RoadTables, p: Program, st: State, c: int) -> int:
    """Return 1 where a condition's value, edge and delay say so in this frame."""
    result = edge_of(p, st, c, holds_now(n, p, st, c))
    if p.condition_ring[c] >= 0:
        result = delayed(p, st, c, result)
    return result
