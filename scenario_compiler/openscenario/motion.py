"""Converts routes, trajectories and the positions on them between OpenSCENARIO's elements and words."""

from __future__ import annotations

from copy import copy
from dataclasses import replace

from lxml import etree

from scenario_compiler.markup import codes
from scenario_compiler.openscenario.catalogs import given
from scenario_compiler.openscenario.codes import NOT_READ
from scenario_compiler.openscenario.node import Node
from scenario_compiler.openscenario.output import Output
from scenario_compiler.openscenario.parameters import with_parameters
from scenario_compiler.openscenario.points import Orientation, read_point, write_as, write_point
from scenario_compiler.openscenario.spelling import (
    Child,
    Children,
    Fields,
    Forms,
    boolean,
    choice,
    entity,
    integer,
    made,
    nested,
    number,
    regular,
    text,
)
from scenario_compiler.vocabulary.positions import (
    Clothoid,
    ClothoidSegment,
    ClothoidSpline,
    ControlPoint,
    InRouteEntity,
    InRouteLane,
    InRouteRoad,
    Nurbs,
    Polyline,
    Position,
    RoutePosition,
    RouteWord,
    Trajectory,
    TrajectoryPosition,
    Vertex,
    Waypoint,
)
from scenario_compiler.vocabulary.word import Word


def _point() -> Child:
    return Child("position", "Position", read_point, write_point)


_STRATEGY = replace(choice(Waypoint, "strategy", "routeStrategy", "shortest"), always=True)


class _Strategy:
    """The strategy of the way to a waypoint; a random one is reported, because the shortest is taken."""

    def read(self, node: Node) -> Fields:
        found = _STRATEGY.read(node)
        if found["strategy"] == "random":
            message = "routeStrategy='random' has no effect: the shortest route to the waypoint is taken"
            node.report(NOT_READ, message, "routeStrategy")
        return found

    def write(self, word: Waypoint, element: etree._Element, output: Output) -> None:
        _STRATEGY.write(word, element, output)


WAYPOINT = regular("Waypoint", Waypoint, _Strategy(), _point())
_NAME = replace(text("name"), default="", always=True)
_CLOSED = replace(boolean("closed"), default=False, always=True)
ROUTE = regular("Route", RouteWord, _NAME, _CLOSED, Children("waypoints", WAYPOINT, least=1, wanted=2))


class _CurvatureRate:
    """The change of a clothoid's curvature: `curvaturePrime`, `curvatureDot` in 1.0."""

    def read(self, node: Node) -> Fields:
        named = "curvatureDot" if node.has("curvatureDot") and not node.has("curvaturePrime") else "curvaturePrime"
        return {"curvature_rate": node.number(named)}

    def write(self, word: Clothoid, element: etree._Element, output: Output) -> None:
        named = "curvatureDot" if output.version == (1, 0) else "curvaturePrime"
        element.set(named, output.text(word.curvature_rate, word))


class _Knots:
    """The knots of a NURBS."""

    def read(self, node: Node) -> Fields | None:
        knots = tuple(one.float("value") for one in node.children("Knot"))
        if not knots:
            node.required("Knot")
        return {"knots": knots} if knots else None

    def write(self, word: Nurbs, element: etree._Element, output: Output) -> None:
        element.extend([made("Knot", value=output.text(knot, word)) for knot in word.knots])


class _Time:
    """The time of a vertex, which is required in 1.0."""

    def read(self, node: Node) -> Fields:
        return {"time": node.optional_number("time")}

    def write(self, word: Vertex, element: etree._Element, output: Output) -> None:
        if word.time is not None:
            element.set("time", output.text(word.time, word))
        elif output.version == (1, 0):
            element.set("time", "0")


def read_position(node: Node) -> Position | None:
    """Return the position of a <Position> element; report an element that is not a position."""
    inner = node.first()
    if inner is not None and inner.tag in ON_CURVES.by_tag:
        position: Position | None = ON_CURVES.by_tag[inner.tag].read(inner)
        return position
    return read_point(node)


def write_position(word: Word, output: Output, tag: str = "Position") -> etree._Element:
    """Return the <Position> of a position; report one that OpenSCENARIO cannot express, and write the origin."""
    form = ON_CURVES.by_word.get(type(word))
    return write_point(word, output, tag) if form is None else write_as(form, word, output, tag)


def anywhere(tag: str = "Position", *, required: bool = True) -> Child:
    """Return the part for a child element that is a position, for the field `position`."""
    return Child("position", tag, read_position, lambda word, output: write_position(word, output, tag), required)


