"""Conditions on the run as a whole: time, storyboard elements, lane confidence, takeover, variables, signals."""

from __future__ import annotations

from typing import TYPE_CHECKING

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.program import ELEMENT, SIGNAL, SIGNAL_CONTROLLER, VARIABLE, Program
from scenario_compiler.engine.columns.rows import ConditionRow, ProgramDraft
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.surroundings import time_of_day
from scenario_compiler.engine.moves.signals import phase_holds
from scenario_compiler.engine.story.comparing import compare
from scenario_compiler.engine.story.entry import RULES, Condition, compared
from scenario_compiler.forms.declaration import index
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables

if TYPE_CHECKING:
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

ALL_ELEMENTS = 0
ANY_ELEMENT = 1
FIRST_TRANSITION = 2
"""Mode of a condition on elements: all states must match, or any; from the third on, a transition to wait for."""

TEXT_IS_NUMBER = 1
"""Mode of a condition on a variable that only texts which are numbers satisfy; those of others are below 0."""

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
"""Comparison of an event's element with a state, as rule and value."""

NAMED_EVENT = "event by its name alone"
"""Kind under which events are found by their name alone, without the names of their parents."""

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


@compiled
def states_compare(p: Program, st: State, c: int) -> int:
    """Return 1 if the states of the elements that a condition watches match: 1 is running, 2 complete.

    An action of several actors is several elements. All must match, or any of them with the mode ANY_ELEMENT.
    """
    any_suffices = p.condition_mode[c]
    limit = p.const[p.condition_const[c] + slot.C_VALUE]
    for e in range(p.condition_other[c], p.condition_other[c] + p.condition_flags[c] + 1):
        holds = compare(st, p.condition_rule[c], 1.0 * st.element_state[e], limit)
        if holds == any_suffices:
            return holds
    return 1 - any_suffices


@compiled
def transition_seen(p: Program, st: State, c: int, e: int, mark: int) -> int:
    """Return 1 if a condition sees a marked transition of an element in this frame.

    A transition during the execution of the actions is visible in the next frame. A transition during a pass of
    triggers is visible in the same pass to later elements of the storyboard, and in the next pass to earlier ones.
    """
    owner = p.condition_owner[c]
    frame = st.frame[0] if owner >= 0 else st.frame[0] + 1
    if mark == 2 * frame or mark == 2 * frame + 1:
        return 1
    return 1 if mark == 2 * frame - 1 and e >= owner else 0


@compiled
def transitions_seen(p: Program, st: State, c: int) -> int:
    """Return 1 if an element, or all elements of an action, have made the transition that a condition waits for."""
    kind = p.condition_mode[c] - FIRST_TRANSITION
    seen = 0
    for e in range(p.condition_other[c], p.condition_other[c] + p.condition_flags[c] + 1):
        if kind == op.TRANSITION_START:
            mark = st.element_started[e]
        elif kind == op.TRANSITION_END:
            mark = st.element_ended[e]
        elif kind == op.TRANSITION_STOP:
            mark = st.element_stopped[e]
        else:
            mark = st.element_skipped[e]
        if mark < 0:
            return 0
        if transition_seen(p, st, c, e, mark) == 1:
            seen = 1
    return seen


@compiled
def side_confidence(p: Program, st: State, c: int) -> float:
    """Return the lane confidence of a condition: that of a side, of the weaker side, or of the stronger side."""
    side = p.condition_other[c]
    if side == op.SIDE_LEFT:
        return st.conf_left[0]
    if side == op.SIDE_RIGHT:
        return st.conf_right[0]
    if side == op.SIDE_EITHER:
        return min(st.conf_left[0], st.conf_right[0])
    return max(st.conf_left[0], st.conf_right[0])


@compiled
def time_holds(n: RoadTables, p: Program, st: State, c: int, i: int) -> int:
    """Return 1 if the time satisfies the condition."""
    del n, i
    return compared(p, st, c, st.clock[0])


@compiled
def element_holds(n: RoadTables, p: Program, st: State, c: int, i: int) -> int:
    """Return 1 if elements are in a state, or make a transition."""
    del n, i
    if p.condition_mode[c] >= FIRST_TRANSITION:
        return transitions_seen(p, st, c)
    return states_compare(p, st, c)


@compiled
def lane_confidence_holds(n: RoadTables, p: Program, st: State, c: int, i: int) -> int:
    """Return 1 if the lane confidence satisfies the condition."""
    del n, i
    return compared(p, st, c, side_confidence(p, st, c))


@compiled
def sensor_health_holds(n: RoadTables, p: Program, st: State, c: int, i: int) -> int:
    """Return 1 if the camera's health satisfies the condition."""
    del n, i
    return compared(p, st, c, st.health[0])


@compiled
def takeover_state_holds(n: RoadTables, p: Program, st: State, c: int, i: int) -> int:
    """Return 1 if the takeover is in the condition's state."""
    del n, i
    return 1 if st.takeover_state[0] == p.condition_other[c] else 0


@compiled
def variable_holds(n: RoadTables, p: Program, st: State, c: int, i: int) -> int:
    """Return 1 if a variable satisfies the condition."""
    del n, i
    value = st.variable[p.condition_other[c]]
    if p.condition_mode[c] == TEXT_IS_NUMBER and value < 0.0:
        return 0
    return compared(p, st, c, value)


@compiled
def time_of_day_holds(n: RoadTables, p: Program, st: State, c: int, i: int) -> int:
    """Return 1 if the time of day satisfies the condition; 0 if there is none."""
    del n, i
    if st.day_known[0] == 0:
        return 0
    limit = p.const[p.condition_const[c] + slot.C_VALUE]
    return compare(st, p.condition_rule[c], time_of_day(st) - limit, 0.0)


