"""The conflict language's own file: the words around the vocabulary's, and reading a file into them.

A file is read shallowly: names, parameters and includes. What a scenario or a template holds is read when it is
expanded, because an attribute's text has a meaning only once its parameters have values.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from lxml import etree

from scenario_compiler.diagnostics import Diagnostics, Place, Severity, all_codes, code_named, did_you_mean
from scenario_compiler.document import Document, read_document
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
from scenario_compiler.vocabulary.weather import Weather
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
    """Bring in the templates of another file, or the vehicles and drivers of a catalog."""

    word: Literal["include"] = "include"

    file: str = attribute("Path of the file, from this file's folder.")


class Allow(Word):
    """Keep quiet about warnings and notes of one kind that this file, or what it uses, gives rise to."""

    word: Literal["allow"] = "allow"

    code: str = attribute("Code of the warning, such as SC401.", names="code", pattern="SC[0-9]{3}")


class Use(Word):
    """Put what a template holds in this place. The other attributes are the template's parameters."""

    word: Literal["use"] = "use"

    template: str = attribute("Name of the template.", names="template")
    id: str = attribute(
        "Name of this use: prefix of the ids of what it brings. The template's name and a number when left out.",
        default="",
        defines="part",
        pattern=f"({ENTITY_ID})?",
    )
    arguments: dict[str, str] = other_attributes("Values of the template's parameters.")


class EntityWhen(Word):
    """Something an entity does once, as soon as all conditions are true."""

    word: Literal["when"] = "when"

    entity: str = attribute("Id of the entity that does it; the ego vehicle when left out.", default="", names="entity")
    name: str = same_as(When, "name")
    conditions: tuple[Condition | AnyOf, ...] = same_as(When, "conditions")
    do: Do = same_as(When, "do")


class Else(Word):
    """What stands there when the test of the `<if>` is false."""

    word: Literal["else"] = "else"

    items: tuple[Any, ...] = child("What is put on the road, and what happens there.", default=())


class If(Word):
    """Put what it holds in this place when a test is true, else what its `<else>` holds."""

    word: Literal["if"] = "if"

    test: bool = attribute("What decides, such as ${$lanes > 2}; it is decided once, before the run.")
    items: tuple[Any, ...] = child("What is put there when the test is true.", default=())
    otherwise: Else | None = child("What is put there when it is false.", default=None)


MOST_ROUNDS = 1000
"""Greatest number of rounds of a <repeat> or <for>."""


class Repeat(Word):
    """Put what it holds in this place a number of times. Ids in round 2 of a repeat `queue` begin with `queue.2.`."""

    word: Literal["repeat"] = "repeat"

    count: int = attribute("Number of rounds.", minimum=0, maximum=MOST_ROUNDS)
    variable: str = attribute(
        "Name of a parameter that holds the number of the round, counted from 0.",
        name="as",
        default="index",
        defines="parameter",
        pattern=IDENTIFIER,
    )
    id: str = attribute(
        "Name of this repeat: prefix of the ids of what it brings. `repeat` and a number when left out.",
        default="",
        defines="part",
        pattern=f"({ENTITY_ID})?",
    )
    items: tuple[Any, ...] = child("What is put there in each round.", default=())


class For(Word):
    """Put what it holds in this place once for each of some values. Ids of the first begin with `for1.1.`."""

    word: Literal["for"] = "for"

    variable: str = attribute(
        "Name of a parameter that holds the value.", name="each", defines="parameter", pattern=IDENTIFIER
    )
    values: tuple[str, ...] = attribute("The values: numbers or names with spaces between.", name="in", separated=True)
    id: str = attribute(
        "Name of this loop: prefix of the ids of what it brings. `for` and a number when left out.",
        default="",
        defines="part",
        pattern=f"({ENTITY_ID})?",
    )
    items: tuple[Any, ...] = child("What is put there for each value.", default=())


Paint = Markings | SecondaryMarkings | LineBeside

Item = Static | Dynamic | Row | WorkZone | Traffic | Paint | EntityWhen | Use | If | Repeat | For

for _word in (Else, If, Repeat, For):  # they hold items and are items: told here, where Item is known
    _word.model_fields["items"].annotation = tuple[Item, ...]


DEEPEST_INCLUDE = 30
"""Most files that an included file is included through; real libraries need three."""


class TemplateElement(Word):
    """A part of a scenario with a name and parameters, to be used in many. Ids inside it are its own."""

    word: Literal["template"] = "template"

    name: str = attribute("Name that <use template=...> gives.", defines="template", pattern=IDENTIFIER)
    summary: str = attribute("One sentence: what it puts on the road.", default="")
    source: str = attribute("Where the situation comes from.", default="")
    parameters: tuple[Parameter, ...] = child("Its parameters.", default=())
    items: tuple[Item, ...] = child("What it puts on the road, and what happens there.", default=())


