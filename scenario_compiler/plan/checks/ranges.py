"""The possible ranges of the quantities in conditions; a condition with a limit outside its range is never true."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

from scenario_compiler.expressions import Value
from scenario_compiler.plan.model import Plan
from scenario_compiler.vocabulary.actions import (
    AssignControllerAction,
    ConnectTrailerAction,
    FollowPathAction,
    FollowTrajectoryAction,
    LongitudinalDistanceAction,
    RelativeSpeedAction,
    SpeedAction,
    SpeedProfileAction,
    SynchronizeAction,
)
from scenario_compiler.vocabulary.conditions import (
    AccelerationCondition,
    Condition,
    DistanceCondition,
    LaneConfidenceCondition,
    PositionDistanceCondition,
    SensorHealthCondition,
    SimulationTimeCondition,
    SpeedCondition,
    TimeHeadwayCondition,
    TimeToCollisionCondition,
)
from scenario_compiler.vocabulary.conditions.measuring import Rule
from scenario_compiler.vocabulary.word import Number, number_value

MAY_GO_BACK = (
    AssignControllerAction,
    FollowPathAction,
    FollowTrajectoryAction,
    LongitudinalDistanceAction,
    RelativeSpeedAction,
    SpeedProfileAction,
    SynchronizeAction,
)
"""Actions that may give their actor a speed below 0, whatever their numbers are."""


class Bounds(NamedTuple):
    """The range of a condition's quantity, the comparison, and the attribute with the limit."""

    attribute: str
    rule: Rule
    limit: Number
    least: float
    most: float
    what: str
    unit: str = ""


def beyond(condition: Condition, plan: Plan, values: Mapping[str, Value]) -> tuple[str, str] | None:
    """Return the reason why a condition is never true and the attribute with its limit; None if it may be true."""
    bounds = _bounds(condition, plan, values)
    if bounds is None or not _misses(bounds, number_value(bounds.limit, values)):
        return None
    if bounds.most == math.inf:
        return f"{bounds.what} is never below {bounds.least:g}{bounds.unit}", bounds.attribute
    return f"{bounds.what} lies between {bounds.least:g} and {bounds.most:g}{bounds.unit}", bounds.attribute


def _misses(bounds: Bounds, limit: float) -> bool:
    return {
        "lessThan": limit <= bounds.least,
        "lessOrEqual": limit < bounds.least,
        "greaterThan": limit >= bounds.most,
        "greaterOrEqual": limit > bounds.most,
        "equalTo": not bounds.least <= limit <= bounds.most,
        "notEqualTo": False,
    }[bounds.rule]


def _bounds(condition: Condition, plan: Plan, values: Mapping[str, Value]) -> Bounds | None:
    if isinstance(condition, TimeHeadwayCondition | TimeToCollisionCondition):
        return Bounds("below", condition.rule, condition.below, 0.0, math.inf, "a time")
    if isinstance(condition, SimulationTimeCondition):
        return Bounds("after", condition.rule, condition.after, 0.0, math.inf, "the time")
    if isinstance(condition, DistanceCondition | PositionDistanceCondition):
        return Bounds("below", condition.rule, condition.below, 0.0, math.inf, "a distance")
    if isinstance(condition, LaneConfidenceCondition | SensorHealthCondition):
        return Bounds("below", "lessThan", condition.below, 0.0, 1.0, "a confidence or health")
    if isinstance(condition, AccelerationCondition) and condition.direction == "total":
        return Bounds("value", condition.rule, condition.value, 0.0, math.inf, "the size of an acceleration")
    if not isinstance(condition, SpeedCondition):
        return None
    least, most = _speeds(plan, condition.entity, values)
    if condition.direction != "total":
        least = -most
    return Bounds("value", condition.rule, condition.value, least, most, f"the speed of '{condition.entity}'", " m/s")


def _speeds(plan: Plan, name: str, values: Mapping[str, Value]) -> tuple[float, float]:
    """Return the least and greatest speed that an entity may have; the storyboard may give an actor any."""
    entity = next((one for one in plan.entities if one.id == name), None)
    if entity is None:
        return -math.inf, math.inf
    if entity.kind == "ego":
        return 0.0, entity.vehicle.max_speed
    back = entity.path is not None or number_value(entity.speed, values) < 0.0
    for actor, action in plan.storyboard.actions():
        if isinstance(action, ConnectTrailerAction):
            back = back or action.trailer == name
        elif actor == name:
            sinks = isinstance(action, SpeedAction) and number_value(action.to, values) < 0.0
            back = back or sinks or isinstance(action, MAY_GO_BACK)
    return -math.inf if back else 0.0, math.inf
