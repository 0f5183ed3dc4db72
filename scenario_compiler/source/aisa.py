"""The AISA toolkit's file: a `<config>` of named scenarios, and the additions that the toolkit's code makes.

The toolkit's code contains the obstacles of its scenarios by the scenario's name; here they are a table. The toolkit
reads <object> elements and the numbers of background traffic without using them; here they are reported as unused.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from lxml import etree

from scenario_compiler.diagnostics import Code, Diagnostics, Place, Severity, did_you_mean
from scenario_compiler.expressions import Expression, Value, format_value, parse_expression
from scenario_compiler.markup import names
from scenario_compiler.markup.environment import Environment, ReadingContext
from scenario_compiler.markup.reading import read_word
from scenario_compiler.markup.values import COMMAND_LINE
from scenario_compiler.resources import PUBLISHED_AS
from scenario_compiler.source.aisa_file import AisaConfig
from scenario_compiler.source.catalogs import Catalogs
from scenario_compiler.source.events import storyboard_of
from scenario_compiler.source.expansion import catalog_driver, catalog_vehicles
from scenario_compiler.source.parameters import report_unknown_arguments, typed
from scenario_compiler.vocabulary.actions import LaneChangeAction, SpeedAction
from scenario_compiler.vocabulary.conditions import SimulationTimeCondition
from scenario_compiler.vocabulary.driver import Driver
from scenario_compiler.vocabulary.entities import Actor, Dynamic, Ego, Static
from scenario_compiler.vocabulary.positions import WorldPosition
from scenario_compiler.vocabulary.scenario import Classification, Parameter, Scenario
from scenario_compiler.vocabulary.sensors import Camera
from scenario_compiler.vocabulary.storyboard import Do, When
from scenario_compiler.vocabulary.takeover import Cause, Message, Takeover
from scenario_compiler.vocabulary.weather import WEATHER_PRESETS, Weather, weather_preset
from scenario_compiler.vocabulary.word import Number, Word, attribute

MODEL = "vehicle.audi.tt"
"""The model of the toolkit's ego vehicle, also used for its obstacles."""

DESIRED_SPEED = 5.0
"""Desired speed of the toolkit's controller, m/s."""

STEP, CONTROL_EVERY = 1.0 / 30.0, 2
"""The toolkit's time step, s, and the number of steps between two control steps."""

MESSAGE = Message.model_construct(modality=("text", "speech"), content=("what", "why"))
"""The message to the driver: the toolkit writes on the screen and, with --audio, speaks."""

DURATION = 60.0
"""Duration of a run, s; the toolkit runs until its window is closed."""

DRIFT_SPEED, DRIFT_DISTANCE = 0.3, 5.3
"""Speed of the moving obstacle, m/s (0.01 m a frame at 30 frames a second), and the distance that it moves here, m."""


@dataclass(frozen=True)
class _Known:
    """Facts on a scenario's name from the toolkit's code and the paper on it.

    Attributes:
        obstacles: CARLA x, y in m and yaw in degrees of each car.
        gold: Number, urgency and response in Gold et al. 2018, as quoted in the paper's table 1.
        summary: Description.
        moving: Whether the obstacle drifts across the road.
        off_map: For a start that is not on its map: its CARLA x, y, and its distance from the centre of the nearest
            driving lane of the published custom map, m; otherwise None.
    """

    summary: str
    gold: tuple[int, str, str] | None = None
    obstacles: tuple[tuple[float, float, float], ...] = ()
    moving: bool = False
    off_map: tuple[float, float, float] | None = None


_MARKINGS, _OBSTACLE = (10, "3", "1"), (9, "3", "1-3")
KNOWN: dict[str, _Known] = {
    "lanesdefault": _Known("Lane keeping on a town road"),
    "customvanishing": _Known(
        "Lane markings vanish on a road of their own", _MARKINGS, off_map=(2793.0, 1068.0, 2541.0)
    ),
    "customramp": _Known(
        "The lane beside the entrance ramp is full",
        (5, "3", "3"),
        tuple((2370.0 + 1000.0 * i, -256.0, 90.0) for i in range(8)),
        off_map=(1231.0, -237.0, 837.0),
    ),
    "obstaclestatic": _Known("A car stands across the lane ahead", _OBSTACLE, ((151.4, -38.4, 0.0),)),
    "obstacledynamic": _Known("A car drifts across the lane ahead", _OBSTACLE, ((155.4, -38.4, 180.0),), moving=True),
    "narrowingroad": _Known("A parked car narrows the lane ahead", (7, "3", "2"), ((149.4, -38.4, 90.0),)),
    "vanishinglanes_weather": _Known("Rain hides the lane markings", _MARKINGS),
    "vanishinglanes_map": _Known("Lane markings are missing on a town road", _MARKINGS),
    "sensornoise": _Known("Noise in the camera image", (2, "3", "1-2")),
}
"""The known facts by the scenario's name."""

