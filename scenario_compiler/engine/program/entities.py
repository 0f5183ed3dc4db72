"""Entities: their kinds of motion, their vehicles, their start positions and the order in which they are placed."""

from __future__ import annotations

from math import radians

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.rows import Slot
from scenario_compiler.engine.program.builder import ProgramBuilder
from scenario_compiler.engine.program.guides import add_legs
from scenario_compiler.engine.program.positions import add_position
from scenario_compiler.engine.traffic.conflicts import conflicts_of
from scenario_compiler.plan.model import Entity
from scenario_compiler.vocabulary.actions import ConnectTrailerAction
from scenario_compiler.vocabulary.entities import THINGS, Category, Vehicle
from scenario_compiler.vocabulary.storyboard import Storyboard

MOTIONS = {
    "ego": op.MOTION_BICYCLE,
    "static": op.MOTION_STATIC,
    "dynamic": op.MOTION_SCRIPTED,
    "traffic": op.MOTION_TRAFFIC,
    "walker": op.MOTION_WALKER,
}

KINDS: dict[Category, int] = {
    "pedestrian": op.KIND_PEDESTRIAN,
    **dict.fromkeys(THINGS, op.KIND_THING),
}
"""Codes of the categories that are not vehicles."""

FOLLOW_EGO = (1.5, 2.0, 1.5, 2.0)
"""Car following of the automation: time gap, s; gap at standstill, m; acceleration and comfortable deceleration, m/s2.
Chosen; the same as the defaults of `vocabulary.entities.Follow`.
"""


def add_entities(draft: ProgramBuilder, *, posed: bool) -> None:
    """Append all entities; `posed` leaves the ego's motion to another program.

    Raises:
        ValueError: Start positions are relative to each other.
    """
    p = draft.program
    touched = touched_by_init(draft.plan.storyboard)
    for entity in draft.plan.entities:
        _add_entity(draft, entity, posed, touched)
    p.entity_count[0] = len(p.entity_motion)
    if draft.plan.entities and draft.plan.entities[0].kind == "ego":
        p.ego[0] = 0
    p.entity_order = _start_order(draft)
    p.traffic_count[0] = sum(1 for motion in p.entity_motion if motion in (op.MOTION_TRAFFIC, op.MOTION_WALKER))
    if p.traffic_count[0] > 0:
        p.conflict_first, p.conflict_road = conflicts_of(draft.network)


def touched_by_init(storyboard: Storyboard) -> set[str]:
    """Return the entities with an action in the init.

    Of the entities without a start position, only these are present when the run begins.
    """
    touched = {initial.entity for initial in storyboard.init}
    actions = [initial.action for initial in storyboard.init]
    return touched | {action.trailer for action in actions if isinstance(action, ConnectTrailerAction)}


def _towing(vehicle: Vehicle) -> tuple[float, float]:
    """Return the positions of a vehicle's hitch and coupler ahead of its reference point, m; by default its ends."""
    rear, front = vehicle.center - 0.5 * vehicle.length, vehicle.center + 0.5 * vehicle.length
    return rear if vehicle.hitch is None else vehicle.hitch, front if vehicle.coupler is None else vehicle.coupler


def vehicle_numbers(vehicle: Vehicle) -> tuple[float, ...]:
    """Return the numbers of a vehicle at the beginning of an entity's block, from slot E_LENGTH to E_MAX_SPEED."""
    return (
        *(vehicle.length, vehicle.width, vehicle.height, vehicle.wheelbase, vehicle.center),
        *(radians(vehicle.max_steer), vehicle.max_acceleration, vehicle.max_deceleration, vehicle.max_speed),
    )


def _add_entity(draft: ProgramBuilder, entity: Entity, posed: bool, touched: set[str]) -> None:
    p, vehicle = draft.program, entity.vehicle
    motion = MOTIONS[entity.kind]
    if posed and motion == op.MOTION_BICYCLE:
        motion = op.MOTION_POSED
    follow: tuple[Slot, Slot, Slot, Slot] = FOLLOW_EGO
    if entity.follow is not None:
        one = entity.follow
        follow = (one.time_gap, one.minimum_gap, one.acceleration, one.deceleration)
    p.entity_motion.append(motion)
    p.entity_type.append(KINDS.get(vehicle.category, op.KIND_VEHICLE))
    p.entity_follows.append(0 if entity.follow is None else 1)
    start = op.NONE if entity.start is None else add_position(draft, entity.start, entity.kind)
    p.entity_position.append(start)
    p.entity_present.append(1 if entity.start is not None or entity.id in touched else 0)
    p.entity_guide.append(add_legs(draft, entity.route))
    p.entity_seed.append(op.NONE if entity.seed is None else entity.seed)
    p.entity_const.append(
        draft.block(
            *vehicle_numbers(vehicle),
            entity.speed,
            entity.desired_speed,
            *follow,
            entity.share,
            *_towing(vehicle),
            radians(vehicle.pitch_gradient),
        )
    )


def _start_order(draft: ProgramBuilder) -> list[int]:
    """Return the entities in an order in which each comes after the one that its start refers to, random ones last."""
    p = draft.program
    order: list[int] = []
    waiting = list(range(len(p.entity_motion)))
    while waiting:
        ready = [i for i in waiting if _start_follows(p, i) in (op.NONE, *order)]
        fixed = [i for i in ready if not _starts_at_random(p, i)]
        ready = fixed or ready
        if not ready:
            names = ", ".join(draft.plan.entities[i].id for i in waiting)
            raise ValueError(f"the starts of {names} are relative to each other")
        order.extend(ready)
        waiting = [i for i in waiting if i not in ready]
    return order


def _start_follows(p: Program, i: int) -> int:
    """Return the entity that the start position of i is relative to, or NONE."""
    at = p.entity_position[i]
    return op.NONE if at < 0 else p.position_entity[at]


def _starts_at_random(p: Program, i: int) -> bool:
    at = p.entity_position[i]
    return at >= 0 and p.position_op[at] == op.POSITION_RANDOM
