"""The elements of OpenSCENARIO 1.0 to 1.3 that are read, executed and exported, one row for each.

Which elements there are, and since when, is taken from the declarations that files are checked by; what an action,
condition or position becomes, from the forms that read and write it and from the engine's tables. What only holds
other elements, or belongs to the file and not to the storyboard, says here who reads it and what becomes of it.
"""

from __future__ import annotations

from dataclasses import dataclass

from scenario_compiler.coverage.conflict import EXECUTION, MOST_PARENTS, NOT_YET, Execution
from scenario_compiler.coverage.table import Table
from scenario_compiler.engine.moves.table import NUMBERS as ACTION_NUMBERS
from scenario_compiler.engine.program.positions import POSITIONS as POSITION_ROWS
from scenario_compiler.engine.story.table import NUMBERS as CONDITION_NUMBERS
from scenario_compiler.openscenario.actions import ACTIONS
from scenario_compiler.openscenario.conditions import BY_ENTITY, BY_VALUE
from scenario_compiler.openscenario.positions import POSITIONS
from scenario_compiler.openscenario.structure.elements import Element, elements
from scenario_compiler.openscenario.structure.grammar import FIRST_MINOR, LAST_MINOR
from scenario_compiler.vocabulary.word import Word


@dataclass(frozen=True, slots=True)
class Home:
    """Elements that one module reads, beside those that are words themselves.

    Attributes:
        reader: The module, below `openscenario`.
        execution: What becomes of them; None for the parts of actions, conditions and positions, which those execute.
        written: Names of those that an exported file has.
        expanded: Names of those that an exported file does not have, because what they stand for is written out.
        unwritten: Names of those that no exported file needs.
    """

    reader: str
    execution: Execution | None
    written: str = ""
    expanded: str = ""
    unwritten: str = ""

    def names(self) -> list[str]:
        """Return the names of all its elements."""
        return f"{self.written} {self.expanded} {self.unwritten}".split()


_STORYBOARD = Execution("engine", "engine.story.storyboard")
_SAMPLED = Execution("sweep", "batch.sampling")

HOMES = (
    Home("expansion", Execution("compilation", "compiler"), "OpenSCENARIO FileHeader"),
    Home("parameters", Execution("expansion", "openscenario.parameters"),
         "ParameterDeclarations ParameterDeclaration",
         "ValueConstraintGroup ValueConstraint ParameterAssignments ParameterAssignment"),
    Home("variables", Execution("engine", "engine.moves.variables"),
         "VariableDeclarations VariableDeclaration", "MonitorDeclarations MonitorDeclaration"),
    Home("catalogs", Execution("expansion", "openscenario.catalogs"),
         "CatalogLocations", "CatalogLocation Directory CatalogReference"),
    Home("catalog_files", Execution("expansion", "openscenario.catalog_files"), "Catalog"),
    Home("road_network", Execution("compilation", "plan.maps"), "RoadNetwork File"),
    Home("road_network", Execution("engine", "engine.moves.signals"),
         "TrafficSignals TrafficSignalController Phase TrafficSignalState TrafficSignalGroupState"),
    Home("entities", Execution("compilation", "plan.lower"),
         "Entities ScenarioObject ObjectController Controller",
         "ExternalObjectReference EntitySelection SelectedEntities ByType Trailer"),
    Home("vehicles", Execution("compilation", "plan.lower"),
         "Vehicle Pedestrian MiscObject BoundingBox Center Dimensions Performance Axles Axle TrailerHitch "
         "TrailerCoupler"),
    Home("actions.control", Execution("run", "controllers.named"), "Properties Property"),
    Home("expansion", _STORYBOARD, "Storyboard"),
    Home("storyboard", _STORYBOARD,
         "Init InitActions Private Story Act ManeuverGroup Actors Maneuver Event Action"),
    Home("triggers", _STORYBOARD, "Trigger ConditionGroup Condition ByEntityCondition TriggeringEntities "
         "EntityCondition ByValueCondition EntityRef"),
    Home("conditions", None, "ByObjectType TimeToCollisionConditionTarget RelativeLaneRange"),
    Home("points", None, "Orientation"),
    Home("motion", None,
         "Position RouteRef Route Waypoint InRoutePosition PositionOfCurrentEntity PositionInRoadCoordinates "
         "PositionInLaneCoordinates TrajectoryRef Trajectory Shape Polyline Vertex Clothoid ClothoidSpline "
         "ClothoidSplineSegment Nurbs ControlPoint Knot"),
    Home("actions", None,
         "PrivateAction GlobalAction UserDefinedAction LongitudinalAction LateralAction RoutingAction AppearanceAction "
         "ControllerAction TrailerAction InfrastructureAction TrafficSignalAction TrafficAction"),
    Home("actions.longitudinal", None,
         "TransitionDynamics SpeedActionTarget AbsoluteTargetSpeed RelativeTargetSpeed SpeedProfileEntry"),
    Home("actions.dynamics", None, "DynamicConstraints"),
    Home("actions.lateral", None,
         "LaneChangeTarget AbsoluteTargetLane RelativeTargetLane LaneOffsetActionDynamics LaneOffsetTarget "
         "AbsoluteTargetLaneOffset RelativeTargetLaneOffset"),
    Home("actions.routing", None,
         "FinalSpeed AbsoluteSpeed RelativeSpeedToMaster TargetDistanceSteadyState TargetTimeSteadyState TimeReference "
         "None Timing TrajectoryFollowingMode"),
    Home("actions.control", None,
         "OverrideThrottleAction OverrideBrakeAction OverrideClutchAction OverrideParkingBrakeAction "
         "OverrideSteeringWheelAction OverrideGearAction Brake ManualGear", unwritten="AutomaticGear"),
    Home("actions.appearance", None,
         "LightType VehicleLight UserDefinedLight LightState AnimationType AnimationState ComponentAnimation "
         "VehicleComponent PedestrianAnimation UserDefinedAnimation", unwritten="UserDefinedComponent AnimationFile"),
    Home("actions.world", None,
         "AddEntityAction DeleteEntityAction ParameterSetAction ParameterModifyAction ModifyRule ParameterAddValueRule "
         "ParameterMultiplyByValueRule VariableSetAction VariableModifyAction VariableModifyRule VariableAddValueRule "
         "VariableMultiplyByValueRule"),
    Home("actions.traffic", None,
         "CentralSwarmObject DirectionOfTravelDistribution TrafficDefinition VehicleCategoryDistribution "
         "VehicleCategoryDistributionEntry",
         unwritten="TrafficDistribution TrafficDistributionEntry EntityDistribution EntityDistributionEntry "
         "ScenarioObjectTemplate"),
    Home("actions.environment", None,
         "Environment TimeOfDay Weather Sun Fog Precipitation Wind RoadCondition"),
    Home("distributions", _SAMPLED,
         "Deterministic DeterministicSingleParameterDistribution DistributionSet DistributionSetElement "
         "DistributionRange Range Stochastic StochasticDistribution ProbabilityDistributionSet "
         "ProbabilityDistributionSetElement NormalDistribution LogNormalDistribution UniformDistribution "
         "PoissonDistribution Histogram HistogramBin",
         unwritten="DeterministicMultiParameterDistribution ValueSetDistribution ParameterValueSet"),
    Home("expansion", _SAMPLED, "ParameterValueDistribution"),
)  # fmt: skip
"""Modules that read elements other than actions, conditions and positions."""

