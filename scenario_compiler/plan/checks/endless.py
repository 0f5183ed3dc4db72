"""Checks that nothing waits for the end of an action that ends only when another one replaces it."""

from __future__ import annotations

from collections.abc import Iterator

from scenario_compiler.diagnostics import Code, Diagnostics, Related, Severity
from scenario_compiler.plan.model import Plan
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.actions import AnimationAction, LimitedLaneOffsetAction
from scenario_compiler.vocabulary.conditions import ElementStateCondition, EventCondition
from scenario_compiler.vocabulary.conditions.by_value import ELEMENT_KINDS
from scenario_compiler.vocabulary.traversal import walk
from scenario_compiler.vocabulary.word import Word

NEVER_ENDS = Code(
    "SC290",
    "never-ends",
    "A trigger waits for the end of an element that contains a continuous action. According to the standard, such an "
    "action keeps its speed, distance or offset, or repeats its animation, and never ends by itself. The trigger "
    "therefore waits until another action replaces it. esmini ends a continuous LaneOffsetAction at its target.\n\n"
    '    <LaneOffsetAction continuous="true"> ... <StoryboardElementStateCondition ... state="completeState"/>\n\n'
    'Write continuous="false" if the action should end at its target, or loop="false" for an animation.',
    Severity.WARNING,
)

AT_AN_END = frozenset({"completeState", "endTransition", "complete"})
"""States and transitions that an element reaches at its end."""


def check_endless(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Warn of conditions that wait for the end of an element with a continuous action."""
    del network
    endless = dict(_endless(plan))
    for word in walk(plan.storyboard):
        if isinstance(word, ElementStateCondition):
            kind, name = word.kind, word.element
        elif isinstance(word, EventCondition):
            kind, name = "event", word.name
        else:
            continue
        action = endless.get((kind, name))
        if word.state in AT_AN_END and action is not None:
            ends = "; esmini ends it at its target" if isinstance(action, LimitedLaneOffsetAction) else ""
            message = f"the {kind} '{name}' never ends by itself: its <{action.tag()}> is continuous{ends}"
            related = (Related("the continuous action is here", action.origin),)
            hint = 'continuous="false" ends it at its target'
            if isinstance(action, AnimationAction):
                hint = 'loop="false" (continuous="false" in the conflict language) ends it after its duration'
            sink.add(NEVER_ENDS, message, word.origin, hint=hint, related=related)


def _endless(plan: Plan) -> Iterator[tuple[tuple[str, str], Word]]:
    """Yield (kind, name) of every element that contains a continuous action, with the action."""
    for story in plan.storyboard.stories:
        for act in story.acts:
            for group in act.groups:
                for maneuver in group.maneuvers:
                    for event in maneuver.events:
                        for one in event.actions:
                            if getattr(one.action, "continuous", False):
                                named = (story, act, group, maneuver, event, one)
                                yield from _named([element.name for element in named], one.action)


def _named(names: list[str], action: Word) -> Iterator[tuple[tuple[str, str], Word]]:
    """Yield (kind, name) of an action and the elements around it, with names from the last part to the full one."""
    for depth, kind in enumerate(ELEMENT_KINDS, 1):
        for first in range(depth):
            yield (kind, "::".join(names[first:depth])), action
