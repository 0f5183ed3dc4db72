"""Guides: tables of the next road, made from routes and destinations."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from itertools import pairwise

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.program.builder import ProgramBuilder
from scenario_compiler.expressions import Value
from scenario_compiler.plan.model import RouteLeg
from scenario_compiler.roads import Network
from scenario_compiler.roads.lanes import lane_at, lane_centre, lane_direction
from scenario_compiler.roads.tables import RoadTables
from scenario_compiler.roads.ways import Stretch, onward, path_between, travel_time
from scenario_compiler.vocabulary.positions import (
    FreePosition,
    InRouteEntity,
    InRouteLane,
    LanePositionWord,
    RoutePosition,
    RouteWord,
)
from scenario_compiler.vocabulary.scenario import parameter_values
from scenario_compiler.vocabulary.word import Word, number_value

JUNCTION_COST = 1.0e6
"""Cost of passing a junction on a route with the fewest intersections, m."""


def add_guide(draft: ProgramBuilder, following: Iterable[tuple[Stretch, int]], last: int) -> int:
    """Append a guide from stretches and the roads that follow them, which ends with the road `last`; return its row."""
    p = draft.program
    roads = len(draft.network.road_ids)
    row = [op.NONE] * (2 * roads)
    for (road, sense), ahead in following:
        at = 2 * road + (1 if sense > 0 else 0)
        if row[at] == op.NONE:
            row[at] = ahead
    p.guide_next.extend(row)
    p.guide_last.append(last)
    return len(p.guide_last) - 1


def add_legs(draft: ProgramBuilder, legs: Sequence[RouteLeg]) -> int:
    """Append the guide of a route over lanes; return its row, NONE for an empty one."""
    if not legs:
        return op.NONE
    path = [_stretch(draft.network, leg.road, leg.lane) for leg in legs]
    return add_guide(draft, _steps(path), path[-1][0])


def add_route(draft: ProgramBuilder, route: RouteWord) -> int:
    """Append the guide of a route over waypoints; return its row, NONE if none of them lies on a road."""
    path = route_path(draft, route)
    if not path:
        return op.NONE
    if not route.closed:
        return add_guide(draft, _steps(path), path[-1][0])
    n = draft.network.tables
    back = path_between(n, path[-1], path[0], lambda road: n.road_length[road]) or path[-1:]
    return add_guide(draft, _steps([*path[:-1], *back]), op.NONE)


def add_goal(draft: ProgramBuilder, position: Word) -> int:
    """Append the guide to a position from everywhere; return its row, NONE if it does not lie on a road."""
    goal = stretch_of(draft, position)
    if goal is None:
        return op.NONE
    n = draft.network.tables
    steps = onward(n, goal, lambda road: n.road_length[road])
    other = onward(n, (goal[0], -goal[1]), lambda road: n.road_length[road])
    return add_guide(draft, [(one, to[0]) for one, to in (*steps.items(), *other.items())], goal[0])


def cost_of_road(n: RoadTables, strategy: str, road: int) -> float:
    """Return the cost of passing a road on a route: its travel time for the fastest one, otherwise its length.

    A random route is the shortest one.
    """
    if strategy == "fastest":
        return travel_time(n, road)
    if strategy == "leastIntersections" and n.road_junction[road] >= 0:
        return JUNCTION_COST
    return n.road_length[road]


def route_path(draft: ProgramBuilder, route: RouteWord) -> list[Stretch]:
    """Return the stretches of a route; waypoints that cannot be reached are skipped."""
    n = draft.network.tables
    path: list[Stretch] = []
    for waypoint in route.waypoints:
        goal = stretch_of(draft, waypoint.position)
        if goal is None:
            continue
        if not path:
            path = [goal]
            continue
        cost = partial(cost_of_road, n, waypoint.strategy)
        tries = [(path[-1], goal), (path[-1], (goal[0], -goal[1]))]
        if len(path) == 1:
            turned = (path[0][0], -path[0][1])
            tries += [(turned, goal), (turned, (goal[0], -goal[1]))]
        found = next((way for start, end in tries if (way := path_between(n, start, end, cost))), None)
        if found is not None:
            path = [*path[:-1], *found]
    return path


def place_on_route(draft: ProgramBuilder, position: RoutePosition) -> tuple[int, int, float, float]:
    """Return (road, lane, s, offset) of a place on a route, which begins at its first waypoint.

    Beyond the route's end it is the end. For a route that lies on no road it is the beginning of the map's first road.
    """
    n = draft.network.tables
    values = parameter_values(draft.plan.parameters)
    place = position.place
    assert not isinstance(place, InRouteEntity)
    path = route_path(draft, position.route)
    if not path:
        return 0, 0, 0.0, 0.0
    rest = number_value(place.s, values)
    road, sense = path[0]
    first = next(one.position for one in position.route.waypoints if stretch_of(draft, one.position) is not None)
    s = _waypoint_s(draft, first, values)
    for following in (*path[1:], None):
        room = n.road_length[road] - s if sense > 0 else s
        if rest <= room or following is None:
            s += sense * min(rest, room)
            break
        rest -= room
        road, sense = following
        s = 0.0 if sense > 0 else n.road_length[road]
    if isinstance(place, InRouteLane):
        return road, place.lane, s, number_value(place.offset, values)
    t = number_value(place.t, values)
    lane = lane_at(n, road, s, t)
    centre, _ = lane_centre(n, road, lane, s)
    return road, lane, s, t - centre


def _waypoint_s(draft: ProgramBuilder, position: Word, values: Mapping[str, Value]) -> float:
    """Return the s of a waypoint on its road, m."""
    if isinstance(position, LanePositionWord):
        return number_value(position.s, values)
    assert isinstance(position, FreePosition)
    x, y = number_value(position.x, values), number_value(position.y, values)
    return (draft.network.locate(x, y) or draft.network.locate(x, y, nearest=True))[0].s


def stretch_of(draft: ProgramBuilder, position: Word) -> Stretch | None:
    """Return the road of a bound position and its lane's direction of travel along s; None off the roads."""
    network = draft.network
    if isinstance(position, LanePositionWord):
        return _stretch(network, position.road, position.lane)
    if isinstance(position, FreePosition):
        values = parameter_values(draft.plan.parameters)
        x, y = number_value(position.x, values), number_value(position.y, values)
        found = network.locate(x, y) or network.locate(x, y, nearest=True)
        return _stretch(network, found[0].road, found[0].lane) if found else None
    return None


def _stretch(network: Network, road: str, lane: int) -> Stretch:
    index = network.road_index(road)
    return index, lane_direction(network.tables, index, lane)


def _steps(path: Sequence[Stretch]) -> list[tuple[Stretch, int]]:
    return [(one, to[0]) for one, to in pairwise(path)]
