"""What the log says of actions that move nothing: lights, animations, commands and traffic signals."""

from __future__ import annotations

from collections.abc import Iterator

from scenario_compiler.plan.model import Plan
from scenario_compiler.vocabulary.actions import (
    RUN_ACTIONS,
    AnimationAction,
    CommandAction,
    LightAction,
    TrafficSignalControllerAction,
    TrafficSignalStateAction,
)
from scenario_compiler.vocabulary.word import Word

OF_ACTIONS = frozenset({"light", "command", "signal"})
"""Kinds of events whose value is the action's row in the program."""


def actions_of(plan: Plan) -> Iterator[tuple[Word, str]]:
    """Yield each action with the entity that does it, empty for none, in the order of a program's rows."""
    for entity in plan.entities:
        if entity.path is not None:
            yield entity.path, entity.id
    for initial in plan.storyboard.init:
        yield initial.action, initial.entity
    for group, event in plan.storyboard.events():
        for named in event.actions:
            actors = ("",) if isinstance(named.action, RUN_ACTIONS) else group.actors
            yield from ((named.action, actor) for actor in actors)


def action_text(word: Word) -> tuple[str, str]:
    """Return what an action is about, and what it does there."""
    if isinstance(word, LightAction):
        return word.type, word.mode
    if isinstance(word, AnimationAction):
        return word.type, f"to {word.state:g}" if isinstance(word.state, float) else "moves"
    if isinstance(word, CommandAction):
        return word.type, word.content
    if isinstance(word, TrafficSignalStateAction):
        return word.signal, word.state
    if isinstance(word, TrafficSignalControllerAction):
        return word.controller, word.phase
    return "", ""
