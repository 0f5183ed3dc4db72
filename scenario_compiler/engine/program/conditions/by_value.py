"""Conditions on the run as a whole."""

from __future__ import annotations

from scenario_compiler.engine import opcodes as op
from scenario_compiler.engine.program.conditions.family import Family
from scenario_compiler.engine.program.draft import ConditionRow, Draft
from scenario_compiler.vocabulary.conditions import (
    EventCondition,
    LaneConfidenceCondition,
    SensorHealthCondition,
    SimulationTimeCondition,
    TakeoverStateCondition,
)

SIDES = {"both": op.SIDE_BOTH, "either": op.SIDE_EITHER, "left": op.SIDE_LEFT, "right": op.SIDE_RIGHT}
STATES = {
    "automated": op.TAKEOVER_AUTOMATED,
    "warning": op.TAKEOVER_WARNING,
    "request": op.TAKEOVER_REQUEST,
    "escalation": op.TAKEOVER_ESCALATION,
    "manual": op.TAKEOVER_MANUAL,
    "minimum_risk": op.TAKEOVER_MINIMUM_RISK,
    "standstill": op.TAKEOVER_STANDSTILL,
}
EVENT_STATES: dict[str, tuple[int, float]] = {
    "started": (op.RULE_GREATER_OR_EQUAL, 1.0 * op.RUNNING),
    "running": (op.RULE_EQUAL, 1.0 * op.RUNNING),
    "complete": (op.RULE_EQUAL, 1.0 * op.COMPLETE),
}
"""How an event's element is compared with a state."""


def _simulation_time(draft: Draft, word: SimulationTimeCondition) -> ConditionRow:
    del draft
    return ConditionRow(op.CONDITION_TIME, op.RULE_GREATER_OR_EQUAL, word.after)


def _lane_confidence(draft: Draft, word: LaneConfidenceCondition) -> ConditionRow:
    del draft
    return ConditionRow(op.CONDITION_LANE_CONFIDENCE, value=word.below, other=SIDES[word.side])


def _sensor_health(draft: Draft, word: SensorHealthCondition) -> ConditionRow:
    del draft
    return ConditionRow(op.CONDITION_SENSOR_HEALTH, value=word.below)


def _event(draft: Draft, word: EventCondition) -> ConditionRow:
    del draft
    rule, state = EVENT_STATES[word.state]
    return ConditionRow(op.CONDITION_ELEMENT_STATE, rule, state, awaits=word.name)


def _takeover_state(draft: Draft, word: TakeoverStateCondition) -> ConditionRow:
    del draft
    return ConditionRow(op.CONDITION_TAKEOVER_STATE, op.RULE_EQUAL, other=STATES[word.state])


CONDITIONS: Family = {
    SimulationTimeCondition: _simulation_time,
    LaneConfidenceCondition: _lane_confidence,
    SensorHealthCondition: _sensor_health,
    EventCondition: _event,
    TakeoverStateCondition: _takeover_state,
}
