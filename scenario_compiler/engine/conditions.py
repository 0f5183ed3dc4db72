"""Conditions: those on the run as a whole, and the edge and delay of all of them (see `storyboard` for triggers).

A condition is evaluated on the states before the step. Edges need an earlier evaluation that is forgotten whenever the
edge fires, and a delay shifts the record of the edge's results in time: all as in esmini 3.6.
"""

from __future__ import annotations

from scenario_compiler.engine.comparing import compare
from scenario_compiler.engine.entity_conditions import holds_for
from scenario_compiler.engine.faults import fault
from scenario_compiler.engine.opcodes import (
    CONDITION_ELEMENT_STATE,
    CONDITION_LANE_CONFIDENCE,
    CONDITION_SENSOR_HEALTH,
    CONDITION_SIGNAL,
    CONDITION_SIGNAL_PHASE,
    CONDITION_TAKEOVER_STATE,
    CONDITION_TIME,
    CONDITION_TIME_OF_DAY,
    CONDITION_TRANSITION,
    CONDITION_USER_VALUE,
    CONDITION_VARIABLE,
    CONDITIONS_OF_RUN,
    DELAY_RECORDS,
    EDGE_BOTH,
    EDGE_FALLING,
    EDGE_NONE,
    EDGE_RISING,
    FAULT_DELAY_OVERFLOW,
    FAULT_UNKNOWN_CONDITION,
    FAULT_UNKNOWN_EDGE,
    NONE,
    SIDE_EITHER,
    SIDE_LEFT,
    SIDE_RIGHT,
    TOLERANCE,
    TRANSITION_END,
    TRANSITION_START,
    TRANSITION_STOP,
)
from scenario_compiler.engine.signals import phase_holds
from scenario_compiler.engine.slots import C_DELAY, C_VALUE
from scenario_compiler.engine.state import State
from scenario_compiler.engine.surroundings import time_of_day
from scenario_compiler.engine.tables import Program
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables


@compiled
def element_state_holds(p: Program, st: State, c: int) -> int:
    """Return 1 where the states of the elements that a condition watches compare as it says: 1 runs, 2 is complete.

    An action of several actors is several elements; all must be as it says, or any where its mode is 1.
    """
    any_suffices = p.condition_mode[c]
    limit = p.const[p.condition_const[c] + C_VALUE]
    for e in range(p.condition_other[c], p.condition_other[c] + p.condition_flags[c] + 1):
        holds = compare(st, p.condition_rule[c], 1.0 * st.element_state[e], limit)
        if holds == any_suffices:
            return holds
    return 1 - any_suffices


@compiled
def transition_seen(p: Program, st: State, c: int, e: int, mark: int) -> int:
    """Return 1 where a condition sees a transition of an element that was marked: for one frame.

    What happened while the actions were run is seen in the next frame. What happens in a pass of triggers is seen in
    that pass by what comes later in the storyboard, in the next one by what had its turn already.
    """
    owner = p.condition_owner[c]
    frame = st.frame[0] if owner >= 0 else st.frame[0] + 1
    if mark == 2 * frame or mark == 2 * frame + 1:
        return 1
    return 1 if mark == 2 * frame - 1 and e >= owner else 0


@compiled
def transition_holds(p: Program, st: State, c: int) -> int:
    """Return 1 where an element, or all elements of an action, go through the transition that a condition waits for."""
    kind = p.condition_mode[c]
    seen = 0
    for e in range(p.condition_other[c], p.condition_other[c] + p.condition_flags[c] + 1):
        if kind == TRANSITION_START:
            mark = st.element_started[e]
        elif kind == TRANSITION_END:
            mark = st.element_ended[e]
        elif kind == TRANSITION_STOP:
            mark = st.element_stopped[e]
        else:
            mark = st.element_skipped[e]
        if mark < 0:
            return 0
        if transition_seen(p, st, c, e, mark) == 1:
            seen = 1
    return seen


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
def holds_of_run(p: Program, st: State, c: int) -> int:
    """Return 1 where a condition on the run as a whole holds."""
    op = p.condition_op[c]
    limit = p.const[p.condition_const[c] + C_VALUE]
    other = p.condition_other[c]
    if op == CONDITION_ELEMENT_STATE:
        return element_state_holds(p, st, c)
    if op == CONDITION_TRANSITION:
        return transition_holds(p, st, c)
    if op == CONDITION_LANE_CONFIDENCE:
        return compare(st, p.condition_rule[c], side_confidence(p, st, c), limit)
    if op == CONDITION_SENSOR_HEALTH:
        return compare(st, p.condition_rule[c], st.health[0], limit)
    if op == CONDITION_TAKEOVER_STATE:
        return 1 if st.takeover_state[0] == other else 0
    if op == CONDITION_VARIABLE:
        return compare(st, p.condition_rule[c], st.variable[other], limit)
    if op == CONDITION_TIME_OF_DAY:
        return compare(st, p.condition_rule[c], time_of_day(st) - limit, 0.0) if st.day_known[0] == 1 else 0
    if op == CONDITION_SIGNAL:
        return 1 if st.signal_state[other] == p.condition_mode[c] else 0
    if op == CONDITION_SIGNAL_PHASE:
        return phase_holds(p, st, other, p.condition_mode[c])
    if op != CONDITION_USER_VALUE:
        fault(st, FAULT_UNKNOWN_CONDITION, c)
    return 0


@compiled
def edge_of(p: Program, st: State, c: int, now: int) -> int:
    """Return 1 where the wanted change of a condition's value has come; the first evaluation is never a change."""
    edge = p.condition_edge[c]
    if edge > EDGE_BOTH:
        fault(st, FAULT_UNKNOWN_EDGE, c)
        return 0
    before = st.condition_before[c]
    st.condition_before[c] = now
    if before == 1 - now and edge != (EDGE_FALLING if now == 1 else EDGE_RISING):
        st.condition_before[c] = NONE
        return 1
    return 0


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
    op = p.condition_op[c]
    if op == CONDITION_TIME:
        result = compare(st, p.condition_rule[c], st.clock[0], p.const[p.condition_const[c] + C_VALUE])
    elif op >= CONDITIONS_OF_RUN:
        result = holds_of_run(p, st, c)
    else:
        every = p.condition_all[c]
        result = every
        for k in range(p.condition_first[c], p.condition_first[c + 1]):
            result = holds_for(n, p, st, c, p.condition_entity[k])
            if result != every:
                break
    if p.condition_edge[c] != EDGE_NONE:
        result = edge_of(p, st, c, result)
    if p.condition_ring[c] >= 0:
        result = delayed(p, st, c, result)
    return result
