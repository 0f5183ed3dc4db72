"""The table of all conditions in the order of their opcodes, and tables derived from their entries."""

from __future__ import annotations

from types import ModuleType

from scenario_compiler.engine.story import clearance, of_entity, of_run
from scenario_compiler.engine.story.entry import Condition

FAMILIES: tuple[ModuleType, ...] = (of_run, of_entity, clearance)
"""The modules of the conditions, one for each family."""

CONDITIONS: tuple[Condition, ...] = tuple(
    one for family in FAMILIES for one in vars(family).values() if isinstance(one, Condition)
)
"""Every condition in the order of the families; the index of a condition is its opcode."""

HOLDS = tuple(entry.holds for entry in CONDITIONS)
OF_THE_RUN = tuple(1 if entry.of_the_run else 0 for entry in CONDITIONS)
"""By opcode: the function that evaluates the condition, and whether it is about the run as a whole."""

NUMBERS: dict[str, int] = {tag: number for number, entry in enumerate(CONDITIONS) for tag in entry.words}
"""Opcode of the condition to which a word is lowered, by the word's tag."""
