"""Actions across the lanes."""

from __future__ import annotations

from scenario_compiler.engine import opcodes as op
from scenario_compiler.engine.program.actions.family import SHAPES, Family
from scenario_compiler.engine.program.draft import ActionRow, Draft
from scenario_compiler.vocabulary.actions import LaneChangeAction, LaneOffsetAction


def _lane_change(draft: Draft, word: LaneChangeAction, actor: int) -> ActionRow:
    del draft, actor
    return ActionRow(op.ACTION_LANE_CHANGE, (0.0, word.over_time), shape=SHAPES[word.shape], lanes=word.by)


def _lane_offset(draft: Draft, word: LaneOffsetAction, actor: int) -> ActionRow:
    del draft, actor
    return ActionRow(op.ACTION_LANE_OFFSET, (word.to, word.over_time), shape=SHAPES[word.shape])


ACTIONS: Family = {LaneChangeAction: _lane_change, LaneOffsetAction: _lane_offset}
