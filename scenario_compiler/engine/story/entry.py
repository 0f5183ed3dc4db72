"""`Condition`: the declaration of a condition, from which its opcode, dispatch and checks are derived."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.rows import ConditionRow, ProgramDraft
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.story.comparing import compare
from scenario_compiler.forms.declaration import Allowed
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables

RULES = {
    "lessThan": op.RULE_LESS,
    "lessOrEqual": op.RULE_LESS_OR_EQUAL,
    "greaterThan": op.RULE_GREATER,
    "greaterOrEqual": op.RULE_GREATER_OR_EQUAL,
    "equalTo": op.RULE_EQUAL,
    "notEqualTo": op.RULE_NOT_EQUAL,
}
"""Codes of comparisons."""


@compiled
def compared(p: Program, st: State, c: int, value: float) -> int:
    """Return 1 if a value satisfies the condition's rule with the condition's value."""
    return compare(st, p.condition_rule[c], value, p.const[p.condition_const[c] + slot.C_VALUE])


@compiled
def time_compared(p: Program, st: State, c: int, time: float) -> int:
    """Return the result of `compared` for a time; 0 for a negative one, which is undefined."""
    return 0 if time < 0.0 else compared(p, st, c, time)


@compiled
def other_is_gone(p: Program, st: State, c: int) -> int:
    """Return 1 if a condition refers to another entity that is not present."""
    other = p.condition_other[c]
    return 1 if other >= 0 and st.present[other] == 0 else 0


class Condition(NamedTuple):
    """A condition of the engine.

    Attributes:
        words: Tags of the words of the language that are lowered to it.
        row: Makes its row from the draft and the word.
        holds: The marked function `(n, p, st, c, i)` for the condition's row c that returns 1 if it holds for the
            triggering entity i, or for the run, where i is NONE.
        of_the_run: Whether it is about the run as a whole, not a triggering entity.
        refers: Allowed values of the fields of its row that refer to something, beyond those of every condition.
    """

    words: tuple[str, ...]
    row: Callable[[ProgramDraft, Any], ConditionRow]
    holds: Callable[[RoadTables, Program, State, int, int], int]
    of_the_run: bool = False
    refers: Mapping[str, Allowed] = MappingProxyType({})

    @property
    def module(self) -> str:
        """The module that executes it, relative to the package."""
        return self.holds.__module__.removeprefix("scenario_compiler.")
