"""Expands a scenario of the conflict language: parameters bound, uses replaced, references resolved."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import count
from typing import Any, NamedTuple

from lxml import etree

from scenario_compiler.diagnostics import MOST_SUGGESTED, Diagnostics, did_you_mean
from scenario_compiler.expressions import Value, format_value, parse_expression
from scenario_compiler.markup import names
from scenario_compiler.markup.empty_ranges import report_empty_ranges
from scenario_compiler.markup.environment import Environment, ReadingContext
from scenario_compiler.markup.reading import misspelt, place_children, read_attributes, read_word
from scenario_compiler.source.catalogs import Catalogs
from scenario_compiler.source.conflict import EntityWhen, Library, Part, ScenarioElement, TemplateElement
from scenario_compiler.source.events import MOST_WAYS, storyboard_of, ways
from scenario_compiler.source.parameters import (
    STRUCTURAL_KINDS,
    Declared,
    bind_arguments,
    default_value,
    read_parameters,
)
from scenario_compiler.source.templates import Expander, TemplateScope, template_parameters
from scenario_compiler.source.unused import report_unused_parameters
from scenario_compiler.source.variation import check_variation
from scenario_compiler.vocabulary.actions import AssignControllerAction, KeepsVehicles, TrafficKind
from scenario_compiler.vocabulary.driver import Driver, DriverModel, Effect
from scenario_compiler.vocabulary.entities import Controller, Dynamic, Ego, Static, Traffic, Vehicle
from scenario_compiler.vocabulary.markings import LineBeside, SecondaryMarkings
from scenario_compiler.vocabulary.scenario import NumberLimit, Parameter, Scenario
from scenario_compiler.vocabulary.storyboard import When
from scenario_compiler.vocabulary.structural import structural_parameters
from scenario_compiler.vocabulary.takeover import Takeover
from scenario_compiler.vocabulary.traversal import AnyWord, entities_named, parameters_in, replaced, walk
from scenario_compiler.vocabulary.weather import (
    USUAL_WEATHER,
    WEATHER_PRESETS,
    AnyWeather,
    Weather,
    complete_weather,
    weather_preset,
)
from scenario_compiler.vocabulary.word import Word


class Around(NamedTuple):
    """The surroundings of a scenario: the templates of its file, and the catalogs."""

    templates: Mapping[str, Part]
    catalogs: Catalogs
    complete: bool

    def expander(self, *, trial: bool = False) -> Expander:
        """Return the expander for the items of one scenario, or of a template that is checked on its own."""
        return Expander(self.templates, self.complete, trial)


def around(library: Library, catalogs: Catalogs) -> Around:
    """Return the surroundings of the scenarios of a file; `catalogs` are the library's."""
    return Around(library.templates, catalogs.extended(library.catalogs), library.complete)


def catalogs_of(surroundings: Around, expander: Expander) -> Catalogs:
    """Return the available catalogs: those of the surroundings, and those beside the used templates."""
    catalogs = Catalogs()
    for beside in expander.catalogs:
        catalogs = catalogs.extended(beside)
    return catalogs.extended(surroundings.catalogs)


MOST_READINGS = 8
"""Greatest number of readings of a scenario that may each find another structural parameter; real ones need two."""


def expand_scenario(
    part: Part, arguments: Mapping[str, str], sink: Diagnostics, surroundings: Around
) -> Scenario | None:
    """Return the scenario; None if too much of it is missing or wrong.

    Parameters that are only used in numbers remain open. If another value turns out to depend on a parameter while
    reading, the scenario is read again with this parameter's value inserted everywhere. The inserted parts may depend
    on another such parameter; after MOST_READINGS no parameter stays open.
    """
    head = part.reading(sink, Environment())
    declared = read_parameters(part.element, head)
    values = bind_arguments(declared, arguments, sink)
    settled = {name for name in values if declared.known[name].type in STRUCTURAL_KINDS}
    for number in count(1):
        attempt = Diagnostics()
        environment = _environment(declared, values, settled)
        scenario = _Attempt(part, part.reading(attempt, environment), surroundings).scenario(declared.known, values)
        if scenario is not None:
            environment.structural |= structural_parameters(scenario)
        if environment.structural <= settled:
            sink.absorb(attempt)
            if scenario is not None and scenario.vary is not None:
                check_variation(scenario.vary, declared, sink)
            if declared.all_read and not sink.has_errors:
                report_unused_parameters(part, declared, sink)
            return scenario
        settled |= environment.structural if number < MOST_READINGS else set(values)
    raise AssertionError("with every parameter settled, none turns out to be structural")


