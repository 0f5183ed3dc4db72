"""Files of the conflict language: the words around those of the vocabulary, and reading a file into them.

Reading is shallow: names, parameters and includes. The contents of a scenario or template are read when it is expanded,
because the text of an attribute has no value before its parameters have values.
"""

import os
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Literal, NamedTuple

from lxml import etree

from scenario_compiler.diagnostics import Diagnostics, Place, Severity, all_codes, code_named, did_you_mean
from scenario_compiler.document import Document, read_document
from scenario_compiler.files import is_file
from scenario_compiler.markup import names
from scenario_compiler.markup.environment import Environment, ReadingContext
from scenario_compiler.markup.reading import misspelt, place_children, read_attributes, read_word
from scenario_compiler.resources import portable
from scenario_compiler.source.catalogs import CatalogElement, Catalogs, read_catalog
from scenario_compiler.vocabulary.conditions import Condition
from scenario_compiler.vocabulary.criteria import Criterion
from scenario_compiler.vocabulary.entities import Dynamic, Ego, Row, Static, Traffic, WorkZone
from scenario_compiler.vocabulary.markings import LineBeside, Markings, SecondaryMarkings
from scenario_compiler.vocabulary.positions import SpawnPoints
from scenario_compiler.vocabulary.scenario import Classification, Parameter, Scenario
from scenario_compiler.vocabulary.signals import SignalController
from scenario_compiler.vocabulary.storyboard import AnyOf, Do, When
from scenario_compiler.vocabulary.takeover import Takeover
from scenario_compiler.vocabulary.variables import Variable
from scenario_compiler.vocabulary.variation import Vary
from scenario_compiler.vocabulary.weather import USUAL_WEATHER, Weather
from scenario_compiler.vocabulary.word import (
    ENTITY_ID,
    IDENTIFIER,
    Word,
    attribute,
    child,
    other_attributes,
    same_as,
)


class Include(Word):
    """Include the templates of another file, or the vehicles and drivers of a catalog."""

    word: Literal["include"] = "include"

    file: str = attribute("Path of the file, relative to this file's folder.")


class Allow(Word):
    """Suppress one kind of warnings and notes about this file and what it uses."""

    word: Literal["allow"] = "allow"

    code: str = attribute("Code of the warning, such as SC401.", names="code", pattern="SC[0-9]{3}")


class Use(Word):
    """Insert the contents of a template here. All other attributes are parameters of the template."""

    word: Literal["use"] = "use"

    template: str = attribute("Name of the template.", names="template")
    id: str = attribute(
        "Name of this use, which prefixes the ids of the inserted entities. If left out, the template's name and a "
        "number.",
        default="",
        defines="part",
        pattern=f"({ENTITY_ID})?",
    )
    arguments: dict[str, str] = other_attributes("Values of the template's parameters.")


class EntityWhen(Word):
    """Actions that an entity performs once, as soon as all conditions are true."""

    word: Literal["when"] = "when"

    entity: str = attribute("Id of the entity; the ego vehicle if left out.", default="", names="entity")
    name: str = same_as(When, "name")
    conditions: tuple[Condition | AnyOf, ...] = same_as(When, "conditions")
    do: Do = same_as(When, "do")


class Else(Word):
    """The contents to insert when the test of the `<if>` is false."""

    word: Literal["else"] = "else"

    items: "tuple[Item, ...]" = child("The contents.", default=())


class If(Word):
    """Insert the contents if a test is true; otherwise insert the contents of `<else>`."""

    word: Literal["if"] = "if"

    test: bool = attribute("The test, such as ${$lanes > 2}. It is evaluated once, before the run.")
    items: "tuple[Item, ...]" = child("Contents to insert if the test is true.", default=())
    otherwise: Else | None = child("Contents to insert if it is false.", default=None)


MOST_ROUNDS = 1000
"""Greatest number of repetitions of a <repeat> or <for>."""


class Repeat(Word):
    """Insert the contents several times. In a repeat named `queue`, ids of round 2 begin with `queue.2.`."""

    word: Literal["repeat"] = "repeat"

    count: int = attribute("Number of repetitions.", minimum=0, maximum=MOST_ROUNDS)
    variable: str = attribute(
        "Name of a parameter that contains the number of the round, counted from 0.",
        name="as",
        default="index",
        defines="parameter",
        pattern=IDENTIFIER,
    )
    id: str = attribute(
        "Name of this repeat, which prefixes the ids of the inserted entities. If left out, `repeat` and a number.",
        default="",
        defines="part",
        pattern=f"({ENTITY_ID})?",
    )
    items: "tuple[Item, ...]" = child("Contents to insert in each round.", default=())


