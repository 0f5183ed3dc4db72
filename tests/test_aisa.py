"""The AISA toolkit's own file runs with the meaning that the toolkit's code gives it."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest
from lxml import etree

from scenario_compiler import judge
from scenario_compiler.compiler import Compilation, Overrides, compile_target, read_source
from scenario_compiler.diagnostics import Diagnostics, Severity, as_text
from scenario_compiler.languages import expand
from scenario_compiler.recording.outcome import Outcome
from scenario_compiler.recording.recording import Recording
from scenario_compiler.resources import library_folder, schema_file
from scenario_compiler.source.aisa import KNOWN, filed_scenario
from scenario_compiler.source.aisa_conversion import convert_aisa
from scenario_compiler.source.aisa_file import AisaConfig
from scenario_compiler.source.catalogs import load_catalogs
from scenario_compiler.vocabulary.sensors import Perception
from tests.playing import played_until

MAPS = {
    "Town01": "Scenic/assets/maps/CARLA/Town01.xodr",
    "Town04": "Scenic/assets/maps/CARLA/Town04.xodr",
    "Town05": "opendrive-test-files/OpenDrive/Town05.xodr",
    "HRI_custommap": "aisa-toolkit/custommap/HRI_custommap.xodr",
}
"""Where the corpus keeps the maps that the file names."""

CONVERTED = sorted(set(KNOWN) - {"lanesdefault"})
"""Scenarios with a start, which say the same in our language."""


@pytest.fixture(scope="module")
def maps(corpus: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("maps")
    for name, path in MAPS.items():
        shutil.copyfile(corpus / path, folder / f"{name}.xodr")
    return folder


@pytest.fixture(scope="module")
def file(corpus: Path) -> Path:
    return corpus / "aisa-toolkit/simulation/scenarios/aisa_conflicts.xml"


def _compiled(
    target: str, maps: Path, perception: Perception = "ideal", duration: float | None = None, **settings: str
) -> tuple[Compilation | None, Diagnostics]:
    sink = Diagnostics()
    overrides = Overrides(perception=perception, duration=duration)
    return compile_target(target, settings, sink, maps=[maps], overrides=overrides), sink


def _played(
    target: str, maps: Path, perception: Perception = "ideal", duration: float | None = None, **settings: str
) -> tuple[Recording, Outcome]:
    compilation, sink = _compiled(target, maps, perception, duration, **settings)
    assert compilation is not None, [as_text(one) for one in sink]
    return _driven(compilation)


def _driven(compilation: Compilation) -> tuple[Recording, Outcome]:
    """Run a scenario with a small image, with the camera until the first request, and judge it."""
    small = compilation.plan.camera.model_copy(update={"width": 512, "height": 256})
    plan = compilation.plan.model_copy(update={"camera": small})
    end = "request" if plan.perception == "camera" else "stop"
    recording = played_until(end, plan, compilation.network)
    return recording, judge(plan, recording)


def _first(recording: Recording, kind: str) -> float | None:
    return next((event.t for event in recording.events if event.kind == kind), None)


def _codes(sink: Diagnostics, severity: Severity = Severity.ERROR) -> set[str]:
    return {one.code.id for one in sink if one.severity is severity}


@pytest.mark.parametrize("name", ["obstaclestatic", "obstacledynamic"])
def test_an_obstacle_of_the_toolkits_code_causes_a_request(file: Path, maps: Path, name: str) -> None:
    recording, outcome = _played(f"{file}#{name}", maps)
    assert outcome.cause == "path_blocked"
    assert _first(recording, "collision") is None


def test_the_moving_obstacle_moves_three_decimetres_a_second(file: Path, maps: Path) -> None:
    recording, _ = _played(f"{file}#obstacledynamic", maps, duration=10.0)
    moved = ((recording.x[-1, 1] - recording.x[0, 1]) ** 2 + (recording.y[-1, 1] - recording.y[0, 1]) ** 2) ** 0.5
    assert moved == pytest.approx(0.3 * 10.0, abs=0.05)


def test_the_parked_car_cuts_the_corridor_of_a_car_in_mid_lane(file: Path, maps: Path) -> None:
    recording, outcome = _played(f"{file}#narrowingroad", maps)
    assert outcome.cause == "path_blocked"
    assert _first(recording, "collision") is None


@pytest.mark.parametrize("perception", ["camera", "ideal"])
def test_rain_hides_the_lanes_only_when_it_rains(file: Path, maps: Path, perception: Perception) -> None:
    dry, _ = _played(f"{file}#vanishinglanes_weather", maps, perception, 2.0)
    wet, _ = _played(f"{file}#vanishinglanes_weather", maps, perception, 1.5, WeatherId="10")
    assert _first(dry, "request") is None
    assert _first(wet, "warning") is not None
    assert _first(wet, "request") is not None


def test_the_note_on_default_weather_names_the_papers_weather(file: Path, maps: Path) -> None:
    _, sink = _compiled(f"{file}#vanishinglanes_weather", maps)
    (note,) = [one for one in sink if one.code.id == "SC242"]
    assert "Default" in note.message
    assert "HardRainSunset" in note.hint


def test_an_unmarked_junction_causes_a_request(file: Path, maps: Path) -> None:
    recording, outcome = _played(f"{file}#vanishinglanes_map", maps)
    assert outcome.cause == "lane_confidence"
    at = _first(recording, "request")
    assert at is not None
    row = int(at / (1 / 30))
    travelled = float(recording.v[:row, 0].sum() / 30.0)
    assert 95.0 <= travelled <= 132.0


def _near_the_junction(file: Path, maps: Path, **settings: str) -> tuple[Recording, Outcome]:
    """Play the last 25 m before Town01's unmarked junction."""
    compilation, sink = _compiled(f"{file}#vanishinglanes_map", maps, "camera", 8.0, start="302,330.85,0", **settings)
    assert compilation is not None, [as_text(one) for one in sink]
    return _driven(compilation)


