"""Conditions on the run as a whole."""

from typing import Literal, get_args

from scenario_compiler.vocabulary.conditions.measuring import Rule
from scenario_compiler.vocabulary.word import Number, Word, attribute

TakeoverState = Literal["automated", "warning", "request", "escalation", "manual", "minimum_risk", "standstill"]
"""States of the takeover, named after who drives and what the automation requests."""

ElementKind = Literal["story", "act", "maneuverGroup", "maneuver", "event", "action"]
ELEMENT_KINDS: tuple[ElementKind, ...] = get_args(ElementKind)
"""Kinds of the storyboard's elements, from the outermost to the innermost."""


class SimulationTimeCondition(Word):
    """The simulation time has reached a value."""

    word: Literal["time"] = "time"

    after: Number = attribute("Limit, s: true from this time on.", quantity="time", minimum=0)
    rule: Rule = attribute(
        "Comparison of the time with the limit. By default the condition is true from this time on.",
        default="greaterOrEqual",
    )


class LaneConfidenceCondition(Word):
    """The automation's lane confidence: of both sides, of one side, or of either side."""

    word: Literal["lane_confidence"] = "lane_confidence"

    below: Number = attribute("Limit: true when the confidence is lower.", quantity="fraction", minimum=0, maximum=1)
    side: Literal["both", "either", "left", "right"] = attribute("Side of the lane.", default="both")


class SensorHealthCondition(Word):
    """The health of the camera."""

    word: Literal["sensor_health"] = "sensor_health"

    below: Number = attribute("Limit: true when the health is lower.", quantity="fraction", minimum=0, maximum=1)


class EventCondition(Word):
    """The state of another event, which is a <when> with a name."""

    word: Literal["event"] = "event"

    name: str = attribute("Name of the event.", names="event")
    state: Literal["started", "running", "complete"] = attribute(
        "Whether the condition is true from the event's start, while its actions run, or after they have ended.",
        default="complete",
    )


class TakeoverStateCondition(Word):
    """The takeover is in a given state."""

    word: Literal["takeover_state"] = "takeover_state"

    state: TakeoverState = attribute("State.", name="is")


class ElementStateCondition(Word):
    """An element of the storyboard is in a state or makes a transition: ASAM's StoryboardElementState."""

    word: Literal["element_state"] = "element_state"

    kind: ElementKind = attribute("Kind of the element.")
    element: str = attribute(
        "Name of the element, preceded by the names of the elements that contain it. The event `brakes` of the entity "
        "`lead` is story::act::lead::lead.whens::brakes; <event> names it more simply."
    )
    state: Literal[
        "standbyState", "runningState", "completeState",
        "startTransition", "endTransition", "stopTransition", "skipTransition",
    ] = attribute("State or transition.")  # fmt: skip


class TimeOfDayCondition(Word):
    """The simulated date and time, compared with a given one."""

    word: Literal["time_of_day"] = "time_of_day"

    date_time: str = attribute("Date and time, ISO 8601.")
    rule: Rule = attribute("Comparison.", default="greaterOrEqual")


class VariableCondition(Word):
    """A variable, or a parameter, compared with a value."""

    word: Literal["variable"] = "variable"

    variable: str = attribute("Name of the variable.", names="variable")
    rule: Rule = attribute(
        "Comparison. A text is less or greater than another one only if both are numbers.", default="equalTo"
    )
    value: str = attribute("The value.")


class UserDefinedValueCondition(Word):
    """A value that another program supplies, compared with a given one."""

    word: Literal["user_defined_value"] = "user_defined_value"

    name: str = attribute("Name of the value.")
    rule: Rule = attribute("Comparison.", default="equalTo")
    value: str = attribute("The value.")


class TrafficSignalCondition(Word):
    """A traffic signal is in a given state."""

    word: Literal["traffic_signal"] = "traffic_signal"

    signal: str = attribute("Id of the signal in the map.", names="signal")
    state: str = attribute("The state.")


class TrafficSignalControllerCondition(Word):
    """A controller of traffic signals is in a given phase."""

    word: Literal["signal_phase"] = "signal_phase"

    controller: str = attribute("Name of the controller.", names="signal_controller")
    phase: str = attribute("Name of the phase.")
