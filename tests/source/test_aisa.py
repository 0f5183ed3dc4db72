"""The AISA toolkit's own file, unchanged."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from scenario_compiler.diagnostics import Diagnostics, Severity
from scenario_compiler.document import read_document
from scenario_compiler.expressions import parse_expression
from scenario_compiler.languages import Source, check_source, expand, parse
from scenario_compiler.vocabulary.actions import LaneChangeAction, SpeedAction
from scenario_compiler.vocabulary.entities import Dynamic, Static
from scenario_compiler.vocabulary.positions import WorldPosition
from scenario_compiler.vocabulary.scenario import Scenario
from tests.source.made import parsed

NAMES = (
    "lanesdefault", "customvanishing", "customramp", "obstaclestatic", "obstacledynamic", "narrowingroad",
    "vanishinglanes_weather", "vanishinglanes_map", "sensornoise",
)  # fmt: skip


@pytest.fixture
def config(corpus: Path) -> Source:
    document = read_document(corpus / "aisa-toolkit/simulation/scenarios/aisa_conflicts.xml", Diagnostics())
    assert document is not None
    source = parse(document, Diagnostics())
    assert source is not None
    return source


def _expanded(config: Source, name: str, **arguments: str) -> tuple[Scenario | None, list[tuple[str, int]]]:
    sink = Diagnostics()
    scenario = expand(config, name, arguments, sink)
    return scenario, [(one.code.id, one.place.line) for one in sink]


def test_file_holds_nine_scenarios(config: Source) -> None:
    assert tuple(config.scenarios) == NAMES


def test_sensornoise(config: Source) -> None:
    scenario, found = _expanded(config, "sensornoise")
    assert scenario is not None
    assert found == []
    assert (scenario.map, scenario.weather.preset, scenario.duration) == ("Town04", "ClearNoon", 60.0)
    assert (scenario.step, scenario.control_every) == (1 / 30, 2)
    assert scenario.ego is not None
    assert scenario.ego.start == WorldPosition(frame="carla", x=-12.905157, y=-87.532539, yaw=math.radians(89.775162))
    assert scenario.ego.destination is not None
    assert (scenario.ego.model, scenario.ego.speed, scenario.ego.desired_speed) == ("vehicle.audi.tt", 0.0, 5.0)
    camera = scenario.ego.camera
    assert (camera.width, camera.height, camera.fov, camera.x, camera.z, camera.pitch) == (
        512,
        256,
        45.0,
        0.5,
        1.3,
        -5.0,
    )
    assert camera.sensor_noise == parse_expression("$sensor_noise")
    assert [(one.name, one.default) for one in scenario.parameters] == [("sensor_noise", "5")]
    assert [cause.kind for cause in scenario.takeover.causes] == ["lane_confidence", "path_blocked", "sensor_health"]


def test_attributes_can_be_set(config: Source) -> None:
    scenario, found = _expanded(config, "sensornoise", sensor_noise="60", WeatherId="10", town="Town05")
    assert scenario is not None
    assert found == []
    assert (scenario.parameters[0].default, scenario.weather.preset, scenario.map) == ("60", "HardRainSunset", "Town05")


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        ({"sensor_noise": "-1"}, "SC112"),
        ({"sensor_noise": "loud"}, "SC111"),
        ({"noise": "3"}, "SC211"),
        ({"WeatherId": "23"}, "SC219"),
        ({"npc_vehicles": "3"}, "SC241"),
    ],
)
def test_arguments_are_checked(config: Source, arguments: dict[str, str], code: str) -> None:
    assert [found for found, _ in _expanded(config, "sensornoise", **arguments)[1]] == [code]


def test_obstacles_of_the_toolkits_code(config: Source) -> None:
    static, _ = _expanded(config, "obstaclestatic")
    narrow, _ = _expanded(config, "narrowingroad")
    ramp, _ = _expanded(config, "customramp", start="413,39,90", obstacles="true")
    assert static is not None
    assert narrow is not None
    assert ramp is not None
    assert static.actors == (
        Static(id="obstacle1", model="vehicle.audi.tt", at=WorldPosition(frame="carla", x=151.4, y=-38.4)),
    )
    (parked,) = narrow.actors
    assert isinstance(parked, Static)
    assert parked.at == WorldPosition(frame="carla", x=149.4, y=-38.4, yaw=math.pi / 2)
    places = [actor.at for actor in ramp.actors if isinstance(actor, Static)]
    assert [place.x for place in places if isinstance(place, WorldPosition)] == [2370 + 1000 * i for i in range(8)]


def test_the_moving_obstacle_drifts_at_three_decimetres_a_second(config: Source) -> None:
    scenario, _ = _expanded(config, "obstacledynamic")
    assert scenario is not None
    (car,) = scenario.actors
    assert isinstance(car, Dynamic)
    assert car.start == WorldPosition(frame="carla", x=155.4, y=-38.4, yaw=math.pi)
    assert car.speed == 0.3
    first, last = scenario.storyboard.stories[0].acts[0].groups[0].maneuvers[0].events
    drift, stop = first.actions[0].action, last.actions[0].action
    assert isinstance(drift, LaneChangeAction)
    assert isinstance(stop, SpeedAction)
    assert (drift.by, drift.shape, stop.to) == (2, "linear", 0.0)


def test_the_maps_own_weather_is_noted(config: Source) -> None:
    scenario, found = _expanded(config, "vanishinglanes_weather")
    assert scenario is not None
    assert (scenario.weather.preset, found) == ("Default", [("SC242", 52)])
    assert _expanded(config, "vanishinglanes_weather", WeatherId="10")[1] == []


def test_without_a_start_there_is_no_scenario(config: Source) -> None:
    scenario, found = _expanded(config, "lanesdefault")
    assert scenario is None
    assert found == [("SC240", 7), ("SC241", 11), ("SC241", 12), ("SC241", 13), ("SC241", 14)]


def test_checking_the_file_finds_the_three_that_cannot_run_as_they_are(config: Source) -> None:
    sink = Diagnostics()
    assert [one.scenario.name for one in check_source(config, sink)] == list(NAMES[3:])
    assert [one.code.id for one in sink if one.severity is Severity.ERROR] == ["SC240", "SC243", "SC243"]


def test_the_papers_situations_are_named(config: Source) -> None:
    numbers = {}
    for name in NAMES[1:]:
        scenario, _ = _expanded(config, name, start="413,39,90", obstacles="false")
        assert scenario is not None
        (classification,) = scenario.classifications
        assert classification.criticality == ""
        numbers[name] = classification.number
    assert sorted(set(map(int, filter(None, numbers.values())))) == [2, 5, 7, 9, 10]


START = '<waypoints><waypoint name="start" x="1" y="2"/></waypoints>'


@pytest.mark.parametrize(
    ("attributes", "inner", "codes"),
    [
        ('name="a" town="T"', START, []),
        ('name="a"', START, ["SC214"]),
        ('name="a" town="T" WeatherId="x"', START, ["SC219"]),
        ('name="a" town="T" sensor_noise="x"', START, ["SC111"]),
        ('name="a" town="T"', START.replace('"1"', '"one"'), ["SC111", "SC240"]),
        ('name="a" town="T"', START.replace("name", "nam"), ["SC106", "SC107", "SC240"]),
    ],
)
def test_faults_in_a_file_of_this_form(attributes: str, inner: str, codes: list[str]) -> None:
    sink = Diagnostics()
    source = parsed(f"<config><scenarios><scenario {attributes}>{inner}</scenario></scenarios></config>", sink)
    expand(source, None, {}, sink)
    assert sorted(one.code.id for one in sink) == codes


def test_repeated_names_are_reported() -> None:
    sink = Diagnostics()
    twice = "<scenario name='a' town='T'/>" * 2
    parsed(f"<config><scenarios>{twice}</scenarios></config>", sink)
    assert [one.code.id for one in sink] == ["SC216"]
