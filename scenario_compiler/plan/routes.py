"""Routes over roads, and places on them, as far as the map and the parameters' values determine them."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

from scenario_compiler.expressions import Value
from scenario_compiler.roads import Network
from scenario_compiler.roads.lanes import lane_at, lane_centre, lane_direction
from scenario_compiler.roads.tables import RoadTables
from scenario_compiler.roads.ways import Stretch, joints, onward, path_between, travel_time
from scenario_compiler.vocabulary.positions import (
    FreePosition,
    InRouteEntity,
    InRouteLane,
    LanePositionWord,
    RoutePosition,
    RouteWord,
    Waypoint,
)
from scenario_compiler.vocabulary.word import Word, number_value

Values = Mapping[str, Value]
"""Values of parameters by name."""

JUNCTION_COST = 1.0e6
"""Cost of passing a junction on a route with the fewest intersections, m."""


def cost_of_stretch(n: RoadTables, strategy: str, stretch: Stretch) -> float:
    """Return the cost of passing a stretch on a route: its travel time for the fastest one, otherwise its length.

    A random route is the shortest one.
    """
    if strategy == "fastest":
        return travel_time(n, stretch)
    road, _ = stretch
    if strategy == "leastIntersections" and n.road_junction[road] >= 0:
        return JUNCTION_COST
    return n.road_length[road]


def route_path(network: Network, values: Values, route: RouteWord) -> list[Stretch]:
    """Return the stretches of a route; waypoints that cannot be reached are skipped."""
    return path_and_missed(network, values, route)[0]


def path_and_missed(network: Network, values: Values, route: RouteWord) -> tuple[list[Stretch], list[Waypoint]]:
    """Return the stretches of a route, and the waypoints on roads that are skipped because no way leads there."""
    n = network.tables
    path: list[Stretch] = []
    missed: list[Waypoint] = []
    for waypoint in route.waypoints:
        goal = stretch_of(network, values, waypoint.position)
        if goal is None:
            continue
        if not path:
            path = [goal]
            continue
        cost = partial(cost_of_stretch, n, waypoint.strategy)
        tries = [(path[-1], goal), (path[-1], (goal[0], -goal[1]))]
        if len(path) == 1:
            turned = (path[0][0], -path[0][1])
            tries += [(turned, goal), (turned, (goal[0], -goal[1]))]
        found = next((way for start, end in tries if (way := path_between(n, start, end, cost))), None)
        if found is None:
            missed.append(waypoint)
        else:
            path = [*path[:-1], *found]
    return path, missed


def leads_to(network: Network, start: Stretch, goal: Stretch) -> bool:
    """Return whether a way leads from a road, driven in either direction, to another one."""
    n = network.tables
    ways = (onward(n, (goal[0], sense)) for sense in (1, -1))
    return start[0] == goal[0] or any((start[0], sense) in way for way in ways for sense in (1, -1))


def place_on_route(network: Network, values: Values, position: RoutePosition) -> tuple[int, int, float, float]:
    """Return (road, lane, s, offset) of a place on a route, which begins at its first waypoint.

    Beyond the route's end it is the end. For a route that lies on no road it is the beginning of the map's first road.
    """
    n = network.tables
    place = position.place
    assert not isinstance(place, InRouteEntity)
    path = route_path(network, values, position.route)
    if not path:
        return 0, 0, 0.0, 0.0
    rest = number_value(place.s, values)
    road, sense = path[0]
    places = [waypoint.position for waypoint in position.route.waypoints]
    s = _waypoint_s(network, values, next(one for one in places if stretch_of(network, values, one) is not None))
    for following in (*path[1:], None):
        joint = next((one for one in joints(n, (road, sense)) if one.to == following), None)
        s_left = joint.s_left if joint is not None else n.road_length[road] if sense > 0 else 0.0
        room = max(sense * (s_left - s), 0.0)
        if rest <= room or joint is None:
            s += sense * min(rest, room)
            break
        rest -= room
        (road, sense), s = joint.to, joint.s_entered
    if isinstance(place, InRouteLane):
        return road, place.lane, s, number_value(place.offset, values)
    t = number_value(place.t, values)
    lane = lane_at(n, road, s, t)
    centre, _ = lane_centre(n, road, lane, s)
    return road, lane, s, t - centre


def _waypoint_s(network: Network, values: Values, position: Word) -> float:
    """Return the s of a waypoint on its road, m."""
    if isinstance(position, LanePositionWord):
        return number_value(position.s, values)
    assert isinstance(position, FreePosition)
    x, y = number_value(position.x, values), number_value(position.y, values)
    return (network.locate(x, y) or network.locate(x, y, nearest=True))[0].s


def stretch_of(network: Network, values: Values, position: Word) -> Stretch | None:
    """Return the road of a bound position and its lane's direction of travel along s; None off the roads."""
    if isinstance(position, LanePositionWord):
        return stretch_in(network, position.road, position.lane, number_value(position.s, values))
    if isinstance(position, FreePosition):
        x, y = number_value(position.x, values), number_value(position.y, values)
        found = network.locate(x, y) or network.locate(x, y, nearest=True)
        return stretch_in(network, *found[0][:3]) if found else None
    return None


def stretch_in(network: Network, road: str, lane: int, s: float) -> Stretch:
    """Return a road and a lane's direction of travel along it at s."""
    index = network.road_index(road)
    return index, lane_direction(network.tables, index, lane, s)
