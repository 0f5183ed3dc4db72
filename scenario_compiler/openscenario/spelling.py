"""The OpenSCENARIO spelling of words, declared once for reading and writing.

A `Form` pairs a word with an element: one function reads, one writes. `regular` makes both from the parts of the
element, each of which reads and writes some of the word's fields.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Generic, Protocol

from lxml import etree

from scenario_compiler.openscenario.node import Node
from scenario_compiler.openscenario.output import Output, Version
from scenario_compiler.vocabulary.grammar import grammar_of
from scenario_compiler.vocabulary.traversal import AnyWord
from scenario_compiler.vocabulary.word import Word

Fields = dict[str, Any]

REQUIRED: Any = ...
"""Stands in place of a default if the attribute is required."""

_EVER: Version = (1, 0)


class Part(Protocol):
    """A part of an element: an attribute, a child, or several of them that belong together."""

    def read(self, node: Node) -> Fields | None:
        """Return the fields of the part; None if a required one is missing."""
        ...

    def write(self, word: Any, element: etree._Element, output: Output) -> None:
        """Add the part to the word's element."""
        ...


@dataclass(frozen=True)
class Form(Generic[AnyWord]):
    """An element and its word.

    Attributes:
        tag: Name of the element.
        word: Type of the word.
        read: Element to word; None if required parts are missing.
        write: Word to element.
        around: Names of the enclosing elements, outermost first.
        since: First version that has the element.
    """

    tag: str
    word: type[AnyWord]
    read: Callable[[Node], AnyWord | None]
    write: Callable[[AnyWord, Output], etree._Element]
    around: tuple[str, ...] = ()
    since: Version = _EVER


@dataclass(frozen=True)
class Forms:
    """The forms of one family, by element and by word."""

    forms: Sequence[Form[Any]]
    by_tag: Mapping[str, Form[Any]] = dataclasses.field(init=False)
    by_word: Mapping[type[Word], Form[Any]] = dataclasses.field(init=False)

    def __post_init__(self) -> None:
        """Index the forms; of two for one word the first is written, of two for one element the first is read."""
        object.__setattr__(self, "by_tag", {one.tag: one for one in reversed(self.forms)})
        object.__setattr__(self, "by_word", {one.word: one for one in reversed(self.forms)})


def regular(
    tag: str, word: type[AnyWord], *parts: Part, around: tuple[str, ...] = (), since: Version = _EVER
) -> Form[AnyWord]:
    """Return the form of a word whose element is the sum of its parts.

    Here and wherever a file is read, words are constructed without further validation: the parts have checked the
    values of the fields, and building the validators of all words takes longer than reading most files.
    """

    def read(node: Node) -> AnyWord | None:
        fields: Fields = {}
        complete = True
        for part in parts:
            found = part.read(node)
            complete = complete and found is not None
            fields.update(found or {})
        return word.model_construct(**fields).written_at(node.origin) if complete else None

    def write(spoken: AnyWord, output: Output) -> etree._Element:
        element = etree.Element(tag)
        for part in parts:
            part.write(spoken, element, output)
        return element

    return Form(tag, word, read, write, around, since)


@dataclass(frozen=True)
class Attribute:
    """An attribute that is a field.

    Attributes:
        field: The word's field.
        name: The attribute.
        convert: Reads the attribute of a node, given its name and default.
        default: Value of a missing attribute; REQUIRED if it must not be missing.
        since: First version that has the attribute.
        names: Names of values in the standard, where they differ from the field's.
        always: Whether to write it even with its default value, because the standard requires it.
    """

    field: str
    name: str
    convert: Callable[[Node, str, Any], Any]
    default: Any = REQUIRED
    since: Version = _EVER
    names: Mapping[str, str] = dataclasses.field(default_factory=dict)
    always: bool = False

    def read(self, node: Node) -> Fields:
        """Return the field."""
        if self.default is None and not node.has(self.name):
            return {self.field: None}
        found = self.convert(node, self.name, None if self.default is REQUIRED else self.default)
        back = {theirs: ours for ours, theirs in self.names.items()}
        return {self.field: back.get(found, found) if isinstance(found, str) else found}

    def write(self, word: Word, element: etree._Element, output: Output) -> None:
        """Add the attribute, unless it has its default value."""
        value = getattr(word, self.field)
        if not self.always and self.default is not REQUIRED and value == self.default:
            return
        if output.version < self.since:
            output.tell_lost(word, f"{element.tag}/{self.name} is not known before {output.dotted(self.since)}")
            return
        element.set(self.name, output.text(self.names.get(value, value) if isinstance(value, str) else value, word))