def check_template(part: Part, sink: Diagnostics, surroundings: Around) -> None:
    """Report every fault of a template on its own, used once without arguments."""
    expander = surroundings.expander(trial=True)
    declared = template_parameters(part, sink)
    reading = _at_defaults(part, declared, sink)
    expander.add_template(part, reading, TemplateScope(part.name, TemplateScope()))
    actors = [actor for actor, _ in expander.contents.actors]
    catalog_vehicles(actors, catalogs_of(surroundings, expander), sink)
    if declared.all_read and not sink.has_errors:
        report_unused_parameters(part, declared, sink)


def _at_defaults(part: Part, declared: Declared, sink: Diagnostics) -> ReadingContext:
    """Return the context for reading a part with its parameters' defaults; a parameter without default stays open."""
    values = {name: value for name, one in declared.known.items() if (value := default_value(one, sink)) is not None}
    return part.reading(sink, _environment(declared, values, set(values)))


def named_in(part: Part, surroundings: Around) -> tuple[TemplateScope, Expander]:
    """Return the names in a scenario or a template, and its items, with its parameters' defaults.

    Faults are not reported: this function serves editors of unfinished files.
    """
    quiet = Diagnostics()
    element, word = part.element, ScenarioElement if part.element.tag == ScenarioElement.tag() else TemplateElement
    reading = _at_defaults(part, read_parameters(element, part.reading(quiet, Environment())), quiet)
    scope, expander = TemplateScope(), surroundings.expander(trial=True)
    for rule, found in place_children(element, word, reading):
        for ego in found if rule.field == "ego" else ():
            full = scope.declare(ego.get("id", "ego"))
            whens = [read_word(one, When, reading) for one in ego.iterchildren(When.tag())]
            named = [scope.name_event(one, quiet) for one in whens if one is not None]
            expander.contents.happenings += [(full, when, scope) for when in named]
        if rule.field == "items":
            expander.add_items(rule, found, reading, scope)
    return scope, expander


def _environment(declared: Declared, values: Mapping[str, Value], settled: set[str]) -> Environment:
    bindings = {name: value if name in settled else parse_expression(f"${name}") for name, value in values.items()}
    missing = frozenset(set(declared.known) - set(values))
    still_open = {name: value for name, value in values.items() if name not in settled}
    return Environment(bindings, still_open, missing, not declared.all_read, quantities=declared.quantities)


NAMED = {
    "variables": ("variable", "", "name"),
    "signal_controllers": ("controller of traffic signals", "", "name"),
    "spawn_points": ("spawn point", "points", "name"),
    "takeover": ("cause", "causes", "kind"),
}
"""What a child of a scenario is or holds, in which field, and the attribute that must differ."""


