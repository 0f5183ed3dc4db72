"""Conditions of triggers, with one module for each family of the standard. `Condition` is their union."""

from scenario_compiler.vocabulary.conditions.by_entity import (
    AccelerationCondition,
    AngleCondition,
    CollisionCondition,
    DistanceCondition,
    EndOfRoadCondition,
    OffroadCondition,
    PositionDistanceCondition,
    ReachPositionCondition,
    RelativeAngleCondition,
    RelativeClearanceCondition,
    RelativeLaneRange,
    RelativeSpeedCondition,
    SpeedCondition,
    StandstillCondition,
    TimeHeadwayCondition,
    TimeToCollisionCondition,
    TraveledDistanceCondition,
)
from scenario_compiler.vocabulary.conditions.by_value import (
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
from scenario_compiler.vocabulary.conditions.measuring import (
    Rule,
)

Condition = (
    SimulationTimeCondition
    | TimeHeadwayCondition
    | DistanceCondition
    | PositionDistanceCondition
    | TimeToCollisionCondition
    | SpeedCondition
    | RelativeSpeedCondition
    | AccelerationCondition
    | StandstillCondition
    | ReachPositionCondition
    | TraveledDistanceCondition
    | CollisionCondition
    | OffroadCondition
    | EndOfRoadCondition
    | RelativeClearanceCondition
    | AngleCondition
    | RelativeAngleCondition
    | LaneConfidenceCondition
    | SensorHealthCondition
    | EventCondition
    | TakeoverStateCondition
    | ElementStateCondition
    | TimeOfDayCondition
    | VariableCondition
    | UserDefinedValueCondition
    | TrafficSignalCondition
    | TrafficSignalControllerCondition
)

__all__ = [
    "AccelerationCondition",
    "AngleCondition",
    "CollisionCondition",
    "Condition",
    "DistanceCondition",
    "ElementStateCondition",
    "EndOfRoadCondition",
    "EventCondition",
    "LaneConfidenceCondition",
    "OffroadCondition",
    "PositionDistanceCondition",
    "ReachPositionCondition",
    "RelativeAngleCondition",
    "RelativeClearanceCondition",
    "RelativeLaneRange",
    "RelativeSpeedCondition",
    "Rule",
    "SensorHealthCondition",
    "SimulationTimeCondition",
    "SpeedCondition",
    "StandstillCondition",
    "TakeoverStateCondition",
    "TimeHeadwayCondition",
    "TimeOfDayCondition",
    "TimeToCollisionCondition",
    "TrafficSignalCondition",
    "TrafficSignalControllerCondition",
    "TraveledDistanceCondition",
    "UserDefinedValueCondition",
    "VariableCondition",
]
