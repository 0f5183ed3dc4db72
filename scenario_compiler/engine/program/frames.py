"""Codes of the coordinate systems in which actions and conditions measure."""

from __future__ import annotations

from scenario_compiler.engine import opcodes as op
from scenario_compiler.vocabulary.conditions.measuring import CoordinateSystem

FRAMES: dict[CoordinateSystem, int] = {
    "entity": op.FRAME_ENTITY,
    "lane": op.FRAME_LANE,
    "road": op.FRAME_ROAD,
    "trajectory": op.FRAME_TRAJECTORY,
    "world": op.FRAME_WORLD,
}
