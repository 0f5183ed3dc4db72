"""Templates: where they are found, the scopes of ids that their uses make, and putting their items in place."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import count
from pathlib import Path
from typing import cast

from lxml import etree

from scenario_compiler.diagnostics import Diagnostic, Diagnostics, did_you_mean
from scenario_compiler.document import read_document
from scenario_compiler.source import names
from scenario_compiler.source.conflict import (
    EntityWhen,
    LibraryElement,
    Part,
    TemplateElement,
    Use,
    read_library,
)
from scenario_compiler.source.environment import Environment, Reading
from scenario_compiler.source.parameters import Declared, bind_use, read_parameters
from scenario_compiler.source.reading import place_children, read_attributes, read_word
from scenario_compiler.vocabulary.entities import Dynamic, Static
from scenario_compiler.vocabulary.grammar import ChildRule, grammar_of
from scenario_compiler.vocabulary.markings import Markings
from scenario_compiler.vocabulary.storyboard import When
from scenario_compiler.vocabulary.traversal import AnyWord, replaced
from scenario_compiler.vocabulary.word import ENTITY_ID, Word


@dataclass
class Scope:
    """The ids that the items of a scenario, or of one use of a template, can name.

    Attributes:
        name: Name of the use, empty for the scenario.
        parent: The scope that the use stands in.
        ids: Id as this scope knows it, to the id in the whole scenario.
        all_read: Every id here could be read; else one that is not known may well be there.
        uses: Names of the uses that stand here.
    """

    name: str = ""
    parent: Scope | None = None
    ids: dict[str, str] = field(default_factory=dict)
    all_read: bool = True
    uses: set[str] = field(default_factory=set)

    def declare(self, local: str) -> str:
        """Make an id known here and, behind the names of the uses, in the scopes around; return it in full."""
        name, scope = local, self
        known = [(self, local)]
        while scope.parent is not None:
            name, scope = f"{scope.name}.{name}", scope.parent
            known.append((scope, name))
        for where, as_known in known:
            where.ids[as_known] = name
        return name

    def name_use(self, use: Use, sink: Diagnostics) -> str:
        """Return the name of a use: its id, else the template's name and the first number that is free."""
        if use.id in self.uses:
            sink.add(names.DUPLICATE_NAME, f"a use '{use.id}' is there already", use.place_of("id"))
        numbered = (f"{use.template}{number}" for number in count(1))
        name = use.id or next(name for name in numbered if name not in self.uses)
        self.uses.add(name)
        return name

    def resolve(self, name: str) -> str | None:
        """Return the id in the whole scenario that a name means here: the nearest scope that knows it decides."""
        scope: Scope | None = self
        while scope is not None:
            if name in scope.ids:
                return scope.ids[name]
            scope = scope.parent
        return None

    def known(self) -> set[str]:
        """Return every name that can be resolved here."""
        return set(self.ids) | (self.parent.known() if self.parent else set())

    def resolved(self, word: AnyWord, sink: Diagnostics) -> AnyWord:
        """Return the word with every id of an entity, in it and below it, in full; report ids that nobody has."""

        def in_full(one: Word) -> Word:
            changes = {}
            for name, rule in grammar_of(type(one)).attributes.items():
                if rule.spelling.names == "entity" and (named := getattr(one, rule.field)):
                    changes[rule.field] = self.resolve(named) or self._unknown(named, one, name, sink)
            return one.model_copy(update=changes) if changes else one

        return replaced(cast(AnyWord, in_full(word)), in_full)

    def _unknown(self, named: str, word: Word, attribute: str, sink: Diagnostics) -> str:
        if not self._complete():
            return named
        sink.add(
            names.UNKNOWN_ENTITY,
            f"there is no entity '{named}'",
            word.place_of(attribute),
            hint=did_you_mean(named, self.known()),
        )
        return named

    def _complete(self) -> bool:
        return self.all_read and (self.parent is None or self.parent._complete())


@dataclass
class Contents:
    """What the items of a scenario come to, in document order, each with the scope that its references mean."""

    actors: list[tuple[Static | Dynamic, Scope]] = field(default_factory=list)
    markings: list[Markings] = field(default_factory=list)
    happenings: list[tuple[str, EntityWhen | When, Scope]] = field(default_factory=list)


