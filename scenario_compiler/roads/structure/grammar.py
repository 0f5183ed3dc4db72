"""The notation of the element tables, and the declarations of one version made from them.

A declaration is a name at the start of a line and indented lines below it:

- `name? length:positive rule?:traffic_rule@1.5-` are attributes: `?` optional, `:` the kind of value (see `words`;
  none: any text), `@` the versions that know it: `@1.4`, `@1.4-`, `@-1.5`, `@1.4-1.6`. Before 1.5 no attribute is
  required.
- `= link=road_link? type* (width+ | border+) ...` are the children in their order: `tag` or `tag=declaration`, `? * +
  {2,4} {2,}` how often, `|` one of, `...` additional data (userData, include, dataQuality), `..` the same but not in
  1.6 and 1.7 (whose schemas leave it out), `text` or `text:kind` text instead of children, `anything` any children.
- `by type@1.8-: virtual=virtual_junction` another declaration takes over where the attribute has that value.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache

from scenario_compiler.roads.structure.content import Choice, Content, Model, Name, Repeat, Sequence
from scenario_compiler.roads.structure.object_elements import (
    JUNCTION_ELEMENTS,
    OBJECT_ELEMENTS,
    SIGNAL_ELEMENTS,
)
from scenario_compiler.roads.structure.road_elements import LANE_ELEMENTS, ROAD_ELEMENTS
from scenario_compiler.roads.structure.words import WORDS

FIRST_MINOR, LAST_MINOR = 1, 8
"""Minor versions of OpenDRIVE 1 that are declared."""

FIRST_WITH_WORDS = 4
"""First minor version whose words are checked."""


@dataclass(frozen=True, slots=True)
class Attribute:
    """An attribute in one version: the kind of its value ("" any text) and whether it must be there."""

    kind: str
    required: bool


@dataclass(slots=True)
class Declaration:
    """An element in one version.

    Attributes:
        name: Name in the tables.
        attributes: By name.
        content: The children's order.
        text: Kind of the text ("" any), None where no text may stand.
        anything: Whether any children may stand in it.
        switch: An attribute and the declarations that take over by its value.
    """

    name: str
    attributes: dict[str, Attribute] = field(default_factory=dict)
    content: Content = field(default_factory=lambda: Content.of(Sequence(())))
    text: str | None = None
    anything: bool = False
    switch: tuple[str, dict[str, str]] | None = None


def in_versions(span: str, minor: int) -> bool:
    """Tell whether a minor version lies in a span like "1.4", "1.4-", "-1.5", "1.4-1.6" or "" (all)."""
    if not span:
        return True
    first, dash, last = span.partition("-")
    low = int(first[2:]) if first else FIRST_MINOR
    high = int(last[2:]) if last else (LAST_MINOR if dash else low)
    return low <= minor <= high


@cache
def declarations(minor: int) -> dict[str, Declaration]:
    """Return the declarations of version 1.`minor`, by name."""
    return {name: _declare(name, lines, minor) for name, lines in _blocks()}


@cache
def words(kind: str, minor: int) -> frozenset[str]:
    """Return the words of a kind that version 1.`minor` knows."""
    listed = (entry.partition("@") for entry in WORDS[kind].split(" | "))
    return frozenset(word for word, _, span in listed if in_versions(span, minor))


@cache
def versions_of(tag: str, attribute: str | None = None) -> list[int]:
    """Return the minor versions in which any element of that tag (with that attribute) is declared."""
    found = []
    for minor in range(FIRST_MINOR, LAST_MINOR + 1):
        known = declarations(minor)
        names = {n.declaration for one in _reachable(minor) for n in known[one].content.names if n.tag == tag}
        names |= {case for one in names for case in _cases(known[one])}
        if any(attribute is None or attribute in known[name].attributes for name in names):
            found.append(minor)
    return found


@cache
def _reachable(minor: int) -> frozenset[str]:
    """Return the declarations that stand anywhere below the root in a version."""
    known = declarations(minor)
    found: set[str] = set()
    pending = ["OpenDRIVE"]
    while pending:
        name = pending.pop()
        if name not in found:
            found.add(name)
            pending.extend(inner.declaration for inner in known[name].content.names[1:])
            pending.extend(_cases(known[name]))
    return frozenset(found)


def _cases(declaration: Declaration) -> list[str]:
    return [] if declaration.switch is None else list(declaration.switch[1].values())


def _blocks() -> Iterator[tuple[str, list[str]]]:
    name, lines = "", [""]
    for table in (ROAD_ELEMENTS, LANE_ELEMENTS, OBJECT_ELEMENTS, SIGNAL_ELEMENTS, JUNCTION_ELEMENTS):
        for line in table.splitlines():
            if line and not line.startswith(" "):
                if name:
                    yield name, lines
                name, lines = line, []
            elif line:
                lines.append(line.strip())
    yield name, lines


def _declare(name: str, lines: list[str], minor: int) -> Declaration:
    declaration = Declaration(name)
    text = " ".join(lines)
    head, _, children = text.partition("= ") if not text.startswith("= ") else ("", "", text[2:])
    if head.startswith("by "):
        head = _switch(declaration, head[3:], minor)
    for word in head.split():
        _attribute(declaration, word, minor)
    if children:
        _content(declaration, children, minor)
    return declaration


def _switch(declaration: Declaration, text: str, minor: int) -> str:
    """Read the switch at the start of the text; return the rest, the attributes."""
    condition, _, rest = text.partition(": ")
    attribute, _, span = condition.partition("@")
    cases: dict[str, str] = {}
    entries = rest.split()
    while entries and re.fullmatch(r"\w+=\w+", entries[0]):
        value, _, target = entries.pop(0).partition("=")
        cases[value] = target
    if in_versions(span, minor):
        declaration.switch = (attribute, cases)
    return " ".join(entries)


def _attribute(declaration: Declaration, word: str, minor: int) -> None:
    spelled, _, span = word.partition("@")
    if in_versions(span, minor):
        name, _, kind = spelled.partition(":")
        required = not name.endswith("?") and minor >= 5
        declaration.attributes[name.rstrip("?")] = Attribute(kind, required)


def _content(declaration: Declaration, text: str, minor: int) -> None:
    tokens = re.findall(r"[()|]|[^\s()|]+", text.replace(")", ") "))
    kept = []
    for token in tokens:
        bare, _, span = token.partition("@")
        if bare in {"text", "anything"} or bare.startswith("text:"):
            if in_versions(span, minor):
                if bare == "anything":
                    declaration.anything = True
                else:
                    declaration.text = bare[5:]
        else:
            kept.append(token)
    parser = _Parser(kept, minor)
    model = parser.choice()
    if parser.tokens or model is None:
        raise ValueError(f"bad content of {declaration.name}: {text}")
    declaration.content = Content.of(model)


class _Parser:
    """Reads the tokens of a content model for one version."""

    def __init__(self, tokens: list[str], minor: int) -> None:
        self.tokens = tokens
        self.minor = minor

    def choice(self) -> Model:
        """Read parts separated by `|` up to a closing bracket or the end."""
        parts = [self.sequence()]
        while self.tokens and self.tokens[0] == "|":
            self.tokens.pop(0)
            parts.append(self.sequence())
        return parts[0] if len(parts) == 1 else Choice(tuple(parts))

    def sequence(self) -> Model:
        """Read parts up to `|`, a closing bracket or the end."""
        parts: list[Model] = []
        while self.tokens and self.tokens[0] not in {"|", ")"}:
            token = self.tokens.pop(0)
            if token == "(":
                model = self.choice()
                self.tokens.pop(0)
                suffix = ""
                if self.tokens and re.match(r"[?*+{@]", self.tokens[0]):
                    suffix = self.tokens.pop(0)
                count, _, span = suffix.partition("@")
                model = _counted(model, count)
            else:
                bare, _, span = token.partition("@")
                model = self._leaf(bare)
            if in_versions(span, self.minor):
                parts.append(model)
        return parts[0] if len(parts) == 1 else Sequence(tuple(parts))

    def _leaf(self, token: str) -> Model:
        if token == "...":
            return _additional(self.minor)
        if token == "..":
            return Sequence(()) if self.minor in {6, 7} else _additional(self.minor)
        match = re.fullmatch(r"(\w+)(?:=(\w+))?(.*)", token)
        if match is None:
            raise ValueError(f"bad token {token}")
        tag, declaration, count = match.groups()
        return _counted(Name(tag, declaration or tag), count)


def _counted(model: Model, count: str) -> Model:
    if not count:
        return model
    if count in "?*+":
        return Repeat(model, int(count == "+"), 1 if count == "?" else None)
    least, comma, most = count.strip("{}").partition(",")
    return Repeat(model, int(least), int(most) if most else (None if comma else int(least)))


def _additional(minor: int) -> Model:
    """Return the model of additional data: once each at first, then often, in any order since 1.6."""
    data, include, quality = (
        Name("userData", "userData"),
        Name("include", "include"),
        Name("dataQuality", "dataQuality"),
    )
    if minor >= 6:
        return Repeat(Choice((data, include, quality)), 0, None)
    most = 1 if minor < 3 else None
    parts: tuple[Model, ...] = (Repeat(data, 0, most), Repeat(include, 0, most))
    return Sequence(parts if minor < 5 else (*parts, Repeat(quality, 0, 1)))
