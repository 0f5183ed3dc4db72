"""What executes each word of the conflict language: one declaration a word.

The reader and the schema are made from the words' own declarations, so every word is read; what is done with it is
said here, by the module that does it and, in the engine, by the opcodes. A test holds both against the code.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from scenario_compiler.coverage.exported import exported
from scenario_compiler.coverage.table import Table
from scenario_compiler.source import catalogs, conflict
from scenario_compiler.vocabulary import (
    actions,
    conditions,
    criteria,
    entities,
    markings,
    positions,
    scenario,
    sensors,
    signals,
    storyboard,
    takeover,
    variables,
    variation,
    weather,
)
from scenario_compiler.vocabulary.actions.path import Path, PathPoint
from scenario_compiler.vocabulary.grammar import grammar_of
from scenario_compiler.vocabulary.positions import routes
from scenario_compiler.vocabulary.schema import words_below
from scenario_compiler.vocabulary.word import Word

Stage = Literal["expansion", "compilation", "engine", "camera", "run", "judgement", "sweep", "report"]
"""When a word takes effect."""

NOT_YET = "not yet"
"""What stands where nothing executes a word."""


MOST_PARENTS = 4
"""Elements that are named as a word's parents before the rest is left out."""


@dataclass(frozen=True, slots=True)
class Execution:
    """What executes a word in the kinematic world.

    Attributes:
        stage: When.
        module: The module that does it, without the package's name.
        opcodes: Codes of `engine.opcodes` that it becomes there.
    """

    stage: Stage
    module: str
    opcodes: tuple[str, ...] = ()

    def text(self) -> str:
        """Return what the table says."""
        return f"{self.stage}: {' '.join((self.module, *self.opcodes))}"


def _engine(module: str, *opcodes: str) -> Execution:
    return Execution("engine", f"engine.{module}", opcodes)


def _condition(opcode: str) -> Execution:
    return _engine("conditions", f"CONDITION_{opcode}")


def _entity_condition(opcode: str) -> Execution:
    return _engine("entity_conditions", f"CONDITION_{opcode}")


def _world(opcode: str) -> Execution:
    return _engine("world_actions", f"ACTION_{opcode}")


_EXPANDED = Execution("expansion", "source.templates")
_SAMPLED = Execution("sweep", "batch.distributions")
_JUDGED = Execution("judgement", "recording.criteria")
_BOUND = Execution("compilation", "plan.binding")
_PLACED = _engine("placing", "POSITION_LANE")
_RANDOM_PLACE = _engine("placing", "POSITION_RANDOM")
_STORYBOARD = _engine("storyboard", "ELEMENT_EVENT")