@dataclass
class _Attempt:
    """One reading of a scenario with one environment."""

    part: Part
    reading: ReadingContext
    around: Around

    def __post_init__(self) -> None:
        self.sink = self.reading.sink
        self.scope = TemplateScope()
        self.expander = self.around.expander()
        self.words: dict[str, Any] = {}

    def scenario(self, parameters: Mapping[str, Parameter], values: Mapping[str, Value]) -> Scenario | None:
        """Return the scenario.

        None if its head or its ego vehicle cannot be read, if it has no known vehicle, or too many items.
        """
        element = self.part.element
        fields = read_attributes(element, ScenarioElement, self.reading)
        preset = (fields or {}).pop("weather", USUAL_WEATHER)
        self._read_children(element)
        catalogs = catalogs_of(self.around, self.expander)
        weather = self._weather(preset)
        takeover = self._takeover(catalogs)
        ego = self.words.get("ego")
        if fields is None or not isinstance(ego, Ego) or self.expander.has_too_many:
            return None
        ego = self.scope.resolved(ego, self.sink)
        actors, happenings = self._contents(ego)
        vehicles = catalog_vehicles([ego, *actors], catalogs, self.sink)
        flows = self.expander.contents.traffic.values()
        traffic = [traffic_models(one, catalogs, self.sink) for one in flows]
        if not vehicles:
            return None
        storyboard = storyboard_of([ego.id, *(actor.id for actor in actors)], self._bounded(happenings))
        more = [one for _, some in traffic for one in some]
        more += kept_vehicles([storyboard], catalogs, self.sink)
        report_empty_ranges([storyboard, *flows], self.sink)
        scenario = Scenario.model_construct(
            **fields,
            weather=weather,
            vary=self.words.get("vary"),
            classifications=self.words.get("classifications", ()),
            ego=ego.model_copy(update={"whens": ()}),
            actors=tuple(actors),
            spawn_points=self.words.get("spawn_points"),
            traffic=tuple(one for one, _ in traffic),
            vehicles=tuple({one.name: one for one in (*vehicles, *more)}.values()),
            markings=tuple(self.expander.contents.markings),
            secondary_markings=self._lines(),
            storyboard=storyboard,
            variables=self.words.get("variables", ()),
            signal_controllers=self.words.get("signal_controllers", ()),
            takeover=takeover,
            criteria=self.words.get("criteria", ()),
        ).written_at(self.reading.origin(element))
        for word in walk(scenario):
            if isinstance(word, Controller | AssignControllerAction):
                self._report_equal(word.properties, "property of the controller", "name")
        in_use = parameters_in(scenario)
        still_open = tuple(
            one.model_copy(update={"default": format_value(values[name])})
            for name, one in parameters.items()
            if name in in_use
        )
        limits = tuple(self._limits(in_use, values))
        return scenario.model_copy(update={"parameters": still_open, "limits": limits})

    def _limits(self, in_use: set[str], values: Mapping[str, Value]) -> Iterator[NumberLimit]:
        """Yield the limits of numbers that depend on open parameters; other parameters have their values."""
        for (holder, _, limits), expression in self.reading.environment.limits.items():
            settled = {name: values[name] for name in expression.names if name not in in_use}
            value = expression.substitute(settled)
            if value.names:
                yield NumberLimit.model_construct(
                    holder=holder,
                    value=value,
                    least=limits.minimum,
                    exclusive=limits.exclusive,
                    greatest=limits.maximum,
                )

    def _bounded(self, happenings: Iterable[tuple[str, When | EntityWhen]]) -> list[tuple[str, When | EntityWhen]]:
        """Return the events; report and leave out those with too many alternatives."""
        kept = []
        for entity, when in happenings:
            if ways(when.conditions) <= MOST_WAYS:
                kept.append((entity, when))
                continue
            message = f"there are {ways(when.conditions)} ways to fulfil this <when>; at most {MOST_WAYS} are read"
            self.sink.add(names.TOO_MANY_WAYS, message, when.origin)
        return kept

    def _read_children(self, element: etree._Element) -> None:
        for rule, elements in place_children(element, ScenarioElement, self.reading):
            if rule.field == "items":
                if misspelt(element, rule.tags):
                    self.scope.all_read = False
                self.expander.add_items(rule, elements, self.reading, self.scope)
            elif rule.field != "parameters":
                read = [read_word(one, rule.words[str(one.tag)], self.reading) for one in elements]
                words = [one for one in read if one is not None]
                if rule.many:
                    self.words[rule.field] = tuple(words)
                elif words:
                    self.words[rule.field] = words[0]
                self._report_twins(rule.field, words)
            if rule.field == "ego":
                ego = self.words.get("ego")
                self.scope.declare(ego.id if ego else "ego")
                if isinstance(ego, Ego):
                    self.scope.places[("entity", ego.id)] = ego.place_of("id")
                    whens = tuple(self.scope.name_event(when, self.sink) for when in ego.whens)
                    self.words["ego"] = ego.model_copy(update={"whens": whens}).written_at(ego.origin)

    def _report_twins(self, field: str, words: Sequence[Any]) -> None:
        """Report variables, controllers of signals, spawn points and causes whose name another one has."""
        if field not in NAMED:
            return
        kind, inside, attribute = NAMED[field]
        self._report_equal(
            [i for word in words for i in (getattr(word, inside) if inside else (word,))], kind, attribute
        )

    def _report_equal(self, words: Sequence[Any], kind: str, attribute: str) -> None:
        first: dict[str, Word] = {}
        for one in words:
            name = getattr(one, attribute)
            there = first.setdefault(name, one)
            if there is not one:
                related = names.first_at(there.place_of(attribute))
                message = f"there is already a {kind} '{name}'"
                self.sink.add(names.DUPLICATE_NAME, message, one.place_of(attribute), related=related)

    def _contents(self, ego: Ego) -> tuple[list[Static | Dynamic], list[tuple[str, When | EntityWhen]]]:
        """Return the actors, and the events with their entities, with resolved references.

        Events that depend on an unreadable actor are left out: only the actor's fault is reported.
        """
        contents, lost = self.expander.contents, set(self.expander.unread)
        actors = [scope.resolved(_without_whens(actor), self.sink) for actor, scope in contents.actors]
        while any(_names(actor) & lost for actor in actors):
            lost.update(actor.id for actor in actors if _names(actor) & lost)
            actors = [actor for actor in actors if not _names(actor) & lost]
        happenings: list[tuple[str, When | EntityWhen]] = [
            (ego.id, with_weather(when, self.sink)) for when in ego.whens
        ]
        for entity, when, scope in contents.happenings:
            in_full = with_weather(scope.resolved(when, self.sink), self.sink)
            full = (scope.resolve(entity) if entity else ego.id) or entity
            if full in self.scope.ids and not ({full} | _names(in_full)) & lost:
                happenings.append((full, in_full))
        return actors, happenings

    def _lines(self) -> tuple[SecondaryMarkings | LineBeside, ...]:
        """Return the painted lines with resolved references; those beside unreadable actors are left out."""
        found = [scope.resolved(line, self.sink) for line, scope in self.expander.contents.lines]
        return tuple(line for line in found if not _names(line) & self.expander.unread)

    def _weather(self, text: str) -> Weather:
        weather = weather_preset(text)
        if weather is None:
            self.sink.add(
                names.UNKNOWN_WEATHER,
                f"there is no weather '{text}'",
                self.reading.origin(self.part.element, "weather"),
                hint=did_you_mean(text, WEATHER_PRESETS) or _PRESETS,
            )
        written = self.words.get("weather_numbers")
        if isinstance(written, Weather):
            return settled_weather(written, self.sink)
        return (weather or Weather.model_construct()).written_at(self.reading.origin(self.part.element, "weather"))

    def _takeover(self, catalogs: Catalogs) -> Takeover:
        """Return the policy with the driver taken from the catalog."""
        origin = self.reading.origin(self.part.element)
        takeover: Takeover = self.words.get("takeover") or Takeover.model_construct().written_at(origin)
        return takeover.model_copy(update={"driver": catalog_driver(takeover.driver, catalogs, self.sink)})


