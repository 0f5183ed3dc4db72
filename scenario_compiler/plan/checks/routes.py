"""Checks that the places of routes are in lanes that are known before the run."""

from __future__ import annotations

from scenario_compiler.diagnostics import Code, Diagnostics, Severity
from scenario_compiler.plan.binding import AT_USE
from scenario_compiler.plan.model import Plan
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.actions import AcquirePositionAction
from scenario_compiler.vocabulary.positions import BoundPosition, FreePosition, Position, RouteWord

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
    """Warn of waypoints and positions to acquire to which no route can be planned."""
    del network
    for word in plan.words():
        if isinstance(word, RouteWord):
            for waypoint in word.waypoints:
                _check(waypoint.position, "the route leaves out this waypoint", sink)
        elif isinstance(word, AcquirePositionAction):
            _check(word.position, "there is no route to this position", sink)


def _check(position: Position | BoundPosition, so: str, sink: Diagnostics) -> None:
    if isinstance(position, AT_USE) and not isinstance(position, FreePosition):
        message = f"{so}: the lane of <{position.word}> is known only during the run"
        sink.add(NOT_IN_A_LANE, message, position.origin, severity=Severity.WARNING)
