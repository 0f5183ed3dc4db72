"""Conditions: what a trigger waits for. One module a family of the standard; `Condition` is their union."""

from scenario_compiler.vocabulary.conditions.by_entity import (
    DistanceCondition,
    ReachPositionCondition,
    SpeedCondition,
    StandstillCondition,
    TimeHeadwayCondition,
    TimeToCollisionCondition,
    TraveledDistanceCondition,
)
from scenario_compiler.vocabulary.conditions.by_value import (
    EventCondition,
    LaneConfidenceCondition,
    SensorHealthCondition,
    SimulationTimeCondition,
    TakeoverStateCondition,
)

Condition = (
    SimulationTimeCondition
    | TimeHeadwayCondition
    | DistanceCondition
    | TimeToCollisionCondition
    | SpeedCondition
    | ReachPositionCondition
    | TraveledDistanceCondition
    | LaneConfidenceCondition
    | TakeoverStateCondition
    | StandstillCondition
    | SensorHealthCondition
    | EventCondition
)

__all__ = [
    "Condition",
    "DistanceCondition",
    "EventCondition",
    "LaneConfidenceCondition",
    "ReachPositionCondition",
    "SensorHealthCondition",
    "SimulationTimeCondition",
    "SpeedCondition",
    "StandstillCondition",
    "TakeoverStateCondition",
    "TimeHeadwayCondition",
    "TimeToCollisionCondition",
    "TraveledDistanceCondition",
]
