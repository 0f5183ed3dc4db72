"""Variables of the scenario, all of them numbers; a text is represented by its place in the list of texts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.program import VARIABLE, Program
from scenario_compiler.engine.columns.rows import ActionRow, ProgramDraft
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.moves.entry import Entry
from scenario_compiler.forms.declaration import index
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables

if TYPE_CHECKING:
    from scenario_compiler.vocabulary.actions import ModifyVariableAction, SetVariableAction


@compiled
def reset_variables(p: Program, st: State) -> None:
    """Give all variables their start values."""
    for k in range(p.variable_count[0]):
        st.variable[k] = p.const[p.variable_const[k]]


@compiled
def set_variable(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Set a variable to the value of an action."""
    del n
    st.variable[p.action_other[k]] = p.const[p.action_const[k] + slot.A_TARGET]


@compiled
def modify_variable(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Add the value of an action to a variable, or multiply the variable by it."""
    del n
    at = p.action_other[k]
    value = p.const[p.action_const[k] + slot.A_TARGET]
    if p.action_mode[k] == op.MODIFY_MULTIPLY:
        st.variable[at] = st.variable[at] * value
    else:
        st.variable[at] = st.variable[at] + value


def set_variable_row(draft: ProgramDraft, word: SetVariableAction, actor: int) -> ActionRow:
    """Return the row of an action that sets a variable."""
    del actor
    at, variable = draft.variables[word.variable]
    return ActionRow((draft.variable_value(variable, word.value), 0.0), other=at)


def modify_variable_row(draft: ProgramDraft, word: ModifyVariableAction, actor: int) -> ActionRow:
    """Return the row of an action that adds to a variable or multiplies it."""
    del actor
    mode = op.MODIFY_ADD if word.by == "add" else op.MODIFY_MULTIPLY
    return ActionRow((word.value, 0.0), other=draft.variables[word.variable][0], mode=mode)


SET_VARIABLE = Entry(("set_variable",), set_variable_row, set_variable, whose="run", refers={"other": index(VARIABLE)})
MODIFY_VARIABLE = Entry(
    ("modify_variable",), modify_variable_row, modify_variable, whose="run", refers={"other": index(VARIABLE)}
)
