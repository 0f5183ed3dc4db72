"""Checks that every entity has a position: a start, or an action that places it."""

from __future__ import annotations

from collections.abc import Iterator

from scenario_compiler.diagnostics import Code, Diagnostics, Severity
from scenario_compiler.plan.model import Plan
from scenario_compiler.plan.provenance import place_of
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.actions import (
    AddEntityAction,
    ConnectTrailerAction,
    FollowTrajectoryAction,
    TeleportAction,
)
from scenario_compiler.vocabulary.word import Word

NOWHERE = Code(
    "SC252",
    "nowhere",
    "An entity has no start position, and no action places it. It never appears, or it stands at the world's origin, "
    "off every road, for the whole run. Give it a <start>, or let <add_entity> place it; a <path>, a <teleport> or a "
    "trajectory moves only an entity that is present.\n\n"
    '    <dynamic id="other" speed="5"/>     <start><lane road="1" lane="-1" s="60"/></start> is missing inside',
    Severity.WARNING,
)

PLACING = (TeleportAction, FollowTrajectoryAction)
"""Actions that give their actor a position, if it is present."""


def check_nowhere(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Warn of entities without a position during the whole run.

    Files of OpenSCENARIO without an automated vehicle rely on the origin as the position of an entity with an action in
    the init. There, only entities that act in the story and are never present are reported.
    """
    del network
    homeless = [entity.id for entity in plan.entities if entity.start is None and entity.kind != "traffic"]
    if not homeless:
        return
    placed = set(_placed(plan))
    hint = "give it a <start>, or place it by <add_entity>"
    if plan.controller is None:
        hint = "give it a TeleportAction in the init, or place it by an AddEntityAction"
        placed |= {initial.entity for initial in plan.storyboard.init}
        acting = {actor for actor, _ in plan.storyboard.actions()}
        homeless = [name for name in homeless if name in acting]
    for name in homeless:
        if name not in placed:
            message = f"'{name}' has no start position, and no action places it"
            sink.add(NOWHERE, message, place_of(plan, f"entities/{name}"), hint=hint)


def _placed(plan: Plan) -> Iterator[str]:
    """Yield the ids of the entities to which an action gives a position.

    Of the entities without a start position, only those with an action in the init are present before one adds them.
    """
    present = {initial.entity for initial in plan.storyboard.init}
    for initial in plan.storyboard.init:
        yield from _placed_by(initial.action, (initial.entity,))
    for group, event in plan.storyboard.events():
        for named in event.actions:
            yield from _placed_by(named.action, tuple(actor for actor in group.actors if actor in present))


def _placed_by(action: Word, actors: tuple[str, ...]) -> tuple[str, ...]:
    if isinstance(action, AddEntityAction):
        return (action.entity,)
    if isinstance(action, ConnectTrailerAction):
        return (action.trailer,)
    return actors if isinstance(action, PLACING) else ()
