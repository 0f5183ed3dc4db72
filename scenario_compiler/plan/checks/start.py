"""Checks that the ego can drive at its start."""

from __future__ import annotations

from scenario_compiler.diagnostics import Code, Diagnostics, Severity
from scenario_compiler.plan.binding import drivable_at, is_bound
from scenario_compiler.plan.model import Plan
from scenario_compiler.plan.provenance import place_of
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.positions import LanePositionWord

NOT_DRIVABLE = Code(
    "SC380",
    "start-not-drivable",
    "The ego vehicle starts on a lane that is not for driving, such as a shoulder or a sidewalk. This is possible, "
    "but the automation will find no lane to follow.\n\n"
    '    <start><lane road="3" lane="-3" s="20"/></start>     lane -3 is a sidewalk; -1 is for driving',
    Severity.WARNING,
)


def check_start(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Warn if the ego starts on a lane that is not drivable."""
    start = None if plan.controller is None else plan.ego.start
    if not isinstance(start, LanePositionWord) or not isinstance(start.s, float):
        return
    if is_bound(network, start, start.s) and not drivable_at(network, start.road, start.lane, start.s):
        message = f"'{plan.ego.id}' starts on lane {start.lane} of road '{start.road}', which is not for driving"
        sink.add(NOT_DRIVABLE, message, place_of(plan, f"entities/{plan.ego.id}"))
