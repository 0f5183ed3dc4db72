"""<Storyboard>: the init, stories, acts, maneuver groups, maneuvers and events, as the storyboard's words."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from scenario_compiler.openscenario.actions import read_actions
from scenario_compiler.openscenario.catalogs import entry_of
from scenario_compiler.openscenario.codes import NO_ACTOR, TRIGGERING_ACTORS
from scenario_compiler.openscenario.element_names import Siblings, with_full_names
from scenario_compiler.openscenario.node import Node
from scenario_compiler.openscenario.parameters import with_parameters
from scenario_compiler.openscenario.triggers import read_start_trigger, read_stop_trigger
from scenario_compiler.vocabulary.actions import Action
from scenario_compiler.vocabulary.storyboard import (
    Act,
    Event,
    InitAction,
    Maneuver,
    ManeuverGroup,
    Priority,
    Story,
    StoryAction,
    Storyboard,
    Trigger,
)

ACTIONS = ("PrivateAction", "GlobalAction", "UserDefinedAction")
"""Elements that contain an action."""

PRIORITIES: dict[str, Priority] = {
    "override": "override", "overwrite": "override", "skip": "skip", "parallel": "parallel",
}  # fmt: skip
"""Priorities by their names in all versions: 1.2 renamed `overwrite` to `override`."""


def read_storyboard(node: Node, first: Iterable[InitAction] = ()) -> Storyboard:
    """Return the storyboard; the actions `first` come before those of the init."""
    init = node.child("Init")
    actions = None if init is None else init.child("Actions")
    names = Siblings()
    storyboard = Storyboard.model_construct(
        init=(*first, *([] if actions is None else _init(actions))),
        stories=tuple(_story(one, names) for one in node.children("Story")),
        stop=read_stop_trigger(node),
    ).written_at(node.origin)
    return with_full_names(storyboard, node.reading.sink)


def _init(actions: Node) -> list[InitAction]:
    found: list[InitAction] = []
    for one in actions.elements():
        if one.tag in ACTIONS and one.tag != "PrivateAction":
            found += [InitAction.model_construct(action=action).written_at(one.origin) for action in read_actions(one)]
        elif one.tag == "Private":
            entities = one.entities("entityRef")
            for private in one.children("PrivateAction"):
                words = read_actions(private)
                found += [
                    InitAction.model_construct(entity=entity, action=action).written_at(private.origin)
                    for entity in entities
                    for action in words
                ]
    return found


def _story(node: Node, names: Siblings) -> Story:
    node = with_parameters(node)
    acts = Siblings()
    return Story.model_construct(
        name=names.name(node), acts=tuple(_act(one, acts) for one in node.children("Act"))
    ).written_at(node.origin)


def _act(node: Node, names: Siblings) -> Act:
    groups = Siblings()
    start = read_start_trigger(node)
    return Act.model_construct(
        name=names.name(node),
        start=start,
        stop=read_stop_trigger(node),
        groups=tuple(_group(one, groups, start) for one in node.children("ManeuverGroup")),
    ).written_at(node.origin)


def _group(node: Node, names: Siblings, start: Trigger | None) -> ManeuverGroup:
    inside = Siblings()
    maneuvers: list[Maneuver] = []
    of_entities: list[Node] = []
    for one in node.children("Maneuver", "CatalogReference"):
        maneuver = with_parameters(one) if one.tag == "Maneuver" else entry_of(one, "Maneuver")
        if maneuver is not None:
            maneuvers.append(_maneuver(maneuver, inside))
            of_entities += _private_actions(maneuver)
    actors = _actors(node, start)
    if not actors:
        for one in of_entities:
            one.report(NO_ACTOR, "nobody executes this action: its maneuver group has no actors")
    return ManeuverGroup.model_construct(
        name=names.name(node),
        maximum_execution_count=_count(node),
        actors=actors,
        maneuvers=tuple(maneuvers),
    ).written_at(node.origin)


def _private_actions(maneuver: Node) -> Iterator[Node]:
    for event in maneuver.children("Event"):
        for action in event.children("Action"):
            yield from action.children("PrivateAction")


def _actors(node: Node, start: Trigger | None) -> tuple[str, ...]:
    """Return the actors of a group; `start` is the start trigger of its act.

    "Only condition groups that are relevant for determining which instances of Entity are added to the actors are
    located in the parent Act" (ManeuverGroups and Actors, ASAM OpenSCENARIO).
    """
    actors = node.child("Actors")
    if actors is None:
        return ()
    found = [entity for one in actors.children("EntityRef") for entity in one.entities("entityRef")]
    if actors.boolean("selectTriggeringEntities", False) and start is not None:
        conditions = [one for group in start.groups for one in group.conditions if one.entities]
        found += [entity for one in conditions for entity in one.entities]
        some = any(len(one.entities) > 1 and not one.every for one in conditions)
        if some or (conditions and len(start.groups) > 1):
            message = "the actors are the triggering entities: all entities in the act's start trigger are used"
            actors.report(TRIGGERING_ACTORS, message, "selectTriggeringEntities")
    return tuple(dict.fromkeys(found))


def _maneuver(node: Node, names: Siblings) -> Maneuver:
    events = Siblings()
    return Maneuver.model_construct(
        name=names.name(node), events=tuple(_event(one, events) for one in node.children("Event"))
    ).written_at(node.origin)


def _event(node: Node, names: Siblings) -> Event:
    inside = Siblings()
    actions = [
        StoryAction.model_construct(name=name, action=action).written_at(one.origin)
        for one in node.children("Action")
        for name, action in _named_actions(one, inside)
    ]
    return Event.model_construct(
        name=names.name(node),
        priority=PRIORITIES[node.choice("priority", tuple(PRIORITIES), "parallel")],
        maximum_execution_count=_count(node),
        start=read_start_trigger(node),
        actions=tuple(actions),
    ).written_at(node.origin)


def _named_actions(node: Node, names: Siblings) -> list[tuple[str, Action]]:
    """Return the words of an <Action>; if there are several, the later ones get the name with a number."""
    inner = node.required(*ACTIONS)
    words = [] if inner is None else read_actions(inner)
    name = names.name(node)
    return [(name if number == 0 else f"{name}.{number + 1}", word) for number, word in enumerate(words)]


def _count(node: Node) -> int:
    return max(1, node.integer("maximumExecutionCount", 1))
