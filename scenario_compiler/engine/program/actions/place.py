"""Actions on where entities are, whether they are there at all, and what they tow."""

from __future__ import annotations

from scenario_compiler.engine import opcodes as op
from scenario_compiler.engine.program.actions.family import Family
from scenario_compiler.engine.program.draft import ActionRow, Draft
from scenario_compiler.engine.program.positions import add_position
from scenario_compiler.vocabulary.actions import (
    AddEntityAction,
    ConnectTrailerAction,
    DeleteEntityAction,
    DisconnectTrailerAction,
    TeleportAction,
    VisibilityAction,
)


def _teleport(draft: Draft, word: TeleportAction, actor: int) -> ActionRow:
    del actor
    return ActionRow(op.ACTION_TELEPORT, position=add_position(draft, word.position))


def _add_entity(draft: Draft, word: AddEntityAction, actor: int) -> ActionRow:
    del actor
    entity = draft.entities[word.entity]
    return ActionRow(op.ACTION_ADD_ENTITY, other=entity, position=add_position(draft, word.position))


def _delete_entity(draft: Draft, word: DeleteEntityAction, actor: int) -> ActionRow:
    del actor
    return ActionRow(op.ACTION_DELETE_ENTITY, other=draft.entities[word.entity])


def _visibility(draft: Draft, word: VisibilityAction, actor: int) -> ActionRow:
    del draft, actor
    seen = op.SEEN_IN_PICTURES * word.graphics + op.SEEN_BY_SENSORS * word.sensors + op.SEEN_BY_TRAFFIC * word.traffic
    return ActionRow(op.ACTION_VISIBILITY, flags=seen)


def _connect_trailer(draft: Draft, word: ConnectTrailerAction, actor: int) -> ActionRow:
    del actor
    return ActionRow(op.ACTION_CONNECT_TRAILER, other=draft.entities[word.trailer])


def _disconnect_trailer(draft: Draft, word: DisconnectTrailerAction, actor: int) -> ActionRow:
    del draft, word, actor
    return ActionRow(op.ACTION_DISCONNECT_TRAILER)


ACTIONS: Family = {
    TeleportAction: _teleport,
    AddEntityAction: _add_entity,
    DeleteEntityAction: _delete_entity,
    VisibilityAction: _visibility,
    ConnectTrailerAction: _connect_trailer,
    DisconnectTrailerAction: _disconnect_trailer,
}
