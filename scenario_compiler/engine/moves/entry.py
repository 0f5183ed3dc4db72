"""`Entry`: the one declaration of an action, from which its number, its dispatch, its checks and its log follow."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.rows import ActionRow, ProgramDraft
from scenario_compiler.engine.columns.state import State
from scenario_compiler.forms.declaration import Allowed
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables

HOLDS_SPEED = 1
HOLDS_LANE = 2
"""Domains of an entity's motion, as bits. An action that starts ends the one that holds the same domain of the same
entity, wherever that stands (esmini 3.6).
"""


@compiled
def nothing_to_start(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Start an action that is only logged."""
    del n, p, st, k


@compiled
def done_at_once(n: RoadTables, p: Program, st: State, k: int, dt: float) -> int:
    """Step an action that its start has done: return 1."""
    del n, p, st, k, dt
    return 1


@dataclass(frozen=True)
class Told:
    """The log entry of an action.

    Attributes:
        event: The kind of the event.
        text: The meaning of that kind, for readers.
        words: From the action's word what it is about, and what it does there.
    """

    event: str
    text: str
    words: Callable[[Any], tuple[str, str]] = lambda _: ("", "")


@dataclass(frozen=True)
class Entry:
    """An action of the engine.

    Attributes:
        words: Tags of the words of the language that become it.
        row: Makes its row, from the draft, its word, and the number of the entity that does it, or NONE.
        start: Starts it: the marked function `(n, p, st, k)` of the action's row k.
        step: Moves it on by dt: the marked function `(n, p, st, k, dt)`, which returns 1 when the action is done.
        holds: The domains of its entity's motion that it holds, as bits.
        whose: Whether the entity does it ("entity"), the run as a whole ("run"), or the run for the ego ("ego"). The
            last two are done once however many actors there are.
        told: What the log says when it starts; None for nothing.
        refers: What fields of its row refer to, beyond what every action's may.
    """

    words: tuple[str, ...]
    row: Callable[[ProgramDraft, Any, int], ActionRow]
    start: Callable[[RoadTables, Program, State, int], None] = nothing_to_start
    step: Callable[[RoadTables, Program, State, int, float], int] = done_at_once
    holds: int = 0
    whose: Literal["entity", "run", "ego"] = "entity"
    told: Told | None = None
    refers: Mapping[str, Allowed] = field(default_factory=dict)

    @property
    def of_the_run(self) -> bool:
        """Whether it is done once, however many actors there are."""
        return self.whose != "entity"

    @property
    def module(self) -> str:
        """The module that executes it, below the package: that of its step, of its start, or of its row."""
        if self.step is not done_at_once:
            home = self.step.__module__
        else:
            home = self.row.__module__ if self.start is nothing_to_start else self.start.__module__
        return home.removeprefix("scenario_compiler.")
