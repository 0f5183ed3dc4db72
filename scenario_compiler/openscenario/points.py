"""Converts points, the positions in routes and trajectories, between OpenSCENARIO's elements and words.

Angles are in radians on both sides. An absolute `Orientation` becomes a word's `heading`, a relative one its `turn`;
pitch and roll always come from the road.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from lxml import etree

from scenario_compiler.diagnostics import Code, Severity
from scenario_compiler.markup import codes
from scenario_compiler.openscenario.node import Node
from scenario_compiler.openscenario.output import Output
from scenario_compiler.openscenario.spelling import (
    Fields,
    Form,
    Forms,
    entity,
    integer,
    made,
    number,
    regular,
    text,
)
from scenario_compiler.vocabulary.positions import (
    FreePosition,
    GeoPosition,
    LanePositionWord,
    LanesAwayPosition,
    Point,
    RelativeObjectPosition,
    RelativeRoadPosition,
    RelativeWorldPosition,
    RoadPosition,
)
from scenario_compiler.vocabulary.word import Word

TILT = Code(
    "SC780",
    "tilt-from-road",
    "A position gives pitch or roll. In this world the road determines the pitch and roll of a vehicle, so the "
    "numbers have no effect. ASAM OpenSCENARIO requires this for all positions on roads and lanes (Orientation); it "
    "allows them for positions in the world and relative to an entity only.\n\n"
    '    <Orientation type="relative" h="0" p="0.1"/>\n\n'
    "Leave them out, or change the road's elevation.",
    Severity.WARNING,
)
POSITION_NOT_HERE = Code(
    "SC781",
    "position-not-here",
    "A waypoint of a route is a position on a route or trajectory. A waypoint must be on the map, in the world or "
    "relative to an entity:\n\n"
    '    <Waypoint routeStrategy="shortest"><Position><TrajectoryPosition .../></Position></Waypoint>\n\n'
    "Write a LanePosition, RoadPosition, WorldPosition or one of the relative positions.",
    Severity.WARNING,
)

ON_CURVES = ("RoutePosition", "TrajectoryPosition")
"""Positions that are not points."""


class Orientation:
    """The child `Orientation`: the fields `turn` and `heading`."""

    def read(self, node: Node) -> Fields:
        """Return the fields; a missing element means relative and 0.

        A missing type means absolute before 1.3, as in esmini 3.6, and relative since (Orientation, ASAM OpenSCENARIO).
        """
        inner = node.child("Orientation")
        if inner is None:
            return {}
        usual = "absolute" if node.reading.version < (1, 3) else "relative"
        kind = inner.choice("type", ("absolute", "relative"), usual)
        heading = inner.number("h", 0.0)
        check_tilt(inner)
        return {"heading" if kind == "absolute" else "turn": heading}

    def write(self, word: Any, element: etree._Element, output: Output) -> None:
        """Add the element if the word's heading differs from that of the position."""
        if word.heading is not None:
            element.append(made("Orientation", type="absolute", h=output.text(word.heading, word)))
        elif word.turn != 0.0:
            element.append(made("Orientation", type="relative", h=output.text(word.turn, word)))


def check_tilt(node: Node) -> None:
    """Report pitch and roll that have no effect."""
    for attribute in ("p", "r"):
        angle = node.float(attribute, 0.0)
        if abs(math.remainder(angle, 2.0 * math.pi)) > 1.0e-6:
            node.report(
                TILT, f"{attribute} = {angle:g} rad has no effect: the road determines pitch and roll", attribute
            )


class _Along:
    """How far ahead a RelativeLanePosition lies: along the road (`ds`) or in the lane (`dsLane`, since 1.1).

    From 1.1 on both may be missing: then the position is beside the entity. If both are given, `ds` counts (esmini).
    """

    def read(self, node: Node) -> Fields:
        if node.has("dsLane") and not node.has("ds"):
            return {"along": "lane", "distance": node.number("dsLane")}
        return {"along": "road", "distance": node.number("ds", 0.0)}

    def write(self, word: LanesAwayPosition, element: etree._Element, output: Output) -> None:
        in_lane = word.along == "lane" and output.version > (1, 0)
        element.set("dsLane" if in_lane else "ds", output.text(word.distance, word))
        if word.along == "lane" and not in_lane:
            output.tell_lost(word, "1.0 measures a relative lane position along the road, not in the lane")


class _Geographic:
    """Latitude and longitude, in degrees from 1.2 on, in radians before."""

    def read(self, node: Node) -> Fields | None:
        fields = {}
        for name, limit in (("latitude", 90.0), ("longitude", 180.0)):
            degrees = f"{name}Deg"
            found = node.float(degrees) if node.has(degrees) else math.degrees(node.float(name))
            if abs(found) > limit:
                where = degrees if node.has(degrees) else name
                node.report(codes.OUT_OF_LIMITS, f"the {name} is {found:g} degrees, beyond {limit:g}", where)
                return None
            fields[name] = found
        return fields

    def write(self, word: GeoPosition, element: etree._Element, output: Output) -> None:
        for name in ("latitude", "longitude"):
            degrees = getattr(word, name)
            if output.version >= (1, 2):
                element.set(f"{name}Deg", output.text(degrees, word))
            else:
                element.set(name, output.text(math.radians(degrees), word))


