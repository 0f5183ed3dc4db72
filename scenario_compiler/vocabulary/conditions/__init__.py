"""Conditions: what a trigger waits for. One module a family of the standard; `Condition` is their union."""

from scenario_compiler.vocabulary.conditions.by_entity import (
    DistanceCondition,
    ReachPositionCondition,
    SpeedCondition,
    TimeHeadwayCondition,
    TimeToCollisionCondition,
    TraveledDistanceCondition,
)
from scenario_compiler.vocabulary.conditions.by_value import (
    LaneConfidenceCondition,
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
)

__all__ = [
    "Condition",
    "DistanceCondition",
    "LaneConfidenceCondition",
    "ReachPositionCondition",
    "SimulationTimeCondition",
    "SpeedCondition",
    "TakeoverStateCondition",
    "TimeHeadwayCondition",
    "TimeToCollisionCondition",
    "TraveledDistanceCondition",
]
