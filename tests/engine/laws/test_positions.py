"""Positions: the place and heading of an entity that is teleported there."""

from __future__ import annotations

from math import pi, sqrt
from pathlib import Path

import pytest

from tests.engine.laws.told import Actor, Event, Seen, document, play, play_text


def put(folder: Path, position: str, **actors: Actor) -> Seen:
    """Return where A is in the row of 1.05 s, into which a teleport at 1 s puts it.

    B is then at x = 208 in lane -2 and C, which comes towards it, at x = 492 in lane 1.
    """
    told = {"B": Actor(lane=-2, s=200.0, speed=8.0), "C": Actor(lane=1, s=500.0, speed=8.0), "A": Actor(), **actors}
    leap = f"<TeleportAction><Position>{position}</Position></TeleportAction>"
    return play(folder, told, [Event("A", leap)], seconds=1.2).at("A", 1.05)


def turned(kind: str, h: float = 0.3) -> str:
    """Return an orientation."""
    return f'<Orientation type="{kind}" h="{h}"/>'


@pytest.mark.law("RelativeWorldPosition", "turned in the world")
@pytest.mark.law("RelativeObjectPosition", "turned in the world")
@pytest.mark.law("RelativeRoadPosition", "turned in the world")
@pytest.mark.parametrize(
    ("position", "x", "y"),
    [
        ('<RelativeWorldPosition entityRef="{}" dx="10" dy="1">{}</RelativeWorldPosition>', 10.0, 1.0),
        ('<RelativeObjectPosition entityRef="{}" dx="10" dy="1">{}</RelativeObjectPosition>', 10.0, 1.0),
        ('<RelativeRoadPosition entityRef="{}" ds="10" dt="1">{}</RelativeRoadPosition>', 10.0, 1.0),
    ],
)
@pytest.mark.parametrize(("kind", "ahead", "oncoming"), [("absolute", 0.3, 0.3), ("relative", 0.3, pi + 0.3)])
def test_the_heading_of_a_relative_position_is_absolute_or_relative(
    tmp_path: Path, position: str, x: float, y: float, kind: str, ahead: float, oncoming: float
) -> None:
    one = put(tmp_path, position.format("B", turned(kind)))
    assert (one.x, one.y, one.h) == pytest.approx((208.0 + x, -5.25 + y, ahead))
    sign = -1.0 if "Object" in position else 1.0
    other = put(tmp_path, position.format("C", turned(kind)))
    h = 0.3 if "Road" in position else oncoming
    assert (other.x, other.y, other.h) == pytest.approx((492.0 + sign * x, 1.75 + sign * y, h))


@pytest.mark.law("RelativeLanePosition", "along the lane")
@pytest.mark.parametrize(("to", "x", "y"), [("B", 218.0, -1.75), ("C", 482.0, -1.75)])
def test_along_a_lane_ahead_and_left_are_those_of_its_travel(tmp_path: Path, to: str, x: float, y: float) -> None:
    place = f'<RelativeLanePosition entityRef="{to}" dsLane="10" dLane="1"></RelativeLanePosition>'
    assert (put(tmp_path, place).x, put(tmp_path, place).y) == pytest.approx((x, y))


def test_beside_ds_a_distance_along_the_lane_does_not_count(tmp_path: Path) -> None:
    """C comes towards A, so that 10 m along the road are behind it."""
    place = put(tmp_path, '<RelativeLanePosition entityRef="C" ds="10" dsLane="30" dLane="0"></RelativeLanePosition>')
    assert place.x == pytest.approx(502.0)


@pytest.mark.law("RelativeLanePosition", "without a distance")
def test_a_relative_position_without_distances_is_beside_the_entity(tmp_path: Path) -> None:
    place = put(tmp_path, '<RelativeLanePosition entityRef="B" dLane="1"></RelativeLanePosition>')
    assert (place.x, place.y) == pytest.approx((208.0, -1.75))
    place = put(tmp_path, '<RelativeRoadPosition entityRef="B" dt="3.5"></RelativeRoadPosition>')
    assert (place.x, place.y) == pytest.approx((208.0, -1.75))
    place = put(tmp_path, '<RelativeRoadPosition entityRef="B" ds="5"></RelativeRoadPosition>')
    assert (place.x, place.y) == pytest.approx((213.0, -5.25))


@pytest.mark.law("LanePosition", "in lane 0")
@pytest.mark.parametrize("offset", [0.0, 1.0])
def test_a_position_in_lane_0_lies_on_the_line_between_left_and_right(tmp_path: Path, offset: float) -> None:
    place = put(tmp_path, f'<LanePosition roadId="1" laneId="0" s="100" offset="{offset}"/>')
    assert (place.x, place.y, place.h) == pytest.approx((100.0, offset, 0.0))