EXECUTION: dict[type[Word], Execution] = {
    conflict.LibraryElement: Execution("expansion", "source.conflict"),
    conflict.Allow: Execution("compilation", "source.conflict"),
    conflict.Include: Execution("expansion", "source.conflict"),
    conflict.TemplateElement: _EXPANDED,
    conflict.ScenarioElement: Execution("expansion", "source.expansion"),
    conflict.Use: _EXPANDED,
    conflict.If: _EXPANDED,
    conflict.Else: _EXPANDED,
    conflict.Repeat: _EXPANDED,
    conflict.For: _EXPANDED,
    conflict.EntityWhen: _STORYBOARD,
    catalogs.CatalogElement: Execution("expansion", "source.catalogs"),
    scenario.Parameter: Execution("engine", "engine.program"),
    scenario.Classification: Execution("report", "report.wording"),
    entities.Vehicle: Execution("compilation", "plan.lower"),
    entities.Ego: _engine("motion", "MOTION_BICYCLE"),
    entities.Static: _engine("motion", "MOTION_STATIC"),
    entities.Dynamic: _engine("motion", "MOTION_SCRIPTED"),
    entities.Row: Execution("expansion", "source.groups"),
    entities.WorkZone: Execution("expansion", "source.groups"),
    entities.Traffic: _engine("traffic", "MOTION_TRAFFIC", "MOTION_WALKER"),
    entities.Follow: _engine("following"),
    entities.Controller: Execution("run", "controllers"),
    entities.Property: Execution("run", "controllers"),
    sensors.Camera: Execution("camera", "worlds.kinematic"),
    sensors.Failure: _engine("failures", "ACTION_FAILURE"),
    markings.Markings: _engine("lane_confidence", "ALL_MARKS"),
    markings.SecondaryMarkings: Execution("camera", "worlds.kinematic"),
    markings.LineBeside: Execution("camera", "worlds.kinematic"),
    weather.Weather: Execution("camera", "perception.weather_look"),
    positions.SpawnPoints: _BOUND,
    positions.NamedPosition: _BOUND,
    positions.SpawnPoint: _BOUND,
    positions.NumberedSpawnPoint: _BOUND,
    positions.RandomSpawnPoint: _RANDOM_PLACE,
    positions.RandomPosition: _RANDOM_PLACE,
    positions.LanePosition: _PLACED,
    positions.RoadPosition: _BOUND,
    positions.WorldPosition: _BOUND,
    positions.RelativeLanePosition: _engine("placing", "POSITION_RELATIVE"),
    positions.BesidePosition: _engine("placing", "POSITION_BESIDE"),
    positions.FreePosition: _engine("positions", "POSITION_FREE"),
    positions.GeoPosition: _BOUND,
    positions.LanesAwayPosition: _engine("positions", "POSITION_LANES_AWAY"),
    positions.RelativeRoadPosition: _engine("positions", "POSITION_RELATIVE_ROAD"),
    positions.RelativeObjectPosition: _engine("positions", "POSITION_RELATIVE_OBJECT"),
    positions.RelativeWorldPosition: _engine("positions", "POSITION_RELATIVE_WORLD"),
    positions.RoutePosition: _engine("positions", "POSITION_LANE", "POSITION_LANES_AWAY"),
    routes.TrajectoryPosition: _engine("on_tracks", "POSITION_ON_TRAJECTORY"),
    routes.Route: _engine("routes"),
    routes.Waypoint: _engine("routes"),
    routes.InRouteLane: _engine("positions", "POSITION_LANE"),
    routes.InRouteRoad: _engine("positions", "POSITION_LANE"),
    routes.InRouteEntity: _engine("positions", "POSITION_LANES_AWAY"),
    routes.Trajectory: _engine("tracks"),
    routes.Polyline: _engine("laying", "TRACK_POLYLINE"),
    routes.Vertex: _engine("laying", "TRACK_POLYLINE"),
    routes.Clothoid: _engine("laying", "TRACK_CLOTHOIDS"),
    routes.ClothoidSpline: _engine("laying", "TRACK_CLOTHOIDS"),
    routes.ClothoidSegment: _engine("laying", "TRACK_CLOTHOIDS"),
    routes.Nurbs: _engine("laying", "TRACK_NURBS"),
    routes.ControlPoint: _engine("laying", "TRACK_NURBS"),
    actions.AssignRouteAction: _engine("routes", "ACTION_ASSIGN_ROUTE"),
    actions.AcquirePositionAction: _engine("routes", "ACTION_ASSIGN_ROUTE"),
    actions.RandomRouteAction: _engine("routes", "ACTION_RANDOM_ROUTE"),
    actions.FollowTrajectoryAction: _engine("trajectories", "ACTION_FOLLOW_TRAJECTORY"),
    actions.TrajectoryTiming: _engine("tracks"),
    storyboard.When: _STORYBOARD,
    storyboard.Do: _STORYBOARD,
    storyboard.All: Execution("expansion", "source.events"),
    storyboard.AnyOf: Execution("expansion", "source.events"),
    conditions.SimulationTimeCondition: _condition("TIME"),
    conditions.TimeHeadwayCondition: _entity_condition("TIME_HEADWAY"),
    conditions.DistanceCondition: _entity_condition("DISTANCE"),
    conditions.TimeToCollisionCondition: _entity_condition("TIME_TO_COLLISION"),
    conditions.SpeedCondition: _entity_condition("SPEED"),
    conditions.ReachPositionCondition: _entity_condition("REACH_POSITION"),
    conditions.TraveledDistanceCondition: _entity_condition("TRAVELED_DISTANCE"),
    conditions.StandstillCondition: _entity_condition("STANDSTILL"),
    conditions.PositionDistanceCondition: _entity_condition("POSITION_DISTANCE"),
    conditions.RelativeSpeedCondition: _entity_condition("RELATIVE_SPEED"),
    conditions.AccelerationCondition: _entity_condition("ACCELERATION"),
    conditions.CollisionCondition: _entity_condition("COLLISION"),
    conditions.OffroadCondition: _entity_condition("OFF_ROAD"),
    conditions.EndOfRoadCondition: _entity_condition("END_OF_ROAD"),
    conditions.RelativeClearanceCondition: _engine("clearance", "CONDITION_CLEARANCE"),
    conditions.RelativeLaneRange: _engine("clearance"),
    conditions.AngleCondition: _entity_condition("ANGLE"),
    conditions.RelativeAngleCondition: _entity_condition("RELATIVE_ANGLE"),
    conditions.LaneConfidenceCondition: _condition("LANE_CONFIDENCE"),
    conditions.SensorHealthCondition: _condition("SENSOR_HEALTH"),
    conditions.TakeoverStateCondition: _condition("TAKEOVER_STATE"),
    conditions.EventCondition: _condition("ELEMENT_STATE"),
    conditions.ElementStateCondition: _engine("conditions", "CONDITION_ELEMENT_STATE", "CONDITION_TRANSITION"),
    conditions.TimeOfDayCondition: _condition("TIME_OF_DAY"),
    conditions.VariableCondition: _condition("VARIABLE"),
    conditions.UserDefinedValueCondition: _condition("USER_VALUE"),
    conditions.TrafficSignalCondition: _condition("SIGNAL"),
    conditions.TrafficSignalControllerCondition: _condition("SIGNAL_PHASE"),
    actions.SpeedAction: _engine("speeds", "ACTION_SPEED"),
    actions.RelativeSpeedAction: _engine("speeds", "ACTION_RELATIVE_SPEED"),
    actions.AtRate: _engine("shapes", "DIMENSION_RATE"),
    actions.OverDistance: _engine("shapes", "DIMENSION_DISTANCE"),
    actions.Limits: _engine("keeping_distance", "FLAG_LIMITED"),
    actions.SpeedProfileAction: _engine("speed_profiles", "ACTION_SPEED_PROFILE"),
    actions.SpeedEntry: _engine("speed_profiles"),
    actions.LongitudinalDistanceAction: _engine("keeping_distance", "ACTION_KEEP_DISTANCE"),
    actions.SynchronizeAction: _engine("synchronizing", "ACTION_SYNCHRONIZE"),
    actions.MasterPosition: _engine("synchronizing"),
    actions.FinalSpeed: _engine("synchronizing", "FINAL_ABSOLUTE", "FINAL_DELTA", "FINAL_FACTOR"),
    actions.LaneChangeAction: _engine("lane_changes", "ACTION_LANE_CHANGE"),
    actions.LaneChangeToAction: _engine("lane_changes", "ACTION_LANE_CHANGE_TO"),
    actions.LaneOffsetAction: _engine("lane_offsets", "ACTION_LANE_OFFSET"),
    actions.LimitedLaneOffsetAction: _engine("lane_offsets", "ACTION_LIMITED_LANE_OFFSET"),
    actions.LateralDistanceAction: _engine("keeping_aside", "ACTION_KEEP_LATERAL_DISTANCE"),
    actions.FollowPathAction: _engine("actions", "ACTION_FOLLOW_PATH"),
    Path: _engine("actions", "ACTION_FOLLOW_PATH"),
    PathPoint: _engine("own_path"),
    actions.TeleportAction: _engine("appearing", "ACTION_TELEPORT"),
    actions.AddEntityAction: _engine("appearing", "ACTION_ADD_ENTITY"),
    actions.DeleteEntityAction: _engine("appearing", "ACTION_DELETE_ENTITY"),
    actions.VisibilityAction: _engine("presence", "ACTION_VISIBILITY"),
    actions.ConnectTrailerAction: _engine("trailers", "ACTION_CONNECT_TRAILER"),
    actions.DisconnectTrailerAction: _engine("trailers", "ACTION_DISCONNECT_TRAILER"),
    actions.SensorNoiseAction: _engine("starts", "ACTION_SENSOR_NOISE"),
    actions.EndFailureAction: _engine("starts", "ACTION_END_FAILURE"),
    actions.WeatherAction: _engine("starts", "ACTION_WEATHER"),
    actions.MessageAction: _engine("starts", "ACTION_MESSAGE"),
    actions.StopAction: _engine("starts", "ACTION_STOP"),
    actions.SetVariableAction: _world("SET_VARIABLE"),
    actions.ModifyVariableAction: _world("MODIFY_VARIABLE"),
    actions.TrafficSignalStateAction: _world("SIGNAL_STATE"),
    actions.TrafficSignalControllerAction: _world("SIGNAL_PHASE"),
    actions.EnvironmentAction: _engine("surroundings", "ACTION_ENVIRONMENT"),
    actions.CommandAction: _world("COMMAND"),
    actions.TrafficSwarmAction: _engine("swarms", "ACTION_TRAFFIC_SWARM"),
    actions.TrafficSourceAction: _engine("sources", "ACTION_TRAFFIC_SOURCE"),
    actions.TrafficSinkAction: _engine("sources", "ACTION_TRAFFIC_SINK"),
    actions.TrafficKind: Execution("compilation", "plan.keeping"),
    actions.SpeedRange: Execution("compilation", "plan.keeping"),
    actions.StopTrafficAction: _world("STOP_TRAFFIC"),
    actions.ActivateControllerAction: _engine("controllers", "ACTION_ACTIVATE_CONTROLLER"),
    actions.AssignControllerAction: _engine("controllers", "ACTION_ASSIGN_CONTROLLER"),
    actions.ControllerProperty: _engine("program"),
    actions.OverrideControllerAction: _engine("controllers", "ACTION_OVERRIDE_CONTROLLER"),
    actions.LightAction: _world("LIGHT"),
    actions.AnimationAction: _world("ANIMATION"),
    variables.Variable: _engine("variables"),
    signals.SignalController: _engine("signals"),
    signals.SignalPhase: _engine("signals"),
    signals.SignalState: _engine("signals"),
    takeover.Takeover: _engine("takeover", "TAKEOVER_REQUEST", "TAKEOVER_MINIMUM_RISK"),
    takeover.Cause: _engine(
        "takeover",
        "CAUSE_CONTROLLER",
        "CAUSE_SENSOR_HEALTH",
        "CAUSE_LANE_CONFIDENCE",
        "CAUSE_PATH_BLOCKED",
        "CAUSE_LANE_ENDS",
    ),
    takeover.Driver: Execution("expansion", "source.expansion"),
    takeover.DriverModel: _engine("takeover", "DRIVER_LOGNORMAL", "DRIVER_FIXED"),
    takeover.Message: Execution("run", "runtime.messages"),
    criteria.NoCollision: _JUDGED,
    criteria.StayOnRoad: _JUDGED,
    criteria.ReachDestination: _JUDGED,
    criteria.MinimumTimeToCollision: _JUDGED,
    criteria.TakeoverWithin: _JUDGED,
    criteria.Requested: _JUDGED,
    criteria.NoMinimumRisk: _JUDGED,
    criteria.MaximumLateralOffset: _JUDGED,
    variation.Vary: Execution("sweep", "batch.sampling"),
    variation.Uniform: _SAMPLED,
    variation.Normal: _SAMPLED,
    variation.Lognormal: _SAMPLED,
    variation.Triangular: _SAMPLED,
    variation.Poisson: _SAMPLED,
    variation.Histogram: _SAMPLED,
    variation.Choice: _SAMPLED,
    variation.Weighted: _SAMPLED,
    variation.Values: _SAMPLED,
    variation.Grid: _SAMPLED,
    variation.Constraint: Execution("sweep", "batch.sampling"),
}


