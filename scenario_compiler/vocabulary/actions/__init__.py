"""Actions of events, with one module for each family of the standard. `Action` is their union."""

from scenario_compiler.vocabulary.actions.control import (
    ActivateControllerAction,
    AnimationAction,
    AssignControllerAction,
    ControllerProperty,
    LightAction,
    OverrideControllerAction,
)
from scenario_compiler.vocabulary.actions.dynamics import AtRate, Limits, OverDistance, Shape
from scenario_compiler.vocabulary.actions.environment import WeatherAction
from scenario_compiler.vocabulary.actions.lateral import (
    LaneChangeAction,
    LaneChangeToAction,
    LaneOffsetAction,
    LateralDistanceAction,
    LimitedLaneOffsetAction,
)
from scenario_compiler.vocabulary.actions.longitudinal import (
    LongitudinalDistanceAction,
    RelativeSpeedAction,
    SpeedAction,
    SpeedEntry,
    SpeedProfileAction,
)
from scenario_compiler.vocabulary.actions.motion import (
    AcquirePositionAction,
    AssignRouteAction,
    ConnectTrailerAction,
    DisconnectTrailerAction,
    FinalSpeed,
    FollowTrajectoryAction,
    MasterPosition,
    RandomRouteAction,
    SynchronizeAction,
    TeleportAction,
    TrajectoryTiming,
    VisibilityAction,
)
from scenario_compiler.vocabulary.actions.path import FollowPathAction
from scenario_compiler.vocabulary.actions.run import MessageAction, StopAction
from scenario_compiler.vocabulary.actions.sensor import EndFailureAction, SensorNoiseAction
from scenario_compiler.vocabulary.actions.takeover import HandBackAction, RequestAction, WarnAction
from scenario_compiler.vocabulary.actions.traffic import (
    KeepsVehicles,
    SpeedRange,
    StopTrafficAction,
    TrafficKind,
    TrafficSinkAction,
    TrafficSourceAction,
    TrafficSwarmAction,
)
from scenario_compiler.vocabulary.actions.world import (
    AddEntityAction,
    CommandAction,
    DeleteEntityAction,
    EnvironmentAction,
    ModifyVariableAction,
    SetVariableAction,
    TrafficSignalControllerAction,
    TrafficSignalStateAction,
)
from scenario_compiler.vocabulary.sensors import Failure

Action = (
    SpeedAction
    | RelativeSpeedAction
    | SpeedProfileAction
    | LongitudinalDistanceAction
    | LaneChangeAction
    | LaneChangeToAction
    | LaneOffsetAction
    | LimitedLaneOffsetAction
    | LateralDistanceAction
    | FollowPathAction
    | TeleportAction
    | AssignRouteAction
    | AcquirePositionAction
    | RandomRouteAction
    | FollowTrajectoryAction
    | SynchronizeAction
    | VisibilityAction
    | ConnectTrailerAction
    | DisconnectTrailerAction
    | ActivateControllerAction
    | AssignControllerAction
    | OverrideControllerAction
    | LightAction
    | AnimationAction
    | AddEntityAction
    | DeleteEntityAction
    | SetVariableAction
    | ModifyVariableAction
    | TrafficSignalStateAction
    | TrafficSignalControllerAction
    | CommandAction
    | EnvironmentAction
    | TrafficSwarmAction
    | TrafficSourceAction
    | TrafficSinkAction
    | StopTrafficAction
    | SensorNoiseAction
    | Failure
    | EndFailureAction
    | WeatherAction
    | MessageAction
    | RequestAction
    | WarnAction
    | HandBackAction
    | StopAction
)

__all__ = [
    "AcquirePositionAction",
    "Action",
    "ActivateControllerAction",
    "AddEntityAction",
    "AnimationAction",
    "AssignControllerAction",
    "AssignRouteAction",
    "AtRate",
    "CommandAction",
    "ConnectTrailerAction",
    "ControllerProperty",
    "DeleteEntityAction",
    "DisconnectTrailerAction",
    "EndFailureAction",
    "EnvironmentAction",
    "Failure",
    "FinalSpeed",
    "FollowPathAction",
    "FollowTrajectoryAction",
    "HandBackAction",
    "KeepsVehicles",
    "LaneChangeAction",
    "LaneChangeToAction",
    "LaneOffsetAction",
    "LateralDistanceAction",
    "LightAction",
    "LimitedLaneOffsetAction",
    "Limits",
    "LongitudinalDistanceAction",
    "MasterPosition",
    "MessageAction",
    "ModifyVariableAction",
    "OverDistance",
    "OverrideControllerAction",
    "RandomRouteAction",
    "RelativeSpeedAction",
    "RequestAction",
    "SensorNoiseAction",
    "SetVariableAction",
    "Shape",
    "SpeedAction",
    "SpeedEntry",
    "SpeedProfileAction",
    "SpeedRange",
    "StopAction",
    "StopTrafficAction",
    "SynchronizeAction",
    "TeleportAction",
    "TrafficKind",
    "TrafficSignalControllerAction",
    "TrafficSignalStateAction",
    "TrafficSinkAction",
    "TrafficSourceAction",
    "TrafficSwarmAction",
    "TrajectoryTiming",
    "VisibilityAction",
    "WarnAction",
    "WeatherAction",
]