_TRAFFIC = "all vehicles of traffic drive by the same rules, and there is no traffic in an area: reported"
_DESCRIPTION = "it describes the file and means nothing to a run"

UNREAD: dict[str, str] = {
    **dict.fromkeys(("License", "CustomContent"), _DESCRIPTION),
    "UsedArea": "the whole road network is loaded",
    **dict.fromkeys(("SensorReferenceSet", "SensorReference"), "visibility is switched for all sensors: reported"),
    **dict.fromkeys(("Color", "ColorRgb", "ColorCmyk"), "a light is logged as on, off or flashing: reported"),
    "PedestrianGesture": "a pedestrian's motion is logged, gestures are not: reported",
    "DomeImage": "the sky is drawn by the weather: reported",
    "UserDefinedDistribution": "only its author knows what it draws: diagnosed",
    **dict.fromkeys(
        (
            *("TrafficAreaAction", "TrafficArea", "Polygon", "RoadRange", "RoadCursor", "Lane"),
            *("VehicleRoleDistribution", "VehicleRoleDistributionEntry"),
            *("ControllerDistribution", "ControllerDistributionEntry"),
        ),
        _TRAFFIC,
    ),
}
"""Elements without effect, and why."""

WITHOUT_EFFECT: dict[str, str] = {
    "FileHeader": "author date description",
    "Vehicle": "mass model3d role",
    "Pedestrian": "mass model model3d role",
    "MiscObject": "mass model3d",
    "Center": "y z",
    "Performance": "maxAccelerationRate maxDecelerationRate",
    "Axle": "positionZ trackWidth wheelDiameter",
    "TrailerHitch": "dz",
    "TrailerCoupler": "dz",
    "GeoPosition": "altitude height verticalRoadSelection",
    "TimeHeadwayCondition": "routingAlgorithm",
    "TimeToCollisionCondition": "routingAlgorithm",
    "DistanceCondition": "routingAlgorithm",
    "RelativeDistanceCondition": "routingAlgorithm",
    "AssignControllerAction": "activateAnimation activateLighting",
    "OverrideThrottleAction": "maxRate",
    "Brake": "<BrakeForce> maxRate",
    "OverrideClutchAction": "maxRate",
    "OverrideSteeringWheelAction": "maxRate maxTorque",
    "LightStateAction": "transitionTime",
    "LightState": "flashingOffDuration flashingOnDuration luminousIntensity",
    "AnimationFile": "timeOffset",
    "Weather": "atmosphericPressure temperature",
    "Sun": "illuminance intensity",
    "Wind": "direction",
}
"""Attributes without effect, of elements that have one, and names of an element under which it has none."""