class ScenarioElement(Word):
    """A whole conflict: a map, an ego vehicle, what is on the road, the takeover policy and the criteria."""

    word: Literal["scenario"] = "scenario"

    name: str = same_as(Scenario, "name")
    summary: str = same_as(Scenario, "summary")
    source: str = same_as(Scenario, "source")
    map: str = same_as(Scenario, "map")
    weather: str = attribute(
        "Name of a CARLA weather preset, or its index in alphabetical order.",
        default="ClearNoon",
        names="weather",
    )
    duration: float | None = same_as(Scenario, "duration")
    step: float = same_as(Scenario, "step")
    control_every: int = same_as(Scenario, "control_every")
    parameters: tuple[Parameter, ...] = same_as(Scenario, "parameters")
    vary: Vary | None = same_as(Scenario, "vary")
    classifications: tuple[Classification, ...] = same_as(Scenario, "classifications")
    weather_numbers: Weather | None = child(
        "The weather by its numbers; it goes before the attribute `weather`.", default=None
    )
    spawn_points: SpawnPoints | None = same_as(Scenario, "spawn_points")
    ego: Ego = child("The automated vehicle.")
    items: tuple[Item, ...] = child("What is on the road, and what happens there.", default=())
    variables: tuple[Variable, ...] = same_as(Scenario, "variables")
    signal_controllers: tuple[SignalController, ...] = same_as(Scenario, "signal_controllers")
    takeover: Takeover = same_as(Scenario, "takeover")
    criteria: tuple[Criterion, ...] = child("What the run is judged by.", default=(), wrapper="criteria")


class LibraryElement(Word):
    """A file of conflicts and templates."""

    word: Literal["scenarios"] = "scenarios"

    version: Literal["1"] = attribute("Version of the language.")
    allowed: tuple[Allow, ...] = child("Warnings that are not reported.", default=())
    includes: tuple[Include, ...] = child("Other files whose templates or catalogs are used.", default=())
    templates: tuple[TemplateElement, ...] = child("Templates.", default=())
    scenarios: tuple[ScenarioElement, ...] = child("Scenarios.", default=())


@dataclass(frozen=True)
class Part:
    """A scenario or template as its file holds it.

    Attributes:
        document: The file.
        element: The element.
        within: The include that brought the file in.
    """

    document: Document
    element: etree._Element
    within: Place | None = None

    @property
    def name(self) -> str:
        """Its name."""
        return str(self.element.get("name", ""))

    def reading(self, sink: Diagnostics, environment: Environment, within: Place | None = None) -> ReadingContext:
        """Return how to read it with these meanings of names."""
        return ReadingContext(self.document, sink, environment, within or self.within)


@dataclass(frozen=True)
class Library:
    """A file of the conflict language.

    Attributes:
        document: The file.
        scenarios: Its scenarios by name.
        templates: Its templates and those of its includes by name.
        own_templates: Names of the templates that stand in the file itself.
        catalogs: Entries of the catalogs that it includes.
        allowed: Codes of the warnings that it wants unsaid.
        complete: Every include and every template's name could be read.
    """

    document: Document
    scenarios: Mapping[str, Part] = field(default_factory=dict)
    templates: Mapping[str, Part] = field(default_factory=dict)
    own_templates: tuple[str, ...] = ()
    catalogs: Catalogs = field(default_factory=Catalogs)
    complete: bool = True
    allowed: frozenset[str] = frozenset()


def read_library(document: Document, sink: Diagnostics) -> Library:
    """Return what a `<scenarios>` file holds, with what it includes."""
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
    """Yield the code of an `<allow>`; report one that there is not, or an error, which cannot be allowed."""
    allow = read_word(element, Allow, reading)
    if allow is None:
        return
    code = code_named(allow.code)
    if code is None:
        hint = did_you_mean(allow.code, all_codes())
        reading.sink.add(names.UNKNOWN_CODE, f"there is no code {allow.code}", allow.place_of("code"), hint=hint)
    elif code.severity is Severity.ERROR:
        message = f"{code.id} ({code.name}) is an error: it must be mended"
        reading.sink.add(names.NOT_ALLOWABLE, message, allow.place_of("code"))
    else:
        yield allow.code


def _add_part(parts: dict[str, Part], part: Part, reading: ReadingContext) -> None:
    if part.name in parts:
        reading.sink.add(
            names.DUPLICATE_NAME,
            f"a {part.element.tag} named '{part.name}' stands in this file already",
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
        message = f"'{include.file}' is included through {depth} files; at most {DEEPEST_INCLUDE} are followed"
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
    if document.root.tag != LibraryElement.tag():
        reading.sink.add(names.UNUSABLE_INCLUDE, f"'{include.file}' holds neither templates nor a catalog", place)
        return catalogs.with_a_gap()
    for child_element in document.root.iterchildren("template"):
        templates.setdefault(str(child_element.get("name", "")), Part(document, child_element, place))
    for child_element in document.root.iterchildren("include"):
        catalogs = _bring_in(child_element, inside, templates, catalogs, seen, depth + 1)
    return catalogs


def _find(name: str, folder: Path) -> Path:
    """Return the path of an included file: whole from the folder, else by its bare name there."""
    whole = folder / name
    bare = folder / Path(name).name
    return bare if not whole.is_file() and bare.is_file() else whole
