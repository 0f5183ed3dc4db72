"""Starting, running and ending actions, which write to their entities at once, in document order: init, then story.

The integration is semi-implicit: a speed action writes the speed of the end of the step, and the entity moves with it.
A lane change moves its entity along the path with the present speed, so the lateral motion reduces the motion ahead.
After esmini 3.6. What an action does is defined in its entry (`moves.table`).
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.log import log_event
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.moves.entry import RELATIVE_AT_START
from scenario_compiler.engine.moves.table import RELATIVE, STARTS, TOLD
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables


@compiled
def lacks_reference(p: Program, st: State, k: int, when: int) -> int:
    """Return 1 if an action depends, at least as often as `when` (RELATIVE_...), on another entity that is absent."""
    other = p.action_other[k]
    if RELATIVE[p.action_op[k]] < when or other < 0 or other == p.action_entity[k]:
        return 0
    return 1 - st.present[other]


@compiled
def start_action(n: RoadTables, p: Program, st: State, k: int, element: int) -> None:
    """Start an action that belongs to a storyboard element, or to the init (-1).

    Without the entity on which it depends it has no effect, and is complete before its first step.
    """
    st.action_element[k] = element
    if lacks_reference(p, st, k, RELATIVE_AT_START) == 1:
        st.action_state[k] = op.COMPLETE
        return
    st.action_state[k] = op.RUNNING
    st.action_progress[k] = 0.0
    STARTS[p.action_op[k]](n, p, st, k)
    if TOLD[p.action_op[k]] == 1:
        log_event(st, op.EVENT_ACTION, 1.0 * k)


@compiled
def end_action(p: Program, st: State, k: int) -> None:
    """End an action, and release the domains that it controlled."""
    st.action_state[k] = op.COMPLETE
    i = p.action_entity[k]
    if i < 0:
        return
    if st.longitudinal[i] == k:
        st.longitudinal[i] = op.NONE
    if st.lateral[i] == k:
        st.lateral[i] = op.NONE
