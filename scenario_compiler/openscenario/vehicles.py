"""<Vehicle>, <Pedestrian> and <MiscObject>: the kind of an entity, its box, its axles and its limits.

The reference point is ASAM's: on the ground, below the rear axle for a vehicle, and relative to its box for any other
entity. Missing limits have esmini's values: 10 m/s2 for acceleration and deceleration, and 100 m/s.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from scenario_compiler.diagnostics import Severity, did_you_mean
from scenario_compiler.markup import codes as form
from scenario_compiler.openscenario.codes import NO_VEHICLE_SIZE
from scenario_compiler.openscenario.node import Node, ObjectType
from scenario_compiler.vocabulary.entities import Category, Vehicle

OBJECTS: dict[str, ObjectType] = {"Vehicle": "vehicle", "Pedestrian": "pedestrian", "MiscObject": "miscellaneous"}
"""Elements that describe an entity, and the ObjectType of each."""

CATEGORIES: dict[str, Category] = {
    "car": "car", "van": "van", "truck": "truck", "trailer": "truck", "semitrailer": "truck", "bus": "bus",
    "motorbike": "motorbike", "bicycle": "bicycle", "train": "bus", "tram": "bus", "standup_scooter": "bicycle",
    "wheelchair": "pedestrian", "work_machine": "truck",
}  # fmt: skip
"""ASAM's VehicleCategory, and the category as which it is drawn."""

THINGS: dict[str, Category] = {
    "barrier": "barrier", "soundBarrier": "barrier", "railing": "barrier", "gantry": "sign", "obstacle": "prop",
    "none": "prop", "other": "prop", "building": "prop", "crosswalk": "prop", "parkingSpace": "prop", "patch": "prop",
    "pole": "prop", "roadMark": "prop", "streetLamp": "prop", "streetlamp": "prop", "trafficIsland": "prop",
    "tree": "prop", "vegetation": "prop", "wind": "prop",
}  # fmt: skip
"""ASAM's MiscObjectCategory, and the category as which it is drawn."""

PEDESTRIANS = ("pedestrian", "wheelchair", "animal")
"""ASAM's PedestrianCategory."""

ACCELERATION, SPEED = 10.0, 100.0
"""Limits of an entity whose file states none, m/s2 and m/s."""

LEAST_SIZE = 0.001
"""Least extent of a box, m; smaller values are increased to this."""

LEAST_WHEELBASE = 0.1
"""Least distance between the axles, m; an entity without axles turns on the spot."""


@dataclass(frozen=True)
class Box:
    """A bounding box: its extents, and how far its centre lies ahead of the reference point, m."""

    length: float
    width: float
    height: float
    center: float


USUAL_BOXES: dict[ObjectType, Box] = {
    "vehicle": Box(5.0, 2.0, 1.5, 1.4),
    "pedestrian": Box(0.6, 0.5, 1.8, 0.0),
    "miscellaneous": Box(1.0, 1.0, 1.0, 0.0),
    "external": Box(5.0, 2.0, 1.5, 1.4),
}
"""Boxes of entities whose file gives none: those of esmini's catalogs, rounded."""

USUAL_TRAFFIC: dict[Category, tuple[Box, float]] = {
    "van": (Box(5.5, 2.0, 2.4, 1.6), 3.4),
    "truck": (Box(8.5, 2.5, 3.5, 2.6), 4.6),
    "bus": (Box(12.0, 2.55, 3.1, 3.0), 6.0),
    "motorbike": (Box(2.2, 0.8, 1.5, 0.7), 1.4),
    "bicycle": (Box(1.8, 0.6, 1.7, 0.5), 1.1),
}
"""Boxes and wheelbases of traffic, m: the size of the library's vehicles of that category, rounded; the lengths of a
rigid truck and of a bus are common ones below the 12 m and 13.5 m that Directive 96/53/EC allows.
"""


def read_vehicle(node: Node) -> Vehicle:
    """Return the vehicle of a <Vehicle>, <Pedestrian> or <MiscObject>."""
    kind = OBJECTS[node.tag]
    box = _box(node, kind)
    base, steer = _axles(node)
    acceleration, deceleration, speed = _performance(node)
    ignore(node)
    return Vehicle.model_construct(
        name=node.text("name", node.tag),
        category=_category(node),
        length=box.length,
        width=box.width,
        height=box.height,
        center=box.center,
        wheelbase=base,
        max_steer=steer,
        max_acceleration=acceleration,
        max_deceleration=deceleration,
        max_speed=speed,
        hitch=_distance(node, "TrailerHitch"),
        coupler=_distance(node, "TrailerCoupler"),
    ).written_at(node.origin)


