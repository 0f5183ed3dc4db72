"""Templates: finding them, the scopes of ids in their uses, and inserting their items."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple, cast

from lxml import etree

from scenario_compiler.diagnostics import Diagnostic, Diagnostics, Place, did_you_mean
from scenario_compiler.document import Origin, read_document
from scenario_compiler.expressions import RESERVED, Value
from scenario_compiler.files import files_in
from scenario_compiler.markup import names
from scenario_compiler.markup.environment import Environment, GivenName, ReadingContext
from scenario_compiler.markup.reading import misspelt, place_children, read_attributes, read_word
from scenario_compiler.resources import template_folders
from scenario_compiler.source.catalogs import CatalogElement, Catalogs, read_catalog
from scenario_compiler.source.conflict import (
    MOST_ROUNDS,
    Else,
    EntityWhen,
    For,
    If,
    Library,
    LibraryElement,
    Part,
    Repeat,
    TemplateElement,
    Use,
    read_library,
)
from scenario_compiler.source.groups import lines, members
from scenario_compiler.source.parameters import Declared, bind_use, read_parameters, report_reserved
from scenario_compiler.vocabulary.actions import TrafficSinkAction, TrafficSourceAction, TrafficSwarmAction
from scenario_compiler.vocabulary.entities import Dynamic, Row, Static, Traffic, WorkZone
from scenario_compiler.vocabulary.grammar import NUMBER, ChildRule, grammar_of
from scenario_compiler.vocabulary.markings import LineBeside, Markings, SecondaryMarkings
from scenario_compiler.vocabulary.storyboard import When
from scenario_compiler.vocabulary.traversal import AnyWord, replaced
from scenario_compiler.vocabulary.word import ENTITY_ID, Word


@dataclass
class TemplateScope:
    """The ids that the items of a scenario, or of one use of a template, can name.

    Attributes:
        name: Name of the use, empty for the scenario.
        parent: The scope that contains the use.
        ids: Ids in this scope, with the corresponding ids in the whole scenario.
        all_read: Whether every id here could be read; otherwise an unknown one is not reported.
        uses: Names of the uses in this scope.
        events: Names of events in this scope, with the corresponding names in the whole scenario.
        traffic: Names of background traffic and of actions on traffic, in the same way.
        numbered: Last number of a part without an id, by the stem of its name.
        places: Where the names of this scope are written: of entities, parts, events and traffic.
        origin: The use or the loop that made the scope; None for the scenario.
    """

    name: str = ""
    parent: TemplateScope | None = None
    ids: dict[str, str] = field(default_factory=dict)
    all_read: bool = True
    uses: set[str] = field(default_factory=set)
    events: dict[str, str] = field(default_factory=dict)
    traffic: dict[str, str] = field(default_factory=dict)
    numbered: dict[str, int] = field(default_factory=dict)
    places: dict[tuple[str, str], Place] = field(default_factory=dict)
    origin: Origin | None = None

    def declare(self, local: str) -> str:
        """Register an id here and, with the uses' names as a prefix, in the enclosing scopes; return the full id."""
        full = self.in_full(local)
        for scope, name in self._known_as(local):
            scope.ids[name] = full
        return full

    def declare_traffic(self, local: str) -> str:
        """Register a name of traffic in the same way; return the full name."""
        full = self.in_full(local)
        for scope, name in self._known_as(local):
            scope.traffic[name] = full
        return full

    def in_full(self, local: str) -> str:
        """Return the name in the whole scenario of a name in this scope."""
        *_, (_, full) = self._known_as(local)
        return full

    def _known_as(self, local: str) -> Iterator[tuple[TemplateScope, str]]:
        """Yield this scope and those around it, each with the name under which it knows a name of this one."""
        name = local
        for scope in self._outwards():
            yield scope, name
            name = f"{scope.name}.{name}"

    def name_use(self, use: Use, sink: Diagnostics) -> str:
        """Return the name of a use: its id, or else the template's name with the first free number."""
        return self.name_part(use.id, use.template, use.place_of("id"), sink)

    def name_part(self, wanted: str, stem: str, place: Place, sink: Diagnostics) -> str:
        """Return the name of a use or a loop: the wanted one, or else the stem with the first free number.

        Args:
            wanted: Its id, or empty.
            stem: The beginning of its name if it has no id.
            place: Where the id is written.
            sink: Receives the report of a repeated id.
        """
        if wanted in self.uses:
            self.report_taken("part", wanted, place, sink)
        if wanted:
            self.places.setdefault(("part", wanted), place)
        name = wanted or self._numbered(stem)
        self.uses.add(name)
        return name

    def report_taken(self, kind: str, name: str, place: Place, sink: Diagnostics) -> None:
        """Report that a name of this scope is already used, and where."""
        article = "" if kind == "traffic" else "an " if kind[0] in "aeiou" else "a "
        message = f"there is already {article}{kind} '{name}'"
        sink.add(names.DUPLICATE_NAME, message, place, related=names.first_at(self.places.get((kind, name))))

    def _numbered(self, stem: str) -> str:
        number = self.numbered.get(stem, 0) + 1
        while f"{stem}{number}" in self.uses:
            number += 1
        self.numbered[stem] = number
        return f"{stem}{number}"

    def _outwards(self) -> Iterator[TemplateScope]:
        """Yield this scope and those around it, from the innermost one."""
        scope: TemplateScope | None = self
        while scope is not None:
            yield scope
            scope = scope.parent

    def resolve(self, name: str) -> str | None:
        """Return the id in the whole scenario to which a name refers here.

        The innermost scope that has it counts, from here or, if the name was given from outside, from there.
        """
        return next((scope.ids[name] for scope in self._scopes_of(name) if name in scope.ids), None)

    def known(self) -> set[str]:
        """Return every name of an entity that can be resolved here."""
        return {one for scope in self._outwards() for one in scope.ids}

    def _home_of(self, name: str) -> TemplateScope:
        """Return the scope in which a name that is used here was written."""
        return name.scope if isinstance(name, GivenName) else self

    def _scopes_of(self, name: str) -> Iterator[TemplateScope]:
        """Yield the scopes in which a name that is used here may be found, from the innermost one."""
        return self._home_of(name)._outwards()

    def resolved(self, word: AnyWord, sink: Diagnostics) -> AnyWord:
        """Return the word with the full names of all entities, events and traffic in it; report unknown ones."""

        def in_full(one: Word) -> Word:
            changes = {}
            for name, rule in grammar_of(type(one)).attributes.items():
                if rule.spelling.names == "entity" and (named := getattr(one, rule.field)):
                    listed = named if isinstance(named, tuple) else (named,)
                    found = tuple(self.resolve(each) or self._unknown(each, one, name, sink) for each in listed)
                    changes[rule.field] = found if listed is named else found[0]
                elif rule.spelling.names == "event":
                    named = getattr(one, rule.field)
                    changes[rule.field] = self.resolve_event(named) or self._unknown_event(named, one, name, sink)
                elif rule.spelling.names == "traffic" and (named := getattr(one, rule.field)):
                    changes[rule.field] = self._resolve_traffic(named) or self._unknown_traffic(named, one, name, sink)
                elif rule.spelling.defines == "traffic" and (named := getattr(one, rule.field)):
                    changes[rule.field] = self.in_full(named)
            return one.model_copy(update=changes) if changes else one

        return replaced(cast(AnyWord, in_full(word)), in_full)

    def _unknown(self, named: str, word: Word, attribute: str, sink: Diagnostics) -> str:
        if not self._complete():
            return named
        sink.add(
            names.UNKNOWN_ENTITY,
            f"there is no entity '{named}'",
            word.place_of(attribute),
            hint=did_you_mean(named, self._home_of(named).known()),
        )
        return named

    def name_event(self, when: When | EntityWhen, sink: Diagnostics) -> When | EntityWhen:
        """Register the names of an event and of its actions on traffic, here and in the enclosing scopes.

        There the names of the uses are their prefix. Returns the event with its full name; an event without a name is
        returned unchanged.
        """
        for action in when.do.actions:
            if isinstance(action, TrafficSwarmAction | TrafficSourceAction | TrafficSinkAction) and action.traffic:
                self.declare_traffic(action.traffic)
        if not when.name:
            return when
        if when.name in self.events:
            self.report_taken("event", when.name, when.place_of("name"), sink)
        self.places.setdefault(("event", when.name), when.place_of("name"))
        full = self.in_full(when.name)
        for scope, name in self._known_as(when.name):
            scope.events[name] = full
        return when.model_copy(update={"name": full}).written_at(when.origin)

    def resolve_event(self, name: str) -> str | None:
        """Return the name in the whole scenario to which the name of an event refers here."""
        return next((scope.events[name] for scope in self._scopes_of(name) if name in scope.events), None)

    def _resolve_traffic(self, name: str) -> str | None:
        return next((scope.traffic[name] for scope in self._scopes_of(name) if name in scope.traffic), None)

    def _unknown_traffic(self, named: str, word: Word, attribute: str, sink: Diagnostics) -> str:
        if self._has_read_everything(sink):
            known = {one for scope in self._scopes_of(named) for one in scope.traffic}
            hint = did_you_mean(named, known) if known else "the scenario has no traffic with a name"
            sink.add(names.UNKNOWN_TRAFFIC, f"there is no traffic '{named}'", word.place_of(attribute), hint=hint)
        return named

    def _unknown_event(self, named: str, word: Word, attribute: str, sink: Diagnostics) -> str:
        if self._has_read_everything(sink):
            known = {one for scope in self._scopes_of(named) for one in scope.events}
            hint = did_you_mean(named, known) or 'give the <when> that is meant a name: <when name="brakes">'
            sink.add(names.UNKNOWN_EVENT, f"there is no event '{named}'", word.place_of(attribute), hint=hint)
        return named

    def _has_read_everything(self, sink: Diagnostics) -> bool:
        """Return whether no element was left out that could have the name: neither unexpanded nor unread (SC1xx)."""
        return self._complete() and not any(one.code.id.startswith("SC1") for one in sink)

    def _complete(self) -> bool:
        return self.all_read and (self.parent is None or self.parent._complete())