@dataclass(frozen=True)
class Expander:
    """Puts items in place: actors get their ids, uses are replaced by what their templates hold.

    Attributes:
        own: Templates of the file and its includes.
        library: Folder of the library's templates.
        complete: `own` has all that the file and its includes hold.
        contents: Where everything goes.
        unread: Ids of actors that are written but cannot be read: references to them are no faults.
    """

    own: Mapping[str, Part]
    library: Path
    complete: bool = True
    contents: Contents = field(default_factory=Contents)
    unread: set[str] = field(default_factory=set)

    def add_items(
        self,
        rule: ChildRule,
        elements: Sequence[etree._Element],
        reading: Reading,
        scope: Scope,
        chain: tuple[str, ...] = (),
    ) -> None:
        """Read and add the items of a scenario or template; `chain` names the templates around them."""
        for element in elements:
            item = read_word(element, rule.words[str(element.tag)], reading)
            if isinstance(item, Static | Dynamic):
                self._add_actor(item, scope, reading.sink)
            elif isinstance(item, Markings):
                self.contents.markings.append(item)
            elif isinstance(item, EntityWhen):
                self.contents.happenings.append((item.entity, item, scope))
            elif isinstance(item, Use):
                self._add_use(item, reading, scope, chain)
            else:
                self._lose(element, scope)

    def _lose(self, element: etree._Element, scope: Scope) -> None:
        """Remember what an item that cannot be read would have brought."""
        if element.tag in (Static.tag(), Dynamic.tag()) and re.fullmatch(ENTITY_ID, element.get("id", "")):
            self.unread.add(scope.declare(str(element.get("id"))))
        elif element.tag != Markings.tag():
            scope.all_read = False

    def _add_actor(self, actor: Static | Dynamic, scope: Scope, sink: Diagnostics) -> None:
        if actor.id in scope.ids:
            message = f"an entity '{actor.id}' is there already"
            sink.add(names.DUPLICATE_NAME, message, actor.place_of("id"))
            return
        full = scope.declare(actor.id)
        self.contents.actors.append((actor.model_copy(update={"id": full}), scope))
        if isinstance(actor, Dynamic):
            self.contents.happenings.extend((actor.id, when, scope) for when in actor.whens)

    def _add_use(self, use: Use, reading: Reading, scope: Scope, chain: tuple[str, ...]) -> None:
        template = self.find(use, reading.sink)
        if template is None:
            scope.all_read = False
            return
        identity = f"{template.document.path}#{use.template}"
        if identity in chain:
            uses = " uses ".join(f"'{one.rsplit('#', 1)[1]}'" for one in (*chain[chain.index(identity) :], identity))
            reading.sink.add(names.TEMPLATE_CYCLE, f"{uses}: it never ends", use.origin)
            return
        name = scope.name_use(use, reading.sink)
        inner = Scope(name, scope)
        parameters = template_parameters(template, reading.sink)
        environment = bind_use(parameters, use.arguments, reading, use)
        inside = template.reading(reading.sink, environment, use.origin)
        self.add_template(template, inside, inner, (*chain, identity))

    def add_template(self, template: Part, reading: Reading, scope: Scope, chain: tuple[str, ...] = ()) -> None:
        """Read and add the items of a template."""
        placed = place_children(template.element, TemplateElement, reading)
        self.add_items(*next((rule, found) for rule, found in placed if rule.field == "items"), reading, scope, chain)

    def find(self, use: Use, sink: Diagnostics) -> Part | None:
        """Return the template of a use: the file's own, an included one, or the library's."""
        if use.template in self.own:
            return self.own[use.template]
        library, faults = library_templates(self.library)
        sink.found.extend(faults)
        if use.template not in library and self.complete:
            sink.add(
                names.UNKNOWN_TEMPLATE,
                f"there is no template '{use.template}'",
                use.place_of("template"),
                hint=did_you_mean(use.template, {*self.own, *library}),
            )
        return library.get(use.template)


def template_parameters(part: Part, sink: Diagnostics) -> Declared:
    """Return the parameters that a template declares."""
    reading = part.reading(sink, Environment())
    read_attributes(part.element, TemplateElement, reading)
    parameters = read_parameters(part.element, reading)
    for name in ("template", "id"):
        if name in parameters.known:
            sink.add(
                names.RESERVED_NAME,
                f"<use> needs the attribute '{name}' for itself",
                parameters.known[name].place_of("name"),
            )
    return parameters


@cache
def library_templates(folder: Path) -> tuple[Mapping[str, Part], tuple[Diagnostic, ...]]:
    """Return the templates of a folder's files, read once a process, and what is wrong with the files."""
    sink = Diagnostics()
    templates: dict[str, Part] = {}
    for path in sorted(folder.glob("*.xml")):
        document = read_document(path, sink)
        if document is not None and document.root.tag == LibraryElement.tag():
            templates.update(read_library(document, sink).templates)
    return templates, tuple(sink.found)
