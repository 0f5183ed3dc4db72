"""The notation of tables of elements, and the declarations of one version made from them.

A declaration is a name at the start of a line and indented lines below it:

- `name? length:positive rule?:traffic_rule@1.5-` are attributes: `?` optional, `:` the kind of value (none: any text),
  `@` the versions that know it: `@1.4`, `@1.4-`, `@-1.5`, `@1.4-1.6`.
- `delay:Double[0,inf)` is a number with the range that the format's text gives, which its schemas do not have: a square
  bracket includes the limit, a round one does not; `pi` and `2pi` are numbers.
- `= link=road_link? type* (width+ | border+) ...` are the children in their order: `tag` or `tag=declaration`, `? * +
  {2,4} {2,}` how often, `|` one of, `text` or `text:kind` text instead of children, `anything` any children; a format
  may have words of its own for groups of children (`...`). `= & Position Orientation?` are children in any order.
- `?1.3-` is optional in these versions and else required, for attributes and children: `Properties?1.3-`.
- `=@-1.2 ...` and `=@1.3- ...` are the children in these versions, where they differ much.
- `by type@1.8-: virtual=virtual_junction` another declaration takes over where the attribute has that value.

A declaration without children and text is empty.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field

from scenario_compiler.structure.content import AnyOrder, Choice, Content, Model, Name, Repeat, Sequence


@dataclass(frozen=True, slots=True)
class Range:
    """A range of numbers, as the notation writes it."""

    text: str

    @property
    def limits(self) -> tuple[float, float]:
        """The least and the greatest number."""
        low, high = (_NUMBERS[limit] if limit in _NUMBERS else float(limit) for limit in self.text[1:-1].split(","))
        return low, high

    def contains(self, number: float) -> bool:
        """Return whether a number is in the range."""
        low, high = self.limits
        above = number > low or (number == low and self.text[0] == "[")
        return above and (number < high or (number == high and (self.text[-1] == "]" or math.isinf(high))))

    @property
    def described(self) -> str:
        """The range in words, after "must be"."""
        low, high = self.text[1:-1].split(",")
        least = f"at least {low}" if self.text[0] == "[" else f"more than {low}"
        if high == "inf":
            return least
        return f"{least} and {'at most' if self.text[-1] == ']' else 'less than'} {high}"


_NUMBERS = {"inf": math.inf, "pi": math.pi, "-pi": -math.pi, "2pi": 2.0 * math.pi}


@dataclass(frozen=True, slots=True)
class Attribute:
    """An attribute in one version: the kind of its value ("" any text), whether it must be there, and its range."""

    kind: str
    required: bool
    range: Range | None = None


@dataclass(slots=True)
class Declaration:
    """An element in one version.

    Attributes:
        name: Name in the tables.
        attributes: By name.
        content: The children's order.
        text: Kind of the text ("" for any); None if no text is allowed.
        anything: Whether any children are allowed.
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
        """Whether the element must be empty."""
        return len(self.content.names) == 1 and self.text is None and not self.anything

    def cases(self) -> list[str]:
        """Return the names of the declarations that take over by an attribute's value."""
        return [] if self.switch is None else list(self.switch[1].values())


def in_versions(span: str, minor: int) -> bool:
    """Return whether a minor version lies in a span like "1.4", "1.4-", "-1.5", "1.4-1.6" or "" (all)."""
    if not span:
        return True
    first, dash, last = span.partition("-")
    low = int(first[2:]) if first else 0
    return low <= minor <= int(last[2:]) if last else (minor >= low if dash else minor == low)


_SPAN = r"(?:\d\.\d+(?:-(?:\d\.\d+)?)?|-\d\.\d+)"
_LEAF = re.compile(rf"(?P<tag>\w+)(?:=(?P<declaration>\w+))?(?P<count>[?*+]|{{[\d,]+}})?(?P<optional>{_SPAN})?")
_ATTRIBUTE = re.compile(rf"(?P<name>\w+)(?P<count>\??)(?P<optional>{_SPAN})?(?::(?P<kind>\w+)(?P<range>[\[(].+)?)?")
_CONTENTS = re.compile(r"(?:^|(?<=\s))=(@\S+)? ")
_TOKEN = re.compile(r"[()|]|[^\s()|]+")


class Notation:
    """Reads the text of declarations for one version.

    `required` tells whether the version requires attributes; `groups` are the format's own words for children.
    """

    def __init__(self, minor: int, required: bool, groups: Mapping[str, Callable[[int], Model]]) -> None:
        """Begin reading for version 1.`minor`."""
        self.minor = minor
        self.required = required
        self.groups = groups
        self.tokens: list[str] = []

    def declaration(self, name: str, text: str) -> Declaration:
        """Return the declaration for a text."""
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
            required = self.required and not optional
            limits = Range(match["range"]) if match["range"] else None
            declaration.attributes[match["name"]] = Attribute(match["kind"] or "", required, limits)

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
        """Yield the children in any order, each with whether it is required."""
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
        if token in self.groups:
            return self.groups[token](self.minor)
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
