"""Conditions on entities."""

from __future__ import annotations

from scenario_compiler.engine import opcodes as op
from scenario_compiler.engine.clearance import CLEARANCE_FREESPACE, CLEARANCE_OPPOSITE
from scenario_compiler.engine.program.conditions.family import RULES, Family
from scenario_compiler.engine.program.draft import ConditionRow, Draft
from scenario_compiler.engine.program.frames import FRAMES
from scenario_compiler.engine.program.positions import add_position
from scenario_compiler.engine.watching import (
    WATCH_ACCELERATION,
    WATCH_AT_END,
    WATCH_MOTION,
    WATCH_OFF_ROAD,
    WATCH_STILL,
)
from scenario_compiler.vocabulary.conditions import (
    AccelerationCondition,
    AngleCondition,
    CollisionCondition,
    DistanceCondition,
    EndOfRoadCondition,
    OffroadCondition,
    PositionDistanceCondition,
    ReachPositionCondition,
    RelativeAngleCondition,
    RelativeClearanceCondition,
    RelativeSpeedCondition,
    SpeedCondition,
    StandstillCondition,
    TimeHeadwayCondition,
    TimeToCollisionCondition,
    TraveledDistanceCondition,
)
from scenario_compiler.vocabulary.conditions.measuring import Direction, DistanceType

MEASURES: dict[DistanceType, int] = {
    "euclidianDistance": op.MEASURE_STRAIGHT,
    "longitudinal": op.MEASURE_ALONG,
    "lateral": op.MEASURE_ACROSS,
}
PARTS: dict[Direction, int] = {
    "total": op.PART_TOTAL,
    "longitudinal": op.PART_ALONG,
    "lateral": op.PART_ACROSS,
    "vertical": op.PART_UP,
}
ANGLES = {"heading": op.ANGLE_HEADING, "pitch": op.ANGLE_PITCH, "roll": op.ANGLE_ROLL}
KINDS = {
    "": op.KIND_ANY,
    "vehicle": op.KIND_VEHICLE,
    "pedestrian": op.KIND_PEDESTRIAN,
    "miscellaneous": op.KIND_THING,
}
LANES_AWAY = 1 << 20
"""Number of lanes that no road has: the end of a range without one."""

Gap = TimeHeadwayCondition | DistanceCondition | TimeToCollisionCondition | PositionDistanceCondition


def _gap(word: Gap, kind: int, other: int, position: int) -> ConditionRow:
    return ConditionRow(
        kind,
        RULES[word.rule],
        word.below,
        word.entity,
        other=other,
        mode=4 * FRAMES[word.coordinates] + MEASURES[word.distance],
        flags=1 if word.freespace else 0,
        position=position,
    )


def _time_headway(draft: Draft, word: TimeHeadwayCondition) -> ConditionRow:
    return _gap(word, op.CONDITION_TIME_HEADWAY, draft.entities[word.to], op.NONE)


def _distance(draft: Draft, word: DistanceCondition) -> ConditionRow:
    return _gap(word, op.CONDITION_DISTANCE, draft.entities[word.to], op.NONE)


def _position_distance(draft: Draft, word: PositionDistanceCondition) -> ConditionRow:
    return _gap(word, op.CONDITION_POSITION_DISTANCE, op.NONE, add_position(draft, word.position))


def _time_to_collision(draft: Draft, word: TimeToCollisionCondition) -> ConditionRow:
    """Raise ValueError where neither an entity nor a position is named."""
    draft.program.watches[0] |= WATCH_MOTION
    if word.to:
        return _gap(word, op.CONDITION_TIME_TO_COLLISION, draft.entities[word.to], op.NONE)
    if word.position is None:
        raise ValueError("a time to collision is to an entity or a position")
    return _gap(word, op.CONDITION_TIME_TO_COLLISION, op.NONE, add_position(draft, word.position))


def _part(draft: Draft, direction: Direction) -> int:
    """Return the code of a part of a motion, and let it be measured."""
    if direction != "total":
        draft.program.watches[0] |= WATCH_MOTION
    return PARTS[direction]


def _speed(draft: Draft, word: SpeedCondition) -> ConditionRow:
    part = _part(draft, word.direction)
    return ConditionRow(op.CONDITION_SPEED, RULES[word.rule], word.value, word.entity, mode=part)


