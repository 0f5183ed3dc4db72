"""Actions on the position and presence of entities, on their visibility, and on trailers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.program import ENTITY, POSITION, Program
from scenario_compiler.engine.columns.rows import ActionRow, ProgramDraft
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.appearing import add_entity, delete_entity, put_at
from scenario_compiler.engine.motion.trailers import connect_trailer, disconnect_trailer, straighten_trailers
from scenario_compiler.engine.moves.entry import HOLDS_LANE, HOLDS_SPEED, Entry
from scenario_compiler.forms.declaration import index
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables

if TYPE_CHECKING:
    from scenario_compiler.vocabulary.actions import (
        AddEntityAction,
        ConnectTrailerAction,
        DeleteEntityAction,
        DisconnectTrailerAction,
        TeleportAction,
        VisibilityAction,
    )


@compiled
def start_teleport(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Put an entity at a position, which is its only motion in this step."""
    i = p.action_entity[k]
    put_at(n, p, st, i, p.action_position[k])
    st.moved[i] = 1


@compiled
def start_add(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Let an entity appear."""
    add_entity(n, p, st, p.action_other[k], p.action_position[k])


@compiled
def start_delete(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Let an entity disappear."""
    del n
    delete_entity(st, p.action_other[k])


@compiled
def start_visibility(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Set the observers to whom an entity is visible."""
    del n
    st.visible[p.action_entity[k]] = p.action_flags[k]


@compiled
def start_connect(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Connect a trailer: in the init it is put in line behind the entity, later its hitch pulls it from where it is."""
    i = p.action_entity[k]
    connect_trailer(p, st, i, p.action_other[k])
    if st.action_element[k] < 0:
        straighten_trailers(n, p, st, i)


@compiled
def start_disconnect(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Disconnect an entity's trailer."""
    del n
    disconnect_trailer(st, p.action_entity[k])


def teleport_row(draft: ProgramDraft, word: TeleportAction, actor: int) -> ActionRow:
    """Return the row of a teleport."""
    del actor
    return ActionRow(position=draft.position(word.position))


def add_row(draft: ProgramDraft, word: AddEntityAction, actor: int) -> ActionRow:
    """Return the row of an action that lets an entity appear."""
    del actor
    return ActionRow(other=draft.entities[word.entity], position=draft.position(word.position))


def delete_row(draft: ProgramDraft, word: DeleteEntityAction, actor: int) -> ActionRow:
    """Return the row of an action that lets an entity disappear."""
    del actor
    return ActionRow(other=draft.entities[word.entity])


def visibility_row(draft: ProgramDraft, word: VisibilityAction, actor: int) -> ActionRow:
    """Return the row of an action on the visibility of an entity."""
    del draft, actor
    seen = op.SEEN_IN_PICTURES * word.graphics + op.SEEN_BY_SENSORS * word.sensors + op.SEEN_BY_TRAFFIC * word.traffic
    return ActionRow(flags=seen)


def connect_row(draft: ProgramDraft, word: ConnectTrailerAction, actor: int) -> ActionRow:
    """Return the row of an action that connects a trailer."""
    del actor
    return ActionRow(other=draft.entities[word.trailer])


def disconnect_row(draft: ProgramDraft, word: DisconnectTrailerAction, actor: int) -> ActionRow:
    """Return the row of an action that disconnects a trailer."""
    del draft, word, actor
    return ActionRow()


TELEPORT = Entry(
    ("teleport",),
    teleport_row,
    start_teleport,
    ends=HOLDS_SPEED | HOLDS_LANE,
    refers={"position": index(POSITION)},
)
ADD_ENTITY = Entry(
    ("add_entity",),
    add_row,
    start_add,
    whose="run",
    ends=HOLDS_LANE,
    refers={"other": index(ENTITY), "position": index(POSITION)},
)
DELETE_ENTITY = Entry(("delete_entity",), delete_row, start_delete, whose="run", refers={"other": index(ENTITY)})
VISIBILITY = Entry(("visibility",), visibility_row, start_visibility)
CONNECT_TRAILER = Entry(("connect_trailer",), connect_row, start_connect, refers={"other": index(ENTITY)})
DISCONNECT_TRAILER = Entry(("disconnect_trailer",), disconnect_row, start_disconnect)
