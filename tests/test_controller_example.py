"""The example of a controller with a network: it drives, it is imported only where it is trusted, its page runs."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest

from scenario_compiler import Control, SensorData, VehicleState
from scenario_compiler.controllers.data import CameraMounting
from tests.command import call
from tests.pages import code_blocks

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "examples" / "onnx_controller"


class Called(NamedTuple):
    """What a command did: its exit code, and what it wrote to stderr."""

    code: int
    err: str


Call = Callable[..., Called]


@pytest.fixture
def called(capsys: pytest.CaptureFixture[str]) -> Call:
    """A function that calls a command in this process."""
    return lambda *arguments: Called(call(*arguments), capsys.readouterr().err)


@pytest.fixture
def example(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of the example's folder; no other test has imported its module."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "configuration"))
    return Path(shutil.copytree(FOLDER, tmp_path / "example", ignore=shutil.ignore_patterns("__pycache__")))


def test_it_keeps_the_lane_on_a_road_that_it_was_not_trained_on(example: Path, tmp_path: Path, called: Call) -> None:
    scenario, out = str(example / "keep_lane.xml"), tmp_path / "out"
    done = called(
        "run", scenario, "--trust", str(example / "steering.py"), "--duration", "4", "--strict", "-o", str(out)
    )
    assert done.code == 0, done.err
    outcome = json.loads((out / "outcome.json").read_text(encoding="utf-8"))
    assert outcome["result"] == "pass"


def test_it_is_found_beside_the_scenario_when_the_command_line_names_it(
    example: Path, tmp_path: Path, called: Call, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    scenario = str(example / "keep_lane.xml")
    assert called("run", scenario, "--duration", "0.2").code == 1
    for name in ("steering.py:NetworkSteering", "steering:NetworkSteering"):
        done = called("run", scenario, "--duration", "0.2", "--controller", name)
        assert done.code == 0, done.err


def test_a_missing_network_is_a_finding_with_the_controllers_line(example: Path, called: Call) -> None:
    (example / "lane_ahead.onnx").unlink()
    scenario, line = str(example / "keep_lane.xml"), "np.fromfile"
    done = called("run", scenario, "--trust", str(example / "steering.py"), "--duration", "0.2")
    number = next(
        k
        for k, text in enumerate((example / "steering.py").read_text(encoding="utf-8").splitlines(), 1)
        if line in text
    )
    assert done.code == 1
    assert f"steering.py:{number}" in done.err
    assert "error[SC521]" in done.err
    assert "lane_ahead.onnx" in done.err
    assert "Traceback" not in done.err


def test_properties_stay_with_the_controller_that_they_are_given_to(example: Path, called: Call) -> None:
    text = (example / "keep_lane.xml").read_text(encoding="utf-8")
    scenario = example / "keep_lane.xml"
    scenario.write_text(text.replace("lane_ahead.onnx", "other.onnx"), encoding="utf-8")
    same = called("run", str(scenario), "--duration", "0.2", "--controller", "steering.py:NetworkSteering")
    assert (same.code, "other.onnx" in same.err) == (1, True)
    other = called("run", str(scenario), "--duration", "0.2", "--controller", "lane_detection")
    assert other.code == 0, other.err


@pytest.mark.slow
def test_the_network_can_be_trained_again(example: Path) -> None:
    pytest.importorskip("onnx")
    command = [sys.executable, "train.py", "short.onnx", "--pictures", "60", "--rounds", "2"]
    done = subprocess.run(command, cwd=example, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    assert (example / "short.onnx").stat().st_size == (example / "lane_ahead.onnx").stat().st_size


def test_the_pages_controller_works() -> None:
    page = (ROOT / "docs" / "controllers.md").read_text(encoding="utf-8")
    code = code_blocks(page, "python")[0]
    names: dict[str, object] = {"__name__": "page"}
    exec(compile(code, "controllers.md", "exec"), names)
    straight = names["Straight"]
    assert isinstance(straight, type)
    made = straight(straight.Params(gain=0.1))  # type: ignore[attr-defined]
    camera = CameraMounting(width=64, height=32, fov=1.0, x=0.5, z=1.3, pitch=0.0)
    vehicle = VehicleState(0.0, 0.0, 0.0, 2.6, 1.4, 0.7, 3.5, 8.0, desired_speed=13.0, period=0.1)
    sensed = SensorData(t=0.0, image=None, camera=camera)  # type: ignore[arg-type]
    assert made.control(sensed, 10.0, vehicle) == Control(throttle=0.1 * 3.0, steer=0.0, brake=0.0)
