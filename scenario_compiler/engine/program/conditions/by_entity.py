"""Conditions on entities."""

from __future__ import annotations

from scenario_compiler.engine import opcodes as op
from scenario_compiler.engine.program.conditions.family import RULES, Family
from scenario_compiler.engine.program.draft import ConditionRow, Draft
from scenario_compiler.engine.program.positions import add_position
from scenario_compiler.vocabulary.conditions import (
    DistanceCondition,
    ReachPositionCondition,
    SpeedCondition,
    StandstillCondition,
    TimeHeadwayCondition,
    TimeToCollisionCondition,
    TraveledDistanceCondition,
)

Between = TimeHeadwayCondition | DistanceCondition | TimeToCollisionCondition


def _between(draft: Draft, word: Between, kind: int) -> ConditionRow:
    return ConditionRow(kind, value=word.below, entity=word.entity, other=draft.entities[word.to])


def _time_headway(draft: Draft, word: TimeHeadwayCondition) -> ConditionRow:
    return _between(draft, word, op.CONDITION_TIME_HEADWAY)


def _distance(draft: Draft, word: DistanceCondition) -> ConditionRow:
    return _between(draft, word, op.CONDITION_DISTANCE)


def _time_to_collision(draft: Draft, word: TimeToCollisionCondition) -> ConditionRow:
    return _between(draft, word, op.CONDITION_TIME_TO_COLLISION)


def _speed(draft: Draft, word: SpeedCondition) -> ConditionRow:
    del draft
    return ConditionRow(op.CONDITION_SPEED, RULES[word.rule], word.value, word.entity)


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
    del draft
    return ConditionRow(op.CONDITION_STANDSTILL, op.RULE_GREATER_OR_EQUAL, word.duration, word.entity)


CONDITIONS: Family = {
    TimeHeadwayCondition: _time_headway,
    DistanceCondition: _distance,
    TimeToCollisionCondition: _time_to_collision,
    SpeedCondition: _speed,
    ReachPositionCondition: _reach_position,
    TraveledDistanceCondition: _traveled_distance,
    StandstillCondition: _standstill,
}
