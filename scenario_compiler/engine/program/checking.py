"""Checks a program: its columns by their declarations, its actions and conditions by their entries."""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.program import ENTITY, ROAD, TRACK, Program
from scenario_compiler.engine.moves.table import ACTIONS
from scenario_compiler.engine.story.table import CONDITIONS
from scenario_compiler.forms.declaration import check_columns, check_values, index

FROM_AN_ENTITY = (
    op.POSITION_RELATIVE,
    op.POSITION_BESIDE,
    op.POSITION_LANES_AWAY,
    op.POSITION_RELATIVE_ROAD,
    op.POSITION_RELATIVE_OBJECT,
    op.POSITION_RELATIVE_WORLD,
)
"""Positions that are relative to an entity."""

REFERRING = {
    **dict.fromkeys(FROM_AN_ENTITY, ("entity", index(ENTITY))),
    op.POSITION_ON_TRAJECTORY: ("lane", index(TRACK)),
    op.POSITION_LANE: ("road", index(ROAD)),
}
"""The field of a position that refers to something, and its allowed values, by the position's kind."""


def check_program(program: Program) -> None:
    """Check every size, code, index and row start of a program.

    Raises:
        ValueError: A column refers outside of another one, because of an error in the code that filled it.
    """
    p = program
    check_columns(p)
    for k, kind in enumerate(p.position_op):
        if kind in REFERRING:
            name, allowed = REFERRING[kind]
            check_values(f"position_{name}", [getattr(p, f"position_{name}")[k]], allowed, p)
    for k, number in enumerate(p.action_op):
        if number >= len(ACTIONS):
            raise ValueError(f"column action_op holds {number}, which is not an action")
        entry = ACTIONS[number]
        if p.action_entity[k] == op.NONE and not entry.of_the_run:
            raise ValueError(f"column action_entity has no entity for {entry.words[0]}")
        for name, allowed in entry.refers.items():
            check_values(f"action_{name}", [getattr(p, f"action_{name}")[k]], allowed, p)
    for c, number in enumerate(p.condition_op):
        if number >= len(CONDITIONS):
            raise ValueError(f"column condition_op holds {number}, which is not a condition")
        for name, allowed in CONDITIONS[number].refers.items():
            check_values(f"condition_{name}", [getattr(p, f"condition_{name}")[c]], allowed, p)
