"""Checks that the tyres hold the ego in the bends right behind its start."""

from __future__ import annotations

import math

from scenario_compiler.diagnostics import Code, Diagnostics, Severity
from scenario_compiler.plan.binding import is_bound
from scenario_compiler.plan.model import Plan
from scenario_compiler.plan.provenance import place_of
from scenario_compiler.roads import LanePosition, Network
from scenario_compiler.roads.lanes import lane_curvature, lane_row
from scenario_compiler.vocabulary.horizon import TYRES_HOLD
from scenario_compiler.vocabulary.positions import LanePositionWord
from scenario_compiler.vocabulary.scenario import parameter_values
from scenario_compiler.vocabulary.word import number_value

TOO_FAST = Code(
    "SC535",
    "too-fast-for-bend",
    "The ego vehicle starts so near to a bend, or so far inside it, that even with full braking its tyres do not hold "
    "it there: it drifts out of its lane, whoever drives. On a dry road tyres hold 8.3 m/s^2 sideways, so that a bend "
    "with the radius r can be driven at most at the speed sqrt(8.3 r):\n\n"
    '    <ego speed="30"><start><lane road="7" lane="-1" s="0"/></start></ego>     r = 50 m: at most 20.4 m/s\n\n'
    "Give the ego a lower `speed`, or let it start further before the bend; the automation then slows down in time.",
    Severity.WARNING,
)

STEP = 2.0
"""Distance from one examined place to the next, m."""


def check_bends(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Warn of a bend ahead of the ego's start that it cannot be slow enough for, up to the first junction.

    The speed at the distance d from the start is at least sqrt(v^2 - 2 b d), where v is the ego's speed and b its
    greatest deceleration.
    """
    start = None if plan.controller is None else plan.ego.start
    if (
        not isinstance(start, LanePositionWord)
        or not isinstance(start.s, float)
        or not is_bound(network, start, start.s)
    ):
        return
    speed = number_value(plan.ego.speed, parameter_values(plan.parameters))
    harder = 2.0 * plan.ego.vehicle.max_deceleration
    here: LanePosition | None = LanePosition(start.road, start.lane, start.s)
    driven = 0.0
    while here is not None and here.lane != 0 and speed * speed > harder * driven:
        if driven > 0.0 and network.road(here.road).junction is not None:
            return
        bend = _curvature(network, here)
        if (speed * speed - harder * driven) * bend > TYRES_HOLD:
            message = (
                f"'{plan.ego.id}' starts at {speed:g} m/s, and {driven:.0f} m ahead its lane has a radius of "
                f"{1 / bend:.0f} m, where the tyres hold up to {math.sqrt(TYRES_HOLD / bend):.1f} m/s"
            )
            sink.add(TOO_FAST, message, place_of(plan, f"entities/{plan.ego.id}"))
            return
        driven += STEP
        here = network.next(here, STEP)


def _curvature(network: Network, place: LanePosition) -> float:
    """Return the curvature of a lane's centre, 1/m, at least 0."""
    n, road = network.tables, network.road_index(place.road)
    return abs(lane_curvature(n, road, place.lane, lane_row(n, road, place.lane, place.s), place.s))