def _relative_speed(draft: Draft, word: RelativeSpeedCondition) -> ConditionRow:
    part, other = _part(draft, word.direction), draft.entities[word.to]
    return ConditionRow(op.CONDITION_RELATIVE_SPEED, RULES[word.rule], word.value, word.entity, other=other, mode=part)


def _acceleration(draft: Draft, word: AccelerationCondition) -> ConditionRow:
    draft.program.watches[0] |= WATCH_MOTION | WATCH_ACCELERATION
    part = PARTS[word.direction]
    return ConditionRow(op.CONDITION_ACCELERATION, RULES[word.rule], word.value, word.entity, mode=part)


def _reach_position(draft: Draft, word: ReachPositionCondition) -> ConditionRow:
    return ConditionRow(
        op.CONDITION_REACH_POSITION,
        value=word.tolerance,
        entity=word.entity,
        position=add_position(draft, word.position),
    )


def _traveled_distance(draft: Draft, word: TraveledDistanceCondition) -> ConditionRow:
    del draft
    return ConditionRow(op.CONDITION_TRAVELED_DISTANCE, op.RULE_GREATER_OR_EQUAL, word.distance, word.entity)


def _standstill(draft: Draft, word: StandstillCondition) -> ConditionRow:
    draft.program.watches[0] |= WATCH_STILL
    return ConditionRow(op.CONDITION_STANDSTILL, op.RULE_GREATER, word.duration, word.entity)


def _off_road(draft: Draft, word: OffroadCondition) -> ConditionRow:
    draft.program.watches[0] |= WATCH_OFF_ROAD
    return ConditionRow(op.CONDITION_OFF_ROAD, op.RULE_GREATER_OR_EQUAL, word.duration, word.entity)


def _end_of_road(draft: Draft, word: EndOfRoadCondition) -> ConditionRow:
    draft.program.watches[0] |= WATCH_AT_END
    return ConditionRow(op.CONDITION_END_OF_ROAD, op.RULE_GREATER_OR_EQUAL, word.duration, word.entity)


def _collision(draft: Draft, word: CollisionCondition) -> ConditionRow:
    other = draft.entities[word.with_entity] if word.with_entity else op.NONE
    return ConditionRow(op.CONDITION_COLLISION, entity=word.entity, other=other, mode=KINDS[word.with_type])


def _clearance(draft: Draft, word: RelativeClearanceCondition) -> ConditionRow:
    others = draft.members(draft.entities[one] for one in word.of)
    draft.members(
        end
        for lanes in word.lanes
        for end in (
            -LANES_AWAY if lanes.least is None else lanes.least,
            LANES_AWAY if lanes.greatest is None else lanes.greatest,
        )
    )
    flags = (CLEARANCE_FREESPACE if word.freespace else 0) | (CLEARANCE_OPPOSITE if word.opposite_lanes else 0)
    const = (word.forward, word.backward)
    return ConditionRow(op.CONDITION_CLEARANCE, entity=word.entity, other=others, flags=flags, const=const)


def _angle(draft: Draft, word: AngleCondition) -> ConditionRow:
    del draft
    mode = 4 * FRAMES[word.coordinates] + ANGLES[word.kind]
    return ConditionRow(op.CONDITION_ANGLE, value=word.value, entity=word.entity, mode=mode, const=(word.tolerance,))


def _relative_angle(draft: Draft, word: RelativeAngleCondition) -> ConditionRow:
    return ConditionRow(
        op.CONDITION_RELATIVE_ANGLE,
        value=word.value,
        entity=word.entity,
        other=draft.entities[word.to],
        mode=ANGLES[word.kind],
        const=(word.tolerance,),
    )


CONDITIONS: Family = {
    TimeHeadwayCondition: _time_headway,
    DistanceCondition: _distance,
    PositionDistanceCondition: _position_distance,
    TimeToCollisionCondition: _time_to_collision,
    SpeedCondition: _speed,
    RelativeSpeedCondition: _relative_speed,
    AccelerationCondition: _acceleration,
    ReachPositionCondition: _reach_position,
    TraveledDistanceCondition: _traveled_distance,
    StandstillCondition: _standstill,
    OffroadCondition: _off_road,
    EndOfRoadCondition: _end_of_road,
    CollisionCondition: _collision,
    RelativeClearanceCondition: _clearance,
    AngleCondition: _angle,
    RelativeAngleCondition: _relative_angle,
}
