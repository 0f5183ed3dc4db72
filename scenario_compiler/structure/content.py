"""The allowed order and number of an element's children, as an automaton over tags.

A content model is a tree of names, sequences, choices and repetitions. Its automaton is Glushkov's: it has one position
for each name in the model, and for each position the set of positions that may follow. States are built when they are
first reached. Children in any order, each at most once, have an automaton of their own, whose states are the positions
that have occurred.

Source: V. M. Glushkov, The abstract theory of automata, Russian Mathematical Surveys 16 (1961).
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import ClassVar


@dataclass(frozen=True, slots=True)
class Name:
    """A child: its tag and the name of its declaration."""

    tag: str
    declaration: str


@dataclass(frozen=True, slots=True)
class Sequence:
    """Parts in this order."""

    parts: tuple[Model, ...]


@dataclass(frozen=True, slots=True)
class Choice:
    """Exactly one of the parts."""

    parts: tuple[Model, ...]


@dataclass(frozen=True, slots=True)
class Repeat:
    """A part repeated at least `least` and at most `most` times; None for `most` is unbounded."""

    part: Model
    least: int
    most: int | None


Model = Name | Sequence | Choice | Repeat

State = frozenset[int]
"""The positions to which the last child may correspond; position 0 is the start."""


@dataclass(slots=True)
class _Ends:
    """Positions at which a part may begin and end, and whether it may be empty."""

    first: frozenset[int]
    last: frozenset[int]
    empty: bool


@dataclass
class Content:
    """The automaton of one content model."""

    start: ClassVar[State] = frozenset({0})

    names: list[Name] = field(default_factory=lambda: [Name("", "")])
    _follow: list[set[int]] = field(default_factory=lambda: [set()])
    _last: frozenset[int] = frozenset()
    _moves: dict[tuple[State, str], State] = field(default_factory=dict)
    _missing: dict[tuple[State, str | None], tuple[list[str], State] | None] = field(default_factory=dict)

    @classmethod
    def of(cls, model: Model) -> Content:
        """Build the automaton of a model."""
        content = cls()
        ends = content._add(model)
        content._follow[0] |= ends.first
        content._last = ends.last | ({0} if ends.empty else frozenset())
        return content

    def declaration(self, tag: str) -> str | None:
        """Return the declaration of a child; None if no child has that tag."""
        return next((name.declaration for name in self.names if name.tag == tag), None)

    def tags(self) -> list[str]:
        """Return the tags of the children, each once, in the order of the model."""
        return list(dict.fromkeys(name.tag for name in self.names[1:]))

    def move(self, state: State, tag: str) -> State:
        """Return the state after one more child; empty if the child is not allowed there."""
        key = (state, tag)
        found = self._moves.get(key)
        if found is None:
            found = frozenset(nearby for at in state for nearby in self._follow[at] if self.names[nearby].tag == tag)
            self._moves[key] = found
        return found

    def expected(self, state: State) -> list[str]:
        """Return the tags of the children that may come next, each once, in the order of the model."""
        return [tag for tag in self.tags() if self.move(state, tag)]

    def complete(self, state: State) -> bool:
        """Return whether the children may end here."""
        return not self._last.isdisjoint(state)

    def fits_sorted(self, tags: Iterable[str]) -> bool:
        """Return whether these children, all with known tags, would be complete in the model's order."""
        first = {name.tag: at for at, name in reversed(list(enumerate(self.names)))}
        state = self.start
        for tag in sorted(tags, key=lambda tag: first[tag]):
            state = self.move(state, tag)
        return self.complete(state)

    def missing(self, state: State, tag: str | None) -> tuple[list[str], State] | None:
        """Return the fewest children missing before `tag` (None: before the end), and the state after all of them."""
        key = (state, tag)
        if key not in self._missing:
            self._missing[key] = self._shortest(state, tag)
        return self._missing[key]

    def choices(self, state: State, tag: str | None) -> list[list[str]]:
        """Return what `missing` returns, for each child with the others that could stand in its place."""
        found = self.missing(state, tag)
        children = [] if found is None else found[0]
        choices = []
        for number, child in enumerate(children):
            after = len(children) - number - 1
            choices.append(
                [one for one in self.expected(state) if one == child or self._replaces(state, one, child, tag, after)]
            )
            state = self.move(state, child)
        return choices

    def _replaces(self, state: State, one: str, child: str, tag: str | None, after: int) -> bool:
        """Return whether, with one child in place of another, no more are missing than `after`, and not that other."""
        missing = self.missing(self.move(state, one), tag)
        return missing is not None and len(missing[0]) == after and child not in missing[0]

    def _shortest(self, state: State, tag: str | None) -> tuple[list[str], State] | None:
        queue: deque[tuple[State, list[str]]] = deque([(state, [])])
        seen = {state}
        while queue:
            at, path = queue.popleft()
            if tag is None and self.complete(at):
                return path, at
            if tag is not None and (after := self.move(at, tag)):
                return path, after
            for other in dict.fromkeys(
                self.names[nearby].tag for one in sorted(at) for nearby in sorted(self._follow[one])
            ):
                after = self.move(at, other)
                if after not in seen:
                    seen.add(after)
                    queue.append((after, [*path, other]))
        return None

    def _add(self, model: Model) -> _Ends:
        if isinstance(model, Name):
            self.names.append(model)
            self._follow.append(set())
            here = frozenset({len(self.names) - 1})
            return _Ends(here, here, False)
        if isinstance(model, Choice):
            parts = [self._add(part) for part in model.parts]
            first = frozenset().union(*(part.first for part in parts))
            last = frozenset().union(*(part.last for part in parts))
            return _Ends(first, last, any(part.empty for part in parts))
        if isinstance(model, Sequence):
            return self._chain([self._add(part) for part in model.parts])
        return self._repeat(model)

    def _chain(self, parts: list[_Ends]) -> _Ends:
        whole = _Ends(frozenset(), frozenset(), True)
        for part in parts:
            for at in whole.last:
                self._follow[at] |= part.first
            first = whole.first | part.first if whole.empty else whole.first
            last = whole.last | part.last if part.empty else part.last
            whole = _Ends(first, last, whole.empty and part.empty)
        return whole

    def _repeat(self, model: Repeat) -> _Ends:
        copies = []
        for i in range(max(model.least, model.most or 1)):
            part = self._add(model.part)
            copies.append(_Ends(part.first, part.last, part.empty or i >= model.least))
        if model.most is None:
            for at in copies[-1].last:
                self._follow[at] |= copies[-1].first
        return self._chain(copies)


@dataclass
class AnyOrder(Content):
    """The automaton of children in any order, each at most once; a state is the set of those that have occurred."""

    _needed: frozenset[int] = frozenset()

    @classmethod
    def of_parts(cls, parts: Iterable[tuple[Name, bool]]) -> AnyOrder:
        """Build it from the children, each with whether it is required."""
        content = cls()
        needed = set()
        for name, required in parts:
            content.names.append(name)
            if required:
                needed.add(len(content.names) - 1)
        content._needed = frozenset(needed)
        return content

    def move(self, state: State, tag: str) -> State:
        """Return the state after one more child; empty if the child is unknown or has already occurred."""
        at = next((at for at, name in enumerate(self.names) if at and name.tag == tag), 0)
        return state | {at} if at and at not in state else frozenset()

    def complete(self, state: State) -> bool:
        """Return whether all required children have occurred."""
        return self._needed <= state

    def _shortest(self, state: State, tag: str | None) -> tuple[list[str], State] | None:
        if tag is not None:
            return None
        lacking = self._needed - state
        return [self.names[at].tag for at in sorted(lacking)], state | lacking
