"""Entities as <ScenarioObject>s, with properties for parts that the standard cannot express."""

from __future__ import annotations

import math
from collections.abc import Sequence

from lxml import etree

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.document import Document
from scenario_compiler.markup.writing import write_word
from scenario_compiler.openscenario.node import FileContext, Node
from scenario_compiler.openscenario.output import Output
from scenario_compiler.openscenario.own import OWN, flattened
from scenario_compiler.openscenario.scope import Scope
from scenario_compiler.openscenario.spelling import made
from scenario_compiler.openscenario.vehicles import read_vehicle
from scenario_compiler.plan.model import Entity
from scenario_compiler.vocabulary.entities import Vehicle

_THINGS = {"cone": "obstacle", "barrier": "barrier", "sign": "pole", "prop": "obstacle"}
"""MiscObjectCategory of each category of objects."""

_MASS = {"pedestrian": "80", "cone": "5", "barrier": "500", "sign": "50", "prop": "100"}
_WHEEL = 0.6
"""Diameter of a wheel, m, which the standard requires."""


def scenario_object(entity: Entity, own: Sequence[etree._Element], output: Output) -> etree._Element:
    """Return the <ScenarioObject> of an entity; its controller's properties keep the elements `own`."""
    described = described_vehicle(entity.vehicle, output)
    properties = described.find("Properties")
    if entity.kind == "ego" and properties is not None:
        properties.append(made("Property", name="type", value="ego_vehicle"))
    kept = [*own, *_kept_of_vehicle(entity.vehicle, described, output)]
    element = made("ScenarioObject", described, name=entity.id)
    if kept:
        element.append(made("ObjectController", own_controller(kept)))
    return element


def own_controller(own: Sequence[etree._Element]) -> etree._Element:
    """Return the <Controller> whose properties keep these elements."""
    properties = [made("Property", name=name, value=value) for name, value in flattened(made(OWN, *own))]
    return made("Controller", made("Properties", *properties), name=OWN)


def described_vehicle(vehicle: Vehicle, output: Output) -> etree._Element:
    """Return the <Vehicle>, <Pedestrian> or <MiscObject> of a vehicle."""
    if vehicle.category == "pedestrian":
        element = made("Pedestrian", mass=_MASS["pedestrian"], name=vehicle.name, pedestrianCategory="pedestrian")
        element.set("model" if output.version == (1, 0) else "model3d", vehicle.name)
        element.extend([_box(vehicle, output), made("Properties")])
        return element
    if vehicle.category in _THINGS:
        element = made("MiscObject", mass=_MASS[vehicle.category], name=vehicle.name)
        element.set("miscObjectCategory", _THINGS[vehicle.category])
        element.extend([_box(vehicle, output), made("Properties")])
        return element
    element = made("Vehicle", name=vehicle.name, vehicleCategory=vehicle.category)
    element.extend([_box(vehicle, output), _performance(vehicle, output), _axles(vehicle, output), made("Properties")])
    for tag, distance in (("TrailerHitch", vehicle.hitch), ("TrailerCoupler", vehicle.coupler)):
        if distance is not None and output.version == (1, 3):
            element.append(made(tag, dx=output.text(distance, vehicle)))
    return element


def _box(vehicle: Vehicle, output: Output) -> etree._Element:
    center = made("Center", x=output.text(vehicle.center, vehicle), y="0", z=output.text(vehicle.height / 2, vehicle))
    sizes = {name: output.text(getattr(vehicle, name), vehicle) for name in ("width", "length", "height")}
    return made("BoundingBox", center, made("Dimensions", **sizes))


def _performance(vehicle: Vehicle, output: Output) -> etree._Element:
    return made(
        "Performance",
        maxSpeed=output.text(vehicle.max_speed, vehicle),
        maxAcceleration=output.text(vehicle.max_acceleration, vehicle),
        maxDeceleration=output.text(vehicle.max_deceleration, vehicle),
    )


def _axles(vehicle: Vehicle, output: Output) -> etree._Element:
    usual = {
        "wheelDiameter": output.text(_WHEEL, vehicle),
        "trackWidth": output.text(vehicle.width, vehicle),
        "positionZ": output.text(_WHEEL / 2, vehicle),
    }
    steer, base = output.text(math.radians(vehicle.max_steer), vehicle), output.text(vehicle.wheelbase, vehicle)
    return made(
        "Axles",
        made("FrontAxle", maxSteering=steer, positionX=base, **usual),
        made("RearAxle", maxSteering="0", positionX="0", **usual),
    )


def _kept_of_vehicle(vehicle: Vehicle, described: etree._Element, output: Output) -> list[etree._Element]:
    """Return the parts of a vehicle that are lost when its element is read."""
    reading = FileContext(Document("", "", described), Diagnostics(), output.version)
    read = read_vehicle(Node(described, reading, Scope()))
    full, understood = write_word(vehicle), write_word(read)
    usual = {rule: info.default for rule, info in Vehicle.model_fields.items()}
    kept = {name: str(full.get(name)) for name in map(str, full.attrib) if understood.get(name) != full.get(name)}
    for name in understood.attrib:
        if name not in full.attrib:
            kept[str(name)] = str(usual[str(name)])
    return [made("vehicle", **kept)] if kept else []
