"""Checks that the places of routes are in lanes that are known before the run."""

from __future__ import annotations

from scenario_compiler.diagnostics import Code, Diagnostics, Severity
from scenario_compiler.plan.binding import AT_USE, UNKNOWN_LANE, is_bound
from scenario_compiler.plan.model import Plan
from scenario_compiler.plan.routes import place_on_route
from scenario_compiler.roads import Network
from scenario_compiler.roads.lanes import lane_exists
from scenario_compiler.vocabulary.actions import AcquirePositionAction
from scenario_compiler.vocabulary.positions import (
    BoundPosition,
    FreePosition,
    InRouteLane,
    LanePositionWord,
    Position,
    RoutePosition,
    RouteWord,
)
from scenario_compiler.vocabulary.scenario import parameter_values
from scenario_compiler.vocabulary.word import number_value

NOT_IN_A_LANE = Code(
    "SC389",
    "not-in-a-lane",
    "Routes are planned before the run, from lane to lane. Here a destination, the start of an entity with a "
    "destination, a waypoint or a position to acquire is in no lane, or is known only during the run, because it is "
    "relative to an entity that moves or lies on a route or a trajectory. There is no route to such a place; a route "
    "leaves such a waypoint out. Write a place on the map:\n\n"
    '    <acquire_position><relative_object entity="ego" dx="300" dy="0"/></acquire_position>\n'
    '    <acquire_position><lane road="3" lane="-1" s="90"/></acquire_position>',
)


def check_routes(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Warn of places to which there is no route, and report places on routes in lanes that do not exist."""
    for word in plan.words():
        if isinstance(word, RouteWord):
            for waypoint in word.waypoints:
                _check(waypoint.position, "the route leaves out this waypoint", sink)
        elif isinstance(word, AcquirePositionAction):
            _check(word.position, "there is no route to this position", sink)
        elif isinstance(word, RoutePosition) and isinstance(word.place, InRouteLane):
            _check_lane(plan, network, word, word.place, sink)


def _check(position: Position | BoundPosition, so: str, sink: Diagnostics) -> None:
    if isinstance(position, AT_USE) and not isinstance(position, FreePosition):
        message = f"{so}: the lane of <{position.word}> is known only during the run"
        sink.add(NOT_IN_A_LANE, message, position.origin, severity=Severity.WARNING)


def _check_lane(plan: Plan, network: Network, position: RoutePosition, place: InRouteLane, sink: Diagnostics) -> None:
    values = parameter_values(plan.parameters)
    corners = [one.position for one in position.route.waypoints if isinstance(one.position, LanePositionWord)]
    if not all(is_bound(network, one, number_value(one.s, values)) for one in corners):
        return  # reported by binding
    at, lane, s, _ = place_on_route(network, values, position)
    if lane != 0 and not lane_exists(network.tables, at, lane, s):
        road = network.road_ids[at]
        there = ", ".join(str(one.lane) for one in network.lanes_at(road, s) if one.lane != 0)
        message = f"the route's road '{road}' has no lane {lane} at s = {s:g} m"
        sink.add(UNKNOWN_LANE, message, place.place_of("lane"), hint=f"lanes there: {there or 'none'}")
