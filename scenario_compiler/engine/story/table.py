"""All conditions, in the order of their numbers, and what follows from their entries."""

from __future__ import annotations

from types import ModuleType

from scenario_compiler.engine.story import clearance, of_entity, of_run
from scenario_compiler.engine.story.entry import Condition

FAMILIES: tuple[ModuleType, ...] = (of_run, of_entity, clearance)
"""The modules of the conditions, one a family."""

CONDITIONS: tuple[Condition, ...] = tuple(
    one for family in FAMILIES for one in vars(family).values() if isinstance(one, Condition)
)
"""Every condition, as the families declare them; its place is the number that a program has for it."""

HOLDS = tuple(entry.holds for entry in CONDITIONS)
OF_THE_RUN = tuple(1 if entry.of_the_run else 0 for entry in CONDITIONS)
"""By the number of a condition what evaluates it, and whether it speaks of the run as a whole."""

NUMBERS: dict[str, int] = {tag: number for number, entry in enumerate(CONDITIONS) for tag in entry.words}
"""Number of the condition that a word becomes, by the word's tag."""
