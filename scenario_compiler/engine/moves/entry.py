"""`Entry`: the declaration of an action, from which its opcode, dispatch, checks and log text are derived."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, Literal, NamedTuple

from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.rows import ActionRow, ProgramDraft
from scenario_compiler.engine.columns.state import State
from scenario_compiler.forms.declaration import Allowed
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables

HOLDS_SPEED = 1
HOLDS_LANE = 2
"""Domains of an entity's motion, as bits. An action that starts ends the one that controls the same domain of the same
entity, wherever it stands in the storyboard (esmini 3.6).
"""

RELATIVE_AT_START = 1
RELATIVE_THROUGHOUT = 2
"""When an action depends on the other entity of its row: only at its start, or in each of its steps."""


@compiled
def nothing_to_start(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Start an action without an effect of its own, which is only logged."""
    del n, p, st, k


@compiled
def done_at_once(n: RoadTables, p: Program, st: State, k: int, dt: float) -> int:
    """Advance an action that was complete when it started: return 1."""
    del n, p, st, k, dt
    return 1


class Told(NamedTuple):
    """The log entry of an action.

    Attributes:
        event: The kind of the event.
        text: The meaning of that kind, for readers.
        words: Returns (subject, what happens to it) for the action's word.
    """

    event: str
    text: str
    words: Callable[[Any], tuple[str, str]] = lambda _: ("", "")


class Entry(NamedTuple):
    """An action of the engine.

    Attributes:
        words: Tags of the words of the language that are lowered to it.
        row: Makes its row from the draft, the word, and the index of the acting entity, or NONE.
        start: Starts it: the marked function `(n, p, st, k)` for the action's row k.
        step: Advances it by dt: the marked function `(n, p, st, k, dt)`, which returns 1 if the action is complete.
        holds: The domains of its entity's motion that it controls, as bits.
        ends: The domains in which it ends other actions without controlling them itself, as bits: those of its entity,
            or, if it belongs to the run, those of the other entity that it refers to.
        relative: Whether it depends on the other entity of its row, if there is one: 0, or a code RELATIVE_... If this
            entity is absent when it is needed, the action ends without an effect.
        whose: Whether it belongs to an entity ("entity"), to the run as a whole ("run"), or to the run on behalf of the
            ego ("ego"). The last two are executed once, regardless of the number of actors.
        told: The log entry at its start; None if it is not logged.
        refers: Allowed values of the fields of its row that refer to something, beyond those of every action.
    """

    words: tuple[str, ...]
    row: Callable[[ProgramDraft, Any, int], ActionRow]
    start: Callable[[RoadTables, Program, State, int], None] = nothing_to_start
    step: Callable[[RoadTables, Program, State, int, float], int] = done_at_once
    holds: int = 0
    ends: int = 0
    relative: int = 0
    whose: Literal["entity", "run", "ego"] = "entity"
    told: Told | None = None
    refers: Mapping[str, Allowed] = MappingProxyType({})

    @property
    def of_the_run(self) -> bool:
        """Whether it is executed once, regardless of the number of actors."""
        return self.whose != "entity"

    @property
    def module(self) -> str:
        """The module that executes it, relative to the package: that of its step, its start or its row."""
        if self.step is not done_at_once:
            home = self.step.__module__
        else:
            home = self.row.__module__ if self.start is nothing_to_start else self.start.__module__
        return home.removeprefix("scenario_compiler.")
