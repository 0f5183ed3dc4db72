"""Conditions on the run as a whole."""

from __future__ import annotations

from scenario_compiler.engine import opcodes as op
from scenario_compiler.engine.program.conditions.family import RULES, Family
from scenario_compiler.engine.program.draft import ConditionRow, Draft
from scenario_compiler.engine.program.world import variable_value
from scenario_compiler.vocabulary.conditions import (
    ElementStateCondition,
    EventCondition,
    LaneConfidenceCondition,
    SensorHealthCondition,
    SimulationTimeCondition,
    TakeoverStateCondition,
    TimeOfDayCondition,
    TrafficSignalCondition,
    TrafficSignalControllerCondition,
    UserDefinedValueCondition,
    VariableCondition,
)
from scenario_compiler.vocabulary.variables import seconds_of

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

NAMED_EVENT = "event by its name alone"
"""Kind under which events are found without the names around them."""

ELEMENT_STATES = {
    "standbyState": 1.0 * op.STANDBY,
    "runningState": 1.0 * op.RUNNING,
    "completeState": 1.0 * op.COMPLETE,
}
TRANSITIONS = {
    "startTransition": op.TRANSITION_START,
    "endTransition": op.TRANSITION_END,
    "stopTransition": op.TRANSITION_STOP,
    "skipTransition": op.TRANSITION_SKIP,
}


def _simulation_time(draft: Draft, word: SimulationTimeCondition) -> ConditionRow:
    del draft
    return ConditionRow(op.CONDITION_TIME, RULES[word.rule], word.after)


def _lane_confidence(draft: Draft, word: LaneConfidenceCondition) -> ConditionRow:
    del draft
    return ConditionRow(op.CONDITION_LANE_CONFIDENCE, value=word.below, other=SIDES[word.side])


def _sensor_health(draft: Draft, word: SensorHealthCondition) -> ConditionRow:
    del draft
    return ConditionRow(op.CONDITION_SENSOR_HEALTH, value=word.below)


def _event(draft: Draft, word: EventCondition) -> ConditionRow:
    del draft
    rule, state = EVENT_STATES[word.state]
    return ConditionRow(op.CONDITION_ELEMENT_STATE, rule, state, awaits=(NAMED_EVENT, word.name))


def _element_state(draft: Draft, word: ElementStateCondition) -> ConditionRow:
    del draft
    awaits = (word.kind, word.element)
    if word.state in TRANSITIONS:
        return ConditionRow(op.CONDITION_TRANSITION, mode=TRANSITIONS[word.state], awaits=awaits)
    any_suffices = 1 if word.state == "runningState" else 0
    state = ELEMENT_STATES[word.state]
    return ConditionRow(op.CONDITION_ELEMENT_STATE, op.RULE_EQUAL, state, mode=any_suffices, awaits=awaits)


def _time_of_day(draft: Draft, word: TimeOfDayCondition) -> ConditionRow:
    del draft
    return ConditionRow(op.CONDITION_TIME_OF_DAY, RULES[word.rule], seconds_of(word.date_time))


def _variable(draft: Draft, word: VariableCondition) -> ConditionRow:
    at, variable = draft.variables[word.variable]
    value = variable_value(draft, variable, word.value)
    return ConditionRow(op.CONDITION_VARIABLE, RULES[word.rule], value, other=at)


def _user_value(draft: Draft, word: UserDefinedValueCondition) -> ConditionRow:
    """Make a condition that is never true: no other program gives values to a run."""
    del draft, word
    return ConditionRow(op.CONDITION_USER_VALUE)


def _signal(draft: Draft, word: TrafficSignalCondition) -> ConditionRow:
    return ConditionRow(op.CONDITION_SIGNAL, other=draft.signal(word.signal), mode=draft.texts[word.state])


def _signal_phase(draft: Draft, word: TrafficSignalControllerCondition) -> ConditionRow:
    controller = draft.controllers[word.controller]
    return ConditionRow(op.CONDITION_SIGNAL_PHASE, other=controller, mode=draft.texts[word.phase])


def _takeover_state(draft: Draft, word: TakeoverStateCondition) -> ConditionRow:
    del draft
    return ConditionRow(op.CONDITION_TAKEOVER_STATE, op.RULE_EQUAL, other=STATES[word.state])


CONDITIONS: Family = {
    SimulationTimeCondition: _simulation_time,
    LaneConfidenceCondition: _lane_confidence,
    SensorHealthCondition: _sensor_health,
    EventCondition: _event,
    TakeoverStateCondition: _takeover_state,
    ElementStateCondition: _element_state,
    TimeOfDayCondition: _time_of_day,
    VariableCondition: _variable,
    UserDefinedValueCondition: _user_value,
    TrafficSignalCondition: _signal,
    TrafficSignalControllerCondition: _signal_phase,
}