def test_with_the_camera_the_request_comes_before_the_unmarked_turn_of_the_route(file: Path, maps: Path) -> None:
    """The visible paint goes straight on over the junction, which begins 113.5 m from the file's start.

    The detector searches for paint up to 30 m ahead, so the request comes within that distance of the junction.
    """
    recording, outcome = _near_the_junction(file, maps, dest="339.018738,116.545761,-90")
    assert outcome.cause == "lane_confidence"
    at = _first(recording, "request")
    assert at is not None
    x = float(np.interp(at, recording.t, recording.x[:, 0]))
    assert 213.76 + 113.5 - 30.0 <= x <= 213.76 + 113.5


@pytest.mark.slow
def test_with_the_camera_no_request_comes_where_the_route_follows_the_paint(file: Path, maps: Path) -> None:
    recording, _ = _near_the_junction(file, maps)
    assert recording.x[-1, 0] > 213.76 + 120.0
    assert _first(recording, "request") is None


@pytest.mark.slow
def test_little_noise_does_no_harm_and_much_does(file: Path, maps: Path) -> None:
    little, _ = _played(f"{file}#sensornoise", maps, "camera", 2.0)
    much, _ = _played(f"{file}#sensornoise", maps, "camera", 1.5, sensor_noise="60")
    assert _first(little, "request") is None
    assert _first(much, "request") is not None


@pytest.mark.parametrize(
    ("name", "distance", "filed"), [("customvanishing", "2541", "2793,1068,0"), ("customramp", "837", "1231,-237,0")]
)
@pytest.mark.parametrize("town", ["conflictmap", "HRI_custommap"])
def test_a_start_off_the_custom_map_is_an_error_with_a_remedy(
    file: Path, maps: Path, name: str, distance: str, filed: str, town: str
) -> None:
    compilation, sink = _compiled(f"{file}#{name}", maps, town=town)
    assert compilation is None
    (fault,) = [one for one in sink if one.severity is Severity.ERROR]
    assert fault.code.id == "SC243"
    assert distance in fault.message
    assert "--set start=" in fault.hint
    assert ("--set obstacles=false" in fault.hint) is (name == "customramp")
    _, measured = _compiled(f"{file}#{name}", maps, start=filed, obstacles="false", town=town)
    (off_road,) = [one for one in measured if one.severity is Severity.ERROR]
    assert off_road.code.id == "SC374"
    assert f"is {distance} m away" in off_road.hint


def test_obstacles_off_the_custom_map_are_one_error_with_a_remedy(file: Path, maps: Path) -> None:
    compilation, sink = _compiled(f"{file}#customramp", maps, start="413,39,90")
    assert compilation is None
    (fault,) = [one for one in sink if one.severity is Severity.ERROR]
    assert (fault.code.id, "--set obstacles=false" in fault.hint) == ("SC243", True)


def test_the_custom_map_is_found_by_the_name_that_it_is_published_under(file: Path, maps: Path, tmp_path: Path) -> None:
    compilation, sink = _compiled(f"{file}#customvanishing", maps, start="413,39,90")
    assert compilation is not None
    assert Path(compilation.network.path).name == "HRI_custommap.xodr"
    (warning,) = [one for one in sink if one.code.id == "SC305"]
    assert "23 more" in warning.hint
    _, sink = _compiled(f"{file}#customvanishing", tmp_path, start="413,39,90")
    (missing,) = [one for one in sink if one.code.id == "SC204"]
    assert "HRI_custommap.xodr" in missing.hint


