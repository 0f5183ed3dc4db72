"""Checks that the places of routes are in lanes that are known before the run."""

from __future__ import annotations

from collections.abc import Mapping

from scenario_compiler.diagnostics import Code, Diagnostics, Severity
from scenario_compiler.expressions import Value
from scenario_compiler.plan.binding import AT_USE, UNKNOWN_LANE, is_bound
from scenario_compiler.plan.model import Plan
from scenario_compiler.plan.routes import leads_to, path_and_missed, place_on_route, stretch_in, stretch_of
from scenario_compiler.roads import Network
from scenario_compiler.roads.lanes import lane_exists
from scenario_compiler.vocabulary.actions import (
    AcquirePositionAction,
    AddEntityAction,
    FollowPathAction,
    FollowTrajectoryAction,
    TeleportAction,
)
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

NO_ROUTE = Code(
    "SC379",
    "no-route",
    "No route along the map's lanes leads from the start to the destination, so the ego vehicle can never reach it. "
    "Check the direction of travel of both lanes.\n\n"
    '    <start><lane road="3" lane="-1" s="20"/></start>\n'
    '    <destination><lane road="3" lane="1" s="90"/></destination>     the oncoming lane\n\n'
    "It is a warning if no roads lead to a waypoint of a route, which the route then leaves out, or to a position to "
    "acquire, which then has no effect. Check the links of the roads and junctions (`scenario-compiler map check`).",
)

LEAPS = (AddEntityAction, FollowPathAction, FollowTrajectoryAction, TeleportAction)
"""Actions of the stories after which an entity may be on a road to which no other one leads."""


def check_routes(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Warn of places to which there is no route, and report places on routes in lanes that do not exist."""
    _check_acquired(plan, network, sink)
    for word in plan.words():
        if isinstance(word, RouteWord):
            for waypoint in word.waypoints:
                _check(waypoint.position, "the route leaves out this waypoint", sink)
            _check_waypoints(plan, network, word, sink)
        elif isinstance(word, AcquirePositionAction):
            _check(word.position, "there is no route to this position", sink)
        elif isinstance(word, RoutePosition) and isinstance(word.place, InRouteLane):
            _check_lane(plan, network, word, word.place, sink)


def _check(position: Position | BoundPosition, so: str, sink: Diagnostics) -> None:
    if isinstance(position, AT_USE) and not isinstance(position, FreePosition):
        message = f"{so}: the lane of <{position.word}> is known only during the run"
        sink.add(NOT_IN_A_LANE, message, position.origin, severity=Severity.WARNING)


def _check_waypoints(plan: Plan, network: Network, route: RouteWord, sink: Diagnostics) -> None:
    values = parameter_values(plan.parameters)
    if not all(_known(network, values, one.position) for one in route.waypoints):
        return  # reported by binding
    for waypoint in path_and_missed(network, values, route)[1]:
        message = "no roads lead from the waypoint before to this one, so the route leaves it out"
        sink.add(NO_ROUTE, message, waypoint.position.origin, severity=Severity.WARNING)


def _check_acquired(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Warn of positions to which no roads lead from where their entity starts, unless it may leap to other roads."""
    values = parameter_values(plan.parameters)
    elsewhere = {
        action.entity if isinstance(action, AddEntityAction) else actor
        for actor, action in plan.storyboard.story_actions()
        if isinstance(action, LEAPS)
    }
    elsewhere.update(one.entity for one in plan.storyboard.init if isinstance(one.action, FollowTrajectoryAction))
    elsewhere.update(one.id for one in plan.entities if one.path is not None)
    elsewhere.update([] if plan.controller is None else [plan.ego.id])
    for actor, action in plan.storyboard.actions():
        start = plan.derived.get(actor)
        if not isinstance(action, AcquirePositionAction) or start is None or actor in elsewhere:
            continue
        goal = stretch_of(network, values, action.position) if _known(network, values, action.position) else None
        here = {stretch_in(network, one.road, one.lane, one.s) for one in network.locate(start.x, start.y)}
        if goal is not None and here and not any(leads_to(network, one, goal) for one in here):
            message = f"no roads lead from the start of '{actor}' to this position, so it has no effect"
            sink.add(NO_ROUTE, message, action.position.origin, severity=Severity.WARNING)


def _known(network: Network, values: Mapping[str, Value], position: Position | BoundPosition) -> bool:
    """Return whether a position is off the lanes, or in a lane that exists."""
    if not isinstance(position, LanePositionWord):
        return True
    return is_bound(network, position, number_value(position.s, values))


def _check_lane(plan: Plan, network: Network, position: RoutePosition, place: InRouteLane, sink: Diagnostics) -> None:
    values = parameter_values(plan.parameters)
    if not all(_known(network, values, one.position) for one in position.route.waypoints):
        return  # reported by binding
    at, lane, s, _ = place_on_route(network, values, position)
    if lane != 0 and not lane_exists(network.tables, at, lane, s):
        road = network.road_ids[at]
        there = ", ".join(str(one.lane) for one in network.lanes_at(road, s) if one.lane != 0)
        message = f"the route's road '{road}' has no lane {lane} at s = {s:g} m"
        sink.add(UNKNOWN_LANE, message, place.place_of("lane"), hint=f"lanes there: {there or 'none'}")
