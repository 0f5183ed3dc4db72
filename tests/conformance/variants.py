"""The features of OpenSCENARIO that a run executes, variant by variant, and the XPath of each variant.

A variant is an XPath over a scenario's file: the run of a file in which it matches is a run of that variant. What lies
in catalogs is not looked into, so a variant may have more runs than are counted, and never fewer.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

SHAPES = ("linear", "sinusoidal", "cubic")
DIMENSIONS = ("time", "rate", "distance")


@dataclass(frozen=True)
class Variant:
    """A variant of a feature.

    Attributes:
        feature: Name of the standard's element, or "Storyboard" for everything else.
        name: What tells it apart from the other variants of the feature.
        path: XPath that is true where a file has it.
    """

    feature: str
    name: str
    path: str


def _speed() -> Iterator[tuple[str, str]]:
    dynamics = "//SpeedAction[SpeedActionTarget/{target}]/SpeedActionDynamics[@dynamicsShape='{shape}'{dimension}]"
    for target, said in (("AbsoluteTargetSpeed", ""), ("RelativeTargetSpeed", "relative, ")):
        yield f"{said}step", dynamics.format(target=target, shape="step", dimension="")
        for shape in SHAPES:
            for dimension in DIMENSIONS:
                by = f" and @dynamicsDimension='{dimension}'"
                yield f"{said}{shape} by {dimension}", dynamics.format(target=target, shape=shape, dimension=by)
    for kind in ("delta", "factor"):
        for continuous in ("false", "true"):
            said = f"relative by {kind}, {'continuous' if continuous == 'true' else 'once'}"
            yield said, f"//RelativeTargetSpeed[@speedTargetValueType='{kind}' and @continuous='{continuous}']"


def _profile() -> Iterator[tuple[str, str]]:
    for following in ("position", "follow"):
        of = f"//SpeedProfileAction[@followingMode='{following}'"
        yield f"{following}, times given", f"{of} and not(@entityRef) and not(SpeedProfileEntry[not(@time)])]"
        yield f"{following}, an entry without time", f"{of} and SpeedProfileEntry[not(@time)]]"
        yield f"{following}, a single entry", f"{of} and count(SpeedProfileEntry)=1]"
    yield "relative to an entity", "//SpeedProfileAction[@entityRef]"


def _gap(action: str) -> Iterator[tuple[str, str]]:
    yield "with limits", f"//{action}[DynamicConstraints]"
    yield "without limits", f"//{action}[not(DynamicConstraints)]"
    yield "with limits of jerk", f"//{action}[DynamicConstraints[@maxAccelerationRate or @maxDecelerationRate]]"
    for continuous in ("true", "false"):
        yield ("continuous" if continuous == "true" else "once"), f"//{action}[@continuous='{continuous}']"
    for freespace in ("true", "false"):
        yield (
            ("between boxes" if freespace == "true" else "between reference points"),
            (f"//{action}[@freespace='{freespace}']"),
        )
    sides = ("trailing", "leading") if action == "LongitudinalDistanceAction" else ("leftTo", "rightTo")
    for side in sides:
        yield f"displacement {side}", f"//{action}[@displacement='{side}ReferencedEntity']"
    if action == "LongitudinalDistanceAction":
        yield "distance", f"//{action}[@distance]"
        yield "time gap", f"//{action}[@timeGap]"


def _lane_change() -> Iterator[tuple[str, str]]:
    for shape in SHAPES:
        for dimension in DIMENSIONS:
            path = f"//LaneChangeActionDynamics[@dynamicsShape='{shape}' and @dynamicsDimension='{dimension}']"
            yield f"{shape} by {dimension}", path
    yield "step", "//LaneChangeActionDynamics[@dynamicsShape='step']"
    yield "to a lane by its id", "//LaneChangeTarget/AbsoluteTargetLane"
    yield "relative", "//LaneChangeTarget/RelativeTargetLane"
    yield "to an offset in the lane", "//LaneChangeAction[@targetLaneOffset and number(@targetLaneOffset)!=0]"


def _lane_offset() -> Iterator[tuple[str, str]]:
    for shape in ("step", *SHAPES):
        yield shape, f"//LaneOffsetActionDynamics[@dynamicsShape='{shape}']"
    yield "absolute", "//LaneOffsetTarget/AbsoluteTargetLaneOffset"
    yield "relative to an entity", "//LaneOffsetTarget/RelativeTargetLaneOffset"
    yield "without a limit", "//LaneOffsetActionDynamics[not(@maxLateralAcc)]"
    yield "continuous", "//LaneOffsetAction[@continuous='true']"
    yield "beyond the lane's border", "//AbsoluteTargetLaneOffset[number(@value)>1.75 or number(@value)<-1.75]"


def _trajectory() -> Iterator[tuple[str, str]]:
    action = "//FollowTrajectoryAction"
    kinds = ("Polyline", "Clothoid", "ClothoidSpline", "Nurbs")
    for shape in kinds:
        yield f"{shape}, without times", f"{action}[.//{shape} and TimeReference/None]"
        yield f"{shape}, with times", f"{action}[.//{shape} and TimeReference/Timing]"
    for domain in ("absolute", "relative"):
        yield f"times {domain}", f"{action}//Timing[@domainAbsoluteRelative='{domain}']"
    yield "times scaled or shifted", f"{action}//Timing[number(@scale)!=1 or number(@offset)!=0]"
    for following in ("position", "follow"):
        yield f"followed by {following}", f"{action}/TrajectoryFollowingMode[@followingMode='{following}']"
    yield "begun at an offset", f"{action}[@initialDistanceOffset and number(@initialDistanceOffset)!=0]"
    yield "closed", f"{action}//Trajectory[@closed='true']"
    yield "with headings", f"{action}//Vertex/Position/WorldPosition[@h]"
    yield "with heights", f"{action}//Position/WorldPosition[@z]"


def _synchronize() -> Iterator[tuple[str, str]]:
    yield "without a final speed", "//SynchronizeAction[not(FinalSpeed)]"
    yield "to an absolute speed", "//SynchronizeAction/FinalSpeed/AbsoluteSpeed"
    yield "to a speed relative to the master's", "//SynchronizeAction/FinalSpeed/RelativeSpeedToMaster"
    yield "with a steady distance", "//SynchronizeAction//TargetDistanceSteadyState"
    yield "with a steady time", "//SynchronizeAction//TargetTimeSteadyState"
    yield "with tolerances", "//SynchronizeAction[@targetTolerance or @targetToleranceMaster]"


def _distance_condition(condition: str) -> Iterator[tuple[str, str]]:
    for system in ("entity", "lane", "road", "trajectory", "world"):
        yield f"system {system}", f"//{condition}[@coordinateSystem='{system}']"
    for kind in ("longitudinal", "lateral", "euclidianDistance", "cartesianDistance"):
        yield kind, f"//{condition}[@relativeDistanceType='{kind}']"
    for freespace in ("true", "false"):
        yield (
            ("between boxes" if freespace == "true" else "between reference points"),
            (f"//{condition}[@freespace='{freespace}']"),
        )


def _directed(condition: str) -> Iterator[tuple[str, str]]:
    yield "as a whole", f"//{condition}[not(@direction)]"
    for direction in ("longitudinal", "lateral", "vertical"):
        yield direction, f"//{condition}[@direction='{direction}']"


def _positions() -> Iterator[tuple[str, str, str]]:
    for tag in (
        *("WorldPosition", "RelativeWorldPosition", "RelativeObjectPosition", "RoadPosition", "RelativeRoadPosition"),
        *("LanePosition", "RelativeLanePosition", "RoutePosition", "GeoPosition", "TrajectoryPosition"),
    ):
        yield tag, "used", f"//{tag}"
        if tag != "WorldPosition":
            yield tag, "turned against the road", f"//{tag}/Orientation[not(@type) or @type='relative']"
            yield tag, "turned in the world", f"//{tag}/Orientation[@type='absolute']"
    yield "LanePosition", "in lane 0", "//LanePosition[@laneId='0']"
    yield "RelativeLanePosition", "along the lane", "//RelativeLanePosition[@dsLane]"
    yield "RelativeLanePosition", "without a distance", "//RelativeLanePosition[not(@ds) and not(@dsLane)]"


def _storyboard() -> Iterator[tuple[str, str]]:
    yield "priority overwrite", "//Event[@priority='overwrite' or @priority='override']"
    yield "priority skip", "//Event[@priority='skip']"
    yield "priority parallel", "//Event[@priority='parallel']"
    yield "an event executed again", "//Event[number(@maximumExecutionCount)>1]"
    yield "a group executed again", "//ManeuverGroup[number(@maximumExecutionCount)>1]"
    yield "several actors", "//Actors[count(EntityRef)>1]"
    yield "triggering entities as actors", "//Actors[@selectTriggeringEntities='true']"
    yield "an act that is stopped", "//Act/StopTrigger/ConditionGroup"
    yield "an act without a start trigger", "//Act[not(StartTrigger)]"
    yield "an event without a start trigger", "//Event[not(StartTrigger)]"
    for edge in ("none", "rising", "falling", "risingOrFalling"):
        yield f"edge {edge}", f"//Condition[@conditionEdge='{edge}']"
    yield "delay", "//Condition[number(@delay)>0]"
    yield "any triggering entity", "//TriggeringEntities[@triggeringEntitiesRule='any' and count(EntityRef)>1]"
    yield "all triggering entities", "//TriggeringEntities[@triggeringEntitiesRule='all' and count(EntityRef)>1]"
    yield "several conditions in a group", "//ConditionGroup[count(Condition)>1]"
    yield "several groups", "//StartTrigger[count(ConditionGroup)>1]"


def _of(feature: str, found: Iterator[tuple[str, str]]) -> Iterator[Variant]:
    return (Variant(feature, name, path) for name, path in found)


def _plain(*tags: str) -> Iterator[Variant]:
    return (Variant(tag, "used", f"//{tag}") for tag in tags)


def _conditions() -> Iterator[Variant]:
    for condition in ("TimeHeadwayCondition", "TimeToCollisionCondition"):
        yield from _of(condition, _distance_condition(condition))
    for condition in ("DistanceCondition", "RelativeDistanceCondition"):
        yield from _of(condition, _distance_condition(condition))
    for condition in ("SpeedCondition", "RelativeSpeedCondition", "AccelerationCondition"):
        yield from _of(condition, _directed(condition))
    for angle in ("heading", "pitch", "roll"):
        for system in ("world", "road", "lane", "trajectory"):
            path = f"//AngleCondition[@angleType='{angle}' and @coordinateSystem='{system}']"
            yield Variant("AngleCondition", f"{angle}, system {system}", path)
        yield Variant("RelativeAngleCondition", angle, f"//RelativeAngleCondition[@angleType='{angle}']")
    yield from _plain("ReachPositionCondition", "TraveledDistanceCondition", "StandStillCondition")
    yield Variant("ReachPositionCondition", "turned", "//ReachPositionCondition/Position/*[@h or Orientation]")
    yield from _plain("EndOfRoadCondition", "OffroadCondition")
    for name, boxes in (("of reference points", "false"), ("of boxes", "true")):
        yield Variant("RelativeClearanceCondition", name, f"//RelativeClearanceCondition[@freeSpace='{boxes}']")
    yield Variant("CollisionCondition", "with an entity", "//CollisionCondition/EntityRef")
    yield Variant("CollisionCondition", "with a kind", "//CollisionCondition/ByType")
    yield from _plain("SimulationTimeCondition", "ParameterCondition", "VariableCondition", "TimeOfDayCondition")
    yield from _plain("UserDefinedValueCondition", "TrafficSignalCondition", "TrafficSignalControllerCondition")
    for state in (
        *("startTransition", "endTransition", "stopTransition", "skipTransition"),
        *("standbyState", "runningState", "completeState"),
    ):
        path = f"//StoryboardElementStateCondition[@state='{state}']"
        yield Variant("StoryboardElementStateCondition", state, path)


VARIANTS: tuple[Variant, ...] = (
    *_of("SpeedAction", _speed()),
    *_of("SpeedProfileAction", _profile()),
    *_of("LongitudinalDistanceAction", _gap("LongitudinalDistanceAction")),
    *_of("SynchronizeAction", _synchronize()),
    *_of("LaneChangeAction", _lane_change()),
    *_of("LaneOffsetAction", _lane_offset()),
    *_of("LateralDistanceAction", _gap("LateralDistanceAction")),
    *_of("FollowTrajectoryAction", _trajectory()),
    *_plain("AssignRouteAction", "AcquirePositionAction", "RandomRouteAction", "TeleportAction"),
    *_plain("AddEntityAction", "DeleteEntityAction", "VisibilityAction"),
    Variant("AddEntityAction", "after it was deleted", "//Storyboard[.//DeleteEntityAction and .//AddEntityAction]"),
    *_plain("ConnectTrailerAction", "DisconnectTrailerAction", "LightStateAction", "AnimationAction"),
    *_plain("ParameterAction", "VariableAction", "EnvironmentAction"),
    *_plain("TrafficSignalStateAction", "TrafficSignalControllerAction"),
    *_conditions(),
    *(Variant(*one) for one in _positions()),
    *_of("Storyboard", _storyboard()),
    Variant("Road network", "a lane that narrows to nothing", "//LogicFile[contains(@filepath, 'taper')]"),
    Variant("Road network", "an offset in the header", "//LogicFile[contains(@filepath, 'turned')]"),
)  # fmt: skip
"""Every variant, by feature."""
