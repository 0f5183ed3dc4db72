"""The library's files: they are valid, name their sources, and provoke the conflicts that they are named after."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from lxml import etree

from scenario_compiler import Plan, judge, open_world, run
from scenario_compiler.compiler import Compilation, Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics, as_text
from scenario_compiler.document import read_document
from scenario_compiler.expressions import format_value
from scenario_compiler.languages import parse
from scenario_compiler.recording.recording import Recording
from scenario_compiler.resources import library_folder
from scenario_compiler.source.catalogs import load_catalogs
from scenario_compiler.source.conflict import Library, Part
from scenario_compiler.source.templates import template_parameters
from scenario_compiler.validation import validate_file
from scenario_compiler.vocabulary.scenario import Parameter
from scenario_compiler.vocabulary.sensors import Perception
from scenario_compiler.vocabulary.taxonomies import TAXONOMIES
from tests.playing import played_until

LIBRARY = library_folder()
FILES = sorted(LIBRARY.rglob("*.xml"))
CONFLICTS = sorted((LIBRARY / "conflicts").glob("*.xml"))
TEMPLATES = sorted((LIBRARY / "templates").glob("*.xml"))

GOLD = {
    2: ("3", "1-2"),
    5: ("3", "3"),
    7: ("3", "2"),
    9: ("3", "1-3"),
    10: ("3", "1"),
}
"""Urgency and response of each situation of Gold et al. 2018 as the AISA paper's table 1 quotes them."""

NUMBERS = {"sensor_failure": 2, "ramp_blocked": 5, "road_narrows": 7, "obstacle_ahead": 9, "markings_missing": 10}
"""Situation of each of the five conflicts that stand for the table's rows."""


@dataclass(frozen=True)
class Provokes:
    """What a conflict makes happen.

    Attributes:
        cause: Cause of the takeover request; empty for none.
        event: Kind of another event that comes.
        changes: Entity that changes lane, and the greatest time gap of the ego vehicle to it just then, s.
    """

    cause: str = ""
    event: str = ""
    changes: tuple[str, float] | None = None


MARKINGS, SENSOR = Provokes("lane_confidence"), Provokes("sensor_health")
OBSTACLE, RAMP = Provokes("path_blocked"), Provokes("lane_ends")