class For(Word):
    """Insert the contents once for each of several values. Ids of the first round begin with `for1.1.`."""

    word: Literal["for"] = "for"

    variable: str = attribute(
        "Name of a parameter that contains the value.", name="each", defines="parameter", pattern=IDENTIFIER
    )
    values: tuple[str, ...] = attribute("The values: numbers or names, separated by spaces.", name="in", separated=True)
    id: str = attribute(
        "Name of this loop, which prefixes the ids of the inserted entities. If left out, `for` and a number.",
        default="",
        defines="part",
        pattern=f"({ENTITY_ID})?",
    )
    items: "tuple[Item, ...]" = child("Contents to insert for each value.", default=())


Paint = Markings | SecondaryMarkings | LineBeside

Item = Static | Dynamic | Row | WorkZone | Traffic | Paint | EntityWhen | Use | If | Repeat | For


DEEPEST_INCLUDE = 30
"""Greatest depth of nested includes; real libraries need three."""


class TemplateElement(Word):
    """A reusable part of a scenario with a name and parameters. Its ids are local to each use.

    A name that a use gives to a parameter, such as the id of an entity, is the one known where the use is written.
    """

    word: Literal["template"] = "template"

    name: str = attribute("Name by which <use template=...> refers to it.", defines="template", pattern=IDENTIFIER)
    summary: str = attribute("Summary of its contents in one sentence.", default="")
    source: str = attribute("Publication or observation that describes the situation.", default="")
    parameters: tuple[Parameter, ...] = child("Its parameters.", default=())
    items: tuple[Item, ...] = child("Entities and events of the template.", default=())


class ScenarioElement(Word):
    """A whole conflict: a map, an ego vehicle, other entities and events, the takeover policy and the criteria."""

    word: Literal["scenario"] = "scenario"

    name: str = same_as(Scenario, "name")
    summary: str = same_as(Scenario, "summary")
    source: str = same_as(Scenario, "source")
    map: str = same_as(Scenario, "map")
    weather: str = attribute(
        "Name of a CARLA weather preset, or its index in alphabetical order.",
        default=USUAL_WEATHER,
        names="weather",
    )
    duration: float | None = same_as(Scenario, "duration")
    step: float = same_as(Scenario, "step")
    control_every: int = same_as(Scenario, "control_every")
    parameters: tuple[Parameter, ...] = same_as(Scenario, "parameters")
    vary: Vary | None = same_as(Scenario, "vary")
    classifications: tuple[Classification, ...] = same_as(Scenario, "classifications")
    weather_numbers: Weather | None = child(
        "The weather as numbers; takes precedence over the attribute `weather`.", default=None
    )
    spawn_points: SpawnPoints | None = same_as(Scenario, "spawn_points")
    ego: Ego = child("The automated vehicle.")
    items: tuple[Item, ...] = child("Other entities, and events.", default=())
    variables: tuple[Variable, ...] = same_as(Scenario, "variables")
    signal_controllers: tuple[SignalController, ...] = same_as(Scenario, "signal_controllers")
    takeover: Takeover = same_as(Scenario, "takeover")
    criteria: tuple[Criterion, ...] = child("Criteria by which the run is judged.", default=(), wrapper="criteria")


class LibraryElement(Word):
    """A file of conflicts and templates."""

    word: Literal["scenarios"] = "scenarios"

    version: Literal["1"] = attribute("Version of the language.")
    allowed: tuple[Allow, ...] = child("Warnings that are not reported.", default=())
    includes: tuple[Include, ...] = child("Other files whose templates or catalogs are used.", default=())
    templates: tuple[TemplateElement, ...] = child("Templates.", default=())
    scenarios: tuple[ScenarioElement, ...] = child("Scenarios.", default=())


class Part(NamedTuple):
    """A scenario or template in its file.

    Attributes:
        document: The file.
        element: The element.
        within: The include through which the file was read.
    """

    document: Document
    element: etree._Element
    within: Place | None = None

    @property
    def name(self) -> str:
        """Its name."""
        return str(self.element.get("name", ""))

    def reading(self, sink: Diagnostics, environment: Environment, within: Place | None = None) -> ReadingContext:
        """Return a reader for the element with an environment."""
        return ReadingContext(self.document, sink, environment, within or self.within)


class Library(NamedTuple):
    """A file of the conflict language.

    Attributes:
        document: The file.
        scenarios: Its scenarios by name.
        templates: Its templates and those of its includes, by name.
        own_templates: Names of the templates in the file itself.
        catalogs: Entries of the catalogs that it includes.
        allowed: Codes of the warnings that it suppresses.
        complete: Whether every include and every template's name could be read.
    """

    document: Document
    scenarios: Mapping[str, Part] = MappingProxyType({})
    templates: Mapping[str, Part] = MappingProxyType({})
    own_templates: tuple[str, ...] = ()
    catalogs: Catalogs = Catalogs()
    complete: bool = True
    allowed: frozenset[str] = frozenset()


