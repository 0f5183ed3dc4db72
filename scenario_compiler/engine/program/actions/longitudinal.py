"""Actions on an entity's speed."""

from __future__ import annotations

from scenario_compiler.engine import opcodes as op
from scenario_compiler.engine.program.actions.family import SHAPES, Family
from scenario_compiler.engine.program.draft import ActionRow, Draft
from scenario_compiler.vocabulary.actions import SpeedAction


def _speed(draft: Draft, word: SpeedAction, actor: int) -> ActionRow:
    del draft, actor
    return ActionRow(op.ACTION_SPEED, (word.to, word.over_time), shape=SHAPES[word.shape])


ACTIONS: Family = {SpeedAction: _speed}