OFF_MAP = Code(
    "SC243",
    "aisa-start-off-map",
    "The scenario's start, its destination and the obstacles that the toolkit's code adds lie far from every road "
    "of the custom map that the toolkit publishes, HRI_custommap.xodr, which its file calls `conflictmap`. On "
    "that map the scenario cannot run as it is filed.\n\n"
    "Start it elsewhere with --set start=X,Y,YAW in CARLA's axes, metres and degrees, and with --set "
    "obstacles=false if the toolkit's code adds obstacles. On a map that contains these positions, confirm them "
    "with --set town=NAME and --set obstacles=true.\n\n"
    "    scenario-compiler run aisa_conflicts.xml#customramp --set start=413,39,90 --set obstacles=false",
)
BAD_POSE = Code(
    "SC244",
    "aisa-bad-pose",
    "`start` and `dest` are set as X,Y or X,Y,YAW: CARLA's axes, m and degrees, such as --set start=151.4,-91.5,90."
    "\n\n    scenario-compiler run aisa_conflicts.xml#lanesdefault --set start=151.4,-91.5,90",
)


CUSTOM_MAP = ("conflictmap", PUBLISHED_AS["conflictmap"])
"""The toolkit's own map: its name in the file, and the published one."""


class Waypoint(Word):
    """A pose of the ego vehicle in CARLA's frame."""

    word: Literal["waypoint"] = "waypoint"

    name: str = attribute("`start` or `dest`.")
    x: float = attribute("x, m.", quantity="length")
    y: float = attribute("y, m, positive to the right of x.", quantity="length")
    z: float = attribute("z, m; the road's own height is taken.", default=0.0, quantity="length")
    yaw: Number = attribute("Heading, degrees, clockwise.", default=0.0, quantity="angle")
    pitch: float = attribute("Pitch, degrees; the road's own is taken.", default=0.0)
    roll: float = attribute("Roll, degrees; the road's own is taken.", default=0.0)

    def position(self) -> WorldPosition:
        """Return the pose as a position."""
        return WorldPosition(frame="carla", x=self.x, y=self.y, yaw=self.yaw).written_at(self.origin)


_PARAMETERS: tuple[Parameter, ...] = (
    Parameter.model_construct(name="town", type="text", summary="Name of the map."),
    Parameter.model_construct(
        name="WeatherId", type="text", default="1", summary="Index or name of the weather preset."
    ),
    Parameter.model_construct(
        name="sensor_noise",
        type="grey_levels",
        default="0",
        min=0.0,
        max=255.0,
        summary="Standard deviation of the camera's noise.",
    ),
    Parameter.model_construct(name="npc_vehicles", type="integer", default="0", min=0.0, summary="Not executed."),
    Parameter.model_construct(name="npc_pedestrians", type="integer", default="0", min=0.0, summary="Not executed."),
)
"""The attributes of a scenario, all of which can be set as parameters."""

_SETTINGS: tuple[Parameter, ...] = (
    Parameter.model_construct(
        name="start", type="text", default="", summary="Start in place of the file's, X,Y,YAW in CARLA's axes."
    ),
    Parameter.model_construct(
        name="dest", type="text", default="", summary="Destination in place of the file's, X,Y,YAW."
    ),
    Parameter.model_construct(
        name="obstacles", type="boolean", default="true", summary="Whether the code's obstacles are placed."
    ),
)
"""Other parameters that can be set."""


def expand_aisa(
    config: AisaConfig, name: str, arguments: Mapping[str, str], sink: Diagnostics, catalogs: Catalogs
) -> Scenario | None:
    """Return a scenario of the toolkit's file with the additions of the toolkit's code; None if it cannot be read.

    For a scenario that is known to lie far off its map, nothing else is reported.
    """
    scenario = filed_scenario(config, name, arguments, sink, catalogs)
    lies_off = report_off_map(config, name, arguments, sink)
    return None if lies_off else scenario