PROVOKES: dict[str, Provokes] = {
    "sensor_failure": SENSOR,
    "ramp_blocked": RAMP,
    "road_narrows": OBSTACLE,
    "obstacle_ahead": OBSTACLE,
    "markings_missing": MARKINGS,
    "aisa_situations#lanesdefault": Provokes(),
    "aisa_situations#customvanishing": MARKINGS,
    "aisa_situations#customramp": RAMP,
    "aisa_situations#obstaclestatic": OBSTACLE,
    "aisa_situations#obstacledynamic": OBSTACLE,
    "aisa_situations#narrowingroad": OBSTACLE,
    "aisa_situations#vanishinglanes_weather": MARKINGS,
    "aisa_situations#vanishinglanes_map": MARKINGS,
    "aisa_situations#sensornoise": SENSOR,
    "camera_failures#dropout": SENSOR,
    "camera_failures#freeze": SENSOR,
    "camera_failures#blackout": SENSOR,
    "camera_failures#blur": SENSOR,
    "camera_failures#dirt": MARKINGS,
    "camera_failures#freeze_in_curve": SENSOR,
    "markings_variants#town_road": MARKINGS,
    "markings_variants#town_rain": MARKINGS,
    "markings_variants#worn_straight": MARKINGS,
    "markings_variants#worn_curve": MARKINGS,
    "markings_variants#worn_winding": MARKINGS,
    "markings_variants#covered": MARKINGS,
    "markings_variants#missing_stretch": MARKINGS,
    "markings_variants#worn_track": MARKINGS,
    "markings_variants#behind_a_truck": MARKINGS,
    "in_traffic#van_in_traffic": OBSTACLE,
    "in_traffic#jaywalker": OBSTACLE,
    "in_traffic#yellow_lines": OBSTACLE,
    "in_traffic#cargo_somewhere": OBSTACLE,
    "in_traffic#leaves_in_rain": MARKINGS,
    "narrowing_variants#parked_van": OBSTACLE,
    "narrowing_variants#work_zone": OBSTACLE,
    "narrowing_variants#traffic_signs": OBSTACLE,
    "narrowing_variants#parked_car_and_traffic": OBSTACLE,
    "narrowing_variants#motorway_works": OBSTACLE,
    "obstacle_variants#crossing_car": Provokes("path_blocked", changes=("crossing_vehicle1.crosser", 10.0)),
    "obstacle_variants#cutting_in": Provokes("path_blocked", changes=("cut_in1.car", 2.5)),
    "obstacle_variants#oncoming_in_lane": Provokes("path_blocked", changes=("wrong_side1.oncoming", 10.0)),
    "obstacle_variants#standing_truck": OBSTACLE,
    "obstacle_variants#accident": OBSTACLE,
    "obstacle_variants#lost_cargo": OBSTACLE,
    "obstacle_variants#traffic_jam": OBSTACLE,
    "obstacle_variants#crossing_cyclist": Provokes("path_blocked", changes=("crossing_pedestrian1.walker", 4.0)),
    "obstacle_variants#obstacle_in_curve": OBSTACLE,
    "ramp_variants#gap": Provokes(event="merge"),
    "ramp_variants#queue": RAMP,
    "ramp_variants#fast_traffic": RAMP,
    "r157_situations#cut_in": Provokes(changes=("cut_in1.car", 1.2)),
    "r157_situations#cut_out": Provokes("path_blocked", changes=("cut_out1.leader", 4.0)),
    "r157_situations#deceleration": OBSTACLE,
    "r157_situations#swerving_leader": Provokes(changes=("swerving_leader1.leader", 3.0)),
    "r157_situations#stationary_target": OBSTACLE,
    "r157_situations#pedestrian": Provokes("path_blocked", changes=("crossing_pedestrian1.walker", 4.0)),
    "weather_and_works#road_works": OBSTACLE,
    "weather_and_works#works_in_traffic": OBSTACLE,
    "weather_and_works#rain_begins": Provokes("lane_confidence", event="weather"),
    "sensor_variants#noise_burst": SENSOR,
    "sensor_variants#noise_in_curve": SENSOR,
}
"""Every conflict by FILE#name, and what it provokes at its defaults."""


@dataclass(frozen=True)
class Close:
    """A conflict with the camera, started close to the event that it provokes.

    Attributes:
        target: FILE#name.
        duration: Length of the run, s.
        use: Attributes of the template's use to set.
        provokes: What it provokes.
    """

    target: str
    duration: float
    use: Mapping[str, str]
    provokes: Provokes


