"""The page on scenarios in Python: its code runs, prints the shown output, and passes mypy."""

from __future__ import annotations

import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from scenario_compiler import (
    Camera,
    CompileError,
    Failure,
    Overrides,
    Parameter,
    SweepSpec,
    Takeover,
    Uniform,
    Vary,
    compile_built,
    compile_scenario,
    load_network,
    open_world,
    run,
    run_sweep,
    weather_preset,
)
from scenario_compiler.batch.search import find_boundary
from scenario_compiler.compiler import compile_target
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.expressions import parse_expression
from scenario_compiler.resources import library_folder
from scenario_compiler.vocabulary.entities import Dynamic, Ego
from scenario_compiler.vocabulary.grammar import limits_broken
from scenario_compiler.vocabulary.positions import LanePositionWord, RelativeLanePosition
from scenario_compiler.vocabulary.scenario import Scenario
from scenario_compiler.vocabulary.weather import Weather
from tests.pages import code_blocks

PAGE = Path(__file__).resolve().parent.parent / "docs" / "python-api.md"


def program() -> str:
    return "\n".join(code_blocks(PAGE.read_text(encoding="utf-8"), "python"))


def test_code_of_the_page_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    exec(compile(program(), str(PAGE), "exec"), {"__name__": "page"})
    printed = capsys.readouterr().out.splitlines()
    assert printed[0] == "['ego', 'car']"
    assert printed[1].startswith("SC204 there is no map 'town_gird' did you mean 'town_grid'?")
    assert "ice fail" in printed
    assert "['gap']" in printed
    assert "True True" in printed
    assert "ideal 5.0 0.1" in printed
    assert f"{Path('sweep', 'results.parquet')} 20" in printed
    assert printed[-1] == "['afterwards', 'story']"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["cut_in.xosc", "sweep", "town_grid.xodr"]


@pytest.mark.slow
def test_code_of_the_page_has_types(tmp_path: Path) -> None:
    """Run by `make check`, where mypy has just read the package."""
    file = tmp_path / "page.py"
    file.write_text(program(), encoding="utf-8")
    command = [sys.executable, "-m", "mypy", "--strict", "--no-error-summary", str(file)]
    checked = subprocess.run(command, cwd=PAGE.parent.parent, capture_output=True, text=True, check=False)
    assert checked.stdout + checked.stderr == ""


def test_unknown_names_are_reported_at_once() -> None:
    scenario = Scenario(
        name="wrong",
        map="town_grid",
        duration=5.0,
        weather=Weather(preset="ClearNon"),
        ego=Ego(model="vehicle.audi.tx", speed=10.0, start=LanePositionWord(road="9", lane=-2, s=30.0)),
        actors=(
            Dynamic(id="car", start=RelativeLanePosition(entity="eg0", distance=parse_expression("$gap"))),
            Dynamic(id="car", start=LanePositionWord(road="9", lane=-2, s=80.0)),
        ),
    )
    with pytest.raises(CompileError) as raised:
        compile_built(scenario)
    assert {one.code.name for one in raised.value.diagnostics} == {
        "unknown-weather",
        "unknown-vehicle",
        "unknown-entity",
        "unknown-parameter",
        "duplicate-name",
    }


def test_numbers_beyond_their_limits_are_reported_at_once() -> None:
    scenario = Scenario(
        name="wrong",
        map="town_grid",
        duration=-1.0,
        step=0.0,
        parameters=(Parameter(name="gap", type="length", default="-30"),),
        weather=Weather(preset="ClearNoon"),
        ego=Ego(
            speed=-5.0,
            start=LanePositionWord(road="9", lane=-2, s=30.0),
            camera=Camera(width=0, fov=45.0, sensor_noise=parse_expression("$gap")),
        ),
        takeover=Takeover(budget=-3.0),
    )
    with pytest.raises(CompileError) as raised:
        compile_built(scenario)
    assert {(one.code.id, one.message) for one in raised.value.diagnostics} == {
        ("SC112", "Scenario: duration is -1, but must be greater than 0"),
        ("SC112", "Scenario: step is 0, but must be at least 0.001"),
        ("SC112", "Ego: speed is -5, but must be at least 0"),
        ("SC112", "Camera: width is 0, but must be at least 64"),
        ("SC112", "Camera: sensor_noise is -30, but must be at least 0"),
        ("SC112", "Takeover: budget is -3, but must be greater than 0"),
    }