def usual_car(name: str) -> Vehicle:
    """Return a car of typical size, for an entity that a file does not describe."""
    box = USUAL_BOXES["external"]
    return Vehicle.model_construct(
        name=name,
        length=box.length,
        width=box.width,
        height=box.height,
        center=box.center,
        wheelbase=2.8,
        max_acceleration=ACCELERATION,
        max_deceleration=ACCELERATION,
        max_speed=SPEED,
    )


def usual_vehicle(name: str, category: Category) -> Vehicle:
    """Return a vehicle of a category with a typical box, for traffic whose vehicles a file does not describe."""
    box, base = USUAL_TRAFFIC.get(category, (USUAL_BOXES["vehicle"], 2.8))
    changes = {
        **{"category": category, "length": box.length, "width": box.width, "height": box.height},
        **{"center": box.center, "wheelbase": base},
    }
    return usual_car(name).model_copy(update=changes)


def _category(node: Node) -> Category:
    if node.tag == "Pedestrian":
        node.choice("pedestrianCategory", PEDESTRIANS, "pedestrian")
        return "pedestrian"
    known, attribute = (CATEGORIES, "vehicleCategory") if node.tag == "Vehicle" else (THINGS, "miscObjectCategory")
    text = node.text(attribute, "car" if node.tag == "Vehicle" else "none")
    if text not in known:
        node.report(form.WRONG_VALUE, f"'{text}' is not a {attribute}", attribute, did_you_mean(text, known))
    return known.get(text, "car" if node.tag == "Vehicle" else "prop")


def _box(node: Node, kind: ObjectType) -> Box:
    usual = USUAL_BOXES[kind]
    bounding = node.child("BoundingBox")
    size = None if bounding is None else bounding.child("Dimensions")
    if bounding is None or size is None:
        node.report(NO_VEHICLE_SIZE, f"<{node.tag}> has no bounding box")
        return usual
    center = bounding.child("Center")
    extents = [size.float(name, 0.0) for name in ("length", "width", "height")]
    middle = 0.0 if center is None else center.float("x", 0.0)
    if center is not None:
        center.read_whole()
    if max(extents[:2]) <= 0.0:
        size.report(NO_VEHICLE_SIZE, f"the box of this <{node.tag}> has the size 0")
        return usual
    length, width, height = (max(LEAST_SIZE, extent) for extent in extents)
    return Box(length, width, height, middle)


def _axles(node: Node) -> tuple[float, float]:
    """Return the wheelbase, m, and the greatest steering angle, degrees."""
    axles = node.child("Axles")
    front = None if axles is None else axles.child("FrontAxle")
    rear = None if axles is None else axles.child("RearAxle")
    if axles is not None:
        axles.read_whole()
    if front is None:
        return (LEAST_WHEELBASE if node.tag != "Vehicle" or rear is not None else 2.8), 40.0
    base = front.float("positionX", 2.8) - (0.0 if rear is None else rear.float("positionX", 0.0))
    steer = math.degrees(front.float("maxSteering", 0.7))
    return max(LEAST_WHEELBASE, base), min(90.0, max(1.0, steer))


def _performance(node: Node) -> tuple[float, float, float]:
    """Return the greatest acceleration and deceleration, m/s2, and the greatest speed, m/s."""
    performance = node.child("Performance")
    if performance is None:
        return ACCELERATION, ACCELERATION, SPEED
    for attribute in ("mass", "maxAccelerationRate", "maxDecelerationRate"):
        performance.has(attribute)
    return (
        _limit(performance, "maxAcceleration", ACCELERATION),
        _limit(performance, "maxDeceleration", ACCELERATION),
        _limit(performance, "maxSpeed", SPEED),
    )


def _limit(performance: Node, attribute: str, usual: float) -> float:
    """Return a limit of an entity, or the usual value if the file has no number, which is reported."""
    return max(0.0, performance.float(attribute, usual, severity=Severity.WARNING))


def _distance(node: Node, tag: str) -> float | None:
    found = node.child(tag)
    return None if found is None else found.float("dx", 0.0)


def ignore(node: Node) -> None:
    """Mark the other parts of an entity's description as read: appearance, mass, and what only other programs use."""
    for attribute in ("model", "model3d", "mass", "role"):
        node.has(attribute)
    for properties in node.children("Properties"):
        properties.read_whole()
