"""Actions along a path of one's own."""

from __future__ import annotations

from scenario_compiler.engine import opcodes as op
from scenario_compiler.engine.program.actions.family import Family
from scenario_compiler.engine.program.draft import ActionRow, Draft
from scenario_compiler.engine.program.positions import add_position
from scenario_compiler.vocabulary.actions import FollowPathAction
from scenario_compiler.vocabulary.actions.path import Path


def _follow_path(draft: Draft, word: FollowPathAction | Path, actor: int) -> ActionRow:
    del actor
    p = draft.program
    first = len(p.point_position)
    for point in word.points:
        p.point_position.append(add_position(draft, point.position))
        p.point_const.append(draft.block(-1.0 if point.time is None else point.time))
    speed = -1.0 if word.speed is None else word.speed
    drives_on = 1 if word.then == "drive" else 0
    return ActionRow(op.ACTION_FOLLOW_PATH, (speed, 0.0), point=first, points=len(word.points), drives_on=drives_on)


ACTIONS: Family = {FollowPathAction: _follow_path, Path: _follow_path}
