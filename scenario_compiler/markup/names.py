"""The codes of names that refer to nothing or to two things (SC2xx), and those for AISA's files."""

from scenario_compiler.diagnostics import Code, Place, Related, Severity

UNKNOWN_PARAMETER = Code(
    "SC210",
    "unknown-parameter",
    "An expression uses a name that no <parameter> of the same scenario or template declares:\n\n"
    '    <parameter name="distance" type="length" default="120"/>\n'
    '    <ahead_of entity="ego" distance="$distanse"/>\n\n'
    "A template can only use its own parameters. Pass a scenario's parameter to it in the <use>.",
)
UNKNOWN_ARGUMENT = Code(
    "SC211",
    "unknown-argument",
    "`--set name=value` names a parameter that the scenario does not declare, so it would have no effect. The message "
    "lists the parameters, or suggests one. To declare another one, write `<parameter name=... type=... "
    "default=.../>` in the scenario.\n\n"
    "    scenario-compiler run paint.xml --set sped=30     the scenario declares `speed`",
)
UNKNOWN_SCENARIO = Code(
    "SC212",
    "unknown-scenario",
    "FILE#name names a scenario that the file does not contain. Correct the name. Without a name, the only scenario "
    "of a file is used.\n\n"
    "    scenario-compiler run variants.xml#obstacle_crosing     the file contains obstacle_crossing",
)
UNKNOWN_TEMPLATE = Code(
    "SC213",
    "unknown-template",
    "A <use> names a template that is neither in this file, nor in the files that it includes, nor in the "
    "library:\n\n"
    '    <include file="our_templates.xml"/>\n'
    '    <use template="blocked_lane" distance="150"/>\n\n'
    "Correct the name, or include the file that contains the template.",
)
MISSING_PARAMETER = Code(
    "SC214",
    "missing-parameter",
    "A parameter has neither a value nor a default. In a <use>, write it as an attribute. For a scenario, set it on "
    "the command line with --set name=value, or give its <parameter> a default.\n\n"
    '    <template name="parked"><parameter name="distance" type="length"/>...</template>\n'
    '    <use template="parked"/>     write distance="80"',
)
TEMPLATE_CYCLE = Code(
    "SC215",
    "template-cycle",
    "A template uses itself, directly or through others, so its expansion would never end. The message shows the "
    "chain of uses. Remove one <use> from the cycle.\n\n"
    '    <template name="jam"><use template="queue"/></template>\n'
    '    <template name="queue"><use template="jam"/></template>',
)
DUPLICATE_NAME = Code(
    "SC216",
    "duplicate-name",
    "Two things of one kind have the same name, so a reference to that name is ambiguous. This concerns entities, "
    "scenarios or templates of a file, parameters of one scenario or template, uses, entries of a catalog, levels of a "
    "study's factors, items of a questionnaire, parameters that a <setting> sets, and questionnaires that a study asks "
    "twice in a row; and of the properties of a controller only one can count. Rename or remove one of them.\n\n"
    '    <static id="van">...</static>\n'
    '    <static id="van">...</static>     which one would `ahead_of entity="van"` mean?',
)
UNKNOWN_VEHICLE = Code(
    "SC217",
    "unknown-vehicle",
    "`model` names a vehicle that is in no catalog, so its dimensions are unknown. The library's vehicles are in "
    "library/catalogs/vehicles.xml, under CARLA's blueprint ids. A catalog of your own can add more:\n\n"
    '    <catalog version="1"><vehicle name="vehicle.our.shuttle" length="4.7" .../></catalog>\n'
    '    <include file="our_vehicles.xml"/>     in <scenarios>',
)
UNKNOWN_DRIVER = Code(
    "SC218",
    "unknown-driver",
    "`preset` names a driver that is in no catalog. The library's drivers are in library/catalogs/drivers.xml; an "
    "included <catalog> adds more, and <driver_model mu=... sigma=.../> in the <takeover> describes one directly. The "
    "old name of a renamed driver is an error, and the hint gives the new name.\n\n"
    '    <driver preset="study_mean"/>     the catalog has `study_means`',
)
UNKNOWN_WEATHER = Code(
    "SC219",
    "unknown-weather",
    "`weather` is neither the name of one of CARLA's 23 presets, such as ClearNoon or HardRainSunset, nor its index in "
    "their alphabetical order, 0 to 22 (the AISA toolkit's WeatherId)."
    '\n\n    <scenario weather="HardRainSunst" ...>     HardRainSunset, or 10',
)
UNUSABLE_INCLUDE = Code(
    "SC220",
    "unusable-include",
    "An <include> names a file that cannot be read or that contains neither templates nor a catalog. A relative path "
    "starts from the folder of the including file; if it does not exist, the bare file name is tried there.\n\n"
    '    <include file="templates/ours.xml"/>     relative to the including file\'s folder',
)
DEEP_INCLUDE = Code(
    "SC232",
    "deep-include",
    "The chain of includes is too long, so its remaining files are not read. Files that include each other in a cycle "
    "are read once; that is not an error.\n\n"
    '    <include file="b.xml"/>     in a.xml, and in b.xml c.xml, and so on through more than 30 files\n\n'
    "Include the required files directly.",
)
RESERVED_NAME = Code(
    "SC221",
    "reserved-name",
    "A template's parameter has a name that <use> needs for itself: `template` or `id`. Or a parameter or the variable "
    "of a loop has a name that means something else in expressions: and, or, not, true, false, pi. Give it another "
    "name."
    '\n\n    <template name="parked"><parameter name="id" type="text"/>...</template>',
)
UNKNOWN_ENTITY = Code(
    "SC222",
    "unknown-entity",
    "An attribute names an entity that the scenario does not have:\n\n"
    '    <time_gap to="egoo" below="4"/>\n\n'
    "Entities are the ego vehicle (`ego` unless it has another id) and every <static> and <dynamic>. An entity of a "
    "template is known inside it by its own id, and outside by the name of the use, a point, and its own id: "
    'blocked_lane1.blocker, or jam.first for <use id="jam" ...>.',
)
UNKNOWN_EVENT = Code(
    "SC228",
    "unknown-event",
    "An <event> condition names an event that the scenario does not have. Give the <when> a name:\n\n"
    '    <when name="brakes"><time after="5"/><do><speed to="0" over_time="3"/></do></when>\n'
    '    <when><event name="brakes" state="started"/><do><sensor_noise sigma="40"/></do></when>\n\n'
    "An event of a template is known inside it by its own name, and outside by the name of the use, a point, and "
    "its own name.",
)
UNKNOWN_TRAFFIC = Code(
    "SC293",
    "unknown-traffic",
    "A <stop_traffic> names traffic that the scenario does not have, so it would stop nothing. Traffic is a <traffic> "
    "by its id, or the action that made it by its attribute `traffic`:\n\n"
    '    <do><traffic_source traffic="ramp" .../></do>\n'
    '    <do><stop_traffic traffic="ramps"/></do>     its name is ramp\n\n'
    "Traffic of a template is known inside it by its own name, and outside by the name of the use, a point, and its "
    "own name. Without the attribute, all traffic is meant. In OpenSCENARIO the name is the `trafficName` of the "
    "<TrafficAction>.",
)
TOO_MANY_ITEMS = Code(
    "SC223",
    "too-many-items",
    "Uses and loops insert so many items into a scenario that this cannot be intended; the rest is not read:\n\n"
    '    <repeat count="1000"><repeat count="1000"><use template="jam"/></repeat></repeat>\n\n'
    "The limits are 1000 rounds of a loop, 20000 items of a scenario, and a depth of 100 for nested uses, loops "
    "and branches. Reduce the counts, or use <traffic> for many vehicles.",
)
TOO_MANY_WAYS = Code(
    "SC229",
    "too-many-ways",
    "The `<any>` elements of a `<when>` can be combined in more than 1000 ways; the numbers of their choices are "
    "multiplied.\n\n"
    "    <when><any>...3 choices...</any><any>...3 choices...</any> ... seven in all ...\n\n"
    "Split it into several `<when>`, or reduce the choices.",
)


