"""One element of an OpenSCENARIO file with the parameters in scope, and the context for reading a file.

A fault is reported once, with its place, and a usable default is returned, so that reading continues.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal, TypeAlias, TypeVar

from lxml import etree

from scenario_compiler.diagnostics import Code, Diagnostics, Place, Related, Severity, did_you_mean
from scenario_compiler.document import Document, Origin
from scenario_compiler.expressions import Expression, ExpressionError
from scenario_compiler.markup import codes
from scenario_compiler.markup.names import UNKNOWN_ENTITY
from scenario_compiler.markup.values import report_expression
from scenario_compiler.openscenario.catalog_files import CatalogFolders
from scenario_compiler.openscenario.codes import ONE_ENTITY, PARAMETER_IN_TEXT
from scenario_compiler.openscenario.scope import Bound, Scope, described_number, literal_number
from scenario_compiler.structure.walk import local_name

_TRUE, _FALSE = ("true", "1"), ("false", "0")
_Chosen = TypeVar("_Chosen", bound=str)
_Value = TypeVar("_Value")

Real: TypeAlias = float
"""Another name of the type float, which `Node.float` hides."""


ObjectType = Literal["vehicle", "pedestrian", "miscellaneous", "external"]


@dataclass
class Known:
    """The meanings of names in a scenario, filled while the file is read from top to bottom.

    Attributes:
        entities: Type of each entity, in document order.
        selections: Members of each EntitySelection.
        catalogs: The catalogs in the folders that the scenario lists.
        entries: The catalog entries to which references refer.
        parameters: The scenario's own parameters.
        inner: Parameters of inner elements that actions change or conditions read, by the names of their variables.
        places: Where each entity and each selection is named.
    """

    entities: dict[str, ObjectType] = field(default_factory=dict)
    selections: dict[str, tuple[str, ...]] = field(default_factory=dict)
    catalogs: CatalogFolders | None = None
    entries: dict[etree._Element, Node] = field(default_factory=dict)
    parameters: Mapping[str, Bound] = field(default_factory=dict)
    inner: dict[str, Bound] = field(default_factory=dict)
    places: dict[str, Place] = field(default_factory=dict)


@dataclass(frozen=True)
class FileContext:
    """The context for reading the elements of a file.

    Attributes:
        document: The file.
        sink: Receives the faults.
        version: revMajor and revMinor of the file.
        known: The meanings of names.
        used: Attributes that were read, by element; an element that is missing here was never read.
        within: The catalog reference because of which the file is read.
    """

    document: Document
    sink: Diagnostics
    version: tuple[int, int]
    known: Known = field(default_factory=Known)
    used: dict[etree._Element, set[str]] = field(default_factory=dict)
    within: Place | None = None

    @property
    def folder(self) -> Path:
        """Folder to which relative paths in the file refer."""
        return self.document.folder

    def origin(self, element: etree._Element, attribute: str | None = None) -> Origin:
        """Return the place of an element or attribute."""
        return self.document.origin(element, attribute, self.within)

    def of(self, document: Document, version: tuple[int, int], within: Place | None) -> FileContext:
        """Return the context for another file that this one refers to."""
        return replace(self, document=document, version=version, within=within)


class Node:
    """An element, the context for reading it, and the parameters in scope.

    Attributes:
        element: The element.
        reading: The context.
        scope: The parameters in scope.
        opened: Whether the scope includes the parameters that the element itself declares.
    """

    __slots__ = ("element", "opened", "reading", "scope")

    def __init__(self, element: etree._Element, reading: FileContext, scope: Scope, *, opened: bool = False) -> None:
        """Mark the element as read."""
        self.element = element
        self.opened = opened
        self.reading = reading
        self.scope = scope
        reading.used.setdefault(element, set())

    @property
    def tag(self) -> str:
        """Name of the element, without a namespace."""
        return local_name(self.element)

    @property
    def origin(self) -> Origin:
        """Place of the element's start tag."""
        return self.reading.origin(self.element)

    def place(self, attribute: str) -> Origin:
        """Return the place of an attribute's value."""
        return self.reading.origin(self.element, attribute)

    def inner(self, more: Mapping[str, Bound], *, opened: bool = False) -> Node:
        """Return the node with more parameters in scope; `opened` if the element itself declares them."""
        return Node(self.element, self.reading, self.scope.inner(more), opened=opened or self.opened)

    def elements(self) -> list[Node]:
        """Return all child elements."""
        return [Node(one, self.reading, self.scope) for one in self.element.iterchildren(etree.Element)]

    def children(self, *tags: str) -> list[Node]:
        """Return the child elements of these names, in document order."""
        return [
            Node(one, self.reading, self.scope)
            for one in self.element.iterchildren(etree.Element)
            if local_name(one) in tags
        ]

    def child(self, *tags: str) -> Node | None:
        """Return the first child element that has one of these names."""
        for one in self.element.iterchildren(etree.Element):
            if local_name(one) in tags:
                return Node(one, self.reading, self.scope)
        return None

    def first(self) -> Node | None:
        """Return the first child element of any name."""
        for one in self.element.iterchildren(etree.Element):
            return Node(one, self.reading, self.scope)
        return None

    def required(self, *tags: str) -> Node | None:
        """Return the first child with one of these names; report it if there is none."""
        found = self.child(*tags)
        if found is None:
            expected = " or ".join(f"<{tag}>" for tag in tags)
            self.report(codes.MISSING_ELEMENT, f"<{self.tag}> has no {expected}")
        return found

    def read_whole(self) -> None:
        """Mark the element, its attributes and everything below it as read."""
        for one in self.element.iter(etree.Element):
            self.reading.used.setdefault(one, set()).update(str(name) for name in one.attrib)

    def has(self, attribute: str) -> bool:
        """Return whether the attribute exists and is not empty."""
        return self._raw(attribute) is not None

    def report(
        self,
        code: Code,
        message: str,
        attribute: str = "",
        hint: str = "",
        severity: Severity | None = None,
        related: tuple[Related, ...] = (),
    ) -> None:
        """Report a finding at the element, or at one of its attributes, with the code's severity if none is given."""
        place: Place = self.place(attribute) if attribute else self.origin
        self.reading.sink.add(code, message, place, hint=hint, severity=severity, related=related)

    def text(self, attribute: str, default: str | None = None) -> str:
        """Return an attribute's text with parameters resolved; it is required if there is no default."""
        found = self._present(attribute, required=default is None, joined=True)
        if found is None:
            return default or ""
        inside = self.scope.inside(str(self.element.get(attribute)))
        if inside:
            self.report(PARAMETER_IN_TEXT, f"'${inside}' is not replaced in a longer text", attribute)
        return found

    def number(self, attribute: str, default: Real | None = None) -> Real | Expression:
        """Return a number in the file's SI unit, as an expression if it depends on the scenario's open parameters."""
        raw = self._raw(attribute)
        if raw is None:
            return self._missing(attribute, default)
        try:
            found = self.scope.symbolic(raw)
            if isinstance(found, Expression):
                found.number(self.scope.values)
                return found
        except ExpressionError as error:
            report_expression(error, raw, self.reading.sink, self.place(attribute))
            return default or 0.0
        number = literal_number(found)
        return self._wrong(attribute, found, described_number(found), default or 0.0) if number is None else number

    def optional_number(self, attribute: str) -> Real | Expression | None:
        """Return a number as `number` does, or None if the attribute is missing."""
        return self.number(attribute) if self.has(attribute) else None

    def float(self, attribute: str, default: Real | None = None, *, severity: Severity | None = None) -> Real:
        """Return a number's present value; parameters that it depends on become structural.

        A text that is not a number is an error, or a finding of `severity` if given.
        """
        found = self._present(attribute, required=default is None)
        if found is None:
            return default or 0.0
        number = literal_number(found)
        if number is None:
            return self._wrong(attribute, found, described_number(found), default or 0.0, severity=severity)
        return number

    def integer(self, attribute: str, default: int | None = None) -> int:
        """Return an integer; parameters that it depends on become structural."""
        found = self._present(attribute, required=default is None)
        if found is None:
            return default or 0
        number = literal_number(found)
        if number is None or number != int(number):
            return self._wrong(attribute, found, "a whole number", default or 0)
        return int(number)

    def boolean(self, attribute: str, default: bool | None = None) -> bool:
        """Return a boolean, which may also be written as 1 or 0."""
        found = self._present(attribute, required=default is None)
        if found is None:
            return bool(default)
        stripped = found.strip()
        if stripped.lower() in _TRUE + _FALSE:
            return stripped.lower() in _TRUE
        return self._wrong(attribute, found, "true or false", bool(default))

    def choice(self, attribute: str, allowed: Sequence[_Chosen], default: _Chosen | None = None) -> _Chosen:
        """Return one of the allowed words; report any other one and return the default, or the first allowed word."""
        otherwise = allowed[0] if default is None else default
        found = self._present(attribute, required=default is None)
        if found is None:
            return otherwise
        stripped = found.strip()
        for word in allowed:
            if word == stripped:
                return word
        hint = did_you_mean(stripped, allowed)
        return self._wrong(attribute, found, f"one of {', '.join(allowed)}", otherwise, hint)

    def entity(self, attribute: str, default: str | None = None) -> str:
        """Return the name of an entity; report an unknown one, and a selection of several entities."""
        name = self.text(attribute, default)
        members = self._members(name, attribute, required=default is None)
        if name in self.reading.known.selections and not members:
            self.report(UNKNOWN_ENTITY, f"the selection '{name}' has no members", attribute)
        elif len(members) > 1:
            message = f"'{name}' is a selection of {len(members)}; its first member is used"
            self.report(ONE_ENTITY, message, attribute)
        return members[0] if members else name

    def entities(self, attribute: str) -> tuple[str, ...]:
        """Return the entities of a name, which may be a selection's; report an unknown one and an empty selection."""
        name = self.text(attribute)
        members = self._members(name, attribute, required=True)
        if name in self.reading.known.selections and not members:
            message = f"the selection '{name}' has no members"
            self.report(UNKNOWN_ENTITY, message, attribute, severity=Severity.WARNING)
        return members

    def _members(self, name: str, attribute: str, *, required: bool) -> tuple[str, ...]:
        known = self.reading.known
        if name in known.selections:
            return known.selections[name]
        named = name != "" or (required and self.element.get(attribute) is not None)
        if named and name not in known.entities:
            hint = did_you_mean(name, [*known.entities, *known.selections])
            self.report(UNKNOWN_ENTITY, f"there is no entity '{name}'", attribute, hint)
        return (name,) if name in known.entities else ()

    def _raw(self, attribute: str) -> str | None:
        self.reading.used[self.element].add(attribute)
        text = self.element.get(attribute)
        return None if text is None or text == "" else str(text)

    def _present(self, attribute: str, required: bool, joined: bool = False) -> str | None:
        """Return an attribute's text, None if there is none; only with `joined` may a required one be empty."""
        raw = self._raw(attribute)
        if raw is None:
            if required and (not joined or self.element.get(attribute) is None):
                self._missing(attribute, None)
            return None
        try:
            return self.scope.text(raw)
        except ExpressionError as error:
            together = self.scope.joined(raw) if joined else None
            if together is not None:
                return together
            report_expression(error, raw, self.reading.sink, self.place(attribute))
            return None

    def _missing(self, attribute: str, default: Real | None) -> Real:
        if default is None:
            self.report(codes.MISSING_ATTRIBUTE, f"<{self.tag}> has no {attribute}")
        return default or 0.0

    def _wrong(
        self,
        attribute: str,
        text: str,
        expected: str,
        default: _Value,
        hint: str = "",
        severity: Severity | None = None,
    ) -> _Value:
        message = f"'{text}' is not {expected} ({self.tag}/{attribute})"
        inside = self.scope.inside(str(self.element.get(attribute)))
        if inside:
            hint = f"'${inside}' is replaced only if it is the whole value; ${{...}} is an expression"
        self.report(codes.WRONG_VALUE, message, attribute, hint, severity)
        return default
