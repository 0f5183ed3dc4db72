"""Criteria: what a run is judged by."""

from __future__ import annotations

from typing import Literal

from scenario_compiler.vocabulary.word import Number, Word, attribute


class NoCollision(Word):
    """The ego vehicle touches no other entity."""

    word: Literal["no_collision"] = "no_collision"


class StayOnRoad(Word):
    """The ego vehicle's reference point stays on a lane."""

    word: Literal["stay_on_road"] = "stay_on_road"


class ReachDestination(Word):
    """The ego vehicle reaches its destination."""

    word: Literal["reach_destination"] = "reach_destination"


class MinimumTimeToCollision(Word):
    """The ego vehicle's time to collision never falls below a value."""

    word: Literal["minimum_time_to_collision"] = "minimum_time_to_collision"

    at_least: Number = attribute("Least time to collision, s.", quantity="time", minimum=0)


Criterion = NoCollision | StayOnRoad | ReachDestination | MinimumTimeToCollision
