"""The names that an attribute can have at a position: ids, templates, models, maps, roads, weathers and so on.

Completion offers these and hover explains them, so that both give the same descriptions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from scenario_compiler.controllers.named import CONTROLLERS
from scenario_compiler.diagnostics import Diagnostics, FilePlace, Severity, all_codes
from scenario_compiler.editor.analysis import LOOPS, Analysis
from scenario_compiler.editor.draft import Tag
from scenario_compiler.expressions import format_value
from scenario_compiler.files import files_in
from scenario_compiler.perception.detectors import DETECTORS
from scenario_compiler.plan.maps import open_map
from scenario_compiler.resources import MapNotFoundError, find_map, known_maps
from scenario_compiler.roads import Network
from scenario_compiler.roads.spawn_points import read_spawn_points
from scenario_compiler.source.conflict import Part, ScenarioElement
from scenario_compiler.source.parameters import parameter_kind
from scenario_compiler.source.templates import template_parameters
from scenario_compiler.vocabulary.driver import DriverModel
from scenario_compiler.vocabulary.entities import Vehicle
from scenario_compiler.vocabulary.grammar import grammar_of
from scenario_compiler.vocabulary.scenario import Parameter
from scenario_compiler.vocabulary.taxonomies import TAXONOMIES
from scenario_compiler.vocabulary.weather import WEATHER_PRESETS, Weather, weather_numbers, weather_preset


@dataclass(frozen=True, slots=True)
class Known:
    """Something with a name: the name, a description in a few words, and more in Markdown."""

    name: str
    detail: str = ""
    text: str = ""


@dataclass(frozen=True)
class Spot:
    """A place at which something is named: a text, the element, and the folders in which maps are looked for first."""

    analysis: Analysis
    tag: Tag
    maps: Sequence[Path] = ()
    quiet: Diagnostics = field(default_factory=Diagnostics)

    @property
    def map_name(self) -> str:
        """The map of the surrounding scenario; empty in a template."""
        part = self.analysis.part_of(self.tag)
        if part is None or part.name != ScenarioElement.tag():
            return ""
        return self.analysis.draft.text_of(part, "map")

    def network(self) -> Network | None:
        """Return the map of the surrounding scenario; None if it names none that exists."""
        if not self.map_name or "$" in self.map_name:
            return None
        return open_map(self.map_name, Path(self.analysis.path).parent, FilePlace(""), self.quiet, self.maps)


def known(kind: str, spot: Spot) -> list[Known]:
    """Return the names of a kind that can be used at a place, each once, in a useful order."""
    found = KNOWN[kind](spot) if kind in KNOWN else ()
    return list({one.name: one for one in reversed(list(found))}.values())[::-1]


def _entities(spot: Spot) -> Iterator[Known]:
    scope, part = spot.analysis.scope_at(spot.tag), spot.analysis.part_of(spot.tag)
    names = None if part is None else spot.analysis.names_of(part)
    for name, full in () if scope is None else scope.ids.items():
        found = None if names is None else names.declared.get(("entity", full))
        yield Known(name, "ego vehicle" if found is None else getattr(found[0], "model", ""))
    yield from _written(spot, "entity")
    if part is not None and part.name != ScenarioElement.tag():
        yield Known("ego", "ego vehicle")


def _events(spot: Spot) -> Iterator[Known]:
    scope = spot.analysis.scope_at(spot.tag)
    while scope is not None:
        yield from (Known(name, "event") for name in scope.events)
        scope = scope.parent
    yield from _written(spot, "event")


def _written(spot: Spot, kind: str) -> Iterator[Known]:
    """Yield names of a kind that elements of the scenario or template declare, except for those in other loops."""
    part = spot.analysis.part_of(spot.tag)
    loops = {one.start for one in spot.tag.ancestors() if one.name in LOOPS}
    for name, _, tag in () if part is None else spot.analysis.declared_in(part, kind):
        if name and "$" not in name and loops.issuperset(one.start for one in tag.ancestors() if one.name in LOOPS):
            yield Known(name, f"<{tag.name}>")


def _templates(spot: Spot) -> Iterator[Known]:
    for name, part in spot.analysis.templates.items():
        if name:
            yield Known(name, part.element.get("summary", ""), template_text(part))


def template_text(part: Part) -> str:
    """Return a template's description and parameters as Markdown."""
    element = part.element
    lines = [f"**{part.name}**: {element.get('summary', '')}", ""]
    lines += [f"- {parameter_text(one)}" for one in template_parameters(part, Diagnostics()).known.values()]
    if element.get("source"):
        lines += ["", str(element.get("source"))]
    return "\n".join(lines)


def parameter_text(parameter: Parameter) -> str:
    """Return a parameter's description, kind, unit, limits and default as a line of Markdown."""
    default = "must be given" if parameter.default is None else f"default `{parameter.default}`"
    return f"`{parameter.name}` ({parameter_kind(parameter)}; {default}) {parameter.summary}".strip()


