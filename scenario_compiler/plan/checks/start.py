"""Checks that the ego is a vehicle, and can drive at its start."""

from __future__ import annotations

from scenario_compiler.diagnostics import Code, Diagnostics, Severity
from scenario_compiler.plan.binding import drivable_at, is_bound
from scenario_compiler.plan.model import Plan
from scenario_compiler.plan.provenance import place_of
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.entities import THINGS
from scenario_compiler.vocabulary.positions import LanePositionWord

NOT_DRIVABLE = Code(
    "SC380",
    "start-not-drivable",
    "The ego vehicle starts on a lane that is not for driving, such as a shoulder or a sidewalk. This is possible, "
    "but the automation will find no lane to follow.\n\n"
    '    <start><lane road="3" lane="-3" s="20"/></start>     lane -3 is a sidewalk; -1 is for driving',
    Severity.WARNING,
)
EGO_NOT_A_VEHICLE = Code(
    "SC534",
    "ego-not-a-vehicle",
    "The model of the automated vehicle is a pedestrian or an object, which has neither wheels nor pedals.\n\n"
    '    <ego model="walker.pedestrian.0001">     model="vehicle.audi.tt"\n\n'
    "Choose a vehicle: a car, van, truck, bus, motorbike or bicycle. `list` and docs/names.md have the models.",
)


def check_start(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Report an ego that is not a vehicle, and one that starts on a lane that is not drivable."""
    if plan.controller is not None and plan.ego.vehicle.category in ("pedestrian", *THINGS):
        model, place = plan.ego.vehicle, place_of(plan, f"entities/{plan.ego.id}")
        sink.add(EGO_NOT_A_VEHICLE, f"the automated vehicle is '{model.name}', a {model.category}", place)
    start = None if plan.controller is None else plan.ego.start
    if not isinstance(start, LanePositionWord) or not isinstance(start.s, float):
        return
    if is_bound(network, start, start.s) and not drivable_at(network, start.road, start.lane, start.s):
        message = f"'{plan.ego.id}' starts on lane {start.lane} of road '{start.road}', which is not for driving"
        sink.add(NOT_DRIVABLE, message, place_of(plan, f"entities/{plan.ego.id}"))