BY_CAMERA: dict[str, Close] = {
    "accident": Close("obstacle_variants#accident", 3.0, {"distance": "150"}, OBSTACLE),
    "black_image": Close("camera_failures#blackout", 4.0, {"onset": "1"}, SENSOR),
    "blocked_lane": Close("r157_situations#stationary_target", 3.0, {"distance": "100"}, OBSTACLE),
    "blurred_image": Close("camera_failures#blur", 5.0, {"onset": "1"}, SENSOR),
    "braking_leader": Close("r157_situations#deceleration", 7.0, {"onset": "0.5", "deceleration": "6"}, OBSTACLE),
    "crossing_pedestrian": Close("r157_situations#pedestrian", 6.0, {"distance": "50"}, OBSTACLE),
    "crossing_vehicle": Close("obstacle_variants#crossing_car", 5.0, {"distance": "60", "speed": "0.6"}, OBSTACLE),
    "cut_in": Close("obstacle_variants#cutting_in", 6.0, {}, OBSTACLE),
    "cut_out": Close("r157_situations#cut_out", 8.0, {"distance": "160", "room": "90"}, OBSTACLE),
    "dirty_lens": Close("camera_failures#dirt", 4.0, {"onset": "1"}, MARKINGS),
    "fading_markings": Close("markings_variants#worn_winding", 8.0, {"from": "50", "over": "40"}, MARKINGS),
    "frozen_image": Close("camera_failures#freeze", 3.0, {"onset": "1"}, SENSOR),
    "lost_cargo": Close("obstacle_variants#lost_cargo", 3.0, {"distance": "150"}, OBSTACLE),
    "missing_images": Close("camera_failures#dropout", 3.0, {"onset": "1"}, SENSOR),
    "missing_markings": Close("markings_variants#town_road", 6.0, {"from": "60"}, MARKINGS),
    "narrowing_road": Close("narrowing_variants#parked_van", 4.0, {"distance": "75"}, OBSTACLE),
    "noise_burst": Close("sensor_variants#noise_burst", 3.0, {"onset": "1"}, SENSOR),
    "occupied_ramp": Close("ramp_variants#fast_traffic", 14.0, {}, RAMP),
    "ramp_queue": Close("ramp_variants#queue", 14.0, {}, RAMP),
    "rain_front": Close("weather_and_works#rain_begins", 10.0, {}, MARKINGS),
    "road_works": Close("weather_and_works#road_works", 4.0, {"distance": "130"}, OBSTACLE),
    "sensor_failure": Close("sensor_variants#noise_in_curve", 3.0, {"onset": "1"}, SENSOR),
    "signs_in_lane": Close("narrowing_variants#traffic_signs", 4.0, {"distance": "75"}, OBSTACLE),
    "traffic_jam": Close("obstacle_variants#traffic_jam", 3.0, {"distance": "150"}, OBSTACLE),
    "work_zone_taper": Close("narrowing_variants#work_zone", 4.0, {"distance": "75"}, OBSTACLE),
    "worn_markings": Close("markings_variants#town_rain", 6.0, {"from": "60", "left": "0"}, MARKINGS),
    "wrong_side": Close("obstacle_variants#oncoming_in_lane", 12.0, {"distance": "180"}, OBSTACLE),
}
"""One conflict a template."""

WITHOUT_REQUEST = {"ramp_gap", "swerving_leader", "oncoming_traffic", "slow_vehicle"}
"""Templates that ask for no takeover."""

SOON = {
    *("blocked_lane", "braking_leader", "crossing_pedestrian", "cut_out", "narrowing_road", "road_works"),
    *("black_image", "dirty_lens", "noise_burst", "missing_markings", "worn_markings"),
}
"""Some templates of each kind whose asserted event comes soon; the tests of the others are slow."""


def _library(path: Path) -> Library:
    sink = Diagnostics()
    document = read_document(path, sink)
    assert document is not None
    source = parse(document, sink)
    assert isinstance(source, Library)
    return source


def _parameters(part: Part) -> Mapping[str, Parameter]:
    return template_parameters(part, Diagnostics()).known


def _targets() -> list[str]:
    """Return every conflict as FILE#name, without the name where the file is named after it."""
    return [
        path.stem if name == path.stem else f"{path.stem}#{name}"
        for path in CONFLICTS
        for name in _library(path).scenarios
    ]


def _path_of(target: str) -> str:
    file, _, name = target.partition("#")
    return f"{LIBRARY / 'conflicts' / file}.xml#{name or file}"


def _compiled(target: str, perception: Perception = "ideal", duration: float | None = None) -> Compilation:
    sink = Diagnostics()
    compilation = compile_target(target, {}, sink, overrides=Overrides(perception=perception, duration=duration))
    assert compilation is not None, [as_text(one) for one in sink]
    return compilation


