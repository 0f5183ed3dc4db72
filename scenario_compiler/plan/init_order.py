"""The order in which the actions of the init are executed: each after those that it depends on.

OpenSCENARIO does not define an order, and files place entities relative to others that come later in the file. An
action that places an entity relative to another one follows the action that places the other one, and likewise for
speeds; otherwise the order is that of the file. esmini 3.6 does the same.
"""

from __future__ import annotations

from bisect import bisect_left
from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Sequence

from scenario_compiler.plan.model import Entity
from scenario_compiler.vocabulary.actions import RelativeSpeedAction, SpeedAction, TeleportAction
from scenario_compiler.vocabulary.storyboard import InitAction
from scenario_compiler.vocabulary.traversal import entities_named
from scenario_compiler.vocabulary.word import Word


def placed_before(entities: Iterable[Entity]) -> frozenset[str]:
    """Return the ids of the entities that have a position and a speed before the init."""
    return frozenset(one.id for one in entities if one.start is not None or one.path is not None)


def in_order(init: Sequence[InitAction], started: Collection[str]) -> tuple[InitAction, ...]:
    """Return the actions of the init in the order of their execution.

    In a circle of dependencies the order of the file decides where it is broken: `circular` finds it.

    Args:
        init: The actions in the order of the file.
        started: Entities that have a position and a speed before the init.
    """
    needed = _Needs(init, started)
    found: dict[int, None] = {}
    seen: set[int] = set()
    for first in range(len(init)):
        path = [(first, needed.of(first))] if first not in seen else []
        seen.add(first)
        while path:
            at, needs = path[-1]
            following = next((need for need in needs if need not in seen), None)
            if following is None:
                found[at] = None
                path.pop()
            else:
                seen.add(following)
                path.append((following, needed.of(following)))
    return tuple(init[at] for at in found)


def circular(ordered: Sequence[InitAction], started: Collection[str]) -> Iterator[tuple[InitAction, InitAction]]:
    """Yield the actions that precede an action on which they depend, with that action."""
    needed = _Needs(ordered, started)
    for at, initial in enumerate(ordered):
        for need in needed.of_others(at):
            if need > at:
                yield initial, ordered[need]


def unplaced(ordered: Sequence[InitAction], started: Collection[str]) -> Iterator[InitAction]:
    """Yield the actions that place an entity relative to itself before it has a position."""
    placed = set(started)
    for initial in ordered:
        if isinstance(initial.action, TeleportAction):
            named = {name for name, _ in entities_named(initial.action)}
            if initial.entity in named - placed:
                yield initial
            placed.add(initial.entity)


class _Needs:
    """The actions that must precede each action of an init."""

    def __init__(self, init: Sequence[InitAction], started: Collection[str]) -> None:
        self.init = init
        self.started = started
        self._setting: dict[tuple[str, str], list[int]] = defaultdict(list)
        self._before: dict[int, int] = {}
        last: dict[str, int] = {}
        for at, initial in enumerate(init):
            self._setting[initial.entity, _sets(initial.action)].append(at)
            if initial.entity in last:
                self._before[at] = last[initial.entity]
            last[initial.entity] = at

    def of(self, at: int) -> Iterator[int]:
        """Yield the entity's own action before this one, and the actions of others on which it depends."""
        if at in self._before:
            yield self._before[at]
        yield from self.of_others(at)

    def of_others(self, at: int) -> Iterator[int]:
        """Yield, for each entity to which an action refers, the index of the action that sets the quantity it needs.

        It is the last such action before it, or the first one after it if there is none before.
        """
        action = self.init[at].action
        if not isinstance(action, TeleportAction | RelativeSpeedAction):
            return
        for name, _ in entities_named(action):
            setting = self._setting.get((name, _sets(action)), ())
            if setting and name not in self.started and name != self.init[at].entity:
                yield setting[max(bisect_left(setting, at) - 1, 0)]


def _sets(action: Word) -> str:
    """Return the quantity that an action sets at once and others can depend on; empty if there is none."""
    if isinstance(action, TeleportAction):
        return "position"
    return "speed" if isinstance(action, SpeedAction | RelativeSpeedAction) else ""