def filed_scenario(
    config: AisaConfig,
    name: str,
    arguments: Mapping[str, str],
    sink: Diagnostics,
    catalogs: Catalogs,
    *,
    usual_start: WorldPosition | None = None,
) -> Scenario | None:
    """Return a scenario of the file and the toolkit's code, wherever it lies; None if it cannot be read.

    One without a start gets `usual_start`; if there is none, that is an error.
    """
    element = config.scenarios[name]
    reading = ReadingContext(config.document, sink, Environment())
    origin = reading.origin(element)
    known = KNOWN.get(name, _Known(""))
    values = _attributes(element, arguments, reading)
    waypoints = _waypoints(element, values, reading)
    start = waypoints["start"].position() if "start" in waypoints else usual_start
    _note_unused(element, values, reading)
    weather = _weather(name, element, values, arguments, reading)
    if start is None:
        sink.add(
            names.NO_START,
            f"the scenario '{name}' has no waypoint named 'start'",
            origin,
            hint="pass --set start=X,Y,YAW (CARLA's axes), or add "
            '<waypoint name="start" x=... y=... z=... yaw=... pitch="0" roll="0"/> to its <waypoints>',
        )
    if "town" not in values or weather is None or start is None:
        return None
    ego = _ego(start, waypoints.get("dest")).written_at(origin)
    actors = _obstacles(known, origin) if values.get("obstacles", True) else []
    happenings = [(one.id, when) for one in actors if isinstance(one, Dynamic) for when in one.whens]
    bare = tuple(one.model_copy(update={"whens": ()}) if isinstance(one, Dynamic) else one for one in actors)
    noise = next(one for one in _PARAMETERS if one.name == "sensor_noise")
    return Scenario(
        name=name,
        summary=known.summary,
        source="AISA toolkit",
        map=str(values["town"]),
        duration=DURATION,
        step=STEP,
        control_every=CONTROL_EVERY,
        weather=weather,
        parameters=(
            noise.model_copy(update={"default": format_value(values.get("sensor_noise", 0.0))}).written_at(origin),
        ),
        classifications=_classifications(known),
        ego=ego,
        actors=bare,
        vehicles=catalog_vehicles([ego, *bare], catalogs, sink),
        storyboard=storyboard_of([ego.id, *(one.id for one in actors)], happenings),
        takeover=_takeover(catalogs, origin, sink),
    ).written_at(origin)


def _weather(
    name: str,
    element: etree._Element,
    values: Mapping[str, Value],
    arguments: Mapping[str, str],
    reading: ReadingContext,
) -> Weather | None:
    """Return the weather of a scenario's id of CARLA's presets, None if there is none with this id."""
    number = str(values.get("WeatherId", "1"))
    weather = weather_preset(number)
    place = _place_of("WeatherId", element, arguments, reading)
    if weather is None:
        hint = did_you_mean(number, WEATHER_PRESETS)
        reading.sink.add(names.UNKNOWN_WEATHER, f"there is no weather '{number}'", place, hint=hint)
    elif weather.preset == "Default":
        reading.sink.add(
            names.MAPS_OWN_WEATHER,
            f"WeatherId {number} is the preset Default, the map's own weather, which is read as a clear noon",
            place,
            hint="WeatherId 10 is HardRainSunset" if name == "vanishinglanes_weather" else "",
        )
    return weather


def _attributes(element: etree._Element, arguments: Mapping[str, str], reading: ReadingContext) -> dict[str, Value]:
    """Return the values of the scenario's attributes; those on the command line override the file's."""
    known = (*_PARAMETERS, *_SETTINGS)
    report_unknown_arguments(arguments, [one.name for one in known], reading.sink)
    values: dict[str, Value] = {}
    for parameter in known:
        filed = element.get(parameter.name, parameter.default) if parameter in _PARAMETERS else parameter.default
        text = arguments.get(parameter.name, filed)
        if text is None:
            reading.sink.add(
                names.MISSING_PARAMETER, f"the scenario names no {parameter.name}", reading.origin(element)
            )
            continue
        place = _place_of(parameter.name, element, arguments, reading)
        value = typed(str(text), parameter, place, reading.sink)
        if value is not None:
            values[parameter.name] = value
    return values


def _place_of(name: str, element: etree._Element, arguments: Mapping[str, str], reading: ReadingContext) -> Place:
    return COMMAND_LINE if name in arguments else reading.origin(element, name)


def _waypoints(element: etree._Element, values: Mapping[str, Value], reading: ReadingContext) -> dict[str, Waypoint]:
    """Return the waypoints by name; if a start is set, the file's destination is not used."""
    set_here = {name: str(values[name]) for name in ("start", "dest") if values.get(name)}
    read = (read_word(one, Waypoint, reading) for one in element.iterfind("waypoints/waypoint"))
    filed = {one.name: one for one in read if one is not None}
    waypoints = {} if "start" in set_here else filed
    for name, text in set_here.items():
        pose = _pose(name, text)
        if pose is None:
            reading.sink.add(BAD_POSE, f"'{text}' is not a pose: write X,Y or X,Y,YAW", COMMAND_LINE)
        else:
            waypoints[name] = pose
    return waypoints


def _pose(name: str, text: str) -> Waypoint | None:
    """Return the pose X,Y or X,Y,YAW, in m and degrees; None if the text is not a pose."""
    try:
        x, y, *rest = (float(part) for part in text.split(","))
    except ValueError:
        return None
    yaw = rest[0] if rest else 0.0
    if len(rest) > 1 or not all(map(math.isfinite, (x, y, yaw))):
        return None
    return Waypoint(name=name, x=x, y=y, yaw=math.radians(yaw)).written_at(COMMAND_LINE)