def _changed_lane(recording: Recording, entity: int) -> list[float]:
    """Return the time gap of the ego vehicle to an entity at each of that entity's changes of lane, s."""
    lane = recording.lane[:, entity]
    rows = np.flatnonzero(lane[1:] != lane[:-1]) + 1
    apart = np.hypot(recording.x[:, entity] - recording.x[:, 0], recording.y[:, entity] - recording.y[:, 0])
    return [float(apart[row] / max(recording.v[row, 0], 0.1)) for row in rows]


def _assert_provoked(plan: Plan, recording: Recording, expected: Provokes) -> None:
    assert (judge(plan, recording).cause or "") == expected.cause
    if expected.event:
        assert expected.event in {event.kind for event in recording.events}
    if expected.changes is not None:
        entity, time_gap = expected.changes
        gaps = _changed_lane(recording, [one.id for one in plan.entities].index(entity))
        assert gaps
        assert gaps[0] <= time_gap


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_file_has_no_finding(path: Path) -> None:
    sink = Diagnostics()
    validate_file(path, sink)
    assert [as_text(one) for one in sink] == []


def test_library_is_large_enough() -> None:
    assert len(TEMPLATES) >= 20
    assert len(_targets()) >= 40


@pytest.mark.parametrize("path", TEMPLATES, ids=lambda path: path.stem)
def test_template_has_a_file_of_its_own(path: Path) -> None:
    library = _library(path)
    assert list(library.templates) == [path.stem]
    assert not library.scenarios


@pytest.mark.parametrize("path", [*CONFLICTS, *TEMPLATES], ids=lambda path: path.stem)
def test_every_part_has_a_summary_and_a_source(path: Path) -> None:
    library = _library(path)
    for name, part in (*library.scenarios.items(), *library.templates.items()):
        assert part.element.get("summary"), name
        assert part.element.get("source"), name


@pytest.mark.parametrize("path", [*CONFLICTS, *TEMPLATES], ids=lambda path: path.stem)
def test_parameters_are_documented_and_limited(path: Path) -> None:
    library = _library(path)
    for part in (*library.scenarios.values(), *library.templates.values()):
        for parameter in _parameters(part).values():
            assert parameter.summary.endswith("."), parameter.name
            if parameter.type not in ("text", "boolean"):
                found = parameter.limits
                assert None not in (found.minimum, found.maximum), parameter.name


@pytest.mark.parametrize("target", _targets())
def test_conflict_has_its_place_in_the_taxonomy(target: str) -> None:
    placed = _compiled(_path_of(target)).plan.classifications
    assert {one.place for one in placed} <= {place for one in placed for place in TAXONOMIES[one.scheme].situations}
    found = next((one for one in placed if one.scheme == "gold2018"), None)
    if found is None:
        assert target not in NUMBERS
        return
    assert found.number is not None
    assert found.number == NUMBERS.get(target, found.number)
    assert (found.scheme, found.urgency, found.response) == ("gold2018", *GOLD[found.number])
    assert (found.predictability, found.criticality) == ("", "")


@pytest.mark.parametrize("target", _targets())
def test_conflict_provokes_what_it_is_named_for(target: str) -> None:
    compilation = _compiled(_path_of(target))
    with open_world("kinematic", compilation.plan, compilation.network) as world:
        recording = run(compilation.plan, world, seed=1)
    _assert_provoked(compilation.plan, recording, PROVOKES[target])


@pytest.mark.parametrize(
    "template",
    [name if name in SOON else pytest.param(name, marks=pytest.mark.slow) for name in sorted(BY_CAMERA)],
)
def test_camera_sees_what_the_template_provokes(template: str, tmp_path: Path) -> None:
    close = BY_CAMERA[template]
    target = _with_use(close.target, template, close.use, tmp_path)
    compilation = _compiled(target, "camera", close.duration)
    recording = played_until("request", compilation.plan, compilation.network)
    _assert_provoked(compilation.plan, recording, close.provokes)


def test_every_template_is_seen_by_the_camera() -> None:
    assert {*BY_CAMERA, *WITHOUT_REQUEST} == {path.stem for path in TEMPLATES}