def test_empty_names_are_reported() -> None:
    scenario = Scenario(
        name="",
        map="town_grid",
        duration=5.0,
        weather=Weather(preset="ClearNoon"),
        ego=Ego(id="", speed=5.0, start=LanePositionWord(road="9", lane=-2, s=30.0)),
    )
    with pytest.raises(CompileError) as raised:
        compile_built(scenario)
    assert {(one.code.id, one.message) for one in raised.value.diagnostics} == {
        ("SC111", "Scenario: name is empty"),
        ("SC111", "Ego: id is empty"),
    }


def test_faults_of_parameters_and_of_their_variation_are_reported_at_once() -> None:
    scenario = Scenario(
        name="varied",
        map="town_grid",
        duration=5.0,
        ego=Ego(speed=5.0, start=LanePositionWord(road="9", lane=-2, s=30.0)),
        parameters=(
            Parameter(name="gap", type="length", default="far"),
            Parameter(name="speed", type="speed", default="9", min=10.0),
            Parameter(name="speed", type="speed", default="12"),
            Parameter(name="budget", type="time"),
            Parameter(name="distance", type="length", default="50", max=100.0),
        ),
        vary=Vary(
            axes=(
                Uniform(parameter="gap", least=40.0, greatest=15.0),
                Uniform(parameter="distance", least=40.0, greatest=150.0),
                Uniform(parameter="distanc", least=1.0, greatest=2.0),
            )
        ),
    )
    with pytest.raises(CompileError) as raised:
        compile_built(scenario)
    assert {(one.code.id, one.message) for one in raised.value.diagnostics} == {
        ("SC111", "'far' is not a number in m, which the parameter 'gap' holds"),
        ("SC112", "speed is 9, but must be at least 10"),
        ("SC216", "the parameter 'speed' is declared twice"),
        ("SC214", "the parameter 'budget' has neither a default nor a value"),
        ("SC250", "greatest must not be below least"),
        ("SC250", "distance may become 150, but must be at most 100"),
        ("SC210", "there is no parameter 'distanc' here"),
    }


def test_the_weather_is_that_of_a_file_by_default() -> None:
    start = LanePositionWord(road="9", lane=-2, s=30.0)
    scenario = Scenario(name="clear", map="town_grid", duration=5.0, ego=Ego(speed=5.0, start=start))
    assert compile_built(scenario, perception="ideal").plan.weather == weather_preset("ClearNoon")


def test_warnings_of_a_scenario_that_compiles_are_in_the_sink() -> None:
    """Lane 0 is the line between left and right: ASAM allows it, but nothing drives there."""
    scenario = Scenario(
        name="on_the_line",
        map="highway_loop",
        duration=5.0,
        weather=Weather(preset="ClearNoon"),
        ego=Ego(speed=5.0, start=LanePositionWord(road="1", lane=0, s=20.0)),
    )
    sink = Diagnostics()
    compile_built(scenario, perception="ideal", sink=sink)
    assert [(one.code.id, one.message) for one in sink] == [
        ("SC380", "'ego' starts on lane 0 of road '1', which is not for driving")
    ]


def test_a_conflict_of_the_library_compiles_by_its_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    file = library_folder() / "conflicts" / "obstacle_ahead.xml"
    assert compile_scenario("obstacle_ahead") == compile_scenario(file)
    spec = SweepSpec(vary=("distance=uniform(100, 120)",), samples=2, perception="ideal")
    tally = run_sweep("obstacle_ahead", spec, tmp_path / "out", workers=1, report=False).tally
    assert (tally.passed + tally.failed, tally.broken_off) == (2, 0)
    (tmp_path / "obstacle_ahead").write_text(CONFLICT, encoding="utf-8")
    assert compile_scenario("obstacle_ahead").name == "straight"


