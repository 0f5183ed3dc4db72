"""The form of each word of the conflict language in an exported OpenSCENARIO file.

Words of the storyboard have forms, which both directions use (`openscenario`); the rest is said here. What the
standard has no words for is kept in properties, which this program reads back and others leave alone.
"""

from __future__ import annotations

from scenario_compiler.openscenario.actions import ACTIONS
from scenario_compiler.openscenario.conditions import BY_ENTITY, BY_VALUE
from scenario_compiler.openscenario.positions import POSITIONS
from scenario_compiler.openscenario.spelling import Form
from scenario_compiler.openscenario.structure.elements import elements
from scenario_compiler.source import conflict
from scenario_compiler.vocabulary import entities, scenario, signals, storyboard, variables, variation, weather
from scenario_compiler.vocabulary.actions import (
    AtRate,
    ControllerProperty,
    FinalSpeed,
    Limits,
    MasterPosition,
    OverDistance,
    SpeedEntry,
    SpeedRange,
    TrafficKind,
    TrajectoryTiming,
)
from scenario_compiler.vocabulary.conditions import RelativeLaneRange
from scenario_compiler.vocabulary.positions import routes
from scenario_compiler.vocabulary.word import Word

FORMS: dict[type[Word], Form[Word]] = {
    **ACTIONS.by_word,
    **BY_ENTITY.by_word,
    **BY_VALUE.by_word,
    **POSITIONS.by_word,
}
"""The words that are elements of the standard, as they are read and written."""

ELEMENTS: dict[type[Word], str] = {
    conflict.EntityWhen: "<Event>",
    storyboard.When: "<Event>",
    storyboard.Do: "<Action>",
    storyboard.AnyOf: "<ConditionGroup>",
    storyboard.All: "<ConditionGroup>",
    scenario.Parameter: "<ParameterDeclaration>",
    entities.Ego: "<ScenarioObject>",
    entities.Static: "<ScenarioObject>",
    entities.Dynamic: "<ScenarioObject>",
    entities.Vehicle: "<Vehicle>, <Pedestrian>, <MiscObject>",
    weather.Weather: "<EnvironmentAction>",
    variables.Variable: "<VariableDeclaration>",
    signals.SignalController: "<TrafficSignalController>",
    signals.SignalPhase: "<Phase>",
    signals.SignalState: "<TrafficSignalState>",
    routes.RouteWord: "<Route>",
    routes.Waypoint: "<Waypoint>",
    routes.InRouteLane: "<FromLaneCoordinates>",
    routes.InRouteRoad: "<FromRoadCoordinates>",
    routes.InRouteEntity: "<FromCurrentEntity>",
    routes.Trajectory: "<Trajectory>",
    routes.Polyline: "<Polyline>",
    routes.Vertex: "<Vertex>",
    routes.Clothoid: "<Clothoid>",
    routes.ClothoidSpline: "<ClothoidSpline>",
    routes.ClothoidSegment: "<ClothoidSplineSegment>",
    routes.Nurbs: "<Nurbs>",
    routes.ControlPoint: "<ControlPoint>",
    RelativeLaneRange: "<RelativeLaneRange>",
    AtRate: "dynamicsDimension",
    OverDistance: "dynamicsDimension",
    Limits: "<DynamicConstraints>",
    SpeedEntry: "<SpeedProfileEntry>",
    TrajectoryTiming: "<TimeReference>",
    FinalSpeed: "<FinalSpeed>",
    MasterPosition: "<TargetPositionMaster>",
    ControllerProperty: "<Property>",
    TrafficKind: "<VehicleCategoryDistributionEntry>",
    SpeedRange: "<InitialSpeedRange>",
    variation.Constraint: "nothing; reported",
}
"""Words whose elements are made within those of others, or by the exporter itself."""


def exported(word: type[Word], stage: str) -> str:
    """Return the form in an exported file of a word that takes effect in a stage."""
    form = FORMS.get(word)
    said = f"<{form.tag}>" if form is not None else ELEMENTS.get(word, "")
    if not said and stage == "sweep":
        said = "<ParameterValueDistribution>"
    if said:
        return said + _since(said)
    return "as its expansion" if stage in ("expansion", "compilation") else "kept in a property"


def _since(said: str) -> str:
    """Return the version that introduced the element which a text names; empty for an element of version 1.0."""
    tag = said.strip("<>")
    minor = min((element.since for element in elements().values() if tag in element.tags), default=0)
    return f" since 1.{minor}" if minor else ""