def first_at(place: Place | None) -> tuple[Related, ...]:
    """Return the place of the first of two things with the same name, for a diagnostic at the second."""
    return () if place is None else (Related("the first one is here", place),)


LEAVING_WHOLE = frozenset(
    (UNKNOWN_ARGUMENT, DUPLICATE_NAME, UNKNOWN_DRIVER, UNKNOWN_WEATHER, UNKNOWN_ENTITY, UNKNOWN_EVENT, UNKNOWN_TRAFFIC)
)
"""Errors that do not change any position, number or event of a scenario."""

UNUSED_TEMPLATE = Code(
    "SC226",
    "unused-template",
    "A file with scenarios contains a template that none of them uses, directly or through other templates, so it "
    "has no effect:\n\n"
    '    <template name="blocked_lane">...</template>\n'
    '    <use template="blocked_lame"/>     was this one meant?\n\n'
    "Use it, remove it, or move it to a file of templates that others include.",
    Severity.WARNING,
)
UNUSED_PARAMETER = Code(
    "SC296",
    "unused-parameter",
    "A scenario or a template declares a parameter that none of its values uses, so `--set`, a sweep, a study or a "
    "<use> that gives it a value changes nothing:\n\n"
    '    <parameter name="distance" type="length" default="120"/>\n'
    '    <use template="blocked_lane" distance="120"/>     distance="$distance" is meant\n\n'
    "Use it as $distance, or in an expression such as ${$distance + 40}, or remove it. A <vary> gives a parameter "
    "values, but does not use it.",
    Severity.WARNING,
)
NOT_ALLOWABLE = Code(
    "SC225",
    "not-allowable",
    "An <allow> names an error. Only warnings and notes can be allowed: after an error there is nothing to run.\n\n"
    '    <allow code="SC226"/>     an unused template is a warning\n\n'
    "Remove the <allow> and correct the error.",
)
UNKNOWN_CODE = Code(
    "SC227",
    "unknown-code",
    "An <allow> names a code that no warning or note has, so it has no effect:\n\n"
    '    <allow code="SC999"/>     was SC401 meant, an event that never fires?\n\n'
    "Correct the code. A warning shows its code after the word `warning`; `scenario-compiler explain SC401` "
    "explains a code.",
    Severity.WARNING,
)
NO_START = Code(
    "SC240",
    "aisa-no-start",
    "A scenario in the AISA toolkit's form has no waypoint named `start`, so the start of the ego vehicle is unknown. "
    "The toolkit's own `lanesdefault` is such a scenario. Add waypoints:\n\n"
    '    <waypoint name="start" x="151.4" y="-91.5" z="0.3" yaw="90" pitch="0" roll="0"/>\n'
    '    <waypoint name="dest" x="151.4" y="-11.5" z="0.3" yaw="90" pitch="0" roll="0"/>',
)
NOT_EXECUTED = Code(
    "SC241",
    "aisa-not-executed",
    "The AISA toolkit reads <object> elements, npc_vehicles and npc_pedestrians and then never uses them. This "
    "program ignores them too, so that the scenario has the same meaning as in the toolkit.\n\n"
    '    <object type="vehicle" .../>     the toolkit reads it, but never places it',
    Severity.NOTE,
)
MAPS_OWN_WEATHER = Code(
    "SC242",
    "aisa-weather",
    "The WeatherId leaves the weather to the map; here that means a clear noon. WeatherId counts CARLA's presets in "
    "alphabetical order, where 6 is Default and 10 is HardRainSunset; the paper on the toolkit names HardRainSunset "
    "for vanishinglanes_weather, which ships with 6. `--set WeatherId=10` runs the weather named in the paper.\n\n"
    '    <WeatherId value="6"/>     leaves the weather to the map',
    Severity.NOTE,
)
