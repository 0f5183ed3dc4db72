"""Routes, trajectories, and positions along them."""

from typing import Literal

from scenario_compiler.vocabulary.positions.basic import (
    BesidePosition,
    LanePositionWord,
    NumberedSpawnPoint,
    RandomPosition,
    RandomSpawnPoint,
    RelativeLanePosition,
    RoadPosition,
    SpawnPoint,
    WorldPosition,
)
from scenario_compiler.vocabulary.positions.relative import (
    FreePosition,
    GeoPosition,
    LanesAwayPosition,
    RelativeObjectPosition,
    RelativeRoadPosition,
    RelativeWorldPosition,
)
from scenario_compiler.vocabulary.word import Number, Word, attribute, child

Point = (
    LanePositionWord
    | RoadPosition
    | WorldPosition
    | SpawnPoint
    | NumberedSpawnPoint
    | RandomSpawnPoint
    | RelativeLanePosition
    | BesidePosition
    | RandomPosition
    | FreePosition
    | GeoPosition
    | LanesAwayPosition
    | RelativeRoadPosition
    | RelativeObjectPosition
    | RelativeWorldPosition
)
"""Positions of waypoints, and of everything that needs no route or trajectory of its own."""


class Waypoint(Word):
    """A point through which a route passes."""

    word: Literal["waypoint"] = "waypoint"

    strategy: Literal["fastest", "leastIntersections", "random", "shortest"] = attribute(
        "Strategy for choosing the route from the previous waypoint; `random` takes the shortest one.",
        default="shortest",
    )
    position: Point = child("Position.")


class RouteWord(Word):
    """A route over the map's roads, through its waypoints in order."""

    word: Literal["route"] = "route"

    name: str = attribute("Name of the route.", default="")
    closed: bool = attribute("Whether the route starts again after its end.", default=False)
    waypoints: tuple[Waypoint, ...] = child("The waypoints, in order.")


class InRouteLane(Word):
    """A place on a route, by the distance from the route's start, in a given lane."""

    word: Literal["route_lane"] = "route_lane"

    s: Number = attribute("Distance along the route, m; beyond its end, the end.", quantity="length", minimum=0)
    lane: int = attribute("Id of the lane.")
    offset: Number = attribute("Distance from the lane's centre, m.", default=0.0, quantity="length")


class InRouteRoad(Word):
    """A place on a route, by the distance from the route's start and from the road's reference line.

    An entity there faces in the direction of travel of the lane at this place, as at any place on a route.
    """

    word: Literal["route_road"] = "route_road"

    s: Number = attribute("Distance along the route, m; beyond its end, the end.", quantity="length", minimum=0)
    t: Number = attribute(
        "Distance from the reference line, m, positive to the left along the road's s, also on a route against it.",
        quantity="length",
    )


class InRouteEntity(Word):
    """An entity's present place on its route."""

    word: Literal["route_entity"] = "route_entity"

    entity: str = attribute("Id of the entity.", names="entity")


class RoutePosition(Word):
    """A place on a route."""

    word: Literal["on_route"] = "on_route"

    turn: Number = attribute(
        "Heading relative to the lane's direction of travel, degrees.",
        default=0.0,
        quantity="angle",
    )
    heading: Number | None = attribute(
        "Heading in the world, degrees, instead of `turn`.", default=None, quantity="angle"
    )
    route: RouteWord = child("The route.")
    place: InRouteLane | InRouteRoad | InRouteEntity = child("Place on the route.")


class Vertex(Word):
    """A vertex of a polyline."""

    word: Literal["vertex"] = "vertex"

    time: Number | None = attribute("Time at which the vertex is reached, s.", default=None, quantity="time")
    position: "Point | RoutePosition | TrajectoryPosition" = child("Position.")


class Polyline(Word):
    """Straight segments from vertex to vertex."""

    word: Literal["polyline"] = "polyline"

    vertices: tuple[Vertex, ...] = child("The vertices, in order.")


