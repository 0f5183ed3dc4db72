"""Running actions: each is advanced once in a frame; when it ends, the elements that thereby complete are updated."""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.moves.entry import RELATIVE_THROUGHOUT
from scenario_compiler.engine.moves.table import STEPS
from scenario_compiler.engine.story.acting import lacks_reference
from scenario_compiler.engine.story.storyboard import action_done
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables


@compiled
def step_action(n: RoadTables, p: Program, st: State, k: int, dt: float) -> None:
    """Advance one running action, and complete it if it is done, or if the entity on which it depends is absent."""
    over = 1 if st.action_state[k] == op.COMPLETE else lacks_reference(p, st, k, RELATIVE_THROUGHOUT)
    if over == 1 or STEPS[p.action_op[k]](n, p, st, k, dt) == 1:
        action_done(p, st, k, 2 * (st.frame[0] + 1))


@compiled
def run_actions(n: RoadTables, p: Program, st: State, dt: float) -> None:
    """Advance all running actions: those of the init, then those of the story in document order."""
    if st.init_acting[0] == 1:
        st.init_acting[0] = 0
        for c in range(p.init_count[0]):
            if st.action_state[p.init_action[c]] == op.RUNNING:
                st.init_acting[0] = 1
                step_action(n, p, st, p.init_action[c], dt)
    if st.acting[0] == 0:
        return
    e = 0
    while e < p.element_count[0]:
        if st.element_state[e] != op.RUNNING:
            e = p.element_end[e]
            continue
        if p.element_kind[e] == op.ELEMENT_ACTION and p.element_action[e] >= 0:
            step_action(n, p, st, p.element_action[e], dt)
        e = e + 1
