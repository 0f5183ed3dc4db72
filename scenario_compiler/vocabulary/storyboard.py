"""The storyboard: stories, acts, maneuver groups, maneuvers, events and triggers, as ASAM OpenSCENARIO has them.

Both languages end here. `When` is our spelling of an event: no edge, once, parallel.
"""

from collections.abc import Iterator
from typing import Literal

from scenario_compiler.vocabulary.actions import Action
from scenario_compiler.vocabulary.conditions import Condition
from scenario_compiler.vocabulary.word import ENTITY_ID, Number, Word, attribute, child

Edge = Literal["none", "rising", "falling", "risingOrFalling"]
Priority = Literal["override", "skip", "parallel"]


class Do(Word):
    """The actions of a `<when>`."""

    word: Literal["do"] = "do"

    actions: tuple[Action, ...] = child("What happens, in this order.")


class All(Word):
    """Conditions inside `<any>` that must all be true."""

    word: Literal["all"] = "all"

    conditions: tuple[Condition, ...] = child("All of them must be true at once.")


class AnyOf(Word):
    """Conditions of which one suffices."""

    word: Literal["any"] = "any"

    conditions: tuple[Condition | All, ...] = child("One of them must be true.")


class When(Word):
    """Something the actor does once, as soon as all conditions are true."""

    word: Literal["when"] = "when"

    name: str = attribute(
        "Name of the event, for <event> and the event log.", default="", defines="event", pattern=f"({ENTITY_ID})?"
    )
    conditions: tuple[Condition | AnyOf, ...] = child("All of them must be true at once.")
    do: Do = child("What happens then.")


class TriggerCondition(Word):
    """A condition with its edge and delay."""

    name: str = attribute("Name of the condition.", default="")
    condition: Condition = child("What is watched.")
    entities: tuple[str, ...] = attribute(
        "Ids of the triggering entities, in place of the condition's own.", default=(), names="entity", separated=True
    )
    every: bool = attribute("Whether all of them must fulfil it, not any.", default=False)
    edge: Edge = attribute("Which change of the condition counts.", default="none")
    delay: Number = attribute("How much later the trigger sees it, s.", default=0.0, quantity="time", minimum=0)


class ConditionGroup(Word):
    """Conditions that must all be true."""

    conditions: tuple[TriggerCondition, ...] = child("All of them must be true.")


class Trigger(Word):
    """True when any of its groups is; without a group, never."""

    groups: tuple[ConditionGroup, ...] = child("Any of them suffices.", default=())


class StoryAction(Word):
    """A named action of an event."""

    name: str = attribute("Name of the action, for messages and the event log.")
    action: Action = child("What is done.")


class Event(Word):
    """Actions that start together when the trigger is true; without a trigger, with their act."""

    name: str = attribute("Name of the event.")
    priority: Priority = attribute("What happens to the maneuver's other running events.", default="parallel")
    maximum_execution_count: int = attribute("How often it may run.", default=1, minimum=1)
    start: Trigger | None = child("When it starts.", default=None)
    actions: tuple[StoryAction, ...] = child("What happens.")


class Maneuver(Word):
    """Events that belong together."""

    name: str = attribute("Name of the maneuver.")
    events: tuple[Event, ...] = child("Its events.", default=())


class ManeuverGroup(Word):
    """Maneuvers and the entities that carry them out."""

    name: str = attribute("Name of the group.")
    maximum_execution_count: int = attribute("How often it may run.", default=1, minimum=1)
    actors: tuple[str, ...] = attribute("Ids of the entities.", default=(), names="entity", separated=True)
    maneuvers: tuple[Maneuver, ...] = child("Its maneuvers.", default=())


class Act(Word):
    """A part of a story with its own start and stop."""

    name: str = attribute("Name of the act.")
    start: Trigger | None = child("When it starts; at once without one.", default=None)
    stop: Trigger | None = child("When it stops.", default=None)
    groups: tuple[ManeuverGroup, ...] = child("Its maneuver groups.", default=())


class Story(Word):
    """Acts that belong together."""

    name: str = attribute("Name of the story.")
    acts: tuple[Act, ...] = child("Its acts.", default=())


class InitAction(Word):
    """An action of the init: done at the start, in document order."""

    entity: str = attribute("Id of the entity; empty for actions on the run as a whole.", default="", names="entity")
    action: Action = child("What is done.")


class Storyboard(Word):
    """Everything that happens in a run, in document order."""

    init: tuple[InitAction, ...] = child("What is done at the start.", default=())
    stories: tuple[Story, ...] = child("Its stories.", default=())
    stop: Trigger | None = child("When the run ends.", default=None)

    def events(self) -> Iterator[tuple[ManeuverGroup, Event]]:
        """Yield every event of the stories with the group that carries it out, in document order."""
        for group in (group for story in self.stories for act in story.acts for group in act.groups):
            for maneuver in group.maneuvers:
                yield from ((group, event) for event in maneuver.events)

    def actions(self) -> Iterator[tuple[str, Action]]:
        """Yield every action with each entity that does it, empty for none: the init's, then the stories'."""
        for initial in self.init:
            yield initial.entity, initial.action
        for group, event in self.events():
            for named in event.actions:
                yield from ((actor, named.action) for actor in group.actors or ("",))