class Clothoid(Word):
    """A curve whose curvature changes linearly with its length (an Euler spiral)."""

    word: Literal["clothoid"] = "clothoid"

    curvature: Number = attribute("Curvature at its start, 1/m, positive to the left.")
    curvature_rate: Number = attribute("Change of the curvature per length, 1/m2.")
    length: Number = attribute("Length, m.", quantity="length", minimum=0)
    start_time: Number | None = attribute("Time at which its start is passed, s.", default=None, quantity="time")
    stop_time: Number | None = attribute("Time at which its end is reached, s.", default=None, quantity="time")
    position: "Point | RoutePosition | TrajectoryPosition" = child("Position and heading of its start.")


class ClothoidSegment(Word):
    """A segment of a clothoid spline. It begins where the previous segment ends."""

    word: Literal["segment"] = "segment"

    curvature_start: Number = attribute("Curvature at its start, 1/m.")
    curvature_end: Number = attribute("Curvature at its end, 1/m.")
    length: Number = attribute("Length, m.", quantity="length", minimum=0)
    turn_at_start: Number = attribute(
        "Heading at its start relative to the end of the previous segment, degrees.", default=0.0, quantity="angle"
    )
    time_start: Number | None = attribute("Time at which its start is passed, s.", default=None, quantity="time")
    position: "Point | RoutePosition | TrajectoryPosition | None" = child(
        "Position of its start, if that is not the end of the previous segment.", default=None
    )


class ClothoidSpline(Word):
    """A sequence of clothoids."""

    word: Literal["clothoid_spline"] = "clothoid_spline"

    time_end: Number | None = attribute("Time at which its end is reached, s.", default=None, quantity="time")
    segments: tuple[ClothoidSegment, ...] = child("The segments, in order.")


class ControlPoint(Word):
    """A control point of a NURBS."""

    word: Literal["control_point"] = "control_point"

    time: Number | None = attribute(
        "Time at which the corresponding point of the curve is reached, s.", default=None, quantity="time"
    )
    weight: Number = attribute("Its weight.", default=1.0)
    position: "Point | RoutePosition | TrajectoryPosition" = child("Position.")


class Nurbs(Word):
    """A non-uniform rational B-spline."""

    word: Literal["nurbs"] = "nurbs"

    order: int = attribute("Order: the degree plus one.", minimum=2)
    knots: tuple[float, ...] = attribute(
        "Knots. Their number is the number of control points plus the order.", separated=True
    )
    points: tuple[ControlPoint, ...] = child("The control points, in order.")


class Trajectory(Word):
    """A curve in the plane, with or without times."""

    word: Literal["trajectory"] = "trajectory"

    name: str = attribute("Name of the trajectory.", default="")
    closed: bool = attribute("Whether its end is connected to its start.", default=False)
    shape: Polyline | Clothoid | ClothoidSpline | Nurbs = child("Its shape.")

    @property
    def times(self) -> tuple[tuple[Word, Number | None], ...]:
        """The times of its vertices or control points, or of the starts and the end of its clothoids, s.

        Each is paired with its word, and None if that gives no time.
        """
        shape = self.shape
        if isinstance(shape, Clothoid):
            return (shape, shape.start_time), (shape, shape.stop_time)
        if isinstance(shape, ClothoidSpline):
            return (*((one, one.time_start) for one in shape.segments), (shape, shape.time_end))
        return tuple((one, one.time) for one in (shape.points if isinstance(shape, Nurbs) else shape.vertices))


class TrajectoryPosition(Word):
    """A place along a trajectory."""

    word: Literal["on_trajectory"] = "on_trajectory"

    s: Number = attribute(
        "Distance from the trajectory's start, m; beyond its end, the end.", quantity="length", minimum=0
    )
    t: Number = attribute("Distance to the left of the trajectory, m.", default=0.0, quantity="length")
    turn: Number = attribute("Heading relative to the trajectory's, degrees.", default=0.0, quantity="angle")
    heading: Number | None = attribute(
        "Heading in the world, degrees, instead of `turn`.", default=None, quantity="angle"
    )
    trajectory: Trajectory = child("The trajectory.")
