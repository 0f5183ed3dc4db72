"""Actions on background traffic: sources, sinks, swarms and their end, and traffic definitions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from lxml import etree

from scenario_compiler.diagnostics import Code, Severity
from scenario_compiler.openscenario.catalogs import given
from scenario_compiler.openscenario.motion import read_position, write_position
from scenario_compiler.openscenario.node import Node
from scenario_compiler.openscenario.output import Output
from scenario_compiler.openscenario.spelling import Form, made
from scenario_compiler.openscenario.vehicles import CATEGORIES
from scenario_compiler.vocabulary.actions import (
    KeepsVehicles,
    SpeedRange,
    StopTrafficAction,
    TrafficKind,
    TrafficSinkAction,
    TrafficSourceAction,
    TrafficSwarmAction,
)
from scenario_compiler.vocabulary.grammar import grammar_of
from scenario_compiler.vocabulary.word import Word

NO_MEANING_IN_TRAFFIC = Code(
    "SC785",
    "part-of-traffic-without-meaning",
    "A part of an action on traffic has no meaning here. All vehicles of background traffic drive by the same "
    "rules, so they have no controllers and no roles. They are cars, vans, trucks, buses, motorbikes and "
    "bicycles. An action cannot create traffic in an area, or of pedestrians.\n\n"
    "    <ControllerDistribution>     the vehicles follow, change lanes and yield by our own rules\n\n"
    "The rest of the action is executed. For traffic on the whole map, the conflict language has <traffic "
    "vehicles='20' pedestrians='5'/>.",
    Severity.WARNING,
)

BY_RULES = "traffic_by_rules"
"""Name of the controller in written files where the standard requires one."""

_AROUND = ("GlobalAction",)
_KINDS = grammar_of(TrafficKind).attributes["category"].choices


def read_kinds(node: Node) -> tuple[TrafficKind, ...]:
    """Return the kinds of vehicles of a traffic action, from its <TrafficDefinition> or <TrafficDistribution>."""
    definition = node.child("TrafficDefinition")
    if definition is not None:
        return _defined_kinds(definition)
    distribution = node.child("TrafficDistribution")
    return () if distribution is None else _distributed_kinds(distribution)


def _defined_kinds(definition: Node) -> tuple[TrafficKind, ...]:
    definition.has("name")
    for roles in definition.children("VehicleRoleDistribution"):
        roles.read_whole()
        roles.report(NO_MEANING_IN_TRAFFIC, "roles have no effect on vehicles of background traffic")
    for controllers in definition.children("ControllerDistribution"):
        controllers.read_whole()
        names = {str(one.get("name")) for one in controllers.element.iter("{*}Controller")}
        if names != {BY_RULES}:
            controllers.report(NO_MEANING_IN_TRAFFIC, "all vehicles of background traffic drive by the same rules")
    kinds = []
    for categories in definition.children("VehicleCategoryDistribution"):
        for entry in categories.children("VehicleCategoryDistributionEntry"):
            kind = _kind(entry, entry.text("category"), entry.float("weight", 1.0))
            kinds += [] if kind is None else [kind]
    return tuple(kinds)


def _distributed_kinds(distribution: Node) -> tuple[TrafficKind, ...]:
    """Return the categories of the vehicles in a <TrafficDistribution>, each by the product of its weights."""
    kinds = []
    for outer in distribution.children("TrafficDistributionEntry"):
        share = outer.float("weight", 1.0)
        for properties in outer.children("Properties"):
            properties.read_whole()
        entries = [one for inner in outer.children("EntityDistribution") for one in inner.elements()]
        for entry in entries:
            weight = share * entry.float("weight", 1.0)
            for template in entry.children("ScenarioObjectTemplate"):
                kind = _template_kind(template, weight)
                kinds += [] if kind is None else [kind]
    return tuple(kinds)


def _template_kind(template: Node, weight: float) -> TrafficKind | None:
    vehicle = given(template, "Vehicle", severity=Severity.WARNING)
    template.read_whole()
    if vehicle is None:
        template.report(NO_MEANING_IN_TRAFFIC, "actions on traffic create vehicles only")
        return None
    kind = _kind(vehicle, vehicle.text("vehicleCategory", "car"), weight)
    vehicle.read_whole()
    return kind


def _kind(node: Node, category: str, weight: float) -> TrafficKind | None:
    ours = CATEGORIES.get(category, "")
    if ours not in _KINDS or category in ("trailer", "semitrailer"):
        node.report(NO_MEANING_IN_TRAFFIC, f"background traffic has no vehicles of the category {category}")
        return None
    return TrafficKind.model_validate({"category": ours, "weight": weight}).written_at(node.origin)


def _name(node: Node) -> str:
    parent = node.element.getparent()
    return "" if parent is None else Node(parent, node.reading, node.scope).text("trafficName", "")


def _read_swarm(node: Node) -> TrafficSwarmAction | None:
    middle = node.required("CentralObject", "CentralSwarmObject")
    if middle is None:
        return None
    range_of = node.child("InitialSpeedRange")
    directions = node.child("DirectionOfTravelDistribution")
    return TrafficSwarmAction.model_construct(
        traffic=_name(node),
        entity=middle.entity("entityRef"),
        vehicles=node.integer("numberOfVehicles"),
        inner_radius=node.number("innerRadius"),
        semi_major=node.number("semiMajorAxis"),
        semi_minor=node.number("semiMinorAxis"),
        offset=node.number("offset"),
        speed=node.optional_number("velocity"),
        same=1.0 if directions is None else directions.float("same"),
        opposite=1.0 if directions is None else directions.float("opposite"),
        speeds=None
        if range_of is None
        else SpeedRange.model_construct(low=range_of.float("lowerLimit"), high=range_of.float("upperLimit")).written_at(
            range_of.origin
        ),
        kinds=read_kinds(node),
    ).written_at(node.origin)


def _write_swarm(word: TrafficSwarmAction, output: Output) -> etree._Element:
    numbers = {
        "innerRadius": word.inner_radius,
        "semiMajorAxis": word.semi_major,
        "semiMinorAxis": word.semi_minor,
        "offset": word.offset,
    }
    element = made("TrafficSwarmAction", numberOfVehicles=str(word.vehicles))
    for name, number in numbers.items():
        element.set(name, output.text(number, word))
    if word.speed is not None:
        element.set("velocity", output.text(word.speed, word))
    middle = "CentralSwarmObject" if output.version == (1, 0) else "CentralObject"
    element.append(made(middle, entityRef=word.entity))
    element.extend(_definition(word, output))
    if word.speeds is not None:
        limits = {"lowerLimit": str(word.speeds.low), "upperLimit": str(word.speeds.high)}
        element.extend(_newer(word, made("InitialSpeedRange", **limits), output))
    if (word.same, word.opposite) != (1.0, 1.0):
        weights = {"same": str(word.same), "opposite": str(word.opposite)}
        element.extend(_newer(word, made("DirectionOfTravelDistribution", **weights), output))
    return _around(word, element, output)


def _read_source(node: Node) -> TrafficSourceAction | None:
    position = _position(node)
    if position is None:
        return None
    return TrafficSourceAction.model_construct(
        traffic=_name(node),
        rate=node.float("rate"),
        radius=node.number("radius"),
        speed=node.optional_number("speed" if node.has("speed") else "velocity"),
        kinds=read_kinds(node),
        position=position,
    ).written_at(node.origin)


def _write_source(word: TrafficSourceAction, output: Output) -> etree._Element:
    element = made("TrafficSourceAction", rate=str(word.rate), radius=output.text(word.radius, word))
    if word.speed is not None:
        element.set("speed" if output.version >= (1, 2) else "velocity", output.text(word.speed, word))
    element.append(write_position(word.position, output))
    element.extend(_definition(word, output))
    return _around(word, element, output)


def _read_sink(node: Node) -> TrafficSinkAction | None:
    position = _position(node)
    definition = node.child("TrafficDefinition")
    if definition is not None:
        definition.read_whole()
        definition.report(NO_MEANING_IN_TRAFFIC, "a sink removes vehicles of all kinds")
    if position is None:
        return None
    return TrafficSinkAction.model_construct(
        traffic=_name(node),
        radius=node.number("radius"),
        rate=node.optional_number("rate"),
        position=position,
    ).written_at(node.origin)


def _write_sink(word: TrafficSinkAction, output: Output) -> etree._Element:
    element = made("TrafficSinkAction", write_position(word.position, output), radius=output.text(word.radius, word))
    if word.rate is not None:
        element.set("rate", output.text(word.rate, word))
    return _around(word, element, output)


def _read_stop(node: Node) -> StopTrafficAction:
    return StopTrafficAction.model_construct(traffic=_name(node)).written_at(node.origin)


def _write_stop(word: StopTrafficAction, output: Output) -> etree._Element:
    return _around(word, made("TrafficStopAction"), output)


def _position(node: Node) -> Any:
    holder = node.required("Position")
    return None if holder is None else read_position(holder)


def _definition(word: KeepsVehicles, output: Output) -> list[etree._Element]:
    """Return the <TrafficDefinition> of the kinds of vehicles; versions before 1.3 require one."""
    if not word.kinds and output.version >= (1, 3):
        return []
    if not word.kinds:
        output.tell_lost(word, f"{output.dotted()} requires the kinds of vehicles: cars are written")
    return [_traffic_definition(word.kinds or (TrafficKind(category="car"),))]


def _traffic_definition(kinds: Sequence[TrafficKind]) -> etree._Element:
    entries = [
        made("VehicleCategoryDistributionEntry", category=kind.category, weight=str(kind.weight)) for kind in kinds
    ]
    controller = made("Controller", made("Properties"), name=BY_RULES)
    return made(
        "TrafficDefinition",
        made("VehicleCategoryDistribution", *entries),
        made("ControllerDistribution", made("ControllerDistributionEntry", controller, weight="1")),
        name="traffic",
    )


def _newer(word: Word, element: etree._Element, output: Output) -> list[etree._Element]:
    if output.version >= (1, 2):
        return [element]
    output.tell_lost(word, f"<{element.tag}> is not known before 1.2")
    return []


def _around(word: Any, element: etree._Element, output: Output) -> etree._Element:
    around = made("TrafficAction", element)
    if word.traffic and output.version == (1, 0):
        output.tell_lost(word, "traffic has no names before 1.1")
    elif word.traffic:
        around.set("trafficName", word.traffic)
    return around


TRAFFIC: tuple[Form[Any], ...] = (
    Form("TrafficSwarmAction", TrafficSwarmAction, _read_swarm, _write_swarm, _AROUND),
    Form("TrafficSourceAction", TrafficSourceAction, _read_source, _write_source, _AROUND),
    Form("TrafficSinkAction", TrafficSinkAction, _read_sink, _write_sink, _AROUND),
    Form("TrafficStopAction", StopTrafficAction, _read_stop, _write_stop, _AROUND, (1, 1)),
)
"""Actions on traffic."""
