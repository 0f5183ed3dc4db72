"""The notation of tables of elements, and the declarations of one version made from them.

A declaration is a name at the start of a line and indented lines below it:

- `name? length:positive rule?:traffic_rule@1.5-` are attributes: `?` optional, `:` the kind of value (none: any text),
  `@` the versions that know it: `@1.4`, `@1.4-`, `@-1.5`, `@1.4-1.6`.
- `= link=road_link? type* (width+ | border+) ...` are the children in their order: `tag` or `tag=declaration`, `? * +
  {2,4} {2,}` how often, `|` one of, `text` or `text:kind` text instead of children, `anything` any children; a format
  may have words of its own for groups of children (`...`). `= & Position Orientation?` are children in any order.
- `?1.3-` is optional in these versions and else required, for attributes and children: `Properties?1.3-`.
- `=@-1.2 ...` and `=@1.3- ...` are the children in these versions, where they differ much.
- `by type@1.8-: virtual=virtual_junction` another declaration takes over where the attribute has that value.

A declaration without children and text is empty.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property

from lxml import etree

from scenario_compiler.diagnostics import Code
from scenario_compiler.structure.content import AnyOrder, Choice, Content, Model, Name, Repeat, Sequence
from scenario_compiler.structure.values import Kind

Condition = Callable[[etree._Element], Iterator[str]]
"""Yields what is wrong with an element."""


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

    @property
    def empty(self) -> bool:
        """True when nothing may stand in the element."""
        return len(self.content.names) == 1 and self.text is None and not self.anything

    def cases(self) -> list[str]:
        """Return the names of the declarations that take over by an attribute's value."""
        return [] if self.switch is None else list(self.switch[1].values())


@dataclass(frozen=True, slots=True)
class Faults:
    """The codes of a format's faults; `walk` says when each is reported.

    Attributes:
        order: The children are those that are needed, in another order.
        misplaced: A child stands too often or too late.
        excluded: A condition of the format does not hold; None where it has none.
        blank: Blanks in an element that is empty; None where they are no fault.
        other_version: What another version has; None where that is a fault like any other.
        loose: A value that only looks different from what it should be; None as above.
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


@dataclass(eq=False)
class Grammar:
    """A format: its elements, words and kinds of values in the versions 1.`minors`.

    Attributes:
        name: The format's name in messages.
        root: Tag of the root element, and the name of its declaration.
        tables: Declarations in the notation of this module.
        words: Kinds of values that are words: the words with their versions, separated by " | ".
        kinds: The other kinds of values.
        minors: The minor versions that are declared, in order.
        faults: The codes of what is wrong.
        words_since: First minor version whose words are checked.
        required_since: First minor version that requires attributes.
        namespace_until: Last minor version whose elements may stand in a namespace.
        stands_for_word: Tells which texts may stand in place of any word.
        loosely: Returns the value of a kind (in a minor version) that a text which is none seems to mean, or None.
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
    namespace_until: int = -1
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
        """Return a declaration as version 1.`minor` has it, also where no element of that version leads to it."""
        key = (name, minor)
        if key not in self._declared:
            self._declared[key] = _Reader(self, minor).declaration(name, self._blocks[name])
        return self._declared[key]

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
        """Tell whether a text is a value of a kind ("" any) in a version."""
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
        """Return the names of the declarations that stand anywhere below the root in a version, the root's too."""
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


def in_versions(span: str, minor: int) -> bool:
    """Tell whether a minor version lies in a span like "1.4", "1.4-", "-1.5", "1.4-1.6" or "" (all)."""
    if not span:
        return True
    first, dash, last = span.partition("-")
    low = int(first[2:]) if first else 0
    return low <= minor <= int(last[2:]) if last else (minor >= low if dash else minor == low)


_SPAN = r"(?:\d\.\d+(?:-(?:\d\.\d+)?)?|-\d\.\d+)"
_LEAF = re.compile(rf"(?P<tag>\w+)(?:=(?P<declaration>\w+))?(?P<count>[?*+]|{{[\d,]+}})?(?P<optional>{_SPAN})?")
_ATTRIBUTE = re.compile(rf"(?P<name>\w+)(?P<count>\??)(?P<optional>{_SPAN})?(?::(?P<kind>\w+))?")
_CONTENTS = re.compile(r"(?:^|(?<=\s))=(@\S+)? ")
_TOKEN = re.compile(r"[()|]|[^\s()|]+")