def report_off_map(
    config: AisaConfig, name: str, arguments: Mapping[str, str], sink: Diagnostics, severity: Severity = Severity.ERROR
) -> bool:
    """Report a start, or obstacles of the toolkit's code, that lie off the toolkit's custom map; return if any does."""
    known, element = KNOWN.get(name, _Known("")), config.scenarios[name]
    if known.off_map is None:
        return False
    reading = ReadingContext(config.document, Diagnostics(), Environment())
    start = _waypoints(element, {}, reading).get("start")
    on_custom_map = arguments.get("town", element.get("town")) in CUSTOM_MAP
    without = "--set obstacles=false" if known.obstacles and "obstacles" not in arguments else ""
    if on_custom_map and "start" not in arguments and start is not None and (start.x, start.y) == known.off_map[:2]:
        message = f"the start of '{name}' lies {known.off_map[2]:.0f} m off the roads of {CUSTOM_MAP[1]}.xodr, its map"
        hint = f"--set start=X,Y,YAW{without and f' {without}'} runs it from elsewhere"
        sink.add(OFF_MAP, message, start.origin, hint=hint, severity=severity)
        return True
    if without:
        message = f"the cars that the toolkit's code adds to '{name}' lie off its map"
        sink.add(OFF_MAP, message, reading.origin(element), hint=f"{without} leaves them out", severity=severity)
    return bool(without)


def _note_unused(element: etree._Element, values: Mapping[str, Value], reading: ReadingContext) -> None:
    """Report elements that the toolkit reads but does not use."""
    for one in element.iterfind("object"):
        kind = one.get("type", "")
        message = f"the toolkit never places its <object> '{one.get('name', '')}'{f' of type {kind}' if kind else ''}"
        reading.sink.add(names.NOT_EXECUTED, message, reading.origin(one))
    for name in ("npc_vehicles", "npc_pedestrians"):
        if values.get(name):
            reading.sink.add(names.NOT_EXECUTED, f"the toolkit never uses {name}", reading.origin(element, name))


def _ego(start: WorldPosition, destination: Waypoint | None) -> Ego:
    noise: Expression = parse_expression("$sensor_noise")
    return Ego(
        model=MODEL,
        speed=0.0,
        desired_speed=DESIRED_SPEED,
        start=start,
        destination=None if destination is None else destination.position(),
        camera=Camera(sensor_noise=noise),
    )


def _obstacles(known: _Known, origin: Place) -> list[Actor]:
    """Return the cars that the toolkit's code adds to a scenario."""
    actors: list[Actor] = []
    for number, (x, y, yaw) in enumerate(known.obstacles, start=1):
        where = WorldPosition(frame="carla", x=x, y=y, yaw=math.radians(yaw)).written_at(origin)
        name = f"obstacle{number}"
        if known.moving:
            car = Dynamic(id=name, model=MODEL, speed=DRIFT_SPEED, start=where, whens=_drift())
            actors.append(car.written_at(origin))
        else:
            actors.append(Static(id=name, model=MODEL, at=where).written_at(origin))
    return actors


def _drift() -> tuple[When, ...]:
    """Return the moving obstacle's event: it moves straight across the road into the lane of the ego vehicle.

    The toolkit moves the car by -0.01 m in x in every frame, tail first and without end. Here it is turned round, which
    does not change its box, so that it drives forwards. It starts at the edge of the oncoming lane, from which the
    ego's lane is the second to the left. The lane change requires more than its speed, so it moves straight across, and
    stops there.
    """
    change = LaneChangeAction(by=2, over_time=1.0, shape="linear")
    stop = SpeedAction(to=0.0)
    return (
        When(conditions=(SimulationTimeCondition(after=0.0),), do=Do(actions=(change,))),
        When(conditions=(SimulationTimeCondition(after=DRIFT_DISTANCE / DRIFT_SPEED),), do=Do(actions=(stop,))),
    )


def _takeover(catalogs: Catalogs, origin: Place, sink: Diagnostics) -> Takeover:
    driver = Driver().written_at(origin)
    kinds: tuple[Literal["lane_confidence", "path_blocked", "sensor_health"], ...] = (
        "lane_confidence",
        "path_blocked",
        "sensor_health",
    )
    return Takeover(
        causes=tuple(Cause(kind=kind).written_at(origin) for kind in kinds),
        driver=catalog_driver(driver, catalogs, sink),
        messages=(MESSAGE,),
    ).written_at(origin)


def _classifications(known: _Known) -> tuple[Classification, ...]:
    if known.gold is None:
        return ()
    number, urgency, response = known.gold
    return (Classification(scheme="gold2018", number=number, urgency=urgency, response=response),)
