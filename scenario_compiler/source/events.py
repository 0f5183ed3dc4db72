"""`<when>` to the storyboard: an event without edge, once, in parallel, in its actor's maneuver group."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

from scenario_compiler.source.conflict import EntityWhen
from scenario_compiler.vocabulary.conditions import Condition
from scenario_compiler.vocabulary.storyboard import (
    Act,
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
"""Names of the one story and the one act."""


def storyboard_of(entities: Sequence[str], happenings: Iterable[tuple[str, When | EntityWhen]]) -> Storyboard:
    """Return the storyboard of what happens to whom.

    Args:
        entities: Ids in document order; a maneuver group for each that does something.
        happenings: Id of the entity, and what it does; references are resolved.
    """
    events: dict[str, list[Event]] = {entity: [] for entity in entities}
    for entity, when in happenings:
        events[entity].append(_event(f"{entity}.when{len(events[entity]) + 1}", entity, when))
    groups = tuple(
        ManeuverGroup(
            name=entity,
            actors=(entity,),
            maneuvers=(Maneuver(name=f"{entity}.whens", events=tuple(theirs)),),
        )
        for entity, theirs in events.items()
        if theirs
    )
    if not groups:
        return Storyboard()
    return Storyboard(stories=(Story(name=STORY, acts=(Act(name=ACT, groups=groups),)),))


def _event(name: str, entity: str, when: When | EntityWhen) -> Event:
    conditions = tuple(_trigger_condition(one, entity) for one in when.conditions)
    trigger = Trigger(groups=(ConditionGroup(conditions=conditions),)).written_at(when.origin)
    counts: Counter[str] = Counter()
    actions = []
    for action in when.do.actions:
        counts[action.word] += 1
        label = f"{name}.{action.word}{counts[action.word]}"
        actions.append(StoryAction(name=label, action=action).written_at(action.origin))
    return Event(name=name, start=trigger, actions=tuple(actions)).written_at(when.origin)


def _trigger_condition(condition: Condition, entity: str) -> TriggerCondition:
    """Wrap a condition; one that names no entity watches the one that holds it."""
    if getattr(condition, "entity", None) == "":
        condition = condition.model_copy(update={"entity": entity})
    return TriggerCondition(condition=condition).written_at(condition.origin)