_VERTEX = regular("Vertex", Vertex, _Time(), anywhere())
_SEGMENT = regular(
    "ClothoidSplineSegment",
    ClothoidSegment,
    number("curvature_start", "curvatureStart"),
    number("curvature_end", "curvatureEnd"),
    number("length"),
    number("turn_at_start", "hOffset", 0.0),
    number("time_start", "timeStart", None),
    anywhere(tag="PositionStart", required=False),
)
_CONTROL_POINT = regular(
    "ControlPoint", ControlPoint, number("time", default=None), number("weight", default=1.0), anywhere()
)

SHAPES = Forms(
    (
        regular("Polyline", Polyline, Children("vertices", _VERTEX, least=1, wanted=2)),
        regular(
            "Clothoid",
            Clothoid,
            number("curvature"),
            _CurvatureRate(),
            number("length"),
            number("start_time", "startTime", None),
            number("stop_time", "stopTime", None),
            anywhere(),
        ),
        regular(
            "ClothoidSpline",
            ClothoidSpline,
            number("time_end", "timeEnd", None),
            Children("segments", _SEGMENT, least=1),
            since=(1, 2),
        ),
        regular("Nurbs", Nurbs, integer("order"), Children("points", _CONTROL_POINT, least=2), _Knots()),
    )
)
"""The forms of trajectories."""


def _read_shape(node: Node) -> Word | None:
    inner = node.first()
    if inner is None or inner.tag not in SHAPES.by_tag:
        (inner or node).report(codes.UNKNOWN_ELEMENT, f"<{(inner or node).tag}> is not a shape of a trajectory")
        return None
    if inner.tag == "Nurbs" and inner.integer("order") < 2:
        inner.report(codes.OUT_OF_LIMITS, "the order of a NURBS is at least 2", "order")
        return None
    shape: Word | None = SHAPES.by_tag[inner.tag].read(inner)
    return shape


def _write_shape(word: Word, output: Output) -> etree._Element:
    form = SHAPES.by_word[type(word)]
    if output.version < form.since:
        output.tell_lost(word, f"<{form.tag}> is not known before {output.dotted(form.since)}")
        origin = made("Vertex", made("Position", made("WorldPosition", x="0", y="0")), time="0")
        return made("Shape", made("Polyline", origin, copy(origin)))
    return made("Shape", form.write(word, output))


TRAJECTORY = regular("Trajectory", Trajectory, _NAME, _CLOSED, Child("shape", "Shape", _read_shape, _write_shape))


def read_route(node: Node) -> RouteWord | None:
    """Return the route in an element or in its catalog reference; report if there is none."""
    found = given(node, "Route")
    if found is None and node.child("CatalogReference") is None:
        node.required("Route", "CatalogReference")
    return None if found is None else ROUTE.read(with_parameters(found))


def read_trajectory(node: Node) -> Trajectory | None:
    """Return the trajectory in an element or in its catalog reference; report if there is none."""
    found = given(node, "Trajectory")
    if found is None and node.child("CatalogReference") is None:
        node.required("Trajectory", "CatalogReference")
    return None if found is None else TRAJECTORY.read(with_parameters(found))


def write_route(word: RouteWord, output: Output) -> etree._Element:
    """Return the <Route> of a route."""
    return ROUTE.write(word, output)


def write_trajectory(word: Trajectory, output: Output) -> etree._Element:
    """Return the <Trajectory> of a trajectory."""
    return TRAJECTORY.write(word, output)


_PLACES = Forms(
    (
        regular(
            "FromLaneCoordinates",
            InRouteLane,
            number("s", "pathS"),
            integer("lane", "laneId"),
            number("offset", "laneOffset", 0.0),
        ),
        regular("FromRoadCoordinates", InRouteRoad, number("s", "pathS"), number("t")),
        regular("FromCurrentEntity", InRouteEntity, entity("entity")),
    )
)


def _read_place(node: Node) -> Word | None:
    inner = node.first()
    if inner is None or inner.tag not in _PLACES.by_tag:
        (inner or node).report(codes.UNKNOWN_ELEMENT, f"<{(inner or node).tag}> is not a position on a route")
        return None
    place: Word | None = _PLACES.by_tag[inner.tag].read(inner)
    return place


def _write_place(word: Word, output: Output) -> etree._Element:
    return made("InRoutePosition", _PLACES.by_word[type(word)].write(word, output))


ON_CURVES = Forms(
    (
        regular(
            "RoutePosition",
            RoutePosition,
            Child(
                "route", "RouteRef", read_route, lambda word, output: nested(["RouteRef"], write_route(word, output))
            ),
            Orientation(),
            Child("place", "InRoutePosition", _read_place, _write_place),
        ),
        regular(
            "TrajectoryPosition",
            TrajectoryPosition,
            number("s"),
            number("t", default=0.0),
            Orientation(),
            Child(
                "trajectory",
                "TrajectoryRef",
                read_trajectory,
                lambda word, output: nested(["TrajectoryRef"], write_trajectory(word, output)),
            ),
            since=(1, 1),
        ),
    )
)
"""The positions that are measured along a route or a trajectory."""
