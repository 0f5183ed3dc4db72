"""Checks the references of actions on speeds, lanes and distances: another entity, one distance, existing lanes."""

from __future__ import annotations

from collections import Counter

from scenario_compiler.diagnostics import Code, Diagnostics, Severity
from scenario_compiler.plan.model import Plan
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.actions import (
    LaneChangeAction,
    LaneChangeToAction,
    LateralDistanceAction,
    LongitudinalDistanceAction,
    SynchronizeAction,
)
from scenario_compiler.vocabulary.positions import LanesAwayPosition
from scenario_compiler.vocabulary.traversal import walk

TO_ITSELF = Code(
    "SC270",
    "distance-to-itself",
    "An entity is to keep a distance to itself or to arrive together with itself, or a condition compares it with "
    "itself."
    '\n\n    <dynamic id="truck"> ... <do><keep_distance to="truck" distance="20"/></do>     to another entity',
)
TWO_DISTANCES = Code(
    "SC271",
    "distance-and-gap",
    "An action specifies both a distance and a time gap, of which only one can be kept, or neither.\n\n"
    '    <keep_distance to="truck" time_gap="2"/>',
)
TWO_STEADY_STATES = Code(
    "SC272",
    "two-steady-states",
    "The last stretch before an arrival is specified by both time and distance; only one of them is allowed.\n\n"
    '    <final_speed value="12" steady_time="2"/>',
)
NO_SUCH_LANE = Code(
    "SC273",
    "no-such-lane",
    "The target of a lane change is a lane that no road of the map has, or the change is by more lanes than any road "
    "of the map has beside another, so the action has no effect. A position that counts more lanes than any road has "
    "is in the outermost lane.\n\n"
    '    <lane_change_to lane="-2" over_time="3"/>     lanes to the right of the reference line are negative',
    Severity.WARNING,
)

OTHERS = {LongitudinalDistanceAction: "to", LateralDistanceAction: "to", SynchronizeAction: "master"}
"""Actions that only make sense with another entity, and the attribute that names it."""


def check_moves(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Report actions that refer to their own actor, give two distances, or need a lane that does not exist."""
    lanes, widest = set(network.tables.lane_id) - {0}, _most_lanes(network)
    for actor, action in plan.storyboard.actions():
        named = OTHERS.get(type(action))
        if named is not None and getattr(action, named) == actor:
            sink.add(TO_ITSELF, f"<{action.tag()}> of '{actor}' refers to '{actor}' itself", action.place_of(named))
        if isinstance(action, LongitudinalDistanceAction):
            if None not in (action.distance, action.time_gap):
                sink.add(TWO_DISTANCES, "both a distance and a time gap are given", action.place_of("time_gap"))
            elif action.distance is None and action.time_gap is None:
                sink.add(TWO_DISTANCES, "neither a distance nor a time gap is given", action.origin)
        if isinstance(action, SynchronizeAction) and action.final_speed is not None:
            final = action.final_speed
            if None not in (final.steady_time, final.steady_distance):
                message = "both a time and a distance of the steady state are given"
                sink.add(TWO_STEADY_STATES, message, final.place_of("steady_distance"))
        if isinstance(action, LaneChangeToAction) and lanes and action.lane not in lanes:
            sink.add(NO_SUCH_LANE, f"no road of the map has a lane {action.lane}", action.place_of("lane"))
        if isinstance(action, LaneChangeAction) and widest and abs(action.by) >= widest:
            message = f"no road of the map has the {abs(action.by) + 1} lanes that a change by {action.by} needs"
            sink.add(NO_SUCH_LANE, message, action.place_of("by"))
    for word in walk(plan.storyboard):
        if isinstance(word, LanesAwayPosition) and widest and abs(word.lanes) >= widest:
            message = (
                f"no road of the map has the {abs(word.lanes) + 1} lanes that a position {word.lanes} lanes away needs"
            )
            sink.add(NO_SUCH_LANE, message, word.place_of("lanes"))


def _most_lanes(network: Network) -> int:
    """Return the greatest number of lanes at a cross-section of a road, without the centre lane; 0 without roads."""
    tables = network.tables
    rows = Counter(section for section, lane in zip(tables.lane_section, tables.lane_id, strict=True) if lane != 0)
    return max(rows.values(), default=0)
