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
    """The automation's lane confidence, the greater of both sides."""

    word: Literal["lane_confidence"] = "lane_confidence"

    below: Number = attribute("True when it is less.", quantity="fraction", minimum=0, maximum=1)


class TakeoverStateCondition(Word):
    """The takeover is in a state."""

    word: Literal["takeover_state"] = "takeover_state"

    state: TakeoverState = attribute("The state to wait for.", name="is")
