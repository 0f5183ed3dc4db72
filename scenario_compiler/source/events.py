"""Converts `<when>` to the storyboard: an event that runs once, in parallel, without an edge."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from itertools import chain, product
from math import prod

from scenario_compiler.source.conflict import EntityWhen
from scenario_compiler.vocabulary.conditions import Condition
from scenario_compiler.vocabulary.storyboard import (
    Act,
    All,
    AnyOf,
    ConditionGroup,
    Event,
    Maneuver,
    ManeuverGroup,
    Story,
    StoryAction,
    Storyboard,
    Trigger,
    TriggerCondition,
    When,
)

STORY, ACT = "story", "act"
"""Names of the only story and the only act."""


MOST_WAYS = 1000
"""Greatest number of condition groups that the choices of one `<when>` may produce."""


def storyboard_of(entities: Sequence[str], happenings: Iterable[tuple[str, When | EntityWhen]]) -> Storyboard:
    """Return the storyboard of the entities' events.

    Args:
        entities: Ids in document order; each with an event gets a maneuver group.
        happenings: Pairs of entity id and event, with resolved references.
    """
    events: dict[str, list[Event]] = {entity: [] for entity in entities}
    for entity, when in happenings:
        name = when.name or f"{entity}.when{len(events[entity]) + 1}"
        events[entity].append(_event(name, entity, when))
    groups = tuple(
        ManeuverGroup.model_construct(
            name=entity,
            actors=(entity,),
            maneuvers=(Maneuver.model_construct(name=f"{entity}.whens", events=tuple(theirs)),),
        )
        for entity, theirs in events.items()
        if theirs
    )
    if not groups:
        return Storyboard.model_construct()
    return Storyboard.model_construct(
        stories=(Story.model_construct(name=STORY, acts=(Act.model_construct(name=ACT, groups=groups),)),)
    )


def _event(name: str, entity: str, when: When | EntityWhen) -> Event:
    groups = tuple(
        ConditionGroup.model_construct(conditions=tuple(_trigger_condition(one, entity) for one in conditions))
        for conditions in alternatives(when.conditions)
    )
    trigger = Trigger.model_construct(groups=groups).written_at(when.origin)
    counts: Counter[str] = Counter()
    actions = []
    for action in when.do.actions:
        counts[action.word] += 1
        label = f"{name}.{action.word}{counts[action.word]}"
        actions.append(StoryAction.model_construct(name=label, action=action).written_at(action.origin))
    return Event.model_construct(name=name, start=trigger, actions=tuple(actions)).written_at(when.origin)


def ways(conditions: Sequence[Condition | AnyOf]) -> int:
    """Return the number of `alternatives`, without computing them."""
    return prod(len(one.conditions) for one in conditions if isinstance(one, AnyOf))


def alternatives(conditions: Sequence[Condition | AnyOf]) -> list[tuple[Condition, ...]]:
    """Return the condition groups of which one must hold completely: one for each way to fulfil every `<any>`."""
    ways: list[list[tuple[Condition, ...]]] = []
    for one in conditions:
        if isinstance(one, AnyOf):
            ways.append([each.conditions if isinstance(each, All) else (each,) for each in one.conditions])
        else:
            ways.append([(one,)])
    return [tuple(chain.from_iterable(way)) for way in product(*ways)]


def _trigger_condition(condition: Condition, entity: str) -> TriggerCondition:
    """Wrap a condition; one without an entity watches the entity of its event."""
    if getattr(condition, "entity", None) == "":
        condition = condition.model_copy(update={"entity": entity})
    return TriggerCondition.model_construct(condition=condition).written_at(condition.origin)
