"""The meaning of the names in a file: where each is declared and where it is used.

The words' declarations tell which attributes define a name and which refer to one (`defines`, `names`). What a name
means at a place is determined by the compiler's scopes, from its expansion of the draft.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from lxml import etree

from scenario_compiler.diagnostics import Diagnostics, Place
from scenario_compiler.document import Document, Origin
from scenario_compiler.editor.draft import Attribute, Draft, DraftDocument, Tag
from scenario_compiler.editor.words import Meaning, meanings
from scenario_compiler.expressions import names_in
from scenario_compiler.markup.environment import Environment, ReadingContext
from scenario_compiler.resources import library_folder, template_folders
from scenario_compiler.source.catalogs import CatalogElement, Catalogs, load_catalogs, read_catalog
from scenario_compiler.source.conflict import (
    For,
    Library,
    LibraryElement,
    Part,
    Repeat,
    ScenarioElement,
    TemplateElement,
    Use,
    read_library,
)
from scenario_compiler.source.expansion import Around, around, named_in
from scenario_compiler.source.templates import Expander, TemplateScope, templates_by_name, templates_in
from scenario_compiler.vocabulary.grammar import AttributeRule, grammar_of
from scenario_compiler.vocabulary.scenario import Parameter
from scenario_compiler.vocabulary.word import Word

PARTS = (ScenarioElement.tag(), TemplateElement.tag())
"""The elements to which ids, events and parameters belong."""

LOOPS = {word.tag(): grammar_of(word).attribute_of("variable") for word in (Repeat, For)}
"""The tag of each loop, and its attribute that names the loop's parameter."""

IN_A_FILE = frozenset({"scenario", "template", "vehicle", "driver"})
"""Kinds of names that are known in the whole file; other names are known in their scenario or template."""

_EMBEDDED = re.compile(r"[$]\{([^{}]*)\}?|[$]([A-Za-z_][A-Za-z0-9_.]*)")
_TOKEN = re.compile(r"\S+")


@dataclass(frozen=True, slots=True)
class Symbol:
    """A named thing and the place of its name: a file, and the line and column, counted from 1."""

    kind: str
    name: str
    file: str
    line: int
    column: int

    @classmethod
    def at(cls, kind: str, name: str, place: Place) -> Symbol:
        """Return the symbol for one of the compiler's places."""
        return cls(kind, name, os.path.realpath(place.file), place.line, place.column)


@dataclass(frozen=True, slots=True)
class Mention:
    """A name in a text.

    Attributes:
        start: Offset of its first character.
        end: Offset after its last character.
        symbol: The thing that it means.
        declares: Whether the name is declared here.
    """

    start: int
    end: int
    symbol: Symbol
    declares: bool = False


@dataclass(frozen=True)
class PartNames:
    """The names of a scenario or template: its outermost scope, and its expanded items."""

    scope: TemplateScope
    expander: Expander

    @cached_property
    def scopes(self) -> Mapping[etree._Element, TemplateScope]:
        """The scope of the first use or round of each element that makes one."""
        found: dict[etree._Element, TemplateScope] = {}
        for scope in self.expander.scopes:
            if scope.origin is not None:
                found.setdefault(scope.origin.element, scope)
        return found

    @cached_property
    def declared(self) -> Mapping[tuple[str, str], tuple[Word, TemplateScope, str]]:
        """The word, its scope and its attribute by the kind and name that the word defines in the part."""
        contents = self.expander.contents
        found: dict[tuple[str, str], tuple[Word, TemplateScope, str]] = {}
        for actor, scope in contents.actors:
            found.setdefault(("entity", actor.id), (actor, scope, "id"))
        for _, when, scope in contents.happenings:
            if when.name:
                found.setdefault(("event", when.name), (when, scope, "name"))
        return found


