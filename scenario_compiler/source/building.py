"""Scenarios that a program builds from words, completed like scenarios from a file."""

from __future__ import annotations

from collections.abc import Iterable

from scenario_compiler.diagnostics import Diagnostics, did_you_mean
from scenario_compiler.markup import names
from scenario_compiler.markup.codes import OUT_OF_LIMITS, WRONG_VALUE
from scenario_compiler.markup.empty_ranges import report_empty_ranges
from scenario_compiler.resources import library_folder
from scenario_compiler.source.catalogs import Catalogs, load_catalogs
from scenario_compiler.source.events import storyboard_of
from scenario_compiler.source.expansion import (
    catalog_driver,
    catalog_vehicles,
    kept_vehicles,
    settled_weather,
    traffic_models,
    with_weather,
)
from scenario_compiler.source.parameters import Declared, bind_arguments, parameters_by_name
from scenario_compiler.source.variation import check_variation
from scenario_compiler.vocabulary.entities import Dynamic, Ego, Static
from scenario_compiler.vocabulary.grammar import empty_texts, limits_broken
from scenario_compiler.vocabulary.scenario import Scenario, parameter_values
from scenario_compiler.vocabulary.storyboard import Storyboard, When
from scenario_compiler.vocabulary.traversal import entities_named, parameters_in, walk


def completed(scenario: Scenario, sink: Diagnostics) -> Scenario:
    """Return a scenario with everything that a file leaves to the library, and with its `whens` as a storyboard.

    Vehicles that the scenario does not define, and the driver, come from the library's catalogs. Unknown names of
    entities, vehicles, drivers, presets and parameters are reported, and so are empty texts, numbers beyond their
    limits, and faults of the parameters and of their variation.
    """
    catalogs = load_catalogs(library_folder() / "catalogs", sink)
    catalogs = catalogs.extended(Catalogs({one.name: one for one in scenario.vehicles}))
    entities = [*([] if scenario.ego is None else [scenario.ego]), *scenario.actors]
    _check_names(scenario, [one.id for one in entities], sink)
    _check_values(scenario, sink)
    declared = Declared(parameters_by_name(scenario.parameters, sink))
    bind_arguments(declared, {}, sink)
    if scenario.vary is not None:
        check_variation(scenario.vary, declared, sink)
    traffic = [traffic_models(one, catalogs, sink) for one in scenario.traffic]
    vehicles = {one.name: one for one in catalog_vehicles(entities, catalogs, sink)}
    vehicles.update((one.name, one) for _, models in traffic for one in models)
    happening = [scenario.storyboard, *(when for one in entities if not isinstance(one, Static) for when in one.whens)]
    vehicles.update((one.name, one) for one in kept_vehicles(happening, catalogs, sink))
    report_empty_ranges([*happening, *scenario.traffic], sink)
    takeover = scenario.takeover
    takeover = takeover.model_copy(update={"driver": catalog_driver(takeover.driver, catalogs, sink)})
    changes = {
        "weather": settled_weather(scenario.weather, sink),
        "ego": None if scenario.ego is None else scenario.ego.model_copy(update={"whens": ()}),
        "actors": tuple(
            one.model_copy(update={"whens": ()}) if isinstance(one, Dynamic) else one for one in scenario.actors
        ),
        "traffic": tuple(one for one, _ in traffic),
        "vehicles": tuple(vehicles.values()),
        "storyboard": _with_whens(scenario.storyboard, entities, sink),
        "takeover": takeover,
    }
    return scenario.model_copy(update=changes)


def _with_whens(written: Storyboard, entities: Iterable[Ego | Static | Dynamic], sink: Diagnostics) -> Storyboard:
    """Return a storyboard with an additional story for the `whens` of the entities."""
    listed = list(entities)
    happenings: list[tuple[str, When]] = [
        (one.id, with_weather(when, sink)) for one in listed if not isinstance(one, Static) for when in one.whens
    ]
    made = storyboard_of([one.id for one in listed], happenings)
    written = with_weather(written, sink)
    return written.model_copy(update={"stories": (*written.stories, *made.stories)})


def _check_names(scenario: Scenario, ids: list[str], sink: Diagnostics) -> None:
    for name in sorted({one for one in ids if ids.count(one) > 1}):
        sink.add(names.DUPLICATE_NAME, f"there are several entities '{name}'", scenario.origin)
    for name, word in entities_named(scenario):
        if name not in ids:
            where = word.tag() or type(word).__name__
            message = f"<{where}> names the entity '{name}', which the scenario does not have"
            sink.add(names.UNKNOWN_ENTITY, message, scenario.origin, hint=did_you_mean(name, ids))
    declared = {one.name for one in scenario.parameters}
    for name in sorted(parameters_in(scenario) - declared):
        message = f"there is no parameter '{name}'"
        sink.add(names.UNKNOWN_PARAMETER, message, scenario.origin, hint=did_you_mean(name, declared))


def _check_values(scenario: Scenario, sink: Diagnostics) -> None:
    """Report empty texts, and numbers beyond the language's limits, in the units of the words."""
    try:
        values = parameter_values(scenario.parameters)
    except ValueError:  # reported where the parameters are used
        values = {}
    for word in walk(scenario):
        for field in empty_texts(word):
            sink.add(WRONG_VALUE, f"{type(word).__name__}: {field} is empty", scenario.origin)
        for broken in limits_broken(word, values):
            sink.add(OUT_OF_LIMITS, f"{type(word).__name__}: {broken}", scenario.origin)
