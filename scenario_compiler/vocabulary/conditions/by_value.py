"""Conditions on the run as a whole."""

from __future__ import annotations

from typing import Literal

from scenario_compiler.vocabulary.word import Number, Word, attribute

TakeoverState = Literal["automated", "warning", "request", "escalation", "manual", "minimum_risk", "standstill"]
"""States of the takeover: after whom the car is driven by, and what it asks."""


class SimulationTimeCondition(Word):
    """The simulation time has come."""

    word: Literal["time"] = "time"

    after: Number = attribute("True from this time on, s.", quantity="time", minimum=0)


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
