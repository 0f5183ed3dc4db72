"""The codes of what is special to OpenSCENARIO files: parameters, catalogs, the road, names of storyboard elements."""

from scenario_compiler.diagnostics import Code, Severity

MENDED_COMMENT = Code(
    "SC740",
    "mended-comment",
    "A comment holds two hyphens in a row, which XML does not allow, so other programs may refuse the file. It is read "
    "as if a space stood between them.\n\n"
    "    <!-- mode: fast -- or slow -->     write one hyphen, or a semicolon",
    Severity.WARNING,
)
UNKNOWN_VERSION = Code(
    "SC741",
    "unknown-version",
    "The <FileHeader> names no version of OpenSCENARIO XML that there is, 1.0 to 1.3. The file is read as the nearest "
    "one; files that say 0.9 are mostly 1.0.\n\n"
    '    <FileHeader revMajor="0" revMinor="9" .../>     read as 1.0',
    Severity.WARNING,
)
CONSTRAINT = Code(
    "SC742",
    "parameter-constraint",
    "The value of a parameter fulfils none of the constraint groups of its declaration. A group is fulfilled when all "
    "of its constraints are.\n\n"
    '    <ParameterDeclaration name="speed" parameterType="double" value="80">\n'
    "      <ConstraintGroup>\n"
    '        <ValueConstraint rule="lessOrEqual" value="60"/>     80 is more\n\n'
    "Give another value, in the file or with --set.",
    Severity.WARNING,
)
WRONG_TYPE = Code(
    "SC743",
    "parameter-type",
    "The value of a parameter or variable is not of the type that its declaration gives.\n\n"
    '    <ParameterDeclaration name="lanes" parameterType="integer" value="two"/>\n\n'
    "Where the parameter is used, its text is taken as it stands.",
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
    "A <Directory> of <CatalogLocations> is not there. That matters only to references to the catalogs in it, and they "
    "are reported where they stand.\n\n"
    '    <VehicleCatalog><Directory path="../catalogs/vehicls"/></VehicleCatalog>',
    Severity.WARNING,
)
NO_ROAD = Code(
    "SC746",
    "no-road-file",
    "The scenario names no OpenDRIVE file, so there is no road to drive on. It runs on a plane without roads, where "
    "world positions and trajectories have a meaning and lanes have none.\n\n"
    '    <RoadNetwork><LogicFile filepath="highway.xodr"/></RoadNetwork>\n\n'
    "A model for display (<SceneGraphFile>) says nothing of lanes.",
    Severity.WARNING,
)
UNKNOWN_STORYBOARD_ELEMENT = Code(
    "SC747",
    "unknown-storyboard-element",
    "A condition waits for a state of a storyboard element that the scenario does not have, so it would never come "
    "true.\n\n"
    '    <StoryboardElementStateCondition storyboardElementType="event" storyboardElementRef="Brakng" .../>\n\n'
    "The type counts too: an act is not found where an event is asked for.",
)
AMBIGUOUS_STORYBOARD_ELEMENT = Code(
    "SC748",
    "ambiguous-storyboard-element",
    "A condition waits for a state of a storyboard element by a name that several have. The first of those nearest to "
    "the condition is meant.\n\n"
    '    storyboardElementRef="Brake"     write "MyAct::MyGroup::MyManeuver::Brake"\n\n'
    "Names of the elements around it, with :: between, tell them apart.",
    Severity.WARNING,
)
DUPLICATE_ELEMENT = Code(
    "SC749",
    "duplicate-storyboard-element",
    "Two storyboard elements of one kind stand side by side under one name, so a condition that names it would be a "
    "guess. The later ones get a number after their name.\n\n"
    '    <Event name="Brake" ...>...</Event>\n'
    '    <Event name="Brake" ...>...</Event>     known as Brake#2',
    Severity.WARNING,
)
NOT_READ = Code(
    "SC750",
    "not-read",
    "An element or attribute has no effect on the run: it is not part of the standard, stands where the standard has "
    "no place for it, or says something that a run here does not take into account.\n\n"
    '    <ScenarioObject name="Ego" colour="red">     nothing reads `colour`',
    Severity.WARNING,
)
EXTERNAL_OBJECT = Code(
    "SC751",
    "external-object",
    "An <ExternalObjectReference> names an object whose description lies outside of the file and of the catalogs. It "
    "is taken to be a car of usual size.\n\n"
    '    <ScenarioObject name="Ego"><ExternalObjectReference name="HeroCar"/></ScenarioObject>',
    Severity.WARNING,
)
TRIGGERING_ACTORS = Code(
    "SC752",
    "triggering-entities-as-actors",
    "The actors of a maneuver group are to be the entities that fulfil the condition of its events. Which they are is "
    "known in the run only; the entities that the events' conditions name are taken, all of them.\n\n"
    '    <Actors selectTriggeringEntities="true"/>     name the actors: <EntityRef entityRef="Ego"/>',
    Severity.WARNING,
)
ONE_ENTITY = Code(
    "SC753",
    "selection-as-entity",
    "A selection of entities stands where one entity is meant; the first member is taken.\n\n"
    '    <DistanceCondition entityRef="AllCars" .../>     AllCars is an <EntitySelection>',
    Severity.WARNING,
)
NO_SCENARIO_FILE = Code(
    "SC754",
    "missing-scenario-file",
    "The <ScenarioFile> of a parameter value distribution is not there, or is no scenario. A relative path is tried "
    "from the folder of the file that names it, whole and then by its bare name.\n\n"
    '    <ScenarioFile filepath="cut_in.xosc"/>',
)
BAD_DISTRIBUTION = Code(
    "SC755",
    "unusable-distribution",
    "A distribution of parameter values cannot be sampled: it has no values, its limits stand the wrong way round, or "
    "it is one that only another program knows.\n\n"
    '    <DistributionRange stepWidth="0"><Range lowerLimit="5" upperLimit="60"/></DistributionRange>',
)
NO_VEHICLE_SIZE = Code(
    "SC756",
    "no-size",
    "An entity has no bounding box, or one without extent. A usual size for its kind is taken.\n\n"
    '    <Dimensions length="0" width="0" height="0"/>',
    Severity.WARNING,
)
NO_OBJECT = Code(
    "SC757",
    "no-entity-object",
    "A <ScenarioObject> does not say what it is: a Vehicle, a Pedestrian, a MiscObject, or a reference to a catalog or "
    "to something outside. It is taken to be a car of usual size.\n\n"
    '    <ScenarioObject name="Ego"/>',
    Severity.WARNING,
)
UNKNOWN_VARIABLE = Code(
    "SC758",
    "unknown-variable",
    "An action or a condition names a variable, a parameter or a monitor that the scenario does not declare.\n\n"
    '    <VariableDeclaration name="attempts" variableType="integer" value="0"/>\n'
    '    <VariableCondition variableRef="atempts" .../>     the variable is called attempts\n\n'
    "It stands for a text that is empty until an action changes it.",
    Severity.WARNING,
)
REPEATED_PARAMETER = Code(
    "SC759",
    "repeated-parameter",
    "A parameter is declared twice in one place; the later declaration counts.\n\n"
    '    <ParameterDeclaration name="speed" parameterType="double" value="10"/>\n'
    '    <ParameterDeclaration name="speed" parameterType="double" value="20"/>     speed is 20',
    Severity.WARNING,
)
