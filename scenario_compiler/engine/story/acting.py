"""How actions start, run and end, each writing its entity at once, in document order: the init's, then the story's.

Semi-implicit: a speed action writes the speed of the end of the step, and the entity moves with it. A lane change
moves its entity along the path with the speed of that moment, so what it moves to the side is missing ahead. After
esmini 3.6. What each action does is its entry's (`moves.table`).
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.log import log_event
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.moves.table import STARTS, TOLD
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables


@compiled
def start_action(n: RoadTables, p: Program, st: State, k: int, element: int) -> None:
    """Start an action that stands in an element, or in the init (-1)."""
    st.action_state[k] = op.RUNNING
    st.action_element[k] = element
    st.action_progress[k] = 0.0
    STARTS[p.action_op[k]](n, p, st, k)
    if TOLD[p.action_op[k]] == 1:
        log_event(st, op.EVENT_ACTION, 1.0 * k)


@compiled
def end_action(p: Program, st: State, k: int) -> None:
    """End an action and free the domain that it held."""
    st.action_state[k] = op.COMPLETE
    i = p.action_entity[k]
    if i < 0:
        return
    if st.longitudinal[i] == k:
        st.longitudinal[i] = op.NONE
    if st.lateral[i] == k:
        st.lateral[i] = op.NONE