@pytest.mark.law("LanePosition", "turned against the road")
@pytest.mark.law("LanePosition", "turned in the world")
@pytest.mark.parametrize(
    ("kind", "lane", "h"), [("relative", -1, 0.3), ("relative", 1, pi + 0.3), ("absolute", 1, 0.3)]
)
def test_a_lane_position_is_turned_from_the_lanes_travel(tmp_path: Path, kind: str, lane: int, h: float) -> None:
    place = f'<LanePosition roadId="1" laneId="{lane}" s="100">{turned(kind)}</LanePosition>'
    assert put(tmp_path, place).h == pytest.approx(h)


@pytest.mark.parametrize(("minor", "h"), [(3, pi + 0.3), (1, 0.3), (0, 0.3)])
def test_an_orientation_without_a_type_is_relative_since_1_3(tmp_path: Path, minor: int, h: float) -> None:
    """A "missing type value is interpreted as relative" in 1.3, and as absolute before, as in esmini 3.6."""
    place = '<Position><LanePosition roadId="1" laneId="1" s="100"><Orientation h="0.3"/></LanePosition></Position>'
    text = document({"A": Actor(position=place)}, [], 1.0).replace('revMinor="3"', f'revMinor="{minor}"')
    assert play_text(tmp_path, text, 1.0).at("A", 0.0).h == pytest.approx(h)


@pytest.mark.law("RoadPosition", "turned against the road")
@pytest.mark.parametrize("t", [1.0, -3.0])
def test_a_road_position_faces_along_s(tmp_path: Path, t: float) -> None:
    place = put(tmp_path, f'<RoadPosition roadId="1" s="100" t="{t}">{turned("relative")}</RoadPosition>')
    assert (place.x, place.y, place.h) == pytest.approx((100.0, t, 0.3))


LINE = (
    '<TrajectoryRef><Trajectory name="t" closed="false"><Shape><Polyline>'
    '<Vertex><Position><WorldPosition x="100" y="-1.75"/></Position></Vertex>'
    '<Vertex><Position><WorldPosition x="100" y="98.25"/></Position></Vertex></Polyline></Shape></Trajectory>'
    "</TrajectoryRef>"
)


@pytest.mark.law("TrajectoryPosition", "used")
@pytest.mark.law("TrajectoryPosition", "turned against the road")
@pytest.mark.law("TrajectoryPosition", "turned in the world")
@pytest.mark.parametrize(
    ("more", "h"), [("", 0.5 * pi), (turned("relative"), 0.5 * pi + 0.3), (turned("absolute"), 0.3)]
)
def test_a_position_on_a_trajectory_is_beside_and_turned_from_where_that_goes(
    tmp_path: Path, more: str, h: float
) -> None:
    place = put(tmp_path, f'<TrajectoryPosition s="4" t="1">{more}{LINE}</TrajectoryPosition>')
    assert (place.x, place.y, place.h) == pytest.approx((99.0, 2.25, h))


@pytest.mark.law("GeoPosition", "used")
@pytest.mark.law("GeoPosition", "turned against the road")
@pytest.mark.law("GeoPosition", "turned in the world")
@pytest.mark.parametrize("kind", ["relative", "absolute"])
def test_a_geographic_position_is_projected_and_turned(tmp_path: Path, kind: str) -> None:
    """On the central meridian of the zone, 9 degrees east, x is 0; the road runs along x, so both turns are one.

    The map lies 5 427 000 m north of the equator, and UTM has the scale 0.9996 on its meridians.
    """
    word = f'<GeoPosition latitudeDeg="49" longitudeDeg="9">{turned(kind)}</GeoPosition>'
    place = put(tmp_path, word)
    assert (place.x, place.h) == pytest.approx((0.0, 0.3), abs=1e-3)
    assert place.y == pytest.approx(0.9996 * MERIDIAN_49 - 5_427_000.0, abs=1e-3)


MERIDIAN_49 = 5_429_627.632
"""Length of the meridian of WGS 84 from the equator to 49 degrees, m: the integral of a (1-e2) / (1 - e2 sin2)^1.5."""


ROUTE = (
    '<RouteRef><Route name="r" closed="false"><Waypoint routeStrategy="shortest"><Position>'
    '<LanePosition roadId="1" laneId="-1" s="100"/></Position></Waypoint><Waypoint routeStrategy="shortest"><Position>'
    '<LanePosition roadId="1" laneId="-1" s="600"/></Position></Waypoint></Route></RouteRef>'
)