def _parameters(spot: Spot) -> Iterator[Known]:
    """Yield the parameters that an expression can use, those of loops first."""
    part = spot.analysis.part_of(spot.tag)
    declared = {} if part is None else parameters_of(spot.analysis, part)
    for name in spot.analysis.parameters_at(spot.tag):
        parameter = declared.get(name)
        text = f"`{name}` is set by the loop around" if parameter is None else parameter_text(parameter)
        if name:
            yield Known(name, "set by the loop" if parameter is None else parameter_kind(parameter), text)


def parameters_of(analysis: Analysis, part: Tag) -> Mapping[str, Parameter]:
    """Return the parameters that a scenario or template declares, as far as they can be read."""
    element = analysis.elements.get(part.start)
    if element is None or analysis.document is None:
        return {}
    return template_parameters(Part(analysis.document, element), Diagnostics()).known


def _vehicles(spot: Spot) -> Iterator[Known]:
    for name, vehicle in spot.analysis.catalogs.vehicles.items():
        yield Known(name, vehicle.category, _vehicle_text(vehicle))


def _vehicle_text(vehicle: Vehicle) -> str:
    size = " × ".join(f"{format_value(one)}" for one in (vehicle.length, vehicle.width, vehicle.height))
    lines = [f"**{vehicle.name}** ({vehicle.category}) {vehicle.summary}", "", f"{size} m (length × width × height)"]
    return "\n".join([*lines, "", vehicle.source] if vehicle.source else lines)


def _drivers(spot: Spot) -> Iterator[Known]:
    for name, driver in spot.analysis.catalogs.drivers.items():
        yield Known(name, driver.summary, _driver_text(driver))


def _driver_text(driver: DriverModel) -> str:
    return "\n\n".join(part for part in (f"**{driver.name}**: {driver.summary}", driver.source) if part)


def _weathers(spot: Spot) -> Iterator[Known]:
    del spot
    for index, name in enumerate(WEATHER_PRESETS):
        preset = weather_preset(name)
        numbers = () if preset is None else weather_numbers(preset)
        named = zip(grammar_of(Weather).attributes.values(), ("", *numbers), strict=False)
        lines = [f"- {rule.name}: {format_value(number)}" for rule, number in named if isinstance(number, float)]
        yield Known(name, f"preset {index}", "\n".join([f"**{name}**, CARLA's preset {index}", "", *lines]))


def _maps(spot: Spot) -> Iterator[Known]:
    folder = Path(spot.analysis.path).parent
    beside = [path.name for path in files_in(folder, ".xodr")] if folder.is_dir() else []
    for name in [*beside, *known_maps(spot.maps)]:
        try:
            yield Known(name, str(find_map(name, beside=folder, folders=spot.maps)))
        except MapNotFoundError:
            continue


def _roads(spot: Spot) -> Iterator[Known]:
    network = spot.network()
    for road in () if network is None else network.road_ids:
        found = None if network is None else network.road(road)
        yield Known(road, "" if found is None else f"{found.length:.1f} m long", "")


def _signals(spot: Spot) -> Iterator[Known]:
    network = spot.network()
    for signal in () if network is None else network.model().signals:
        yield Known(signal.id, signal.name or signal.type)


def _spawn_points(spot: Spot) -> Iterator[Known]:
    yield from _written(spot, "spawn_point")
    network = spot.network()
    for name, point in {} if network is None else read_spawn_points(network.path, spot.quiet).items():
        where = f"road {point.road}, lane {point.lane}, s = {format_value(point.s)} m"
        yield Known(name, where, f"**{name}** ({where}) {point.summary}")


def _schemes(spot: Spot) -> Iterator[Known]:
    del spot
    for name, taxonomy in TAXONOMIES.items():
        yield Known(name, taxonomy.title, f"**{taxonomy.title}**\n\n{taxonomy.source}")


def _situations(spot: Spot) -> Iterator[Known]:
    taxonomy = TAXONOMIES.get(spot.analysis.draft.text_of(spot.tag, "scheme"))
    for name, meaning in {} if taxonomy is None else taxonomy.situations.items():
        yield Known(name, meaning)


def _controllers(spot: Spot) -> Iterator[Known]:
    del spot
    yield from (Known(name, "controller") for name in CONTROLLERS)


def _detectors(spot: Spot) -> Iterator[Known]:
    del spot
    yield from (Known(name, "lane detector") for name in DETECTORS)


def _codes(spot: Spot) -> Iterator[Known]:
    del spot
    for code in sorted(all_codes().values(), key=lambda one: one.id):
        if code.severity is not Severity.ERROR:
            yield Known(code.id, code.name, code.explanation)


KNOWN: Mapping[str, Callable[[Spot], Iterable[Known]]] = {
    "code": _codes,
    "controller": _controllers,
    "detector": _detectors,
    "driver": _drivers,
    "entity": _entities,
    "event": _events,
    "map": _maps,
    "parameter": _parameters,
    "road": _roads,
    "scheme": _schemes,
    "signal": _signals,
    "situation": _situations,
    "signal_controller": lambda spot: _written(spot, "signal_controller"),
    "spawn_point": _spawn_points,
    "template": _templates,
    "traffic": lambda spot: _written(spot, "traffic"),
    "variable": lambda spot: _written(spot, "variable"),
    "vehicle": _vehicles,
    "weather": _weathers,
}
"""For each kind of name, the function that lists the names."""