@compiled
def user_value_holds(n: RoadTables, p: Program, st: State, c: int, i: int) -> int:
    """Return 0, because no other program gives values to a run."""
    del n, p, st, c, i
    return 0


@compiled
def signal_holds(n: RoadTables, p: Program, st: State, c: int, i: int) -> int:
    """Return 1 if a signal is in the condition's state."""
    del n, i
    return 1 if st.signal_state[p.condition_other[c]] == p.condition_mode[c] else 0


@compiled
def signal_phase_holds(n: RoadTables, p: Program, st: State, c: int, i: int) -> int:
    """Return 1 if a traffic signal controller is in the condition's phase."""
    del n, i
    return phase_holds(p, st, p.condition_other[c], p.condition_mode[c])


def time_row(draft: ProgramDraft, word: SimulationTimeCondition) -> ConditionRow:
    """Return the row of a condition on the time."""
    del draft
    return ConditionRow(RULES[word.rule], word.after)


def lane_confidence_row(draft: ProgramDraft, word: LaneConfidenceCondition) -> ConditionRow:
    """Return the row of a condition on the lane confidence."""
    del draft
    return ConditionRow(value=word.below, other=SIDES[word.side])


def sensor_health_row(draft: ProgramDraft, word: SensorHealthCondition) -> ConditionRow:
    """Return the row of a condition on the camera's health."""
    del draft
    return ConditionRow(value=word.below)


def event_row(draft: ProgramDraft, word: EventCondition) -> ConditionRow:
    """Return the row of a condition on an event's state."""
    del draft
    rule, state = EVENT_STATES[word.state]
    return ConditionRow(rule, state, mode=ALL_ELEMENTS, awaits=(NAMED_EVENT, word.name))


def element_state_row(draft: ProgramDraft, word: ElementStateCondition) -> ConditionRow:
    """Return the row of a condition on an element's state or transition."""
    del draft
    awaits = (word.kind, word.element)
    if word.state in TRANSITIONS:
        return ConditionRow(mode=FIRST_TRANSITION + TRANSITIONS[word.state], awaits=awaits)
    mode = ANY_ELEMENT if word.state == "runningState" else ALL_ELEMENTS
    return ConditionRow(op.RULE_EQUAL, ELEMENT_STATES[word.state], mode=mode, awaits=awaits)


def time_of_day_row(draft: ProgramDraft, word: TimeOfDayCondition) -> ConditionRow:
    """Return the row of a condition on the time of day."""
    return ConditionRow(RULES[word.rule], draft.seconds_of(word.date_time))


def variable_row(draft: ProgramDraft, word: VariableCondition) -> ConditionRow:
    """Return the row of a condition on a variable."""
    at, variable = draft.variables[word.variable]
    rule = RULES[word.rule]
    if variable.type == "string" and rule not in (op.RULE_EQUAL, op.RULE_NOT_EQUAL):
        rule, place = draft.order_of_texts(rule, word.value)
        return ConditionRow(rule, place, other=at, mode=TEXT_IS_NUMBER)
    return ConditionRow(rule, draft.variable_value(variable, word.value), other=at)


def user_value_row(draft: ProgramDraft, word: UserDefinedValueCondition) -> ConditionRow:
    """Return the row of a condition on a value of another program."""
    del draft, word
    return ConditionRow()


def signal_row(draft: ProgramDraft, word: TrafficSignalCondition) -> ConditionRow:
    """Return the row of a condition on a signal's state."""
    return ConditionRow(other=draft.signal(word.signal), mode=draft.texts[word.state])


def signal_phase_row(draft: ProgramDraft, word: TrafficSignalControllerCondition) -> ConditionRow:
    """Return the row of a condition on the phase of a traffic signal controller."""
    return ConditionRow(other=draft.controllers[word.controller], mode=draft.texts[word.phase])


def takeover_state_row(draft: ProgramDraft, word: TakeoverStateCondition) -> ConditionRow:
    """Return the row of a condition on the state of the takeover."""
    del draft
    return ConditionRow(op.RULE_EQUAL, other=STATES[word.state])


WATCHED = {"other": index(ELEMENT)}

TIME = Condition(("time",), time_row, time_holds, of_the_run=True)
EVENT = Condition(("event",), event_row, element_holds, of_the_run=True, refers=WATCHED)
ELEMENT_STATE = Condition(("element_state",), element_state_row, element_holds, of_the_run=True, refers=WATCHED)
LANE_CONFIDENCE = Condition(("lane_confidence",), lane_confidence_row, lane_confidence_holds, of_the_run=True)
SENSOR_HEALTH = Condition(("sensor_health",), sensor_health_row, sensor_health_holds, of_the_run=True)
TAKEOVER_STATE = Condition(("takeover_state",), takeover_state_row, takeover_state_holds, of_the_run=True)
TIME_OF_DAY = Condition(("time_of_day",), time_of_day_row, time_of_day_holds, of_the_run=True)
VARIABLE_VALUE = Condition(
    ("variable",), variable_row, variable_holds, of_the_run=True, refers={"other": index(VARIABLE)}
)
USER_VALUE = Condition(("user_defined_value",), user_value_row, user_value_holds, of_the_run=True)
SIGNAL_STATE = Condition(
    ("traffic_signal",), signal_row, signal_holds, of_the_run=True, refers={"other": index(SIGNAL)}
)
SIGNAL_PHASE = Condition(
    ("signal_phase",),
    signal_phase_row,
    signal_phase_holds,
    of_the_run=True,
    refers={"other": index(SIGNAL_CONTROLLER)},
)
