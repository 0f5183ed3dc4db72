"""Names of storyboard elements: full paths, and the element to which a shorter name in a condition refers."""

from __future__ import annotations

from dataclasses import dataclass, field

from scenario_compiler.diagnostics import Diagnostics, Place, did_you_mean
from scenario_compiler.markup.names import first_at
from scenario_compiler.openscenario.codes import (
    AMBIGUOUS_STORYBOARD_ELEMENT,
    DUPLICATE_ELEMENT,
    UNKNOWN_STORYBOARD_ELEMENT,
)
from scenario_compiler.openscenario.node import Node
from scenario_compiler.vocabulary.conditions import ElementStateCondition
from scenario_compiler.vocabulary.conditions.by_value import ELEMENT_KINDS
from scenario_compiler.vocabulary.storyboard import Story, Storyboard
from scenario_compiler.vocabulary.traversal import replaced
from scenario_compiler.vocabulary.word import Word

BETWEEN = "::"
"""Separator of the names in a path."""

MOST_GUESSES = 100
"""Greatest number of unknown names for which a similar known one is searched."""

Path = tuple[str, ...]


@dataclass
class Siblings:
    """The names of sibling elements of one kind."""

    taken: dict[str, Place] = field(default_factory=dict)
    counts: dict[str, int] = field(default_factory=dict)

    def name(self, node: Node) -> str:
        """Return an element's name; report one that a sibling has already, and append a number to it."""
        written = node.text("name", "") or node.tag
        name, number = written, self.counts.get(written, 1)
        while name in self.taken:
            number += 1
            name = f"{written}#{number}"
        self.counts[written] = number
        if name != written:
            message = f"<{node.tag}> '{written}' has the same name as another one beside it"
            node.report(DUPLICATE_ELEMENT, message, "name", related=first_at(self.taken.get(written)))
        self.taken[name] = node.place("name")
        return name


def with_full_names(storyboard: Storyboard, sink: Diagnostics) -> Storyboard:
    """Return the storyboard with the full path of the element in each condition on an element's state."""
    names = ElementNames()
    for story in storyboard.stories:
        names.add_story(story)
    stories = tuple(_resolved(story, names, (story.name,), sink) for story in storyboard.stories)
    stop = None if storyboard.stop is None else replaced(storyboard.stop, lambda word: names.meant(word, (), sink))
    return storyboard.model_copy(update={"stories": stories, "stop": stop})


def _resolved(story: Story, names: ElementNames, path: Path, sink: Diagnostics) -> Story:
    return replaced(story, lambda word: names.meant(word, path, sink))


@dataclass
class ElementNames:
    """The paths of all elements by kind and own name, in document order."""

    paths: dict[str, dict[str, list[Path]]] = field(default_factory=lambda: {kind: {} for kind in ELEMENT_KINDS})
    unknown: int = 0

    def add_story(self, story: Story) -> None:
        """Register a story and all elements in it."""
        self._add((story.name,))
        for act in story.acts:
            self._add((story.name, act.name))
            for group in act.groups:
                self._add((story.name, act.name, group.name))
                for maneuver in group.maneuvers:
                    path = (story.name, act.name, group.name, maneuver.name)
                    self._add(path)
                    for event in maneuver.events:
                        self._add((*path, event.name))
                        for action in event.actions:
                            self._add((*path, event.name, action.name))

    def _add(self, path: Path) -> None:
        self.paths[ELEMENT_KINDS[len(path) - 1]].setdefault(path[-1], []).append(path)

    def _fitting(self, kind: str, wanted: Path) -> list[Path]:
        named = self.paths[kind].get(wanted[-1], []) if wanted else []
        return [path for path in named if _fits(path, wanted)]

    def meant(self, word: Word, around: Path, sink: Diagnostics) -> Word:
        """Return a condition on an element's state with the element's full path; return any other word unchanged."""
        if not isinstance(word, ElementStateCondition):
            return word
        wanted = tuple(part for part in word.element.split(BETWEEN) if part)
        fitting = self._fitting(word.kind, wanted)
        if not fitting:
            self._report_unknown(word, wanted, sink)
            return word
        nearest = max(fitting, key=lambda path: _shared(path, around))
        if len(fitting) > 1:
            message = f"{len(fitting)} elements are called '{word.element}'; {BETWEEN.join(nearest)} is used"
            sink.add(AMBIGUOUS_STORYBOARD_ELEMENT, message, word.place_of("storyboardElementRef"))
        return word.model_copy(update={"element": BETWEEN.join(nearest)}).written_at(word.origin)

    def _report_unknown(self, word: ElementStateCondition, wanted: Path, sink: Diagnostics) -> None:
        others = [kind for kind in ELEMENT_KINDS if self._fitting(kind, wanted)]
        known = self.paths[word.kind]
        self.unknown += 1
        guess = did_you_mean(word.element, known) if self.unknown <= MOST_GUESSES else ""
        hint = f"there is {_article(others[0])} of that name" if others else guess
        message = f"there is no {word.kind} '{word.element}'"
        sink.add(UNKNOWN_STORYBOARD_ELEMENT, message, word.place_of("storyboardElementRef"), hint=hint)


def _article(kind: str) -> str:
    return f"{'an' if kind[0] in 'aeiou' else 'a'} {kind}"


def _fits(path: Path, wanted: Path) -> bool:
    """Return whether `wanted`, the names of an element and of some of its parents in order, match a path."""
    rest = iter(path[:-1])
    return all(any(name == one for one in rest) for name in wanted[:-1])


def _shared(path: Path, around: Path) -> int:
    """Return the number of leading names that two paths have in common."""
    count = 0
    for one, other in zip(path, around, strict=False):
        if one != other:
            break
        count += 1
    return count
