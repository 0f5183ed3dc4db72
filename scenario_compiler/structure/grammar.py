"""A format: its elements, words and kinds of values, in every version."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property

from lxml import etree

from scenario_compiler.diagnostics import Code
from scenario_compiler.structure.content import Model
from scenario_compiler.structure.notation import Declaration, Notation, in_versions
from scenario_compiler.structure.values import Kind

Condition = Callable[[etree._Element], Iterator[str]]
"""A function that yields the faults of an element."""


@dataclass(frozen=True, slots=True)
class Faults:
    """The codes of a format's faults; `walk` says when each is reported.

    Attributes:
        unknown_element: An element that the format does not allow there.
        unknown_attribute: An attribute that the element does not have.
        missing_attribute: A required attribute is missing.
        missing_element: A required child is missing.
        bad_value: A value is not of its kind.
        order: The children are those that are needed, in another order.
        misplaced: A child stands too often or too late.
        stray_text: Text between elements.
        excluded: A condition of the format is not met; None if the format has no conditions.
        blank: Blanks in an element that must be empty; None if they are allowed.
        other_version: A word of another version; None if that is a fault like any other.
        loose: A value that only looks different from what it should be; None as above.
        out_of_range: A number beyond its range; None if the format has no ranges.
    """

    unknown_element: Code
    unknown_attribute: Code
    missing_attribute: Code
    missing_element: Code
    bad_value: Code
    order: Code
    misplaced: Code
    stray_text: Code
    excluded: Code | None = None
    blank: Code | None = None
    other_version: Code | None = None
    loose: Code | None = None
    out_of_range: Code | None = None


@dataclass(eq=False)
class Grammar:
    """A format: its elements, words and kinds of values in the versions 1.`minors`.

    Attributes:
        name: The format's name in messages.
        root: Tag of the root element, and the name of its declaration.
        tables: Declarations, as `notation` describes.
        words: Kinds of values that are words: the words with their versions, separated by " | ".
        kinds: The other kinds of values.
        minors: The minor versions that are declared, in order.
        faults: The codes of its faults.
        words_since: First minor version whose words are checked.
        required_since: First minor version that requires attributes.
        stands_for_word: Returns whether a text is allowed in place of any word.
        loosely: Returns the value of a kind (in a minor version) that a wrongly written text seems to mean, or None.
        groups: Models of the format's own words for children, by minor version.
        conditions: What an element demands beyond its declaration, by the declaration's name.
        conditions_since: First minor version with conditions.
    """

    name: str
    root: str
    tables: tuple[str, ...]
    words: Mapping[str, str]
    kinds: Mapping[str, Kind]
    minors: range
    faults: Faults
    words_since: int = 0
    required_since: int = 0
    stands_for_word: Callable[[str], bool] = lambda text: False
    loosely: Callable[[str, str, int], str | None] = lambda kind, text, minor: None
    groups: Mapping[str, Callable[[int], Model]] = field(default_factory=dict)
    conditions: Mapping[str, Condition] = field(default_factory=dict)
    conditions_since: int = 0

    _declared: dict[tuple[str, int], Declaration] = field(default_factory=dict, init=False)
    _words: dict[tuple[str, int], frozenset[str]] = field(default_factory=dict, init=False)
    _versions: dict[tuple[str, str | None], list[int]] = field(default_factory=dict, init=False)
    _reachable: dict[int, frozenset[str]] = field(default_factory=dict, init=False)

    def declaration(self, name: str, minor: int) -> Declaration:
        """Return a declaration in version 1.`minor`, even if no element of that version leads to it."""
        key = (name, minor)
        if key not in self._declared:
            self._declared[key] = self._notation(minor).declaration(name, self._blocks[name])
        return self._declared[key]

    def _notation(self, minor: int) -> Notation:
        return Notation(minor, minor >= self.required_since, self.groups)

    def declarations(self, minor: int) -> dict[str, Declaration]:
        """Return the declarations of version 1.`minor`, by name."""
        return {name: self.declaration(name, minor) for name in self._blocks}

    def words_of(self, kind: str, minor: int) -> frozenset[str]:
        """Return the words of a kind that version 1.`minor` knows."""
        key = (kind, minor)
        if key not in self._words:
            listed = (entry.partition("@") for entry in self.words[kind].split(" | "))
            self._words[key] = frozenset(word for word, _, span in listed if in_versions(span, minor))
        return self._words[key]

    def is_value(self, kind: str, text: str, minor: int) -> bool:
        """Return whether a text is a value of a kind ("" any) in a version."""
        if not kind:
            return True
        if kind in self.words:
            return minor < self.words_since or text in self.words_of(kind, minor) or self.stands_for_word(text)
        found = self.kinds[kind]
        return found.test(text if found.blanks else text.strip(" \t\n\r"), minor)

    def versions_of(self, tag: str, attribute: str | None = None) -> list[int]:
        """Return the minor versions in which any element of that tag (with that attribute) is declared."""
        key = (tag, attribute)
        if key not in self._versions:
            self._versions[key] = [minor for minor in self.minors if self._has(tag, attribute, minor)]
        return self._versions[key]

    def _has(self, tag: str, attribute: str | None, minor: int) -> bool:
        names = {self.root} if tag == self.root else set()
        for one in self.reachable(minor):
            names |= {n.declaration for n in self.declaration(one, minor).content.names if n.tag == tag}
        names |= {case for one in names for case in self.declaration(one, minor).cases()}
        return any(attribute is None or attribute in self.declaration(name, minor).attributes for name in names)

    def reachable(self, minor: int) -> frozenset[str]:
        """Return the names of the declarations at or below the root in a version."""
        if minor not in self._reachable:
            found: set[str] = set()
            pending = [self.root]
            while pending:
                name = pending.pop()
                if name not in found:
                    found.add(name)
                    declaration = self.declaration(name, minor)
                    pending.extend(inner.declaration for inner in declaration.content.names[1:])
                    pending.extend(declaration.cases())
            self._reachable[minor] = frozenset(found)
        return self._reachable[minor]

    @cached_property
    def _blocks(self) -> dict[str, str]:
        """The lines below each name, as one text."""
        found: dict[str, list[str]] = {}
        lines: list[str] = []
        for table in self.tables:
            for line in table.splitlines():
                if line and not line.startswith(" "):
                    lines = found[line] = []
                elif line:
                    lines.append(line.strip())
        return {name: " ".join(texts) for name, texts in found.items()}