class _Reader:
    """Reads the text of declarations for one version."""

    def __init__(self, grammar: Grammar, minor: int) -> None:
        self.grammar = grammar
        self.minor = minor
        self.tokens: list[str] = []

    def declaration(self, name: str, text: str) -> Declaration:
        """Return the declaration that a text gives."""
        declaration = Declaration(name)
        head, *contents = _CONTENTS.split(text)
        if head.startswith("by "):
            head = self._switch(declaration, head[3:])
        for word in head.split():
            self._attribute(declaration, word)
        for span, children in zip(contents[::2], contents[1::2], strict=True):
            if in_versions((span or "")[1:], self.minor):
                self._content(declaration, children)
        return declaration

    def _switch(self, declaration: Declaration, text: str) -> str:
        """Read the switch at the start of the text; return the rest, the attributes."""
        condition, _, rest = text.partition(": ")
        attribute, _, span = condition.partition("@")
        cases: dict[str, str] = {}
        entries = rest.split()
        while entries and re.fullmatch(r"\w+=\w+", entries[0]):
            value, _, target = entries.pop(0).partition("=")
            cases[value] = target
        if in_versions(span, self.minor):
            declaration.switch = (attribute, cases)
        return " ".join(entries)

    def _attribute(self, declaration: Declaration, word: str) -> None:
        spelled, _, span = word.partition("@")
        match = _ATTRIBUTE.fullmatch(spelled)
        if match is None:
            raise ValueError(f"bad attribute of {declaration.name}: {word}")
        if in_versions(span, self.minor):
            optional = bool(match["count"]) and in_versions(match["optional"] or "", self.minor)
            required = not optional and self.minor >= self.grammar.required_since
            declaration.attributes[match["name"]] = Attribute(match["kind"] or "", required)

    def _content(self, declaration: Declaration, text: str) -> None:
        self.tokens = []
        for token in _TOKEN.findall(text):
            bare, _, span = token.partition("@")
            if bare not in {"text", "anything"} and not bare.startswith("text:"):
                self.tokens.append(token)
            elif in_versions(span, self.minor):
                if bare == "anything":
                    declaration.anything = True
                else:
                    declaration.text = bare[5:]
        if self.tokens[:1] == ["&"]:
            declaration.content = AnyOrder.of_parts(self._parts())
            return
        model = self._choice()
        if self.tokens:
            raise ValueError(f"bad content of {declaration.name}: {text}")
        declaration.content = Content.of(model)

    def _parts(self) -> Iterator[tuple[Name, bool]]:
        """Yield the children that stand in any order, each with whether it must be there."""
        for token in self.tokens[1:]:
            bare, _, span = token.partition("@")
            if in_versions(span, self.minor):
                model = self._leaf(bare)
                if isinstance(model, Name):
                    yield model, True
                elif isinstance(model, Repeat) and isinstance(model.part, Name):
                    yield model.part, False

    def _choice(self) -> Model:
        """Read parts separated by `|` up to a closing bracket or the end."""
        parts = [self._sequence()]
        while self.tokens and self.tokens[0] == "|":
            self.tokens.pop(0)
            parts.append(self._sequence())
        kept = [part for part in parts if part is not None]
        if len(kept) == 1:
            return kept[0]
        return Choice(tuple(kept)) if kept else Sequence(())

    def _sequence(self) -> Model | None:
        """Read parts up to `|`, a closing bracket or the end; None when the version knows none of them."""
        parts: list[Model] = []
        unknown = False
        while self.tokens and self.tokens[0] not in {"|", ")"}:
            token = self.tokens.pop(0)
            if token == "(":
                model = self._choice()
                self.tokens.pop(0)
                suffix = ""
                if self.tokens and re.match(r"[?*+{@]", self.tokens[0]):
                    suffix = self.tokens.pop(0)
                count, _, span = suffix.partition("@")
                model = self._counted(model, count)
            else:
                bare, _, span = token.partition("@")
                model = self._leaf(bare)
            if in_versions(span, self.minor):
                parts.append(model)
            else:
                unknown = True
        if unknown and not parts:
            return None
        return parts[0] if len(parts) == 1 else Sequence(tuple(parts))

    def _leaf(self, token: str) -> Model:
        if token in self.grammar.groups:
            return self.grammar.groups[token](self.minor)
        match = _LEAF.fullmatch(token)
        if match is None:
            raise ValueError(f"bad token {token}")
        name = Name(match["tag"], match["declaration"] or match["tag"])
        return self._counted(name, (match["count"] or "") + (match["optional"] or ""))

    def _counted(self, model: Model, count: str) -> Model:
        if not count:
            return model
        if count[0] in "?*+":
            if not in_versions(count[1:], self.minor):
                return model
            return Repeat(model, int(count == "+"), 1 if count[0] == "?" else None)
        least, comma, most = count.strip("{}").partition(",")
        return Repeat(model, int(least), int(most) if most else (None if comma else int(least)))
