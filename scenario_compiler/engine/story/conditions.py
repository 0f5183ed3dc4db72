"""When a condition fires: its value for its triggering entities, then its edge and its delay.

A condition is evaluated on the states before the step. An edge needs an earlier evaluation, which is forgotten whenever
the trigger fires; a delay shifts the recorded results of the edge in time. Both are as in esmini 3.6.
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.log import fault
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.story.table import HOLDS, OF_THE_RUN
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables


@compiled
def edge_of(p: Program, st: State, c: int, now: int) -> int:
    """Return 1 if a condition's value has changed as its edge requires; the first evaluation is never a change."""
    edge = p.condition_edge[c]
    if edge > op.EDGE_BOTH:
        fault(st, op.FAULT_UNKNOWN_EDGE, c)
        return 0
    before = st.condition_before[c]
    st.condition_before[c] = now
    return 1 if before == 1 - now and edge != (op.EDGE_FALLING if now == 1 else op.EDGE_RISING) else 0


@compiled
def delayed(p: Program, st: State, c: int, now: int) -> int:
    """Return the result that a condition had one delay ago; 0 before the first result.

    A ring of DELAY_RECORDS records stores only changes.
    """
    ring = p.condition_ring[c]
    base = ring * op.DELAY_RECORDS
    first = st.ring_first[ring]
    size = st.ring_size[ring]
    changed = 1
    if size > 0:
        changed = 1 if st.ring_value[base + (first + size - 1) % op.DELAY_RECORDS] != now else 0
    if changed == 1:
        if size == op.DELAY_RECORDS:
            fault(st, op.FAULT_DELAY_OVERFLOW, c)
            return 0
        place = base + (first + size) % op.DELAY_RECORDS
        st.ring_time[place] = st.clock[0]
        st.ring_value[place] = now
        size = size + 1
    wanted = st.clock[0] - p.const[p.condition_const[c] + slot.C_DELAY] + op.TOLERANCE
    while size > 1 and st.ring_time[base + (first + 1) % op.DELAY_RECORDS] <= wanted:
        first = (first + 1) % op.DELAY_RECORDS
        size = size - 1
    st.ring_first[ring] = first
    st.ring_size[ring] = size
    if st.ring_time[base + first] <= wanted:
        return st.ring_value[base + first]
    return 0


@compiled
def holds_for_entities(n: RoadTables, p: Program, st: State, c: int) -> int:
    """Return 1 if a condition holds for all of its present triggering entities, or for any of them.

    It does not hold if none of them is present (esmini 3.6).
    """
    every = p.condition_all[c]
    there = 0
    for k in range(p.condition_first[c], p.condition_first[c + 1]):
        i = p.condition_entity[k]
        if st.present[i] == 1:
            there = 1
            result = HOLDS[p.condition_op[c]](n, p, st, c, i)
            if result != every:
                return result
    return every * there


@compiled
def condition_fires(n: RoadTables, p: Program, st: State, c: int) -> int:
    """Return 1 if a condition fires in this frame, with its value, edge and delay."""
    if OF_THE_RUN[p.condition_op[c]] == 1:
        result = HOLDS[p.condition_op[c]](n, p, st, c, op.NONE)
    else:
        result = holds_for_entities(n, p, st, c)
    if p.condition_edge[c] != op.EDGE_NONE:
        result = edge_of(p, st, c, result)
    if p.condition_ring[c] >= 0:
        result = delayed(p, st, c, result)
    return result
