"""The storyboard: the actions of the init, then the elements from stories down to actions, in document order."""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.moves.table import ACTIONS
from scenario_compiler.engine.moves.table import NUMBERS as ACTION_NUMBERS
from scenario_compiler.engine.program.plan_builder import PlanBuilder
from scenario_compiler.engine.story.of_run import NAMED_EVENT
from scenario_compiler.engine.story.table import CONDITIONS
from scenario_compiler.engine.story.table import NUMBERS as CONDITION_NUMBERS
from scenario_compiler.vocabulary.storyboard import Edge, Event, ManeuverGroup, Priority, Trigger, TriggerCondition
from scenario_compiler.vocabulary.word import Word

EDGES: dict[Edge, int] = {
    "none": op.EDGE_NONE,
    "rising": op.EDGE_RISING,
    "falling": op.EDGE_FALLING,
    "risingOrFalling": op.EDGE_BOTH,
}

PRIORITIES: dict[Priority, int] = {
    "override": op.PRIORITY_OVERRIDE,
    "skip": op.PRIORITY_SKIP,
    "parallel": op.PRIORITY_PARALLEL,
}

MOST_EXECUTIONS = (1 << 30) - 1
"""Number of executions that no run reaches; greater limits are reduced to it."""


def is_of_the_run(word: Word) -> bool:
    """Return whether an action is executed once, regardless of the number of actors."""
    return ACTIONS[ACTION_NUMBERS[word.tag()]].of_the_run


def add_action(draft: PlanBuilder, word: Word, actor: int) -> int:
    """Append an action of an entity, or of none (NONE); return its row.

    Raises:
        ValueError: The engine has no action for the word.
    """
    if word.tag() not in ACTION_NUMBERS:
        raise ValueError(f"the engine has no action for <{word.tag()}>")
    number = ACTION_NUMBERS[word.tag()]
    return draft.add_action(number, ACTIONS[number].row(draft, word, actor), actor)


def add_trigger(draft: PlanBuilder, trigger: Trigger | None, owner: int) -> int:
    """Append a trigger of an element (NONE: of the storyboard); return its row, NONE for no trigger or an empty one."""
    if trigger is None or not trigger.groups:
        return op.NONE
    p = draft.program
    for group in trigger.groups:
        for condition in group.conditions:
            add_condition(draft, condition, owner)
        p.group_first.append(p.condition_count[0])
    p.trigger_first.append(len(p.group_first) - 1)
    return len(p.trigger_first) - 2


def add_condition(draft: PlanBuilder, wrapped: TriggerCondition, owner: int) -> None:
    """Append a condition to the group under construction, with the trigger's triggering entities, or its own.

    Raises:
        ValueError: The engine has no condition for the word.
    """
    word = wrapped.condition
    if word.tag() not in CONDITION_NUMBERS:
        raise ValueError(f"the engine has no condition for <{word.tag()}>")
    number = CONDITION_NUMBERS[word.tag()]
    row = CONDITIONS[number].row(draft, word)
    own = (row.entity,) if row.entity else ()
    entities = [draft.entities[name] for name in wrapped.entities or own]
    draft.add_condition(number, row, entities, wrapped.every, EDGES[wrapped.edge], wrapped.delay, owner)


def add_init(draft: PlanBuilder) -> None:
    """Append the paths that entities begin with, then the actions of the storyboard's init, in document order."""
    for i, entity in enumerate(draft.plan.entities):
        if entity.path is not None:
            _add_initial(draft, entity.path, i)
    for initial in draft.plan.storyboard.init:
        actor = draft.entities[initial.entity] if initial.entity else draft.program.ego[0]
        _add_initial(draft, initial.action, actor)


def _add_initial(draft: PlanBuilder, action: Word, actor: int) -> None:
    p = draft.program
    p.init_action.append(add_action(draft, action, actor))
    p.init_count[0] = len(p.init_action)


def add_storyboard(draft: PlanBuilder) -> None:
    """Append all stories, and the stop trigger."""
    p, board = draft.program, draft.plan.storyboard
    p.stop_trigger[0] = add_trigger(draft, board.stop, op.NONE)
    for story in board.stories:
        at = draft.element(op.ELEMENT_STORY, op.NONE)
        draft.note("story", story.name, at)
        for act in story.acts:
            next_at = p.element_count[0]
            start, stop = add_trigger(draft, act.start, next_at), add_trigger(draft, act.stop, next_at)
            act_at = draft.element(op.ELEMENT_ACT, at, start=start, stop=stop)
            path = f"{story.name}::{act.name}"
            draft.note("act", path, act_at)
            for group in act.groups:
                _add_group(draft, group, act_at, f"{path}::{group.name}")
    draft.find_awaited()


def _add_group(draft: PlanBuilder, group: ManeuverGroup, parent: int, path: str) -> None:
    at = draft.element(op.ELEMENT_GROUP, parent, limit=min(group.maximum_execution_count, MOST_EXECUTIONS))
    draft.note("maneuverGroup", path, at)
    actors = [draft.entities[actor] for actor in group.actors]
    for maneuver in group.maneuvers:
        maneuver_at = draft.element(op.ELEMENT_MANEUVER, at)
        draft.note("maneuver", f"{path}::{maneuver.name}", maneuver_at)
        for event in maneuver.events:
            _add_event(draft, event, maneuver_at, actors, f"{path}::{maneuver.name}::{event.name}")


def _add_event(draft: PlanBuilder, event: Event, parent: int, actors: list[int], path: str) -> None:
    """Append an event and its actions: each once for every actor, those of the run as a whole once."""
    at = draft.element(
        op.ELEMENT_EVENT,
        parent,
        start=add_trigger(draft, event.start, draft.program.element_count[0]),
        limit=min(event.maximum_execution_count, MOST_EXECUTIONS),
        priority=PRIORITIES[event.priority],
    )
    draft.note("event", path, at)
    draft.note(NAMED_EVENT, event.name, at)
    for named in event.actions:
        of_all = [draft.program.ego[0]] if is_of_the_run(named.action) else actors
        for actor in of_all:
            action_at = draft.element(op.ELEMENT_ACTION, at, action=add_action(draft, named.action, actor))
            draft.note("action", f"{path}::{named.name}", action_at)
