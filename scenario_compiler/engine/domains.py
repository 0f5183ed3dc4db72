"""Which domain of an entity's motion an action holds: its speed, its lane, or both.

An action that starts ends the one that holds the same domain of the same entity, wherever that stands (esmini 3.6).
"""

from __future__ import annotations

from scenario_compiler.engine.opcodes import (
    ACTION_FOLLOW_PATH,
    ACTION_FOLLOW_TRAJECTORY,
    ACTION_KEEP_DISTANCE,
    ACTION_KEEP_LATERAL_DISTANCE,
    ACTION_LANE_CHANGE,
    ACTION_LANE_CHANGE_TO,
    ACTION_LANE_OFFSET,
    ACTION_LIMITED_LANE_OFFSET,
    ACTION_RELATIVE_SPEED,
    ACTION_SPEED,
    ACTION_SPEED_PROFILE,
    ACTION_SYNCHRONIZE,
)
from scenario_compiler.marker import compiled


@compiled
def holds_speed(op: int) -> int:
    """Return 1 where an action of this kind decides on its entity's speed."""
    if op in (ACTION_SPEED, ACTION_RELATIVE_SPEED, ACTION_SPEED_PROFILE, ACTION_KEEP_DISTANCE, ACTION_SYNCHRONIZE):
        return 1
    return 0


@compiled
def holds_lane(op: int) -> int:
    """Return 1 where an action of this kind decides on where its entity is across the road."""
    if op in (ACTION_LANE_CHANGE, ACTION_LANE_CHANGE_TO, ACTION_FOLLOW_PATH, ACTION_FOLLOW_TRAJECTORY):
        return 1
    if op in (ACTION_LANE_OFFSET, ACTION_LIMITED_LANE_OFFSET, ACTION_KEEP_LATERAL_DISTANCE):
        return 1
    return 0
