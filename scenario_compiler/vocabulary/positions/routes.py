"""Routes and trajectories, and positions measured along them."""

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
"""Positions that routes and trajectories are made of."""


class Waypoint(Word):
    """A point that a route passes."""

    word: Literal["waypoint"] = "waypoint"

    strategy: Literal["fastest", "leastIntersections", "random", "shortest"] = attribute(
        "How the way to it from the waypoint before is chosen.", default="shortest"
    )
    position: Point = child("Where it is.")


class RouteWord(Word):
    """A way over the map's roads, from waypoint to waypoint."""

    word: Literal["route"] = "route"

    name: str = attribute("Name of the route.", default="")
    closed: bool = attribute("Whether it goes on at its begin when it is over.", default=False)
    waypoints: tuple[Waypoint, ...] = child("Its waypoints, in order.")


class InRouteLane(Word):
    """A place on a route by its distance from the route's begin, in one of the lanes there."""

    word: Literal["route_lane"] = "route_lane"

    s: Number = attribute("Distance along the route, m.", quantity="length", minimum=0)
    lane: int = attribute("Id of the lane.")
    offset: Number = attribute("Distance from the lane's centre, m.", default=0.0, quantity="length")


class InRouteRoad(Word):
    """A place on a route by its distance from the route's begin and from the road's reference line."""

    word: Literal["route_road"] = "route_road"

    s: Number = attribute("Distance along the route, m.", quantity="length", minimum=0)
    t: Number = attribute("Distance from the reference line, m.", quantity="length")


class InRouteEntity(Word):
    """Where an entity is on its route."""

    word: Literal["route_entity"] = "route_entity"

    entity: str = attribute("Id of the entity.", names="entity")


class RoutePosition(Word):
    """A place on a route."""

    word: Literal["on_route"] = "on_route"

    turn: Number = attribute("Heading relative to the lane's or road's, degrees.", default=0.0, quantity="angle")
    heading: Number | None = attribute(
        "Heading in the world, degrees, in place of `turn`.", default=None, quantity="angle"
    )
    route: RouteWord = child("The route.")
    place: InRouteLane | InRouteRoad | InRouteEntity = child("Where on it.")


class Vertex(Word):
    """A corner of a polyline."""

    word: Literal["vertex"] = "vertex"

    time: Number | None = attribute("When it is reached, s.", default=None, quantity="time")
    position: Point = child("Where it is.")


class Polyline(Word):
    """Straight lines from vertex to vertex."""

    word: Literal["polyline"] = "polyline"

    vertices: tuple[Vertex, ...] = child("Its vertices, in order.")


class Clothoid(Word):
    """A curve whose curvature grows evenly with its length (an Euler spiral)."""

    word: Literal["clothoid"] = "clothoid"

    curvature: Number = attribute("Curvature at its begin, 1/m, positive to the left.")
    curvature_rate: Number = attribute("Change of the curvature with length, 1/m2.")
    length: Number = attribute("Its length, m.", quantity="length", minimum=0)
    start_time: Number | None = attribute("When its begin is passed, s.", default=None, quantity="time")
    stop_time: Number | None = attribute("When its end is reached, s.", default=None, quantity="time")
    position: Point = child("Where it begins, and in which direction.")


class ClothoidSegment(Word):
    """A piece of a clothoid spline; it begins where the piece before ends."""

    word: Literal["segment"] = "segment"

    curvature_start: Number = attribute("Curvature at its begin, 1/m.")
    curvature_end: Number = attribute("Curvature at its end, 1/m.")
    length: Number = attribute("Its length, m.", quantity="length", minimum=0)
    turn_at_start: Number = attribute(
        "Heading at its begin relative to the end before, degrees.", default=0.0, quantity="angle"
    )
    time_start: Number | None = attribute("When its begin is passed, s.", default=None, quantity="time")
    position: Point | None = child("Where it begins, if not at the end of the piece before.", default=None)


class ClothoidSpline(Word):
    """Clothoids one after the other."""

    word: Literal["clothoid_spline"] = "clothoid_spline"

    time_end: Number | None = attribute("When its end is reached, s.", default=None, quantity="time")
    segments: tuple[ClothoidSegment, ...] = child("Its pieces, in order.")


class ControlPoint(Word):
    """A control point of a NURBS."""

    word: Literal["control_point"] = "control_point"

    time: Number | None = attribute(
        "When the curve's point that belongs to it is reached, s.", default=None, quantity="time"
    )
    weight: Number = attribute("Its weight.", default=1.0)
    position: Point = child("Where it is.")


class Nurbs(Word):
    """A non-uniform rational B-spline."""

    word: Literal["nurbs"] = "nurbs"

    order: int = attribute("Order: the degree and one.", minimum=2)
    knots: tuple[float, ...] = attribute("Knots, as many as control points and order together.", separated=True)
    points: tuple[ControlPoint, ...] = child("Its control points, in order.")


class Trajectory(Word):
    """A curve in the plane, with times or without."""

    word: Literal["trajectory"] = "trajectory"

    name: str = attribute("Name of the trajectory.", default="")
    closed: bool = attribute("Whether its end is joined to its begin.", default=False)
    shape: Polyline | Clothoid | ClothoidSpline | Nurbs = child("Its form.")


class TrajectoryPosition(Word):
    """A place along a trajectory."""

    word: Literal["on_trajectory"] = "on_trajectory"

    s: Number = attribute("Distance from the trajectory's begin, m.", quantity="length", minimum=0)
    t: Number = attribute("Distance to the left of the trajectory, m.", default=0.0, quantity="length")
    turn: Number = attribute("Heading relative to the trajectory's, degrees.", default=0.0, quantity="angle")
    heading: Number | None = attribute(
        "Heading in the world, degrees, in place of `turn`.", default=None, quantity="angle"
    )
    trajectory: Trajectory = child("The trajectory.")