@pytest.mark.law("RoutePosition", "used")
@pytest.mark.law("RoutePosition", "turned against the road")
@pytest.mark.law("RoutePosition", "turned in the world")
@pytest.mark.parametrize("kind", ["relative", "absolute"])
def test_a_position_on_a_route_counts_from_its_start(tmp_path: Path, kind: str) -> None:
    where = '<InRoutePosition><FromLaneCoordinates pathS="40" laneId="-2"/></InRoutePosition>'
    place = put(tmp_path, f"<RoutePosition>{ROUTE}{turned(kind)}{where}</RoutePosition>")
    assert (place.x, place.y, place.h) == pytest.approx((140.0, -5.25, 0.3))


@pytest.mark.parametrize(("lane", "heading"), [(-1, 0.0), (2, pi)])
def test_a_position_on_a_route_where_an_entity_is_faces_as_its_lane_is_travelled(
    tmp_path: Path, lane: int, heading: float
) -> None:
    """As a position in lane or road coordinates of a route does; an oncoming entity faces against s."""
    where = '<InRoutePosition><FromCurrentEntity entityRef="B"/></InRoutePosition>'
    placed = Actor(position=f"<Position><RoutePosition>{ROUTE}{where}</RoutePosition></Position>")
    place = play(tmp_path, {"B": Actor(lane=lane, s=300.0), "A": placed}, [], 0.1).at("A", 0.0)
    assert (place.x, place.lane) == (300.0, lane)
    assert place.h == pytest.approx(heading)


def vertex(position: str) -> str:
    """Return a vertex at a position."""
    return f"<Vertex><Position>{position}</Position></Vertex>"


def polyline(*vertices: str) -> str:
    """Return a trajectory through vertices, without its name and `closed`, which a run does not need."""
    line = f"<Shape><Polyline>{''.join(vertices)}</Polyline></Shape>"
    return f"<TrajectoryRef><Trajectory>{line}</Trajectory></TrajectoryRef>"


def on_trajectory(s: float, t: float, trajectory: str) -> str:
    """Return a position beside a trajectory."""
    return f'<TrajectoryPosition s="{s}" t="{t}">{trajectory}</TrajectoryPosition>'


def test_vertices_can_lie_beside_other_trajectories(tmp_path: Path) -> None:
    """The line of A crosses the helper, which leads from (100, -20) to (200, -20), at 30 m of it, from its right.

    A vertex of the helper lies on a third trajectory, and A's line ends on a route.
    """
    third = polyline(*(vertex(f'<WorldPosition x="100" y="{y}"/>') for y in (0, -100)))
    helper = polyline(vertex(on_trajectory(20.0, 0.0, third)), vertex('<WorldPosition x="200" y="-20"/>'))
    waypoints = "".join(
        f'<Waypoint routeStrategy="shortest"><Position><LanePosition roadId="1" laneId="-1" s="{s}"/></Position>'
        "</Waypoint>"
        for s in (100, 300)
    )
    route = (
        f"<RoutePosition><RouteRef><Route>{waypoints}</Route></RouteRef><InRoutePosition>"
        '<FromLaneCoordinates pathS="30" laneId="-1"/></InRoutePosition></RoutePosition>'
    )
    line = polyline(vertex(on_trajectory(30.0, -15.0, helper)), vertex(on_trajectory(30.0, 5.0, helper)), vertex(route))
    follow = (
        f"<RoutingAction><FollowTrajectoryAction>{line}<TimeReference><None/></TimeReference>"
        '<TrajectoryFollowingMode followingMode="position"/></FollowTrajectoryAction></RoutingAction>'
    )
    run = play(tmp_path, {"A": Actor()}, [Event("A", follow)], seconds=6.0)
    assert (run.at("A", 2.0).x, run.at("A", 2.0).y) == pytest.approx((130.0, -25.0))
    assert (run.at("A", 3.0).x, run.at("A", 3.0).y) == pytest.approx((130.0, -15.0))
    assert (run.at("A", 4.0).x, run.at("A", 4.0).y) == pytest.approx((130.0, -5.0))


def test_the_axes_of_a_relative_position_are_tilted_as_its_entity(tmp_path: Path) -> None:
    """B stands where the road climbs by 0.1: 10 m along its own axis are 10 / sqrt(1.01) in the plane."""
    up = put(tmp_path, '<RelativeObjectPosition entityRef="B" dx="10" dy="1"/>', B=Actor(lane=-2, s=1100, speed=0.0))
    assert (up.x, up.y) == pytest.approx((1100.0 + 10.0 / sqrt(1.01), -4.25))
    above = '<RelativeObjectPosition entityRef="B" dx="0" dy="0" dz="2"/>'
    back = put(tmp_path, above, B=Actor(lane=-2, s=1100, speed=0.0))
    assert back.x == pytest.approx(1100.0 - 0.2 / sqrt(1.01))