@dataclass
class Contents:
    """The expanded items of a scenario in document order, each with the scope of its references."""

    actors: list[tuple[Static | Dynamic, TemplateScope]] = field(default_factory=list)
    traffic: dict[str, Traffic] = field(default_factory=dict)
    markings: list[Markings] = field(default_factory=list)
    lines: list[tuple[SecondaryMarkings | LineBeside, TemplateScope]] = field(default_factory=list)
    happenings: list[tuple[str, EntityWhen | When, TemplateScope]] = field(default_factory=list)
    count: int = 0
    depth: int = 0


MOST_ITEMS = 20_000
"""Greatest number of items of a scenario, with those of uses and loops counted each time."""

MOST_ITEMS_TRIED = 1000
"""Greatest number of items that are read of a template that is checked on its own."""

MOST_NESTED, MOST_NESTED_TRIED = 100, 10
"""Greatest depth of nested uses, loops and branches, and that in a template that is checked on its own."""

LOOPS = ((Repeat.tag(), "as"), (For.tag(), "each"))
"""The loops' tags, and the attribute of each that names its variable."""


@dataclass(frozen=True)
class Expander:
    """Expands items: actors get their ids, and uses are replaced by the contents of their templates.

    Attributes:
        own: Templates of the file and its includes.
        complete: Whether `own` has all templates of the file and its includes.
        trial: Whether a template is checked on its own; then items beyond a limit are left out without a report.
        contents: Receives everything.
        declared: Parameters of the used templates, by the templates' places.
        unread: Ids of unreadable actors, to which references are not reported.
        scopes: The scopes of uses and loops, in document order.
        catalogs: Vehicles and drivers beside the used templates.
    """

    own: Mapping[str, Part]
    complete: bool = True
    trial: bool = False
    contents: Contents = field(default_factory=Contents)
    declared: dict[str, Declared] = field(default_factory=dict)
    unread: set[str] = field(default_factory=set)
    scopes: list[TemplateScope] = field(default_factory=list)
    catalogs: list[Catalogs] = field(default_factory=list)

    @property
    def most(self) -> int:
        """Greatest number of items."""
        return MOST_ITEMS_TRIED if self.trial else MOST_ITEMS

    @property
    def has_too_many(self) -> bool:
        """Whether items were left out because there are too many."""
        return self.contents.count > self.most

    def add_items(
        self,
        rule: ChildRule,
        elements: Sequence[etree._Element],
        reading: ReadingContext,
        scope: TemplateScope,
        chain: tuple[str, ...] = (),
    ) -> None:
        """Read and add the items of a scenario or template; `chain` names the enclosing templates."""
        self.contents.depth += 1
        for element in elements:
            if not self._counted(element, reading):
                scope.all_read = False
                break
            word = rule.words[str(element.tag)]
            if word is If:
                self._add_branch(element, reading, scope, chain)
            elif word in (Repeat, For):
                self._add_rounds(element, word, reading, scope, chain)
            else:
                self._add_item(element, word, reading, scope, chain)
        self.contents.depth -= 1

    def _add_item(
        self,
        element: etree._Element,
        word: type[Word],
        reading: ReadingContext,
        scope: TemplateScope,
        chain: tuple[str, ...],
    ) -> None:
        item = read_word(element, word, reading)
        if isinstance(item, Static | Dynamic):
            self._add_actor(item, scope, reading.sink)
        elif isinstance(item, Row | WorkZone):
            for one in members(item):
                self._add_actor(one, scope, reading.sink)
            self.contents.lines += [(line, scope) for line in lines(item)]
        elif isinstance(item, Traffic):
            self._add_traffic(item, scope, reading.sink)
        elif isinstance(item, Markings):
            self.contents.markings.append(item)
        elif isinstance(item, SecondaryMarkings | LineBeside):
            self.contents.lines.append((item, scope))
        elif isinstance(item, EntityWhen):
            self.contents.happenings.append((item.entity, scope.name_event(item, reading.sink), scope))
        elif isinstance(item, Use):
            self._add_use(item, reading, scope, chain)
        else:
            self._lose(element, scope)

    def _counted(self, element: etree._Element, reading: ReadingContext) -> bool:
        """Count an item and return whether it may be added; report the first one above the limit."""
        self.contents.count += 1
        if self.contents.count == self.most + 1 and not self.trial:
            message = f"more than {self.most} items are inserted here"
            reading.sink.add(names.TOO_MANY_ITEMS, message, reading.origin(element))
        if self.contents.depth <= (MOST_NESTED_TRIED if self.trial else MOST_NESTED):
            return not self.has_too_many
        if not self.trial:
            message = f"more than {MOST_NESTED} uses, loops and branches are nested here"
            reading.sink.add(names.TOO_MANY_ITEMS, message, reading.origin(element))
        return False

    def _add_branch(
        self, element: etree._Element, reading: ReadingContext, scope: TemplateScope, chain: tuple[str, ...]
    ) -> None:
        """Add the items in the chosen branch of an `<if>`; read the other branch in any case, to report its faults."""
        test = (read_attributes(element, If, reading) or {}).get("test")
        for rule, elements in place_children(element, If, reading):
            if rule.field == "items":
                self._add_if(test is True, rule, elements, reading, scope, chain)
                continue
            for otherwise in elements:
                read_attributes(otherwise, Else, reading)
                for inner, found in place_children(otherwise, Else, reading):
                    self._add_if(test is False, inner, found, reading, scope, chain)
        if test is None:
            scope.all_read = False

    def _add_if(
        self,
        wanted: bool,
        rule: ChildRule,
        elements: Sequence[etree._Element],
        reading: ReadingContext,
        scope: TemplateScope,
        chain: tuple[str, ...],
    ) -> None:
        if wanted:
            self.add_items(rule, elements, reading, scope, chain)
            return
        variables = {loop.get(name) for one in elements for tag, name in LOOPS for loop in one.iter(tag)}
        open_everywhere = reading.environment.undecided(map(str, variables))
        open_everywhere.lenient |= None in variables
        skimming = reading._replace(environment=open_everywhere)
        for element in elements:
            read_word(element, rule.words[str(element.tag)], skimming)

    def _add_rounds(
        self,
        element: etree._Element,
        word: type[Word],
        reading: ReadingContext,
        scope: TemplateScope,
        chain: tuple[str, ...],
    ) -> None:
        """Add the items of a `<repeat>` or `<for>` for each round, with ids of their own."""
        before = reading.sink.reported
        fields = read_attributes(element, word, reading)
        faultless = reading.sink.reported == before
        ((rule, elements),) = place_children(element, word, reading)
        values = _round_values(fields) if fields is not None and faultless else None
        if not values:
            known = reading.environment.undecided([str(element.get(dict(LOOPS)[word.tag()], "index"))])
            known.lenient |= not faultless
            self._add_if(False, rule, elements, reading._replace(environment=known), scope, chain)
        if fields is None or values is None:
            scope.all_read = False
            return
        if len(values) > MOST_ROUNDS:
            message = f"{len(values)} rounds are too many; at most {MOST_ROUNDS} are allowed"
            reading.sink.add(names.TOO_MANY_ITEMS, message, reading.origin(element))
            return
        name = scope.name_part(fields.get("id", ""), word.tag(), reading.origin(element, "id"), reading.sink)
        variable = fields.get("variable", "index")
        if variable in RESERVED:
            report_reserved(variable, reading.origin(element, dict(LOOPS)[word.tag()]), reading.sink)
        for number, value in enumerate(values if elements else (), start=1):
            if self.has_too_many:
                break
            inside = reading._replace(environment=reading.environment.with_value(variable, value, scope))
            inner = self._inside(f"{name}.{number}", scope, reading.origin(element))
            self.add_items(rule, elements, inside, inner, chain)

    def _lose(self, element: etree._Element, scope: TemplateScope) -> None:
        """Record the names that an unreadable item would have declared."""
        if element.tag in (Static.tag(), Dynamic.tag()) and re.fullmatch(ENTITY_ID, element.get("id", "")):
            self.unread.add(scope.declare(str(element.get("id"))))
        elif element.tag not in (Markings.tag(), SecondaryMarkings.tag(), LineBeside.tag()):
            scope.all_read = False

    def _add_actor(self, actor: Static | Dynamic, scope: TemplateScope, sink: Diagnostics) -> None:
        if actor.id in scope.ids:
            scope.report_taken("entity", actor.id, actor.place_of("id"), sink)
            return
        scope.places.setdefault(("entity", actor.id), actor.place_of("id"))
        full = scope.declare(actor.id)
        self.contents.actors.append((actor.model_copy(update={"id": full}), scope))
        if isinstance(actor, Dynamic):
            self.contents.happenings.extend((actor.id, scope.name_event(when, sink), scope) for when in actor.whens)

    def _add_traffic(self, traffic: Traffic, scope: TemplateScope, sink: Diagnostics) -> None:
        full = scope.in_full(traffic.id)
        if full in self.contents.traffic:
            scope.report_taken("traffic", traffic.id, traffic.place_of("id"), sink)
            return
        scope.places[("traffic", traffic.id)] = traffic.place_of("id")
        scope.declare_traffic(traffic.id)
        self.contents.traffic[full] = traffic.model_copy(update={"id": full}).written_at(traffic.origin)

    def _add_use(self, use: Use, reading: ReadingContext, scope: TemplateScope, chain: tuple[str, ...]) -> None:
        template = self.find(use, reading.sink)
        if template is None:
            scope.all_read = False
            return
        identity = f"{template.document.path}#{use.template}"
        if identity in chain:
            uses = " uses ".join(f"'{one.rsplit('#', 1)[1]}'" for one in (*chain[chain.index(identity) :], identity))
            reading.sink.add(names.TEMPLATE_CYCLE, f"{uses}, without end", use.origin)
            return
        name = scope.name_use(use, reading.sink)
        inner = self._inside(name, scope, use.origin)
        if identity not in self.declared:
            self.declared[identity] = template_parameters(template, reading.sink)
        environment = bind_use(self.declared[identity], use.arguments, reading, use, scope)
        inside = template.reading(reading.sink, environment, use.origin)
        self.add_template(template, inside, inner, (*chain, identity))

    def _inside(self, name: str, scope: TemplateScope, origin: Place) -> TemplateScope:
        """Return and register the scope of a use or of a round of a loop."""
        inner = TemplateScope(name, scope, origin=origin if isinstance(origin, Origin) else None)
        self.scopes.append(inner)
        return inner

    def add_template(
        self, template: Part, reading: ReadingContext, scope: TemplateScope, chain: tuple[str, ...] = ()
    ) -> None:
        """Read and add the items of a template."""
        placed = place_children(template.element, TemplateElement, reading)
        rule, found = next((rule, found) for rule, found in placed if rule.field == "items")
        if misspelt(template.element, rule.tags):
            scope.all_read = False
        self.add_items(rule, found, reading, scope, chain)

    def find(self, use: Use, sink: Diagnostics) -> Part | None:
        """Return the template of a use: one of the file, an included one, or one of the folders."""
        if use.template in self.own:
            return self.own[use.template]
        for shelf in map(templates_in, template_folders()):
            sink.take(shelf.faults)
            if use.template in shelf.templates:
                self.catalogs.append(shelf.catalogs)
                return shelf.templates[use.template]
        if self.complete:
            known = {*self.own, *templates_by_name()}
            message = f"there is no template '{use.template}'"
            sink.add(names.UNKNOWN_TEMPLATE, message, use.place_of("template"), hint=did_you_mean(use.template, known))
        return None


