"""Expands an OpenSCENARIO file to a `Scenario`: parameters bound, catalogs read, names resolved."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from pathlib import Path

from scenario_compiler.diagnostics import Diagnostic, Diagnostics, Severity
from scenario_compiler.document import Document
from scenario_compiler.files import is_file
from scenario_compiler.markup.codes import WRONG_VALUE
from scenario_compiler.markup.empty_ranges import report_empty_ranges
from scenario_compiler.markup.values import COMMAND_LINE
from scenario_compiler.openscenario.catalogs import read_catalog_locations
from scenario_compiler.openscenario.codes import NO_SCENARIO_FILE, NOT_READ
from scenario_compiler.openscenario.contents import OpenScenario, Variation, parameter_types
from scenario_compiler.openscenario.distributions import check_variation, read_variation, varied_values
from scenario_compiler.openscenario.entities import read_entities
from scenario_compiler.openscenario.files import VERSIONS, beside, read_forgiving, read_version
from scenario_compiler.openscenario.node import FileContext, Node
from scenario_compiler.openscenario.parameters import (
    Given,
    check_constraints,
    declared_name,
    declared_parameters,
    given_parameters,
    parameter_word,
    report_unknown,
)
from scenario_compiler.openscenario.restoring import restored
from scenario_compiler.openscenario.road_network import read_map, read_signal_controllers
from scenario_compiler.openscenario.scope import Bound, Scope, literal_number
from scenario_compiler.openscenario.storyboard import read_storyboard
from scenario_compiler.openscenario.structure import check_structure, is_of_old_format, report_old_format
from scenario_compiler.openscenario.traffic import report_unknown_traffic, with_traffic_vehicles
from scenario_compiler.openscenario.unread import report_unread
from scenario_compiler.openscenario.variables import read_variables, used_variables
from scenario_compiler.vocabulary.scenario import Parameter, Scenario
from scenario_compiler.vocabulary.storyboard import Storyboard
from scenario_compiler.vocabulary.structural import structural_parameters
from scenario_compiler.vocabulary.traversal import parameters_in
from scenario_compiler.vocabulary.weather import USUAL_WEATHER, Weather, weather_preset

LONGEST = 600.0
"""Duration of a run that only a stop trigger ends, s, if the trigger never fires."""


def read_openscenario(document: Document, sink: Diagnostics) -> OpenScenario | None:
    """Return the contents of an <OpenSCENARIO> file; report contents of an unknown kind and return None."""
    if is_of_old_format(document):
        report_old_format(document, sink)
        return None
    root = _root(document, sink)
    if root.child("Storyboard") is not None or root.child("Entities") is not None:
        return OpenScenario(document, {Path(document.path).stem: document.root})
    if root.child("Catalog") is not None:
        return OpenScenario(document, {})
    distribution = root.child("ParameterValueDistribution")
    if distribution is not None:
        sink.take(_structure_warnings(document))
        return _varied(distribution, Path(document.path).stem, sink)
    root.required("Storyboard", "Catalog", "ParameterValueDistribution")
    return None


def _varied(node: Node, name: str, sink: Diagnostics) -> OpenScenario | None:
    """Return the scenario whose parameters a <ParameterValueDistribution> varies; None if it does not exist."""
    variation = read_variation(node)
    file = node.required("ScenarioFile")
    written = "" if file is None else file.text("filepath")
    path = next((one for one in beside(node.reading.folder, written) if is_file(one)), None)
    document = None if path is None else read_forgiving(path, sink)
    if document is None or document.root.find("{*}Storyboard") is None:
        if file is not None:
            file.report(NO_SCENARIO_FILE, f"there is no scenario '{written}'", "filepath")
        return None
    check_variation(variation, parameter_types(document), sink)
    return OpenScenario(document, {name: document.root}, variation)


def _chosen(variation: Variation, arguments: Mapping[str, str], sink: Diagnostics) -> dict[str, str]:
    """Return the values of parameters that a variation gives: those of the chosen sets, and the first values."""
    values = dict(variation.first)
    for counter, sets in variation.sets.items():
        number = literal_number(arguments.get(counter, "0"))
        if number is None or number != int(number) or not 0 <= number < len(sets):
            message = f"{counter} is a whole number from 0 to {len(sets) - 1}"
            sink.add(WRONG_VALUE, message, COMMAND_LINE)
            number = 0.0
        values.update(sets[int(number)])
    return values


def expand_openscenario(source: OpenScenario, name: str, arguments: Mapping[str, str], sink: Diagnostics) -> Scenario:
    """Return the scenario.

    Numeric parameters remain open where numbers use them. If another value turns out to depend on one while reading,
    the scenario is read again with this parameter's value inserted everywhere.
    """
    variation = source.variation
    chosen = {} if variation is None else _chosen(variation, arguments, sink)
    counters = () if variation is None else variation.sets
    places = {} if variation is None else variation.places
    given = given_parameters(chosen, places) | given_parameters(
        {one: text for one, text in arguments.items() if one not in counters}
    )
    settled: set[str] = set()
    while True:
        attempt = Diagnostics()
        root = _root(source.document, attempt)
        scenario = _scenario(root, name, given, settled, variation)
        root.scope.structural.update(structural_parameters(scenario))
        if root.scope.structural <= settled:
            sink.take(_with_structure(source.document, attempt))
            return scenario
        settled |= root.scope.structural


def _with_structure(document: Document, found: Diagnostics) -> list[Diagnostic]:
    """Return the findings, with those on the structure of the file's version as warnings, once for each place."""
    wrong = {_where(one) for one in found if one.severity is Severity.ERROR}
    told = [one for one in _structure_warnings(document) if _where(one) not in wrong]
    places = {_where(one) for one in told}
    return told + [one for one in found if one.code is not NOT_READ or _where(one) not in places]


