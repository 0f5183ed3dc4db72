"""Actions on an entity's speed, and on its distance to another along the road."""

from __future__ import annotations

from scenario_compiler.engine import opcodes as op
from scenario_compiler.engine.program.actions.family import SHAPES, Family, dynamics_of, flags_of, limits_of
from scenario_compiler.engine.program.draft import ActionRow, Draft, Slot
from scenario_compiler.engine.program.frames import FRAMES
from scenario_compiler.engine.program.positions import add_position
from scenario_compiler.vocabulary.actions import (
    FinalSpeed,
    LongitudinalDistanceAction,
    RelativeSpeedAction,
    SpeedAction,
    SpeedProfileAction,
    SynchronizeAction,
)


def _speed(draft: Draft, word: SpeedAction, actor: int) -> ActionRow:
    del draft, actor
    value, dimension = dynamics_of(word.over_time, word.dynamics)
    return ActionRow(op.ACTION_SPEED, (word.to, value), shape=SHAPES[word.shape], dimension=dimension)


def _relative_speed(draft: Draft, word: RelativeSpeedAction, actor: int) -> ActionRow:
    del actor
    value, dimension = dynamics_of(word.over_time, word.dynamics)
    return ActionRow(
        op.ACTION_RELATIVE_SPEED,
        (word.value, value),
        shape=SHAPES[word.shape],
        dimension=dimension,
        other=draft.entities[word.to],
        mode=op.MODE_DELTA if word.kind == "delta" else op.MODE_FACTOR,
        flags=flags_of((op.FLAG_CONTINUOUS, word.continuous)),
    )


def _speed_profile(draft: Draft, word: SpeedProfileAction, actor: int) -> ActionRow:
    del actor
    entries: list[Slot] = []
    for entry in word.entries:
        entries += [entry.speed, -1.0 if entry.time is None else entry.time]
    return ActionRow(
        op.ACTION_SPEED_PROFILE,
        (0.0, 0.0, *limits_of(word.limits), *entries),
        lanes=len(word.entries),
        other=draft.entities[word.to] if word.to else op.NONE,
        flags=flags_of((op.FLAG_SMOOTH, word.following == "follow")),
    )


def _keep_distance(draft: Draft, word: LongitudinalDistanceAction, actor: int) -> ActionRow:
    del actor
    given = word.time_gap if word.time_gap is not None else word.distance
    return ActionRow(
        op.ACTION_KEEP_DISTANCE,
        (0.0 if given is None else given, 0.0, *limits_of(word.limits)),
        other=draft.entities[word.to],
        mode=FRAMES[word.coordinates],
        flags=flags_of(
            (op.FLAG_CONTINUOUS, word.continuous),
            (op.FLAG_FREESPACE, word.freespace),
            (op.FLAG_TIME_GAP, word.time_gap is not None),
            (op.FLAG_PRESENT, given is None),
            (op.FLAG_LIMITED, word.limits is not None),
            (op.FLAG_BEHIND, word.displacement == "trailingReferencedEntity"),
            (op.FLAG_AHEAD, word.displacement == "leadingReferencedEntity"),
        ),
    )


def _synchronize(draft: Draft, word: SynchronizeAction, actor: int) -> ActionRow:
    del actor
    p = draft.program
    final = word.final_speed
    point = len(p.point_position)
    p.point_position.append(add_position(draft, word.master_position.position))
    p.point_const.append(draft.block(-1.0))
    return ActionRow(
        op.ACTION_SYNCHRONIZE,
        (
            0.0 if final is None else final.value,
            0.0,
            word.tolerance,
            word.master_tolerance,
            -1.0 if final is None or final.steady_time is None else final.steady_time,
            -1.0 if final is None or final.steady_distance is None else final.steady_distance,
        ),
        lanes=draft.entities[final.relative_to] if final is not None and final.relative_to else 0,
        other=draft.entities[word.master],
        mode=_final_mode(final),
        position=add_position(draft, word.position),
        point=point,
        points=1,
    )


def _final_mode(final: FinalSpeed | None) -> int:
    if final is None:
        return op.FINAL_NONE
    if not final.relative_to:
        return op.FINAL_ABSOLUTE
    return op.FINAL_DELTA if final.kind == "delta" else op.FINAL_FACTOR


ACTIONS: Family = {
    SpeedAction: _speed,
    RelativeSpeedAction: _relative_speed,
    SpeedProfileAction: _speed_profile,
    LongitudinalDistanceAction: _keep_distance,
    SynchronizeAction: _synchronize,
}