def read_library(document: Document, sink: Diagnostics) -> Library:
    """Return the contents of a `<scenarios>` file and of its includes."""
    reading = ReadingContext(document, sink, Environment())
    read_attributes(document.root, LibraryElement, reading)
    includes: list[etree._Element] = []
    allowed: set[str] = set()
    parts: dict[str, dict[str, Part]] = {"template": {}, "scenario": {}}
    for rule, elements in place_children(document.root, LibraryElement, reading):
        for element in elements:
            if rule.field == "includes":
                includes.append(element)
            elif rule.field == "allowed":
                allowed.update(_allowed(element, reading))
            else:
                _add_part(parts[str(element.tag)], Part(document, element), reading)
    own = tuple(parts["template"])
    catalogs = Catalogs()
    seen = {os.path.realpath(document.path)}
    for element in includes:
        catalogs = _bring_in(element, reading, parts["template"], catalogs, seen)
    named = all(re.fullmatch(IDENTIFIER, name) for name in own)
    if misspelt(document.root, (Include.tag(), TemplateElement.tag())):
        catalogs = catalogs.with_a_gap()
    complete = named and catalogs.complete
    return Library(document, parts["scenario"], parts["template"], own, catalogs, complete, frozenset(allowed))


def _allowed(element: etree._Element, reading: ReadingContext) -> Iterator[str]:
    """Yield the code of an `<allow>`; report a code that does not exist, or an error, which cannot be suppressed."""
    allow = read_word(element, Allow, reading)
    if allow is None:
        return
    code = code_named(allow.code)
    if code is None:
        hint = did_you_mean(allow.code, all_codes())
        reading.sink.add(names.UNKNOWN_CODE, f"there is no code {allow.code}", allow.place_of("code"), hint=hint)
    elif code.severity is Severity.ERROR:
        message = f"{code.id} ({code.name}) is an error and cannot be allowed: correct it"
        reading.sink.add(names.NOT_ALLOWABLE, message, allow.place_of("code"))
    else:
        yield allow.code


def _add_part(parts: dict[str, Part], part: Part, reading: ReadingContext) -> None:
    if part.name in parts:
        reading.sink.add(
            names.DUPLICATE_NAME,
            f"this file already has a {part.element.tag} named '{part.name}'",
            _name_of(part, reading),
            related=names.first_at(_name_of(parts[part.name], reading)),
        )
    parts.setdefault(part.name, part)


def _name_of(part: Part, reading: ReadingContext) -> Place:
    return reading.origin(part.element, "name" if "name" in part.element.attrib else None)


def _bring_in(
    element: etree._Element,
    reading: ReadingContext,
    templates: dict[str, Part],
    catalogs: Catalogs,
    seen: set[str],
    depth: int = 1,
) -> Catalogs:
    """Add the templates of an included file and of its includes; return the catalogs with its entries."""
    include = read_word(element, Include, reading)
    if include is None:
        return catalogs.with_a_gap()
    place = reading.origin(element, "file")
    path = _find(include.file, reading.document.folder)
    if os.path.realpath(path) in seen:
        return catalogs
    seen.add(os.path.realpath(path))
    if depth > DEEPEST_INCLUDE:
        message = f"'{include.file}' is included through {depth} files; the limit is {DEEPEST_INCLUDE}"
        reading.sink.add(names.DEEP_INCLUDE, message, place)
        return catalogs.with_a_gap()
    inner = Diagnostics()
    document = read_document(path, inner)
    if document is None:
        for one in inner:
            hint = f"write {portable(include.file)}" if "\\" in include.file else one.hint
            reading.sink.add(names.UNUSABLE_INCLUDE, f"'{include.file}': {one.message}", place, hint=hint)
        return catalogs.with_a_gap()
    inside = ReadingContext(document, reading.sink, Environment(), place)
    if document.root.tag == CatalogElement.tag():
        return catalogs.extended(read_catalog(inside))
    parts = list(document.root.iterchildren(TemplateElement.tag(), Include.tag()))
    if document.root.tag != LibraryElement.tag() or (len(document.root) > 0 and not parts):
        reading.sink.add(names.UNUSABLE_INCLUDE, f"'{include.file}' contains neither templates nor a catalog", place)
        return catalogs.with_a_gap()
    for child_element in document.root.iterchildren(TemplateElement.tag()):
        _add_included(templates, Part(document, child_element, place), inside)
    for child_element in document.root.iterchildren("include"):
        catalogs = _bring_in(child_element, inside, templates, catalogs, seen, depth + 1)
    return catalogs


def _add_included(templates: dict[str, Part], part: Part, reading: ReadingContext) -> None:
    """Add a template of an included file; warn if an earlier include has one with this name, which is used instead."""
    there = templates.setdefault(part.name, part)
    if there.within is not None and there.document.path != part.document.path:
        message = f"the template '{part.name}' of {there.document.path} is used, not this one"
        place = _name_of(part, reading)
        first = names.first_at(there.document.origin(there.element, "name"))
        reading.sink.add(names.DUPLICATE_NAME, message, place, related=first, severity=Severity.WARNING)


def _find(name: str, folder: Path) -> Path:
    """Return the path of an included file: the whole path from the folder, or its bare name there."""
    whole = folder / name
    bare = folder / Path(name).name
    return bare if not is_file(whole) and is_file(bare) else whole
