"""Actions: what an event does. One module a family of the standard; `Action` is their union."""

from scenario_compiler.vocabulary.actions.lateral import LaneChangeAction
from scenario_compiler.vocabulary.actions.longitudinal import SpeedAction
from scenario_compiler.vocabulary.actions.sensor import SensorNoiseAction

Action = SpeedAction | LaneChangeAction | SensorNoiseAction

__all__ = ["Action", "LaneChangeAction", "SensorNoiseAction", "SpeedAction"]