class Analysis:
    """A text of a scenario file and the meaning of its names, which is determined when it is asked for."""

    def __init__(self, path: str, text: str) -> None:
        """Set the path of the file and its text."""
        self.path = path
        self.draft = Draft(text)
        self.quiet = Diagnostics()
        self._parts: dict[int, PartNames | None] = {}
        self._given: dict[tuple[int, str], dict[str, Attribute]] = {}

    @cached_property
    def document(self) -> DraftDocument | None:
        """The text as the compiler reads it; None if it has no element."""
        return self.draft.document(self.path)

    @cached_property
    def library(self) -> Library:
        """The scenarios and templates that the file has and includes."""
        document = self.document
        if document is None:
            return Library(Document(self.path, "", etree.Element(LibraryElement.tag())))
        if document.root.tag == LibraryElement.tag():
            return read_library(document, self.quiet)
        if document.root.tag == CatalogElement.tag():
            return Library(document, catalogs=read_catalog(ReadingContext(document, self.quiet, Environment())))
        return Library(document)

    @cached_property
    def around(self) -> Around:
        """The templates and catalogs that can be named in the file."""
        return around(self.library, load_catalogs(library_folder() / "catalogs", self.quiet))

    @property
    def catalogs(self) -> Catalogs:
        """The vehicles and drivers that can be named in the file, including those beside templates."""
        catalogs = Catalogs()
        for folder in template_folders():
            catalogs = catalogs.extended(templates_in(folder).catalogs)
        return catalogs.extended(self.around.catalogs)

    @cached_property
    def templates(self) -> Mapping[str, Part]:
        """The templates that can be named in the file, by name."""
        return {**templates_by_name(), **self.around.templates}

    @cached_property
    def meanings(self) -> Mapping[int, Meaning]:
        """The meaning of each element, by the offset of its tag."""
        root = self.draft.root
        return {} if root is None else {tag.start: meaning for tag, meaning in meanings(root)}

    @cached_property
    def elements(self) -> Mapping[int, etree._Element]:
        """The compiler's element for each tag, by the tag's offset."""
        return {} if self.document is None else {tag.start: one for one, tag in self.document.tags.items()}

    def part_of(self, tag: Tag) -> Tag | None:
        """Return the scenario or template to which an element belongs, or the element itself if it is one."""
        return next((one for one in tag.ancestors() if one.name in PARTS), None)

    def names_of(self, part: Tag) -> PartNames | None:
        """Return the names of a scenario or template; None if it cannot be read."""
        if part.start not in self._parts:
            element = self.elements.get(part.start)
            names = None
            if element is not None and self.document is not None:
                names = PartNames(*named_in(Part(self.document, element), self.around))
            self._parts[part.start] = names
        return self._parts[part.start]

    def scope_at(self, tag: Tag) -> TemplateScope | None:
        """Return the scope of ids and events at an element; in a loop it is that of the first round."""
        part = self.part_of(tag)
        names = None if part is None else self.names_of(part)
        if names is None:
            return None
        for one in tag.ancestors():
            element = self.elements.get(one.start) if one.name in LOOPS and one is not tag else None
            if element is not None and element in names.scopes:
                return names.scopes[element]
        return names.scope

    def parameters_at(self, tag: Tag) -> Mapping[str, Attribute | None]:
        """Return the parameters that an element's values can use, each with the attribute that names it.

        The innermost declaration of a name applies: first those of the loops around the element, then those of the
        scenario or template. A loop's parameter without a name has its default name and no attribute.
        """
        found: dict[str, Attribute | None] = {}
        for one in tag.ancestors():
            if one.name in LOOPS and one is not tag:
                variable = one.attribute(LOOPS[one.name].name)
                name = LOOPS[one.name].default if variable is None else self.draft.meant(variable)
                found.setdefault(name or "", variable)
            if one.name in PARTS:
                for child in one.children:
                    declared = child.attribute("name") if child.name == Parameter.tag() else None
                    if declared is not None:
                        found.setdefault(self.draft.meant(declared), declared)
                break
        return found

    @cached_property
    def mentions(self) -> list[Mention]:
        """All names in the text with a known declaration, in the order of the text."""
        root = self.draft.root
        found = (
            [] if root is None else [one for tag, meaning in meanings(root) for one in self._mentions_in(tag, meaning)]
        )
        return sorted(found, key=lambda one: (one.start, one.end))

    def mention_at(self, offset: int) -> Mention | None:
        """Return the name that contains an offset or ends at it; the shortest if there are several."""
        there = [one for one in self.mentions if one.start <= offset <= one.end]
        return min(there, key=lambda one: one.end - one.start, default=None)

    def template_of(self, tag: Tag) -> Part | None:
        """Return the template named by a `<use>`."""
        return self.templates.get(self.draft.text_of(tag, "template")) if tag.name == Use.tag() else None

    def symbol(self, kind: str, attribute: Attribute) -> Symbol:
        """Return the symbol that an attribute of this text declares."""
        line = self.draft.line_of(attribute.value_start)
        column = attribute.value_start - self.draft.line_starts[line] + 1
        return Symbol(kind, self.draft.meant(attribute), os.path.realpath(self.path), line + 1, column)

    def _mentions_in(self, tag: Tag, meaning: Meaning) -> Iterator[Mention]:
        parameters = self.parameters_at(tag)
        for attribute in tag.attributes:
            rule = meaning.attributes.get(attribute.name)
            if rule is None and tag.name == Use.tag():
                yield from self._argument(tag, attribute)
            yield from self._parameters_in(attribute, parameters, whole=rule is not None and rule.spelling.expression)
            value = self.draft.value(attribute)
            if rule is None or not value or "$" in value:
                continue
            if rule.spelling.defines:
                symbol = self.symbol(rule.spelling.defines, attribute)
                yield Mention(attribute.value_start, attribute.value_end, symbol, declares=True)
            if rule.spelling.names:
                yield from self._references(tag, attribute, rule)

    def _argument(self, use: Tag, attribute: Attribute) -> Iterator[Mention]:
        """Yield the name of an argument of a use, which means a parameter of the template."""
        template = self.template_of(use)
        for element in [] if template is None else template.element.iterchildren(Parameter.tag()):
            if template is not None and element.get("name") == attribute.name:
                symbol = Symbol.at("parameter", attribute.name, template.document.origin(element, "name"))
                yield Mention(attribute.start, attribute.start + len(attribute.name), symbol)

    def _parameters_in(
        self, attribute: Attribute, parameters: Mapping[str, Attribute | None], *, whole: bool
    ) -> Iterator[Mention]:
        """Yield the parameters that a value uses; with `whole` the value is an expression without brackets."""
        for name, start in parameters_named(self.draft.value(attribute), whole=whole):
            declared = parameters.get(name)
            if declared is not None and declared.has_value:
                begin = attribute.value_start + start
                yield Mention(begin, begin + len(name), self.symbol("parameter", declared))

    def _references(self, tag: Tag, attribute: Attribute, rule: AttributeRule) -> Iterator[Mention]:
        value, kind = self.draft.value(attribute), rule.spelling.names
        whole = [(value.strip(), len(value) - len(value.lstrip()))]
        words = [(one.group(), one.start()) for one in _TOKEN.finditer(value)] if rule.spelling.separated else whole
        for name, at in words:
            start = attribute.value_start + at
            if kind in ("entity", "event"):
                yield from self._scoped(tag, kind, name, start)
            elif (symbol := self._named(tag, kind, name)) is not None:
                yield Mention(start, start + len(name), symbol)

    def _named(self, tag: Tag, kind: str, name: str) -> Symbol | None:
        """Return the meaning of a name that is not looked up in scopes."""
        if kind == "template":
            part = self.templates.get(name)
            return None if part is None else Symbol.at(kind, name, part.document.origin(part.element, "name"))
        if kind in ("vehicle", "driver"):
            entries: Mapping[str, Word] = self.catalogs.vehicles if kind == "vehicle" else self.catalogs.drivers
            entry = entries.get(name)
            return None if entry is None else Symbol.at(kind, name, entry.place_of("name"))
        if kind == "parameter":
            attribute = self.parameters_at(tag).get(name)
            return None if attribute is None else self.symbol(kind, attribute)
        return self._written(tag, kind, name)

    def declared_in(self, part: Tag, kind: str) -> Iterator[tuple[str, Attribute, Tag]]:
        """Yield the names of a kind that elements of a scenario or template declare, as written."""
        for tag in part.below():
            meaning = self.meanings.get(tag.start)
            for name, rule in () if meaning is None else meaning.attributes.items():
                attribute = tag.attribute(name) if rule.spelling.defines == kind else None
                if attribute is not None and attribute.has_value:
                    yield self.draft.meant(attribute), attribute, tag

    def _written(self, tag: Tag, kind: str, name: str) -> Symbol | None:
        part = self.part_of(tag)
        if part is None:
            return None
        if (part.start, kind) not in self._given:
            declared = [(written, attribute) for written, attribute, _ in self.declared_in(part, kind)]
            self._given[part.start, kind] = dict(reversed(declared))
        attribute = self._given[part.start, kind].get(name)
        return None if attribute is None else self.symbol(kind, attribute)

    def _scoped(self, tag: Tag, kind: str, name: str, start: int) -> Iterator[Mention]:
        """Yield the meanings of a name's parts, such as the use and the actor of `queue.2.van`, the outermost last."""
        part, scope = self.part_of(tag), self.scope_at(tag)
        names = None if part is None else self.names_of(part)
        full = None if scope is None else scope.resolve(name) if kind == "entity" else scope.resolve_event(name)
        declared = None if names is None or full is None else names.declared.get((kind, full))
        if declared is None or full is None:
            symbol = self._written(tag, kind, name)
            if symbol is not None:
                yield Mention(start, start + len(name), symbol)
            return
        word, inner, attribute = declared
        at = len(name) - len(_local(full, inner))
        place = word.place_of(attribute)
        element = place.element if isinstance(place, Origin) else None
        written = "" if element is None else element.get(attribute, "")
        if at >= 0 and written and name.startswith(written, at):
            yield Mention(start + at, start + at + len(written), Symbol.at(kind, written, place))
        while inner.parent is not None and (at := at - len(inner.name) - 1) >= 0:
            yield from self._scope_name(inner, start + at)
            inner = inner.parent

    def _scope_name(self, scope: TemplateScope, start: int) -> Iterator[Mention]:
        """Yield the meaning of a scope's name: the id of its use or loop, or the template that names a use."""
        origin = scope.origin
        if origin is None:
            return
        for attribute, kind in (("id", "part"), ("template", "template")):
            written = origin.element.get(attribute, "")
            if written and scope.name.startswith(written):
                symbol = Symbol.at(kind, written, origin.of(attribute))
                if kind == "template" and (part := self.templates.get(written)) is not None:
                    symbol = Symbol.at(kind, written, part.document.origin(part.element, "name"))
                yield Mention(start, start + len(written), symbol)
                return


def parameters_named(value: str, *, whole: bool = False) -> Iterator[tuple[str, int]]:
    """Yield the parameters that an attribute's text uses, each with the offset of its name.

    Args:
        value: The text as written, with XML's references.
        whole: Whether the text is an expression without brackets around it.
    """
    plain = re.sub(r"&[#\w]*;?", lambda one: " " * len(one.group()), value)
    if whole:
        yield from names_in(plain)
        return
    for match in _EMBEDDED.finditer(plain):
        if match.group(2) is not None:
            yield match.group(2), match.start(2)
        else:
            yield from ((name, match.start(1) + at) for name, at in names_in(match.group(1)))


def _local(full: str, scope: TemplateScope) -> str:
    """Return a name without the names of the uses and loops around it."""
    before = 0
    while scope.parent is not None:
        before, scope = before + len(scope.name) + 1, scope.parent
    return full[before:]


def read_analysis(path: Path) -> Analysis | None:
    """Return the analysis of a stored file; None if it cannot be read as text."""
    try:
        return Analysis(str(path), path.read_text(encoding="utf-8-sig"))
    except (OSError, UnicodeDecodeError):
        return None