def conflict_table() -> Table:
    """Return the table of the conflict language's words, in the order of its reference."""
    columns = ("word", "stands in", "read", "executed, kinematic", "executed, CARLA", "exported")
    return Table("conflict", "The conflict language", columns, tuple(map(_row, conflict_words())))


def _row(word: type[Word]) -> tuple[str, ...]:
    stage = EXECUTION[word].stage if word in EXECUTION else ""
    return (f"<{word.tag()}>", _parents(word), "yes", _executed(word), NOT_YET, exported(word, stage))


def _executed(word: type[Word]) -> str:
    return EXECUTION[word].text() if word in EXECUTION else NOT_YET


def conflict_words() -> list[type[Word]]:
    """Return every word of the conflict language's files, in the order of its reference."""
    return words_below((conflict.LibraryElement, catalogs.CatalogElement))


def _parents(word: type[Word]) -> str:
    """Return the elements that a word stands in, the first few by name."""
    tags = [
        f"<{rule.wrapper or parent.tag()}>"
        for parent in conflict_words()
        for rule in grammar_of(parent).children
        if word in rule.words.values()
    ]
    named = list(dict.fromkeys(tags))
    return ", ".join(named[:MOST_PARENTS]) + (", ..." if len(named) > MOST_PARENTS else "")