def number(field: str, name: str = "", default: Any = REQUIRED, since: Version = _EVER) -> Attribute:
    """Return the part for a number that may be an expression."""
    return Attribute(field, name or field, lambda node, at, usual: node.number(at, usual), default, since)


def integer(field: str, name: str = "", default: Any = REQUIRED, since: Version = _EVER) -> Attribute:
    """Return the part for an integer."""
    return Attribute(field, name or field, lambda node, at, usual: node.integer(at, usual), default, since)


def boolean(field: str, name: str = "", default: Any = REQUIRED, since: Version = _EVER) -> Attribute:
    """Return the part for a boolean."""
    return Attribute(field, name or field, lambda node, at, usual: node.boolean(at, usual), default, since)


def text(field: str, name: str = "", default: Any = REQUIRED, since: Version = _EVER) -> Attribute:
    """Return the part for a text."""
    return Attribute(field, name or field, lambda node, at, usual: node.text(at, usual), default, since)


def entity(field: str = "to", name: str = "entityRef", default: Any = REQUIRED) -> Attribute:
    """Return the part for the name of an entity."""
    return Attribute(field, name, lambda node, at, usual: node.entity(at, usual), default)


def choice(
    word: type[Word],
    field: str,
    name: str = "",
    default: Any = REQUIRED,
    since: Version = _EVER,
    names: Mapping[str, str] | None = None,
) -> Attribute:
    """Return the part for one of the words that a field of `word` allows; `names` are those with another spelling."""
    renamed = names or {}
    allowed = [renamed.get(one, one) for one in grammar_of(word).attributes[field].choices if one]

    def convert(node: Node, at: str, usual: Any) -> str:
        found: str = node.choice(at, allowed, None if usual is None else renamed.get(usual, usual))
        return found

    return Attribute(field, name or field, convert, default, since, renamed)


@dataclass(frozen=True)
class Child:
    """A child element that is a field.

    Attributes:
        field: The word's field.
        tag: Name of the child element.
        reader: Child element to the field's value; None if it is not usable.
        writer: The field's value to the child element.
        required: Whether the word needs the field.
        since: First version that has the child.
    """

    field: str
    tag: str
    reader: Callable[[Node], Any]
    writer: Callable[[Any, Output], etree._Element]
    required: bool = True
    since: Version = _EVER

    def read(self, node: Node) -> Fields | None:
        """Return the field; None if it is required and missing."""
        inner = node.required(self.tag) if self.required else node.child(self.tag)
        found = None if inner is None else self.reader(inner)
        return None if self.required and found is None else {self.field: found}

    def write(self, word: Word, element: etree._Element, output: Output) -> None:
        """Add the child if the field has a value."""
        value = getattr(word, self.field)
        if value is None:
            return
        if output.version < self.since:
            output.tell_lost(word, f"{element.tag}/{self.tag} is not known before {output.dotted(self.since)}")
            return
        element.append(self.writer(value, output))


@dataclass(frozen=True)
class Children:
    """Child elements of one name that are a tuple.

    Attributes:
        field: The word's field.
        form: The form of each.
        least: Least number that a word needs.
        wanted: Least number that the standard requires; the last one is repeated to reach it.
    """

    field: str
    form: Form[Any]
    least: int = 0
    wanted: int = 0

    def read(self, node: Node) -> Fields | None:
        """Return the field; None if there are too few."""
        found = [self.form.read(inner) for inner in node.children(self.form.tag)]
        if len(found) < self.least:
            node.required(self.form.tag)
        words = tuple(one for one in found if one is not None)
        return None if len(words) < self.least else {self.field: words}

    def write(self, word: Word, element: etree._Element, output: Output) -> None:
        """Add the children in order."""
        words = getattr(word, self.field)
        missing = self.wanted - len(words) if words else 0
        if missing > 0:
            output.tell_lost(word, f"<{element.tag}> needs at least {self.wanted} <{self.form.tag}>")
        for one in (*words, *words[-1:] * missing):
            element.append(self.form.write(one, output))


def made(tag: str, *children: etree._Element, **attributes: str) -> etree._Element:
    """Return an element with attributes and children."""
    element = etree.Element(tag, attributes)
    element.extend(children)
    return element


def nested(around: Sequence[str], element: etree._Element) -> etree._Element:
    """Return an element inside others, whose tags are given from the outermost."""
    for tag in reversed(around):
        element = made(tag, element)
    return element
