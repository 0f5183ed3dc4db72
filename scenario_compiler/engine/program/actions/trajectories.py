"""Actions along trajectories."""

from __future__ import annotations

from scenario_compiler.engine import opcodes as op
from scenario_compiler.engine.program.actions.family import Family
from scenario_compiler.engine.program.draft import ActionRow, Draft
from scenario_compiler.engine.program.positions import add_position
from scenario_compiler.engine.program.tracks import add_track
from scenario_compiler.vocabulary.actions import FollowTrajectoryAction

TIMINGS = {"absolute": op.TIMING_ABSOLUTE, "relative": op.TIMING_RELATIVE}


def _follow_trajectory(draft: Draft, word: FollowTrajectoryAction, actor: int) -> ActionRow:
    del actor
    timing = word.timing
    scale, offset = (1.0, 0.0) if timing is None else (timing.scale, timing.offset)
    return ActionRow(
        op.ACTION_FOLLOW_TRAJECTORY,
        (word.begin, offset, scale),
        other=add_track(draft, word.trajectory, add_position),
        mode=op.TIMING_NONE if timing is None else TIMINGS[timing.domain],
        flags=op.FOLLOW_SMOOTHLY if word.following == "follow" else 0,
    )


ACTIONS: Family = {FollowTrajectoryAction: _follow_trajectory}
