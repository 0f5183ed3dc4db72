"""The OpenSCENARIO spelling of our words, declared once for reading and writing.

A `Form` pairs a word with an element: one function reads, one writes. `regular` makes both from the parts that the
element consists of, each of which reads and writes some of the word's fields.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Generic, Protocol, TypeVar

from lxml import etree

from scenario_compiler.openscenario.node import Node
from scenario_compiler.openscenario.output import Output, Version
from scenario_compiler.vocabulary.grammar import grammar_of
from scenario_compiler.vocabulary.word import Word

AnyWord = TypeVar("AnyWord", bound=Word)
Fields = dict[str, Any]

REQUIRED: Any = ...
"""In place of a default: the attribute must be there."""

_EVER: Version = (1, 0)


class Part(Protocol):
    """A part of an element: an attribute, a child, or some of them that belong together."""

    def read(self, node: Node) -> Fields | None:
        """Return the fields that the part spells; None when the word cannot do without what is missing."""
        ...

    def write(self, word: Any, element: etree._Element, output: Output) -> None:
        """Add the part to the word's element."""
        ...


@dataclass(frozen=True)
class Form(Generic[AnyWord]):
    """An element and the word that it is.

    Attributes:
        tag: Name of the element.
        word: Type of the word.
        read: Element to word; None when too much of it is missing.
        write: Word to element.
        around: Names of the elements around it, outermost first.
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
        """Sort the forms; of two for one word the first is written, of two for one element the first is read."""
        object.__setattr__(self, "by_tag", {one.tag: one for one in reversed(self.forms)})
        object.__setattr__(self, "by_word", {one.word: one for one in reversed(self.forms)})


def regular(
    tag: str, word: type[AnyWord], *parts: Part, around: tuple[str, ...] = (), since: Version = _EVER
) -> Form[AnyWord]:
    """Return the form of a word whose element is the sum of its parts.

    Here and wherever a file is read, words are constructed without being validated again: the parts have read what
    the fields take, and the validators of all words take longer to make than most files to read.
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
        default: What a missing attribute means; REQUIRED when it must be there.
        since: First version that has the attribute.
        names: Field value to the standard's, where they differ.
        always: It is written even where it says what a missing one is taken for: the standard wants it there.
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
        """Add the attribute, unless it says what a missing one means."""
        value = getattr(word, self.field)
        if not self.always and self.default is not REQUIRED and value == self.default:
            return
        if output.version < self.since:
            output.tell_lost(word, f"{element.tag}/{self.name} is not known before {output.dotted(self.since)}")
            return
        element.set(self.name, output.text(self.names.get(value, value) if isinstance(value, str) else value, word))


def number(field: str, name: str = "", default: Any = REQUIRED, since: Version = _EVER) -> Attribute:
    """Return the part for a number that may stay open."""
    return Attribute(field, name or field, lambda node, at, usual: node.number(at, usual), default, since)


def fixed(field: str, name: str = "", default: Any = REQUIRED, since: Version = _EVER) -> Attribute:
    """Return the part for a number that decides structure."""
    return Attribute(field, name or field, lambda node, at, usual: node.float(at, usual), default, since)


def integer(field: str, name: str = "", default: Any = REQUIRED, since: Version = _EVER) -> Attribute:
    """Return the part for a whole number."""
    return Attribute(field, name or field, lambda node, at, usual: node.integer(at, usual), default, since)


def boolean(field: str, name: str = "", default: Any = REQUIRED, since: Version = _EVER) -> Attribute:
    """Return the part for true or false."""
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
    """Return the part for one of the words that a field of `word` allows; `names` are those spelled otherwise."""
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
        reader: Child element to the field's value, None when nothing can be made of it.
        writer: The field's value to the child element.
        required: The word cannot do without.
        since: First version that has the child.
    """

    field: str
    tag: str
    reader: Callable[[Node], Any]
    writer: Callable[[Any, Output], etree._Element]
    required: bool = True
    since: Version = _EVER

    def read(self, node: Node) -> Fields | None:
        """Return the field; None when it is needed and missing."""
        inner = node.required(self.tag) if self.required else node.child(self.tag)
        found = None if inner is None else self.reader(inner)
        return None if self.required and found is None else {self.field: found}

    def write(self, word: Word, element: etree._Element, output: Output) -> None:
        """Add the child where the field has a value."""
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
        least: Fewest that are read.
        wanted: Fewest that the standard wants: the last one is repeated where there are fewer.
    """

    field: str
    form: Form[Any]
    least: int = 0
    wanted: int = 0

    def read(self, node: Node) -> Fields | None:
        """Return the field; None when there are too few."""
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
            output.tell_lost(word, f"<{element.tag}> has {self.wanted} <{self.form.tag}> at least")
        for one in (*words, *words[-1:] * missing):
            element.append(self.form.write(one, output))


def made(tag: str, *children: etree._Element, **attributes: str) -> etree._Element:
    """Return an element with attributes and children."""
    element = etree.Element(tag, attributes)
    element.extend(children)
    return element


def nested(around: Sequence[str], element: etree._Element) -> etree._Element:
    """Return an element inside others, given from the outermost."""
    for tag in reversed(around):
        element = made(tag, element)
    return element