def with_weather(when: AnyWord, sink: Diagnostics) -> AnyWord:
    """Return an event in which changes of the weather have the numbers of their presets."""
    return replaced(when, lambda word: settled_weather(word, sink) if isinstance(word, Weather) else word)


_PRESETS = f"the presets are {', '.join(WEATHER_PRESETS)}, or their index from 0 to {len(WEATHER_PRESETS) - 1}"


def settled_weather(weather: AnyWeather, sink: Diagnostics) -> AnyWeather:
    """Return a weather with the numbers of its preset; report an unknown preset."""
    complete = complete_weather(weather)
    if complete is None:
        sink.add(
            names.UNKNOWN_WEATHER,
            f"there is no weather '{weather.preset}'",
            weather.place_of("preset"),
            hint=did_you_mean(weather.preset, WEATHER_PRESETS) or _PRESETS,
        )
    return complete or weather


def catalog_driver(driver: Driver | DriverModel, catalogs: Catalogs, sink: Diagnostics) -> Driver | DriverModel:
    """Return the catalog's driver with the scenario's changes and the catalog's effects; report an unknown one.

    A takeover time and effects of the scenario override those of the catalog's driver, and these override the catalog's
    effects.
    """
    if isinstance(driver, DriverModel):
        return driver.model_copy(update={"effects": _effects(catalogs.effects.values(), driver.effects)})
    found = catalogs.drivers.get(driver.preset)
    if found is None and catalogs.complete:
        renamed = [one.name for one in catalogs.drivers.values() if one.formerly == driver.preset]
        sink.add(
            names.UNKNOWN_DRIVER,
            f"there is no driver '{driver.preset}'",
            driver.place_of("preset"),
            hint=f"it is called '{renamed[0]}' now" if renamed else did_you_mean(driver.preset, catalogs.drivers),
        )
    if found is None:
        return driver
    fixed = found.takeover_time if driver.takeover_time is None else driver.takeover_time
    changes = {
        "takeover_time": fixed,
        "by_person": driver.by_person,
        "task": driver.task,
        "eyes_closed": driver.eyes_closed,
        "traffic_density": driver.traffic_density,
        "effects": _effects(catalogs.effects.values(), found.effects, driver.effects),
        "driving": driver.driving or found.driving,
    }
    return found.model_copy(update=changes).written_at(driver.origin)


