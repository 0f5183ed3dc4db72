"""Actions on traffic: their vehicles, from the file's catalogs or of typical size, and their names."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from scenario_compiler.diagnostics import Diagnostics, Severity, did_you_mean
from scenario_compiler.markup.names import UNKNOWN_TRAFFIC
from scenario_compiler.openscenario.node import Node
from scenario_compiler.openscenario.parameters import with_parameters
from scenario_compiler.openscenario.vehicles import read_vehicle, usual_vehicle
from scenario_compiler.vocabulary.actions import KeepsVehicles, StopTrafficAction, TrafficKind, TrafficSinkAction
from scenario_compiler.vocabulary.entities import Vehicle
from scenario_compiler.vocabulary.scenario import Scenario
from scenario_compiler.vocabulary.traversal import walk


def with_traffic_vehicles(scenario: Scenario, root: Node) -> Scenario:
    """Return a scenario that has vehicles of every category that its actions on traffic use."""
    actions = [one for one in walk(scenario.storyboard) if isinstance(one, KeepsVehicles)]
    wanted = dict.fromkeys(
        kind.category for one in actions for kind in one.kinds or (TrafficKind(category="car"),) if kind.weight > 0.0
    )
    if not wanted:
        return scenario
    vehicles = {one.name: one for one in scenario.vehicles}
    for one in _catalog_vehicles(root):
        if one.category in wanted:
            vehicles.setdefault(one.name, one)
    for category in wanted:
        if not any(one.category == category and one.coupler is None for one in vehicles.values()):
            one = usual_vehicle(f"usual {category}", category)
            vehicles[one.name] = one
    return scenario.model_copy(update={"vehicles": tuple(vehicles.values())})


def report_unknown_traffic(scenario: Scenario, sink: Diagnostics) -> None:
    """Warn of actions that end traffic by a `trafficName` that no other traffic has."""
    words = list(walk(scenario.storyboard))
    known = {one.traffic for one in words if isinstance(one, KeepsVehicles | TrafficSinkAction)}
    known.update(one.id for one in scenario.traffic)
    for one in words:
        if isinstance(one, StopTrafficAction) and one.traffic and one.traffic not in known:
            hint = did_you_mean(one.traffic, known - {""})
            message = f"no action on traffic has the trafficName '{one.traffic}', so this ends nothing"
            sink.add(UNKNOWN_TRAFFIC, message, one.origin, severity=Severity.WARNING, hint=hint)


def _catalog_vehicles(root: Node) -> Iterable[Vehicle]:
    """Yield the readable vehicles of the file's catalogs; others are not reported, because nothing refers to them."""
    catalogs = root.reading.known.catalogs
    for catalog in [] if catalogs is None else catalogs.all(Diagnostics()):
        for element in catalog.entries.values():
            sink = Diagnostics()
            reading = replace(root.reading.of(catalog.document, catalog.version, root.origin), sink=sink, used={})
            node = Node(element, reading, root.scope)
            if node.tag == "Vehicle" and node.text("vehicleCategory", "car") not in ("trailer", "semitrailer"):
                vehicle = read_vehicle(with_parameters(node))
                if not sink.has_errors:
                    yield vehicle