def test_a_misspelt_conflict_of_the_library_gets_a_hint(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The current folder contains a file with a similar name, which is not meant: its name has a suffix."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "obstacle_ahed.xml").write_text(CONFLICT, encoding="utf-8")
    spec = SweepSpec(vary=("distance=uniform(100, 120)",), perception="ideal")

    def compile_it() -> object:
        return compile_scenario("obstacle_ahed")

    def sweep_it() -> object:
        return run_sweep("obstacle_ahed", spec, tmp_path / "out")

    def search_it() -> object:
        return find_boundary("obstacle_ahed", spec, tmp_path / "out", when="collision", tolerance=1.0)

    for attempt in (compile_it, sweep_it, search_it):
        with pytest.raises(CompileError) as refused:
            attempt()
        assert [(one.code.id, one.message, one.hint) for one in refused.value.diagnostics] == [
            (
                "SC101",
                "there is no file and no conflict of the library called 'obstacle_ahed'",
                "did you mean 'obstacle_ahead'?",
            )
        ]
    assert not (tmp_path / "out").exists()


def test_limits_of_angles_are_compared_in_radians() -> None:
    """A failure's turn is at most 30 degrees, to the bit as a file writes it."""
    most = 30.0 * math.radians(1.0)
    assert not list(limits_broken(Failure(kind="misalignment", yaw=most), {}))
    (broken,) = limits_broken(Failure(kind="misalignment", yaw=0.6), {})
    assert broken.startswith("yaw is 0.6, but must be at most 0.52")


CONFLICT = """<scenarios version="1">
  <scenario name="straight" map="highway_loop" duration="10">
    <parameter name="speed" type="speed" default="20" min="5" max="40"/>
    <parameter name="maps" type="number" default="1"/>
    <ego speed="${$speed * $maps}"><start><lane road="1" lane="-1" s="20"/></start></ego>
  </scenario>
</scenarios>
"""


@pytest.fixture
def conflict(tmp_path: Path) -> Path:
    file = tmp_path / "straight.xml"
    file.write_text(CONFLICT, encoding="utf-8")
    return file


def test_overrides_replace_values_of_the_scenario(conflict: Path) -> None:
    plan = compile_scenario(conflict, overrides=Overrides("ideal", "lane_detection", step=0.1, duration=2.0), speed=30)
    assert (plan.perception, plan.step, plan.duration) == ("ideal", 0.1, 2.0)
    assert plan.controller is not None
    assert plan.controller.model == "lane_detection"
    assert [one.default for one in plan.parameters] == ["30", "1"]
    assert compile_scenario(conflict).duration == 10.0


def test_maps_are_looked_for_in_the_folders_that_are_given(conflict: Path, tmp_path: Path, repository: Path) -> None:
    folder = tmp_path / "maps"
    folder.mkdir()
    road = (repository / "maps" / "highway_loop" / "highway_loop.xodr").read_bytes()
    (folder / "mine.xodr").write_bytes(road)
    conflict.write_text(CONFLICT.replace("highway_loop", "mine"), encoding="utf-8")
    with pytest.raises(CompileError) as raised:
        compile_scenario(conflict)
    assert "unknown-map" in {one.code.name for one in raised.value.diagnostics}
    assert compile_scenario(conflict, maps=[str(folder)]).map.file == str(folder / "mine.xodr")


def test_a_file_is_not_a_scenario_of_words(conflict: Path) -> None:
    file: Any = str(conflict)
    with pytest.raises(TypeError, match="scenario is a Scenario, not '"):
        compile_built(file)


def test_a_parameter_with_the_name_of_an_argument_is_refused(conflict: Path) -> None:
    with pytest.raises(TypeError, match="maps is a list of folders, not '3'"):
        compile_scenario(conflict, maps="3")
    taken: dict[str, object] = {"overrides": 3}
    with pytest.raises(TypeError, match="overrides is an Overrides, not 3"):
        compile_scenario(conflict, **taken)  # type: ignore[arg-type]
    done = compile_target(conflict, {"maps": "3"}, Diagnostics())
    assert done is not None
    assert [one.default for one in done.plan.parameters] == ["20", "3"]


def test_a_seed_is_a_whole_number_of_any_type(conflict: Path) -> None:
    plan = compile_scenario(conflict, overrides=Overrides(perception="ideal", duration=0.5))
    world = open_world("kinematic", plan, load_network(plan.map.file))
    wrong: Any
    for wrong in ("1", 1.5, None):
        with pytest.raises(TypeError, match="seed is a whole number, not"):
            run(plan, world, seed=wrong)
    recording = run(plan, world, seed=np.int64(3))  # type: ignore[arg-type]
    assert type(recording.header.seed) is int
    assert recording.trajectory_hash == run(plan, world, seed=3).trajectory_hash


@pytest.mark.parametrize("wrong", [{"step": 0.0}, {"step": 2.0}, {"duration": 0.0}, {"perception": "radar"}], ids=str)
def test_impossible_overrides_are_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=next(iter(wrong))):
        Overrides(**wrong)