def _with_use(target: str, template: str, attributes: Mapping[str, str], folder: Path) -> str:
    """Write a conflict with other attributes of its use of a template; return its FILE#name."""
    path, _, name = _path_of(target).rpartition("#")
    tree = etree.parse(path)
    use = tree.find(f"scenario[@name='{name}']/use[@template='{template}']")
    assert use is not None
    for key, value in attributes.items():
        use.set(key, value)
    written = folder / Path(path).name
    tree.write(written)
    return f"{written}#{name}"


def _ends(part: Part) -> list[tuple[str, str]]:
    """Return the ends of the range of each parameter: (name, value)."""
    return [
        (parameter.name, format_value(float(end)))
        for parameter in _parameters(part).values()
        for end in (parameter.limits.minimum, parameter.limits.maximum)
        if end is not None
    ]


@pytest.mark.parametrize("target", _targets())
def test_conflict_compiles_at_the_ends_of_its_parameters(target: str) -> None:
    path, _, name = _path_of(target).rpartition("#")
    for parameter, value in _ends(_library(Path(path)).scenarios[name]):
        sink = Diagnostics()
        compiled = compile_target(f"{path}#{name}", {parameter: value}, sink)
        assert [as_text(one) for one in sink] == [], (parameter, value)
        assert compiled is not None
        assert {one.name: one.default for one in compiled.plan.parameters}.get(parameter, value) == value


def _host(template: str) -> str:
    """Return the first conflict that uses a template."""
    for target in _targets():
        path, _, name = _path_of(target).rpartition("#")
        uses = _library(Path(path)).scenarios[name].element.iter("use")
        if template in [use.get("template") for use in uses]:
            return target
    raise AssertionError(f"no conflict uses {template}")


@pytest.mark.parametrize("path", TEMPLATES, ids=lambda path: path.stem)
def test_template_compiles_at_the_ends_of_its_parameters(path: Path, tmp_path: Path) -> None:
    host = _host(path.stem)
    for parameter, value in _ends(_library(path).templates[path.stem]):
        sink = Diagnostics()
        compiled = compile_target(_with_use(host, path.stem, {parameter: value}, tmp_path), {}, sink)
        assert compiled is not None, (parameter, value, [as_text(one) for one in sink])


@pytest.mark.parametrize("target", [one for one in _targets() if one.startswith("in_traffic")])
def test_every_conflict_declares_how_a_sweep_varies_it(target: str) -> None:
    vary = _compiled(_path_of(target)).scenario.vary
    assert vary is not None
    declared = _parameters(_library(Path(_path_of(target).rpartition("#")[0])).scenarios[target.partition("#")[2]])
    for axis in vary.axes:
        found = declared[axis.parameter].limits
        assert found.minimum is not None
        assert found.maximum is not None
        assert all(found.minimum <= value <= found.maximum for value in axis.extent())


def test_every_template_is_used_by_a_conflict() -> None:
    used = {use.get("template") for path in CONFLICTS for use in _library(path).document.root.iter("use")}
    assert used == {path.stem for path in TEMPLATES}


def test_catalog_entries_are_plausible_and_name_their_source() -> None:
    catalogs = load_catalogs(LIBRARY / "catalogs", Diagnostics())
    assert {"vehicle.audi.tt", "vehicle.tesla.model3"} <= set(catalogs.vehicles)
    for vehicle in catalogs.vehicles.values():
        assert vehicle.source, vehicle.name
        assert vehicle.wheelbase <= vehicle.length, vehicle.name
        rear, front = vehicle.center - vehicle.length / 2, vehicle.center + vehicle.length / 2
        if vehicle.name.startswith("vehicle."):
            assert rear < 0 < vehicle.wheelbase < front, vehicle.name
    for driver in catalogs.drivers.values():
        assert driver.source, driver.name
    assert {"study_means", "unhurried", "unhurried_with_task", "mixed", "absent"} <= set(catalogs.drivers)
