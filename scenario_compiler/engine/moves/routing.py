"""Actions on the route of entities at junctions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.program import GUIDE, Program
from scenario_compiler.engine.columns.rows import ActionRow, ProgramDraft
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.moves.entry import Entry
from scenario_compiler.forms.declaration import index_or_none
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables

if TYPE_CHECKING:
    from scenario_compiler.vocabulary.actions import AcquirePositionAction, AssignRouteAction, RandomRouteAction


@compiled
def start_route(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Set the guide that determines an entity's turns."""
    del n
    st.guide[p.action_entity[k]] = p.action_other[k]


def assign_route_row(draft: ProgramDraft, word: AssignRouteAction, actor: int) -> ActionRow:
    """Return the row of an action that assigns a route."""
    del actor
    return ActionRow(other=draft.route(word.route))


def acquire_position_row(draft: ProgramDraft, word: AcquirePositionAction, actor: int) -> ActionRow:
    """Return the row of an action that leads to a position."""
    del actor
    return ActionRow(other=draft.goal(word.position))


def random_route_row(draft: ProgramDraft, word: RandomRouteAction, actor: int) -> ActionRow:
    """Return the row of an action for random turns."""
    del draft, word, actor
    return ActionRow(other=op.RANDOM_GUIDE)


ASSIGN_ROUTE = Entry(("assign_route",), assign_route_row, start_route, refers={"other": index_or_none(GUIDE)})
ACQUIRE_POSITION = Entry(
    ("acquire_position",), acquire_position_row, start_route, refers={"other": index_or_none(GUIDE)}
)
RANDOM_ROUTE = Entry(("random_route",), random_route_row, start_route)
