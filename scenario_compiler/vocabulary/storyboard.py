"""The storyboard: stories, acts, maneuver groups, maneuvers, events and triggers, as in ASAM OpenSCENARIO.

Both languages are lowered to it. `When` is our notation for an event that is executed once, in parallel, without an
edge.
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

    actions: tuple[Action, ...] = child("The actions, in order.")


class All(Word):
    """Conditions inside `<any>`, all of which must be true."""

    word: Literal["all"] = "all"

    conditions: tuple[Condition, ...] = child("The conditions, all of which must be true at once.")


class AnyOf(Word):
    """Conditions, at least one of which must be true."""

    word: Literal["any"] = "any"

    conditions: tuple[Condition | All, ...] = child("The conditions, at least one of which must be true.")


class When(Word):
    """Actions that the actor performs once, as soon as all conditions are true."""

    word: Literal["when"] = "when"

    name: str = attribute(
        "Name of the event, for <event> and the event log.", default="", defines="event", pattern=f"({ENTITY_ID})?"
    )
    conditions: tuple[Condition | AnyOf, ...] = child("The conditions, all of which must be true at once.")
    do: Do = child("The actions.")


class TriggerCondition(Word):
    """A condition with its edge and delay."""

    name: str = attribute("Name of the condition.", default="")
    condition: Condition = child("The condition.")
    entities: tuple[str, ...] = attribute(
        "Ids of the triggering entities, instead of the condition's own entity.",
        default=(),
        names="entity",
        separated=True,
    )
    every: bool = attribute("Whether all of them must meet the condition; if false, one is enough.", default=False)
    edge: Edge = attribute("The change of the condition that triggers.", default="none")
    delay: Number = attribute("Delay of the trigger, s.", default=0.0, quantity="time", minimum=0)


class ConditionGroup(Word):
    """Conditions that must all be true."""

    conditions: tuple[TriggerCondition, ...] = child("The conditions, all of which must be true.")


class Trigger(Word):
    """True when any of its groups is true. A trigger without a group is never true."""

    groups: tuple[ConditionGroup, ...] = child("The groups, at least one of which must be true.", default=())


class StoryAction(Word):
    """A named action of an event."""

    name: str = attribute("Name of the action, for messages and the event log.")
    action: Action = child("The action.")


class Event(Word):
    """Actions that start together when the trigger is true. Without a trigger they start with their act."""

    name: str = attribute("Name of the event.")
    priority: Priority = attribute("Effect on the maneuver's other running events.", default="parallel")
    maximum_execution_count: int = attribute("Greatest number of executions.", default=1, minimum=1)
    start: Trigger | None = child("Start trigger.", default=None)
    actions: tuple[StoryAction, ...] = child("What happens.")


class Maneuver(Word):
    """Events of one maneuver."""

    name: str = attribute("Name of the maneuver.")
    events: tuple[Event, ...] = child("Its events.", default=())


class ManeuverGroup(Word):
    """Maneuvers and the entities that execute them."""

    name: str = attribute("Name of the group.")
    maximum_execution_count: int = attribute("Greatest number of executions.", default=1, minimum=1)
    actors: tuple[str, ...] = attribute("Ids of the entities.", default=(), names="entity", separated=True)
    maneuvers: tuple[Maneuver, ...] = child("Its maneuvers.", default=())


class Act(Word):
    """A part of a story with a start trigger and a stop trigger of its own."""

    name: str = attribute("Name of the act.")
    start: Trigger | None = child("Start trigger; the act starts at once without one.", default=None)
    stop: Trigger | None = child("Stop trigger.", default=None)
    groups: tuple[ManeuverGroup, ...] = child("Its maneuver groups.", default=())


class Story(Word):
    """Acts of one story."""

    name: str = attribute("Name of the story.")
    acts: tuple[Act, ...] = child("Its acts.", default=())


class InitAction(Word):
    """An action of the init: executed at the start, in document order but after those that it depends on."""

    entity: str = attribute("Id of the entity; empty for actions on the run as a whole.", default="", names="entity")
    action: Action = child("The action.")


class Storyboard(Word):
    """Everything that happens in a run, in document order."""

    init: tuple[InitAction, ...] = child("Actions executed at the start.", default=())
    stories: tuple[Story, ...] = child("Its stories.", default=())
    stop: Trigger | None = child("Stop trigger: the run ends.", default=None)

    def events(self) -> Iterator[tuple[ManeuverGroup, Event]]:
        """Yield every event of the stories with the maneuver group that executes it, in document order."""
        for group in (group for story in self.stories for act in story.acts for group in act.groups):
            for maneuver in group.maneuvers:
                yield from ((group, event) for event in maneuver.events)

    def actions(self) -> Iterator[tuple[str, Action]]:
        """Yield every action with each entity that executes it (empty for none): the init's, then the stories'."""
        for initial in self.init:
            yield initial.entity, initial.action
        yield from self.story_actions()

    def story_actions(self) -> Iterator[tuple[str, Action]]:
        """Yield every action of the stories with each entity that executes it (empty for none)."""
        for group, event in self.events():
            for named in event.actions:
                yield from ((actor, named.action) for actor in group.actors or ("",))
