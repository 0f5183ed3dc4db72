"""Actions across the lanes."""

from __future__ import annotations

from scenario_compiler.engine import opcodes as op
from scenario_compiler.engine.program.actions.family import SHAPES, Family, dynamics_of, flags_of, limits_of
from scenario_compiler.engine.program.draft import ActionRow, Draft
from scenario_compiler.engine.program.frames import FRAMES
from scenario_compiler.engine.watching import WATCH_MOTION
from scenario_compiler.vocabulary.actions import (
    LaneChangeAction,
    LaneChangeToAction,
    LaneOffsetAction,
    LateralDistanceAction,
    LimitedLaneOffsetAction,
)


def _lane_change(draft: Draft, word: LaneChangeAction, actor: int) -> ActionRow:
    del actor
    value, dimension = dynamics_of(word.over_time, word.dynamics)
    return ActionRow(
        op.ACTION_LANE_CHANGE,
        (word.offset, value),
        shape=SHAPES[word.shape],
        dimension=dimension,
        lanes=word.by,
        other=draft.entities[word.of] if word.of else op.NONE,
    )


def _lane_change_to(draft: Draft, word: LaneChangeToAction, actor: int) -> ActionRow:
    del draft, actor
    value, dimension = dynamics_of(word.over_time, word.dynamics)
    shape = SHAPES[word.shape]
    return ActionRow(op.ACTION_LANE_CHANGE_TO, (word.offset, value), shape=shape, dimension=dimension, lanes=word.lane)


def _lane_offset(draft: Draft, word: LaneOffsetAction, actor: int) -> ActionRow:
    del draft, actor
    return ActionRow(op.ACTION_LANE_OFFSET, (word.to, word.over_time), shape=SHAPES[word.shape])


def _limited_lane_offset(draft: Draft, word: LimitedLaneOffsetAction, actor: int) -> ActionRow:
    del actor
    return ActionRow(
        op.ACTION_LIMITED_LANE_OFFSET,
        (word.to, -1.0 if word.acceleration is None else word.acceleration),
        shape=SHAPES[word.shape],
        other=draft.entities[word.of] if word.of else op.NONE,
        flags=flags_of((op.FLAG_CONTINUOUS, word.continuous)),
    )


def _keep_lateral_distance(draft: Draft, word: LateralDistanceAction, actor: int) -> ActionRow:
    del actor
    draft.program.watches[0] |= WATCH_MOTION
    return ActionRow(
        op.ACTION_KEEP_LATERAL_DISTANCE,
        (0.0 if word.distance is None else word.distance, 0.0, *limits_of(word.limits)),
        other=draft.entities[word.to],
        mode=FRAMES[word.coordinates],
        flags=flags_of(
            (op.FLAG_CONTINUOUS, word.continuous),
            (op.FLAG_FREESPACE, word.freespace),
            (op.FLAG_PRESENT, word.distance is None),
            (op.FLAG_LIMITED, word.limits is not None),
            (op.FLAG_BEHIND, word.displacement == "rightToReferencedEntity"),
            (op.FLAG_AHEAD, word.displacement == "leftToReferencedEntity"),
        ),
    )


ACTIONS: Family = {
    LaneChangeAction: _lane_change,
    LaneChangeToAction: _lane_change_to,
    LaneOffsetAction: _lane_offset,
    LimitedLaneOffsetAction: _limited_lane_offset,
    LateralDistanceAction: _keep_lateral_distance,
}