def _read_world(node: Node) -> FreePosition:
    check_tilt(node)
    return FreePosition.model_construct(
        x=node.number("x"),
        y=node.number("y"),
        z=node.optional_number("z"),
        heading=node.optional_number("h"),
    ).written_at(node.origin)


def _write_world(word: FreePosition, output: Output) -> etree._Element:
    element = made("WorldPosition", x=output.text(word.x, word), y=output.text(word.y, word))
    if word.z is not None:
        element.set("z", output.text(word.z, word))
    if word.heading is not None:
        element.set("h", output.text(word.heading, word))
    return element


_FACING = Orientation()
_ENTITY = entity("entity")
_ACROSS = tuple(replace(number(name), default=0.0, always=True) for name in ("dx", "dy"))
_ALONG_ROAD = tuple(replace(number(name), default=0.0, always=True) for name in ("ds", "dt"))

POINTS = Forms(
    (
        Form("WorldPosition", FreePosition, _read_world, _write_world),
        regular(
            "LanePosition",
            LanePositionWord,
            text("road", "roadId"),
            integer("lane", "laneId"),
            number("s"),
            number("offset", default=0.0),
            _FACING,
        ),
        regular("RoadPosition", RoadPosition, text("road", "roadId"), number("s"), number("t"), _FACING),
        regular(
            "RelativeWorldPosition",
            RelativeWorldPosition,
            _ENTITY,
            *_ACROSS,
            number("dz", default=0.0),
            _FACING,
        ),
        regular(
            "RelativeObjectPosition",
            RelativeObjectPosition,
            _ENTITY,
            *_ACROSS,
            number("dz", default=0.0),
            _FACING,
        ),
        regular("RelativeRoadPosition", RelativeRoadPosition, _ENTITY, *_ALONG_ROAD, _FACING),
        regular(
            "RelativeLanePosition",
            LanesAwayPosition,
            _ENTITY,
            integer("lanes", "dLane"),
            _Along(),
            number("offset", default=0.0),
            _FACING,
        ),
        regular("GeoPosition", GeoPosition, _Geographic(), _FACING, since=(1, 1)),
    )
)
"""The points that OpenSCENARIO can express."""

UNSAID = {
    "world": "a plan binds it to a lane; in CARLA's axes it means the middle of the vehicle's box",
    "spawn_point": "a plan binds it to a lane",
    "numbered_spawn_point": "a plan binds it to a lane",
    "random_spawn_point": "OpenSCENARIO has no random positions",
    "random": "OpenSCENARIO has no random positions",
    "ahead_of": "it follows the lane over junctions in the entity's direction of travel",
    "beside": "it is measured from the entity's position in its lane",
}
"""Tags of the positions that OpenSCENARIO cannot express, with the reasons."""


def read_point(node: Node) -> Point | None:
    """Return the point of a <Position> element, or of another element with one; report an unknown element."""
    inner = node.first()
    if inner is None:
        node.report(codes.MISSING_ELEMENT, f"<{node.tag}> contains no position")
        return None
    if inner.tag in ON_CURVES:
        inner.read_whole()
        inner.report(POSITION_NOT_HERE, f"<{inner.tag}> is not allowed in <{_outside(node)}>")
        return None
    if inner.tag not in POINTS.by_tag:
        inner.read_whole()
        inner.report(codes.UNKNOWN_ELEMENT, f"<{inner.tag}> is not a position")
        return None
    point: Point | None = POINTS.by_tag[inner.tag].read(inner)
    return point


def _outside(node: Node) -> str:
    parent = node.element.getparent()
    return node.tag if parent is None or node.tag != "Position" else str(parent.tag)


def write_point(word: Word, output: Output, tag: str = "Position") -> etree._Element:
    """Return the <Position> of a point; one that OpenSCENARIO cannot express is reported and written as the origin."""
    return write_as(POINTS.by_word.get(type(word)), word, output, tag)


def write_as(form: Form[Any] | None, word: Word, output: Output, tag: str) -> etree._Element:
    """Return the <Position> of a position in its form.

    Without a form, or with one of a later version, the reason is reported and the position is the origin.
    """
    if form is not None and output.version >= form.since:
        return made(tag, form.write(word, output))
    why = UNSAID[word.tag()] if form is None else f"{output.dotted()} has no <{form.tag}>"
    output.tell_lost(word, f"the position <{word.tag()}> cannot be written: {why}")
    return made(tag, made("WorldPosition", x="0", y="0", h="0"))
