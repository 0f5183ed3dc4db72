"""The module that executes each word of the conflict language, declared once for each word.

The reader and the schema are made from the words' own declarations, so every word is read; what is done with it is
said here, by the module that does it and, in the engine, by the opcodes. A test holds both against the code.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from scenario_compiler.coverage.exported import exported
from scenario_compiler.coverage.table import Table
from scenario_compiler.engine.moves.table import ACTIONS
from scenario_compiler.engine.moves.table import NUMBERS as ACTION_NUMBERS
from scenario_compiler.engine.story.table import CONDITIONS
from scenario_compiler.engine.story.table import NUMBERS as CONDITION_NUMBERS
from scenario_compiler.source import catalogs, conflict
from scenario_compiler.vocabulary import (
    actions,
    conditions,
    criteria,
    driver,
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
"""Text for a word that nothing executes."""


MOST_PARENTS = 4
"""Greatest number of parents of a word that are listed."""


@dataclass(frozen=True, slots=True)
class Execution:
    """The code that executes a word.

    Attributes:
        stage: When.
        module: The module that does it, without the package's name.
        opcodes: Codes of `engine.opcodes` that it becomes there.
    """

    stage: Stage
    module: str
    opcodes: tuple[str, ...] = ()

    def text(self) -> str:
        """Return the text of the table."""
        return f"{self.stage}: {' '.join((self.module, *self.opcodes))}"


def _engine(module: str, *opcodes: str) -> Execution:
    return Execution("engine", f"engine.{module}", opcodes)


_EXPANDED = Execution("expansion", "source.templates")
_SAMPLED = Execution("sweep", "batch.distributions")
_JUDGED = Execution("judgement", "recording.criteria")
_BOUND = Execution("compilation", "plan.binding")
_PLACED = _engine("motion.places", "POSITION_LANE")
_RANDOM_PLACE = _engine("motion.places", "POSITION_RANDOM")
_STORYBOARD = _engine("story.storyboard", "ELEMENT_EVENT")

OTHERS: dict[type[Word], Execution] = {
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
    entities.Ego: _engine("motion.entities", "MOTION_BICYCLE"),
    entities.Static: _engine("motion.entities", "MOTION_STATIC"),
    entities.Dynamic: _engine("motion.entities", "MOTION_SCRIPTED"),
    entities.Row: Execution("expansion", "source.groups"),
    entities.WorkZone: Execution("expansion", "source.groups"),
    entities.Traffic: _engine("traffic.driving", "MOTION_TRAFFIC", "MOTION_WALKER"),
    entities.Follow: _engine("motion.following"),
    entities.Controller: Execution("run", "controllers.named"),
    entities.Property: Execution("run", "controllers.named"),
    sensors.ForwardSensor: _engine("ego.reach", "SENSOR_CAMERA", "SENSOR_RADAR", "SENSOR_LIDAR"),
    entities.Detector: Execution("run", "controllers.detectors"),
    sensors.Odometry: _engine("ego.lane_memory"),
    sensors.Camera: Execution("camera", "perception.stage"),
    markings.Markings: _engine("ego.lane_confidence", "ALL_MARKS"),
    markings.SecondaryMarkings: Execution("camera", "perception.stage"),
    markings.LineBeside: Execution("camera", "perception.stage"),
    weather.Weather: Execution("camera", "perception.weather_look"),
    positions.SpawnPoints: _BOUND,
    positions.NamedPosition: _BOUND,
    positions.SpawnPoint: _BOUND,
    positions.NumberedSpawnPoint: _BOUND,
    positions.RandomSpawnPoint: _RANDOM_PLACE,
    positions.RandomPosition: _RANDOM_PLACE,
    positions.LanePositionWord: _PLACED,
    positions.RoadPosition: _BOUND,
    positions.WorldPosition: _BOUND,
    positions.RelativeLanePosition: _engine("motion.places", "POSITION_RELATIVE"),
    positions.BesidePosition: _engine("motion.places", "POSITION_BESIDE"),
    positions.FreePosition: _engine("motion.positions", "POSITION_FREE"),
    positions.GeoPosition: _BOUND,
    positions.LanesAwayPosition: _engine("motion.positions", "POSITION_LANES_AWAY"),
    positions.RelativeRoadPosition: _engine("motion.positions", "POSITION_RELATIVE_ROAD"),
    positions.RelativeObjectPosition: _engine("motion.positions", "POSITION_RELATIVE_OBJECT"),
    positions.RelativeWorldPosition: _engine("motion.positions", "POSITION_RELATIVE_WORLD"),
    positions.RoutePosition: _engine("motion.positions", "POSITION_LANE", "POSITION_LANES_AWAY"),
    routes.TrajectoryPosition: _engine("motion.on_tracks", "POSITION_ON_TRAJECTORY"),
    routes.RouteWord: _engine("motion.routes"),
    routes.Waypoint: _engine("motion.routes"),
    routes.InRouteLane: _engine("motion.positions", "POSITION_LANE"),
    routes.InRouteRoad: _engine("motion.positions", "POSITION_LANE"),
    routes.InRouteEntity: _engine("motion.positions", "POSITION_LANES_AWAY"),
    routes.Trajectory: _engine("motion.tracks"),
    routes.Polyline: _engine("motion.laying", "TRACK_POLYLINE"),
    routes.Vertex: _engine("motion.laying", "TRACK_POLYLINE"),
    routes.Clothoid: _engine("motion.laying", "TRACK_CLOTHOIDS"),
    routes.ClothoidSpline: _engine("motion.laying", "TRACK_CLOTHOIDS"),
    routes.ClothoidSegment: _engine("motion.laying", "TRACK_CLOTHOIDS"),
    routes.Nurbs: _engine("motion.laying", "TRACK_NURBS"),
    routes.ControlPoint: _engine("motion.laying", "TRACK_NURBS"),
    actions.TrajectoryTiming: _engine("motion.tracks"),
    storyboard.When: _STORYBOARD,
    storyboard.Do: _STORYBOARD,
    storyboard.All: Execution("expansion", "source.events"),
    storyboard.AnyOf: Execution("expansion", "source.events"),
    conditions.RelativeLaneRange: _engine("story.clearance"),
    actions.AtRate: _engine("motion.shapes", "DIMENSION_RATE"),
    actions.OverDistance: _engine("motion.shapes", "DIMENSION_DISTANCE"),
    actions.Limits: _engine("moves.keeping_distance", "FLAG_LIMITED"),
    actions.SpeedEntry: _engine("moves.speed_profiles"),
    actions.MasterPosition: _engine("moves.synchronizing"),
    actions.FinalSpeed: _engine("moves.synchronizing", "FINAL_ABSOLUTE", "FINAL_DELTA", "FINAL_FACTOR"),
    PathPoint: _engine("moves.follow_path"),
    actions.TrafficKind: Execution("compilation", "plan.keeping"),
    actions.SpeedRange: Execution("compilation", "plan.keeping"),
    actions.ControllerProperty: _engine("program"),
    variables.Variable: _engine("moves.variables"),
    signals.SignalController: _engine("moves.signals"),
    signals.SignalPhase: _engine("moves.signals"),
    signals.SignalState: _engine("moves.signals"),
    takeover.Takeover: _engine("ego.takeover", "TAKEOVER_REQUEST", "TAKEOVER_MINIMUM_RISK"),
    takeover.Cause: _engine(
        "ego.takeover",
        "CAUSE_CONTROLLER",
        "CAUSE_SENSOR_HEALTH",
        "CAUSE_LANE_CONFIDENCE",
        "CAUSE_PATH_BLOCKED",
        "CAUSE_LANE_ENDS",
        "CAUSE_NO_PROGRESS",
    ),
    driver.Person: _engine("ego.person", "WISH_TAKE_OVER", "WISH_HAND_BACK"),
    driver.Driver: Execution("expansion", "source.expansion"),
    driver.DriverModel: _engine("ego.answering", "DRIVER_LOGNORMAL", "DRIVER_NORMAL", "DRIVER_SUMO", "DRIVER_FIXED"),
    driver.Driving: _engine("ego.driver"),
    driver.Inputs: _engine("measures.inputs"),
    driver.Effect: _engine("ego.answering"),
    takeover.Automation: _engine(
        "ego.limits", "BEHAVIOUR_FOLLOW", "BEHAVIOUR_HOLD_SPEED", "BEHAVIOUR_SLOW_DOWN", "BEHAVIOUR_LET_GO"
    ),
    takeover.Message: Execution("run", "runtime.messages"),
    takeover.Say: Execution("run", "runtime.messages"),
    criteria.NoCollision: _JUDGED,
    criteria.StayOnRoad: _JUDGED,
    criteria.ReachDestination: _JUDGED,
    criteria.MinimumTimeToCollision: _JUDGED,
    criteria.TakeoverWithin: _JUDGED,
    criteria.Requested: _JUDGED,
    criteria.NoMinimumRisk: _JUDGED,
    criteria.NoAvoidableCollision: Execution("judgement", "engine.reference_runs"),
    criteria.MakesProgress: _JUDGED,
    criteria.NoObstruction: _JUDGED,
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


def _declared() -> dict[type[Word], Execution]:
    """Return the code that executes actions and conditions, by their entries in the engine."""
    found: dict[type[Word], Execution] = {}
    for word in (*get_args(actions.Action), Path):
        if word.tag() in ACTION_NUMBERS:
            found[word] = Execution("engine", ACTIONS[ACTION_NUMBERS[word.tag()]].module)
    for word in get_args(conditions.Condition):
        if word.tag() in CONDITION_NUMBERS:
            found[word] = Execution("engine", CONDITIONS[CONDITION_NUMBERS[word.tag()]].module)
    return found


EXECUTION: dict[type[Word], Execution] = {**OTHERS, **_declared()}
"""The code that executes each word."""


def conflict_table() -> Table:
    """Return the table of the conflict language's words, in the order of its reference."""
    columns = ("word", "inside", "read", "executed", "exported")
    return Table("conflict", "The conflict language", columns, tuple(map(_row, conflict_words())))


def _row(word: type[Word]) -> tuple[str, ...]:
    stage = EXECUTION[word].stage if word in EXECUTION else ""
    return (f"<{word.tag()}>", _parents(word), "yes", _executed(word), exported(word, stage))


def _executed(word: type[Word]) -> str:
    return EXECUTION[word].text() if word in EXECUTION else NOT_YET


def conflict_words() -> list[type[Word]]:
    """Return every word of the conflict language's files, in the order of its reference."""
    return words_below((conflict.LibraryElement, catalogs.CatalogElement))


def _parents(word: type[Word]) -> str:
    """Return the elements that can contain a word; only the first few are listed."""
    tags = [
        f"<{rule.wrapper or parent.tag()}>"
        for parent in conflict_words()
        for rule in grammar_of(parent).children
        if word in rule.words.values()
    ]
    named = list(dict.fromkeys(tags))
    return ", ".join(named[:MOST_PARENTS]) + (", ..." if len(named) > MOST_PARENTS else "")
