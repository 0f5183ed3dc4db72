"""The codes that only OpenSCENARIO files have: parameters, catalogs, the road, names of storyboard elements."""

from scenario_compiler.diagnostics import Code, Severity

MENDED_COMMENT = Code(
    "SC740",
    "mended-comment",
    "A comment contains two hyphens in a row, which XML does not allow, so other programs may reject the file. It "
    "is read as if there were a space between them.\n\n"
    "    <!-- mode: fast -- or slow -->     write one hyphen, or a semicolon",
    Severity.WARNING,
)
UNKNOWN_VERSION = Code(
    "SC741",
    "unknown-version",
    "The version in the <FileHeader> is not one of the existing versions of OpenSCENARIO XML, 1.0 to 1.3. The "
    "file is read as the nearest version; most files with the version 0.9 are in fact 1.0.\n\n"
    '    <FileHeader revMajor="0" revMinor="9" .../>     read as 1.0',
    Severity.WARNING,
)
CONSTRAINT = Code(
    "SC742",
    "parameter-constraint",
    "The value of a parameter meets none of the constraint groups in its declaration. A group is met if all of "
    "its constraints are met.\n\n"
    '    <ParameterDeclaration name="speed" parameterType="double" value="80">\n'
    "      <ConstraintGroup>\n"
    '        <ValueConstraint rule="lessOrEqual" value="60"/>     80 is greater\n\n'
    "Give another value, in the file or with --set.",
    Severity.WARNING,
)
WRONG_TYPE = Code(
    "SC743",
    "parameter-type",
    "The value of a parameter or variable does not have the type in its declaration.\n\n"
    '    <ParameterDeclaration name="lanes" parameterType="integer" value="two"/>\n\n'
    "Where the parameter is used, its text is inserted unchanged.",
    Severity.WARNING,
)
UNKNOWN_CATALOG_ENTRY = Code(
    "SC744",
    "unknown-catalog-entry",
    "A <CatalogReference> names a catalog, or an entry of one, that is in none of the folders that <CatalogLocations> "
    "lists.\n\n"
    '    <CatalogReference catalogName="VehicleCatalog" entryName="car_whit"/>     the entry is called car_white\n\n'
    "A relative folder is tried from the folder of the scenario's file, whole and then by its bare name.",
)
NO_CATALOG_FOLDER = Code(
    "SC745",
    "missing-catalog-folder",
    "A <Directory> of <CatalogLocations> does not exist. Only references to its catalogs need it; they are "
    "reported at their own places.\n\n"
    '    <VehicleCatalog><Directory path="../catalogs/vehicls"/></VehicleCatalog>',
    Severity.WARNING,
)
NO_ROAD = Code(
    "SC746",
    "no-road-file",
    "The scenario names no OpenDRIVE file, so there is no road to drive on. It runs on a plane without roads: "
    "world positions and trajectories can be used there, lanes cannot.\n\n"
    '    <RoadNetwork><LogicFile filepath="highway.xodr"/></RoadNetwork>\n\n'
    "A model for display (<SceneGraphFile>) does not define lanes.",
    Severity.WARNING,
)
UNKNOWN_STORYBOARD_ELEMENT = Code(
    "SC747",
    "unknown-storyboard-element",
    "A condition waits for a state of a storyboard element that the scenario does not have, so it would never be "
    "true.\n\n"
    '    <StoryboardElementStateCondition storyboardElementType="event" storyboardElementRef="Brakng" .../>\n\n'
    "The type must match too: a reference of type event does not find an act.",
)
AMBIGUOUS_STORYBOARD_ELEMENT = Code(
    "SC748",
    "ambiguous-storyboard-element",
    "A condition waits for a state of a storyboard element by a name that several elements have. The first of "
    "those nearest to the condition is used.\n\n"
    '    storyboardElementRef="Brake"     write "MyAct::MyGroup::MyManeuver::Brake"\n\n'
    "Put the names of the containing elements before it, separated by ::.",
    Severity.WARNING,
)
DUPLICATE_ELEMENT = Code(
    "SC749",
    "duplicate-storyboard-element",
    "Two storyboard elements of the same kind and parent have the same name, so a condition that uses it is "
    "ambiguous. A number is added to the names of the later ones.\n\n"
    '    <Event name="Brake" ...>...</Event>\n'
    '    <Event name="Brake" ...>...</Event>     known as Brake#2',
    Severity.WARNING,
)
NOT_READ = Code(
    "SC750",
    "not-read",
    "An element or attribute has no effect on the run: it is not part of the standard, is at a place where the "
    "standard does not allow it, or describes something that runs of this program do not consider.\n\n"
    '    <ScenarioObject name="Ego" colour="red">     `colour` is never read',
    Severity.WARNING,
)
EXTERNAL_OBJECT = Code(
    "SC751",
    "external-object",
    "An <ExternalObjectReference> names an object that neither the file nor a catalog describes. A car of usual "
    "size is used for it.\n\n"
    '    <ScenarioObject name="Ego"><ExternalObjectReference name="HeroCar"/></ScenarioObject>',
    Severity.WARNING,
)
TRIGGERING_ACTORS = Code(
    "SC752",
    "triggering-entities-as-actors",
    "The actors of a maneuver group are the entities that trigger its act. Which they are is known only during the "
    "run if the act's start trigger has several condition groups, or a condition for any of several entities. All "
    "entities in the start trigger are then used.\n\n"
    '    <Actors selectTriggeringEntities="true"/>     name the actors: <EntityRef entityRef="Ego"/>',
    Severity.WARNING,
)
ONE_ENTITY = Code(
    "SC753",
    "selection-as-entity",
    "A selection of entities is used in place of a single entity; its first member is used.\n\n"
    '    <DistanceCondition entityRef="AllCars" .../>     AllCars is an <EntitySelection>',
    Severity.WARNING,
)
NO_SCENARIO_FILE = Code(
    "SC754",
    "missing-scenario-file",
    "The <ScenarioFile> of a parameter value distribution does not exist, or is not a scenario. A relative path "
    "is tried from the folder of the file that names it, whole and then by its bare name.\n\n"
    '    <ScenarioFile filepath="cut_in.xosc"/>',
)
BAD_DISTRIBUTION = Code(
    "SC755",
    "unusable-distribution",
    "A distribution of parameter values cannot be sampled: it has no values, its lower limit is above the upper "
    "one, its bins overlap, its values do not have the type of the parameter, another distribution varies the same "
    "parameter, or it is defined by another program only.\n\n"
    '    <DistributionRange stepWidth="0"><Range lowerLimit="5" upperLimit="60"/></DistributionRange>',
)
NO_VEHICLE_SIZE = Code(
    "SC756",
    "no-size",
    "An entity has no bounding box, or one with the size 0. A usual size for its kind is used.\n\n"
    '    <Dimensions length="0" width="0" height="0"/>',
    Severity.WARNING,
)
NO_OBJECT = Code(
    "SC757",
    "no-entity-object",
    "A <ScenarioObject> has no object: a Vehicle, a Pedestrian, a MiscObject, a reference to a catalog, or an "
    "external reference. A car of usual size is used for it.\n\n"
    '    <ScenarioObject name="Ego"/>',
    Severity.WARNING,
)
UNKNOWN_VARIABLE = Code(
    "SC758",
    "unknown-variable",
    "An action or a condition names a variable, a parameter or a monitor that the scenario does not declare.\n\n"
    '    <VariableDeclaration name="attempts" variableType="integer" value="0"/>\n'
    '    <VariableCondition variableRef="atempts" .../>     the variable is called attempts\n\n'
    "It is treated as a text that is empty until an action changes it.",
    Severity.WARNING,
)
REPEATED_PARAMETER = Code(
    "SC759",
    "repeated-parameter",
    "A parameter is declared twice in the same place; the later declaration is used.\n\n"
    '    <ParameterDeclaration name="speed" parameterType="double" value="10"/>\n'
    '    <ParameterDeclaration name="speed" parameterType="double" value="20"/>     speed is 20',
    Severity.WARNING,
)
NO_ACTOR = Code(
    "SC760",
    "action-without-actor",
    "An action that belongs to an entity is in a maneuver group without actors, so nobody executes it: its <Actors> "
    "name no entity, or select triggering entities and no condition names one.\n\n"
    '    <Actors selectTriggeringEntities="false"/>     <Actors ...><EntityRef entityRef="Ego"/></Actors>',
    Severity.WARNING,
)
PARAMETER_IN_TEXT = Code(
    "SC761",
    "parameter-in-text",
    "The name of a parameter is a part of a longer text, where it is not replaced: in OpenSCENARIO a parameter is the "
    "whole value of an attribute, or a part of an expression.\n\n"
    '    <EntityRef entityRef="Car$number"/>     the name Car$number\n'
    '    <EntityRef entityRef="$car"/>           the value of the parameter car\n'
    '    <... value="${$speed / 2}"/>            an expression\n\n'
    "Declare a parameter for the whole text, or write a backslash before the $ if the text is meant as it is.",
    Severity.WARNING,
)
CONTINUOUS_OVER_TIME = Code(
    "SC762",
    "continuous-speed-over-time",
    "A speed that is kept relative to another entity's (`continuous`) is to be reached over a time or a distance. By "
    "the standard, `continuous` may not be used together with these dimensions. Here the speed is reached as given, "
    "and then follows the target exactly; other programs may do otherwise.\n\n"
    '    <SpeedActionDynamics dynamicsShape="linear" dynamicsDimension="rate" value="2"/>     give a rate\n'
    '    <RelativeTargetSpeed entityRef="Lead" continuous="true" .../>                        or do not keep it\n\n'
    "A step needs no dimension and is not reported.",
    Severity.WARNING,
)
