"""Conditions on the run as a whole."""

from typing import Literal

from scenario_compiler.vocabulary.conditions.measuring import Rule
from scenario_compiler.vocabulary.word import Number, Word, attribute

TakeoverState = Literal["automated", "warning", "request", "escalation", "manual", "minimum_risk", "standstill"]
"""States of the takeover: after whom the car is driven by, and what it asks."""


class SimulationTimeCondition(Word):
    """The simulation time has come."""

    word: Literal["time"] = "time"

    after: Number = attribute("The limit: true from this time on, s.", quantity="time", minimum=0)
    rule: Rule = attribute(
        "How the time is compared with the limit, where `from this time on` is not meant.", default="greaterOrEqual"
    )


class LaneConfidenceCondition(Word):
    """The automation's lane confidence: of both sides, of one, or of either."""

    word: Literal["lane_confidence"] = "lane_confidence"

    below: Number = attribute("True when it is less.", quantity="fraction", minimum=0, maximum=1)
    side: Literal["both", "either", "left", "right"] = attribute("Which side of the lane is meant.", default="both")


class SensorHealthCondition(Word):
    """The health of the camera."""

    word: Literal["sensor_health"] = "sensor_health"

    below: Number = attribute("True when it is less.", quantity="fraction", minimum=0, maximum=1)


class EventCondition(Word):
    """Another event: one that a <when> with a name describes."""

    word: Literal["event"] = "event"

    name: str = attribute("Name of the event.", names="event")
    state: Literal["started", "running", "complete"] = attribute(
        "True from its start on, while its actions run, or once they are all done.", default="complete"
    )


class TakeoverStateCondition(Word):
    """The takeover is in a state."""

    word: Literal["takeover_state"] = "takeover_state"

    state: TakeoverState = attribute("The state to wait for.", name="is")


class ElementStateCondition(Word):
    """An element of the storyboard is in a state, or goes through a transition: ASAM's StoryboardElementState."""

    word: Literal["element_state"] = "element_state"

    kind: Literal["story", "act", "maneuverGroup", "maneuver", "event", "action"] = attribute("What it is.")
    element: str = attribute("Its name, with the names of the elements around it before it: story::act::...")
    state: Literal[
        "standbyState", "runningState", "completeState",
        "startTransition", "endTransition", "stopTransition", "skipTransition",
    ] = attribute("The state or transition.")  # fmt: skip


class TimeOfDayCondition(Word):
    """The simulated date and time against another."""

    word: Literal["time_of_day"] = "time_of_day"

    date_time: str = attribute("Date and time, ISO 8601.")
    rule: Rule = attribute("How it is compared.", default="greaterOrEqual")


class VariableCondition(Word):
    """A variable, or a parameter, against a value."""

    word: Literal["variable"] = "variable"

    variable: str = attribute("Name of the variable.", names="variable")
    rule: Rule = attribute("How it is compared.", default="equalTo")
    value: str = attribute("The value.")


class UserDefinedValueCondition(Word):
    """A value that another program gives."""

    word: Literal["user_defined_value"] = "user_defined_value"

    name: str = attribute("Name of the value.")
    rule: Rule = attribute("How it is compared.", default="equalTo")
    value: str = attribute("The value.")


class TrafficSignalCondition(Word):
    """A traffic signal is in a state."""

    word: Literal["traffic_signal"] = "traffic_signal"

    signal: str = attribute("Id of the signal in the map.", names="signal")
    state: str = attribute("The state.")


class TrafficSignalControllerCondition(Word):
    """A controller of traffic signals is in a phase."""

    word: Literal["signal_phase"] = "signal_phase"

    controller: str = attribute("Name of the controller.", names="signal_controller")
    phase: str = attribute("Name of the phase.")