FORMS = (*ACTIONS.forms, *BY_ENTITY.forms, *BY_VALUE.forms, *POSITIONS.forms)
"""The elements that are words."""

_WRITTEN = {form.tag for family in (ACTIONS, BY_ENTITY, BY_VALUE, POSITIONS) for form in family.by_word.values()}
_HOME = {name: home for home in HOMES for name in home.names()}


def openscenario_table() -> Table:
    """Return the table of OpenSCENARIO's elements, in the order of the standard's declarations."""
    columns = ("element", "versions", "attributes of some versions", "read", "executed")
    return Table(
        "openscenario",
        "OpenSCENARIO 1.0 to 1.3",
        (*columns, "exported"),
        tuple(_row(element) for element in elements().values()),
    )


def _row(element: Element) -> tuple[str, ...]:
    named = " ".join(f"<{tag}>" for tag in element.tags)
    if element.tags != (element.name,):
        named += f" ({element.name})"
    versions = span(element.since, element.until)
    return (named, versions, _parts(element), _read(element), _executed(element), _sent(element))


def span(since: int, until: int) -> str:
    """Return the minor versions from one to another as a text."""
    if since == until:
        return f"1.{since}"
    return f"1.{since} to 1.{until}" if until < LAST_MINOR else f"all since 1.{since}" if since else "all"


def _parts(element: Element) -> str:
    """Return the attributes that not all of the element's versions have."""
    whole = (element.since, element.until)
    return ", ".join(f"{name} {_from_to(*ends)}" for name, ends in element.attributes.items() if ends != whole) or "-"


def _from_to(since: int, until: int) -> str:
    if until == LAST_MINOR:
        return f"since 1.{since}"
    return f"until 1.{until}" if since == FIRST_MINOR else span(since, until)


def words_of(element: Element) -> list[type[Word]]:
    """Return the words that an element is read as; none for one that belongs to others."""
    return list(dict.fromkeys(form.word for form in FORMS if form.tag in element.tags and element.name == form.tag))


def _read(element: Element) -> str:
    if element.name in UNREAD:
        return f"no: {UNREAD[element.name]}"
    words = ", ".join(f"<{word.tag()}>" for word in words_of(element))
    read = f"as {words}" if words else f"openscenario.{_HOME[element.name].reader}"
    without = WITHOUT_EFFECT.get(element.name, "").split()
    return f"{read}, without {', '.join(without)}" if without else read


def _executed(element: Element) -> str:
    """Return the code that executes an element: its words in the engine's tables, or those that a plan binds."""
    words = words_of(element)
    if words:
        return "; ".join(dict.fromkeys(_executed_word(word) for word in words))
    if element.name in UNREAD:
        return "no"
    execution = _HOME[element.name].execution
    return execution.text() if execution is not None else f"with {_owners(element)}"


def _executed_word(word: type[Word]) -> str:
    execution = EXECUTION.get(word)
    numbered = word.tag() in ACTION_NUMBERS or word.tag() in CONDITION_NUMBERS
    has_row = numbered or word in POSITION_ROWS or (execution is not None and execution.stage == "compilation")
    return execution.text() if execution is not None and has_row else NOT_YET


def _owners(element: Element) -> str:
    """Return the elements that can contain an element; only the first few are listed."""
    tags = [f"<{one.tags[0]}>" for one in elements().values() if any(tag in one.children for tag in element.tags)]
    named = list(dict.fromkeys(tags))
    return ", ".join(named[:MOST_PARENTS]) + (", ..." if len(named) > MOST_PARENTS else "")


def _sent(element: Element) -> str:
    """Return whether exported files have an element, by the forms' table of what is written for each word."""
    if words_of(element):
        return "yes" if element.name in _WRITTEN else f"as <{_instead(element)}>"
    home = _HOME.get(element.name)
    if home is None or element.name in home.unwritten.split():
        return "no"
    return "as its expansion" if element.name in home.expanded.split() else "yes"


def _instead(element: Element) -> str:
    """Return the element that is written for the word of one that is only read."""
    families = (ACTIONS, BY_ENTITY, BY_VALUE, POSITIONS)
    word = words_of(element)[0]
    return next(family.by_word[word].tag for family in families if word in family.by_word)