def _structure_warnings(document: Document) -> list[Diagnostic]:
    """Return the findings on the structure of the file's version, as warnings."""
    structure = Diagnostics()
    check_structure(document, structure, forgiving=True)
    return [replace(one, severity=Severity.WARNING) for one in structure]


def _where(one: Diagnostic) -> tuple[str, int, int]:
    return one.place.file, one.place.line, one.place.column


def _root(document: Document, sink: Diagnostics) -> Node:
    """Return the root element, to be read in the version that its header names."""
    reading = FileContext(document, sink, VERSIONS[-1])
    root = Node(document.root, reading, Scope())
    header = root.child("FileHeader")
    if header is None:
        return root
    version = read_version(header.text("revMajor", ""), header.text("revMinor", ""), header.place("revMinor"), sink)
    return Node(document.root, replace(reading, version=version), root.scope)


def _check_varied(root: Node, declared: Mapping[str, Bound], given: Given, variation: Variation) -> None:
    """Report values of a variation that meet no constraint group, beside the given ones, which are checked already."""
    declarations = {
        declared_name(one): one
        for group in root.children("ParameterDeclarations")
        for one in group.children("ParameterDeclaration")
    }
    for name, text, place in varied_values(variation):
        known = given.get(name)
        if name in declarations and (known is None or (known.text != text and known.place != COMMAND_LINE)):
            check_constraints(declarations[name], name, Bound(declared[name].type, text), place)


def _scenario(root: Node, name: str, given: Given, settled: Collection[str], variation: Variation | None) -> Scenario:
    declared = declared_parameters(root, given, settled)
    report_unknown(given, declared, root)
    root = root.inner(declared)
    root.reading.known.parameters = declared
    if variation is not None:
        _check_varied(root, declared, given, variation)
    root.reading.known.catalogs = read_catalog_locations(root)
    road = read_map(root)
    controllers = read_signal_controllers(root)
    variables = read_variables(root)
    entities = read_entities(root)
    written = root.required("Storyboard")
    storyboard = Storyboard.model_construct() if written is None else read_storyboard(written, entities.first)
    report_empty_ranges([storyboard], root.reading.sink)
    variables_used = used_variables(storyboard, variables, root)
    for one in (root, *root.reading.known.entries.values()):
        report_unread(one)
    scenario = Scenario.model_construct(
        name=name,
        map=road,
        duration=LONGEST if storyboard.stop is not None else None,
        weather=weather_preset(USUAL_WEATHER) or Weather.model_construct(),
        actors=tuple(entities.actors),
        vehicles=tuple(entities.vehicles.values()),
        variables=variables_used,
        signal_controllers=controllers,
        vary=None if variation is None else variation.vary,
        storyboard=storyboard,
    ).written_at(root.origin)
    scenario = with_traffic_vehicles(restored(scenario, root), root)
    report_unknown_traffic(scenario, root.reading.sink)
    return scenario.model_copy(update={"parameters": _open_parameters(root, declared, scenario)})


def _open_parameters(root: Node, declared: Mapping[str, Bound], scenario: Scenario) -> tuple[Parameter, ...]:
    """Return the parameters that numbers of the scenario use, as words."""
    in_use = parameters_in(scenario)
    return tuple(
        parameter_word(declaration, declared[name])
        for group in root.children("ParameterDeclarations")
        for declaration in group.children("ParameterDeclaration")
        if (name := declared_name(declaration)) in in_use
    )
