"""Actions: what an event does. One module a family of the standard; `Action` is their union."""

from scenario_compiler.vocabulary.actions.environment import WeatherAction
from scenario_compiler.vocabulary.actions.lateral import LaneChangeAction, LaneOffsetAction
from scenario_compiler.vocabulary.actions.longitudinal import SpeedAction
from scenario_compiler.vocabulary.actions.path import FollowPathAction
from scenario_compiler.vocabulary.actions.run import MessageAction, StopAction
from scenario_compiler.vocabulary.actions.sensor import EndFailureAction, SensorNoiseAction
from scenario_compiler.vocabulary.sensors import Failure

Action = (
    SpeedAction
    | LaneChangeAction
    | LaneOffsetAction
    | FollowPathAction
    | SensorNoiseAction
    | Failure
    | EndFailureAction
    | WeatherAction
    | MessageAction
    | StopAction
)

RUN_ACTIONS = (SensorNoiseAction, Failure, EndFailureAction, WeatherAction, MessageAction, StopAction)
"""Actions that concern the run as a whole, not the entity that does them."""

__all__ = [
    "RUN_ACTIONS",
    "Action",
    "EndFailureAction",
    "Failure",
    "FollowPathAction",
    "LaneChangeAction",
    "LaneOffsetAction",
    "MessageAction",
    "SensorNoiseAction",
    "SpeedAction",
    "StopAction",
    "WeatherAction",
]