@pytest.mark.parametrize(
    ("name", "town", "start"),
    [
        ("customvanishing", "Town05", "151.4,-91.5,90"),
        ("customramp", "Town05", "151.4,-91.5,90"),
        ("lanesdefault", "Town05", "151.4,-91.5,90"),
    ],
)
def test_setting_a_start_runs_it(file: Path, maps: Path, name: str, town: str, start: str) -> None:
    recording, _ = _played(f"{file}#{name}", maps, duration=2.0, start=start, town=town, obstacles="false")
    assert recording.v[-1, 0] > 1.0


def test_without_a_start_there_is_an_error_with_a_remedy_and_objects_are_noted(file: Path, maps: Path) -> None:
    compilation, sink = _compiled(f"{file}#lanesdefault", maps)
    assert compilation is None
    assert _codes(sink) == {"SC240"}
    assert _codes(sink, Severity.NOTE) == {"SC241"}
    (fault,) = [one for one in sink if one.code.id == "SC240"]
    assert "--set start=" in fault.hint


@pytest.mark.parametrize("start", ["here", "1", "1,2,3,4", "1,2,nan"])
def test_a_start_that_is_not_a_pose_is_an_error(file: Path, maps: Path, start: str) -> None:
    compilation, sink = _compiled(f"{file}#lanesdefault", maps, start=start)
    assert compilation is None
    assert "SC244" in _codes(sink)


@pytest.fixture(scope="module")
def converted(file: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    sink = Diagnostics()
    read = read_source(file, sink)
    assert read is not None
    source = read[1]
    assert isinstance(source, AisaConfig)
    path = tmp_path_factory.mktemp("converted") / "converted.xml"
    path.write_text(convert_aisa(source, sink), encoding="utf-8")
    assert not sink.has_errors
    return path


def test_converted_file_follows_the_schema(converted: Path) -> None:
    schema = etree.XMLSchema(etree.parse(schema_file("conflict.xsd")))
    schema.assertValid(etree.parse(converted))


def test_a_scenario_without_a_start_is_converted_to_a_conflict_with_parameters_for_it(
    converted: Path, maps: Path
) -> None:
    compilation, sink = _compiled(f"{converted}#lanesdefault", maps)
    assert compilation is None
    assert _codes(sink) == {"SC214"}
    target = f"{converted}#lanesdefault"
    recording, _ = _played(target, maps, duration=2.0, start_x="151.4", start_y="-91.5", start_yaw="90")
    assert recording.v[-1, 0] > 1.0


def test_gaps_in_a_conversion_are_reported(file: Path) -> None:
    sink = Diagnostics()
    read = read_source(file, sink)
    assert read is not None
    assert isinstance(read[1], AisaConfig)
    convert_aisa(read[1], sink)
    assert _codes(sink, Severity.WARNING) == {"SC240", "SC243"}
    assert not sink.has_errors


def test_a_converted_file_lists_what_could_not_be_converted(converted: Path) -> None:
    text = converted.read_text(encoding="utf-8")
    assert "lanesdefault: the scenario 'lanesdefault' has no waypoint named 'start'" in text
    assert text.count("lanesdefault: not executed: object name=") == 4
    assert 'object name="bike1" type="vehicle_2W" autopilot="True" start_x="147.6" start_y="62.6"' in text


def test_every_object_is_named_in_a_note_of_its_own_line(file: Path, maps: Path) -> None:
    compilation, sink = _compiled(f"{file}#lanesdefault", maps, start="151.4,-91.5,90", town="Town05")
    assert compilation is not None
    notes = [(one.place.line, one.message) for one in sink if one.code.id == "SC241"]
    assert [line for line, _ in notes] == [11, 12, 13, 14]
    for name, (_, message) in zip(("vehicle1", "vehicle2", "pedestrian1", "bike1"), notes, strict=True):
        assert f"'{name}'" in message


@pytest.mark.parametrize("name", CONVERTED)
def test_converted_scenario_says_the_same(file: Path, converted: Path, name: str) -> None:
    before, after = read_source(file, Diagnostics()), read_source(converted, Diagnostics())
    assert before is not None
    assert after is not None
    sink = Diagnostics()
    catalogs = load_catalogs(library_folder() / "catalogs", sink)
    assert isinstance(before[1], AisaConfig)
    said = expand(after[1], name, {}, sink)
    assert said is not None
    unlimited = said.model_copy(update={"limits": ()})
    assert unlimited == filed_scenario(before[1], name, {}, Diagnostics(), catalogs)
    assert not list(sink)
