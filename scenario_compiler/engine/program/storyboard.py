"""The storyboard: the actions of the init, then stories down to actions as elements in document order."""

from __future__ import annotations

from scenario_compiler.engine import opcodes as op
from scenario_compiler.engine.program.actions import add_action
from scenario_compiler.engine.program.conditions import add_trigger
from scenario_compiler.engine.program.conditions.by_value import NAMED_EVENT
from scenario_compiler.engine.program.draft import Draft
from scenario_compiler.vocabulary.actions import RUN_ACTIONS
from scenario_compiler.vocabulary.storyboard import Event, ManeuverGroup, Priority
from scenario_compiler.vocabulary.word import Word

PRIORITIES: dict[Priority, int] = {
    "override": op.PRIORITY_OVERRIDE,
    "skip": op.PRIORITY_SKIP,
    "parallel": op.PRIORITY_PARALLEL,
}

MOST_EXECUTIONS = (1 << 30) - 1
"""Executions that no run ever reaches: what allows more allows as many."""


def add_init(draft: Draft) -> None:
    """Append the paths that entities begin with, then the actions of the storyboard's init, in document order."""
    for i, entity in enumerate(draft.plan.entities):
        if entity.path is not None:
            _add_initial(draft, entity.path, i)
    for initial in draft.plan.storyboard.init:
        actor = draft.entities[initial.entity] if initial.entity else draft.program.ego[0]
        _add_initial(draft, initial.action, actor)


def _add_initial(draft: Draft, action: Word, actor: int) -> None:
    p = draft.program
    p.init_action.append(add_action(draft, action, actor))
    p.init_count[0] = len(p.init_action)


def add_storyboard(draft: Draft) -> None:
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


def _add_group(draft: Draft, group: ManeuverGroup, parent: int, path: str) -> None:
    at = draft.element(op.ELEMENT_GROUP, parent, limit=min(group.maximum_execution_count, MOST_EXECUTIONS))
    draft.note("maneuverGroup", path, at)
    actors = [draft.entities[actor] for actor in group.actors]
    for maneuver in group.maneuvers:
        maneuver_at = draft.element(op.ELEMENT_MANEUVER, at)
        draft.note("maneuver", f"{path}::{maneuver.name}", maneuver_at)
        for event in maneuver.events:
            _add_event(draft, event, maneuver_at, actors, f"{path}::{maneuver.name}::{event.name}")


def _add_event(draft: Draft, event: Event, parent: int, actors: list[int], path: str) -> None:
    """Append an event and its actions, each once an actor, those of the run as a whole once."""
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
        of_all = [draft.program.ego[0]] if isinstance(named.action, RUN_ACTIONS) else actors
        for actor in of_all:
            action_at = draft.element(op.ELEMENT_ACTION, at, action=add_action(draft, named.action, actor))
            draft.note("action", f"{path}::{named.name}", action_at)