def _effects(*groups: Iterable[Effect]) -> tuple[Effect, ...]:
    """Return one effect of each kind: the last one."""
    return tuple({one.of: one for group in groups for one in group}.values())


def catalog_vehicles(
    entities: Iterable[Ego | Static | Dynamic], catalogs: Catalogs, sink: Diagnostics
) -> tuple[Vehicle, ...]:
    """Return the catalog's vehicles of the entities, each once.

    An unknown one is reported if the catalogs could be read completely, and is replaced by their first vehicle, so that
    the later stages can continue.
    """
    found: dict[str, Vehicle] = {}
    for entity in entities:
        vehicle = catalogs.vehicles.get(entity.model)
        if vehicle is None and catalogs.complete:
            sink.add(
                names.UNKNOWN_VEHICLE,
                f"there is no vehicle '{entity.model}'",
                entity.place_of("model"),
                hint=_vehicle_hint(entity.model, catalogs.vehicles),
            )
        vehicle = vehicle or next(iter(catalogs.vehicles.values()), None)
        if vehicle is not None:
            found.setdefault(entity.model, vehicle.model_copy(update={"name": entity.model}))
    return tuple(found.values())


VEHICLE_CATEGORIES = ("car", "van", "truck", "bus", "motorbike", "bicycle")
"""Categories of the models that drive in traffic."""

PEDESTRIAN_CATEGORIES = ("pedestrian",)
"""Categories of the models that walk in traffic."""


def traffic_models(traffic: Traffic, catalogs: Catalogs, sink: Diagnostics) -> tuple[Traffic, list[Vehicle]]:
    """Return the traffic with the catalog's models as its types, and these models; report unknown types."""
    found: dict[str, Vehicle] = {}
    fields: dict[str, tuple[str, ...]] = {}
    for name, categories in (("types", VEHICLE_CATEGORIES), ("pedestrian_types", PEDESTRIAN_CATEGORIES)):
        able = [one for one in catalogs.vehicles.values() if one.category in categories]
        models: dict[str, Vehicle] = {}
        for wanted in getattr(traffic, name):
            some = [one for one in able if wanted in (one.name, one.category)]
            if not some and catalogs.complete:
                known = {*categories, *(one.name for one in able)}
                what = "vehicle" if name == "types" else "pedestrian"
                message = f"there is no {what} or category of {what}s '{wanted}'"
                sink.add(names.UNKNOWN_VEHICLE, message, traffic.place_of(name), hint=did_you_mean(wanted, known))
            models.update((one.name, one) for one in some)
        fields[name] = tuple(models)
        found.update(models)
    return traffic.model_copy(update=fields).written_at(traffic.origin), list(found.values())


def kept_vehicles(words: Iterable[Word], catalogs: Catalogs, sink: Diagnostics) -> list[Vehicle]:
    """Return the catalog's vehicles that actions on traffic below the words may use; report missing kinds."""
    found: dict[str, Vehicle] = {}
    for action in (one for word in words for one in walk(word) if isinstance(one, KeepsVehicles)):
        for kind in action.kinds or (TrafficKind.model_construct(category="car").written_at(action.origin),):
            some = [one for one in catalogs.vehicles.values() if one.category == kind.category]
            if not some and catalogs.complete:
                message = f"the catalogs have no vehicle of the category '{kind.category}'"
                sink.add(names.UNKNOWN_VEHICLE, message, kind.place_of("category"))
            found.update((one.name, one) for one in some)
    return list(found.values())


def _without_whens(actor: Static | Dynamic) -> Static | Dynamic:
    """Return the actor without its events, which are part of the storyboard."""
    return actor.model_copy(update={"whens": ()}) if isinstance(actor, Dynamic) else actor


def _names(word: Word) -> set[str]:
    """Return the ids of the entities that a word, or anything below it, names."""
    return {name for name, _ in entities_named(word)}


def _vehicle_hint(model: str, vehicles: Mapping[str, Vehicle]) -> str:
    """Return a hint for an unknown model, which may be the name of a category."""
    of_category = [name for name, vehicle in vehicles.items() if vehicle.category == model]
    if not of_category:
        return did_you_mean(model, vehicles)
    named = ", ".join(of_category[:MOST_SUGGESTED])
    return f"vehicles of the category '{model}': {named}{', ...' if len(of_category) > MOST_SUGGESTED else ''}"