def _round_values(fields: Mapping[str, Any]) -> Sequence[Value]:
    """Return the value of a loop's variable in each round."""
    if "count" in fields:
        return [float(number) for number in range(fields["count"])]
    return [_meant(text) for text in fields["values"]]


def _meant(text: str) -> Value:
    if re.fullmatch(NUMBER, text):
        return float(text)
    return text == "true" if text in ("true", "false") else text


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


def templates_by_name() -> dict[str, Part]:
    """Return the templates of all folders; for equal names that of the first folder."""
    shelves = [templates_in(folder).templates for folder in template_folders()]
    return {name: part for templates in reversed(shelves) for name, part in templates.items()}


class Shelf(NamedTuple):
    """The contents of a folder of templates.

    Attributes:
        templates: Templates by name.
        catalogs: Vehicles and drivers in the same files.
        faults: The faults of the files.
    """

    templates: Mapping[str, Part]
    catalogs: Catalogs
    faults: tuple[Diagnostic, ...]


@cache
def templates_in(folder: Path) -> Shelf:
    """Return the contents of a folder of templates, including subfolders; read once per process."""
    sink = Diagnostics()
    templates: dict[str, Part] = {}
    catalogs = Catalogs()
    for path in files_in(folder, ".xml", deep=True):
        document = read_document(path, sink)
        root = "" if document is None else document.root.tag
        if document is not None and root == LibraryElement.tag():
            library = read_library(document, sink)
            _shelve(library, templates, sink)
            catalogs = catalogs.extended(library.catalogs)
        elif document is not None and root == CatalogElement.tag():
            catalogs = catalogs.extended(read_catalog(ReadingContext(document, sink, Environment())))
    return Shelf(templates, catalogs, tuple(sink.found))


def _shelve(library: Library, templates: dict[str, Part], sink: Diagnostics) -> None:
    """Add the templates of a file and of its includes; report one of its own with a name that another file uses."""
    for name in library.own_templates:
        part, there = library.templates[name], templates.get(name)
        if there is not None and there.document.path != part.document.path:
            message = f"a template named '{name}' is already in {there.document.path}"
            sink.add(names.DUPLICATE_NAME, message, part.document.origin(part.element, "name"))
    for name, part in library.templates.items():
        if name in library.own_templates or name not in templates:
            templates[name] = part
