"""Variables of the scenario: every one is a number; of a text it is the text's place in the program's list of texts."""

from __future__ import annotations

from scenario_compiler.engine.opcodes import MODIFY_MULTIPLY
from scenario_compiler.engine.slots import A_TARGET
from scenario_compiler.engine.state import State
from scenario_compiler.engine.tables import Program
from scenario_compiler.marker import compiled


@compiled
def reset_variables(p: Program, st: State) -> None:
    """Give all variables the values that they begin with."""
    for k in range(p.variable_count[0]):
        st.variable[k] = p.const[p.variable_const[k]]


@compiled
def set_variable(p: Program, st: State, k: int) -> None:
    """Give a variable the value of an action."""
    st.variable[p.action_other[k]] = p.const[p.action_const[k] + A_TARGET]


@compiled
def modify_variable(p: Program, st: State, k: int) -> None:
    """Add the value of an action to a variable, or multiply it by that."""
    at = p.action_other[k]
    value = p.const[p.action_const[k] + A_TARGET]
    if p.action_mode[k] == MODIFY_MULTIPLY:
        st.variable[at] = st.variable[at] * value
    else:
        st.variable[at] = st.variable[at] + value
