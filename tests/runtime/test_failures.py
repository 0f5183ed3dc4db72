"""A run that cannot continue ends: the recording is kept, and a diagnostic names the place of the failure."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

from scenario_compiler import compile_scenario, load_network, run
from scenario_compiler.compiler import Overrides
from scenario_compiler.engine.simulation import Simulation
from scenario_compiler.forms.failure import EngineError
from scenario_compiler.recording.store import read_recording
from scenario_compiler.worlds.kinematic import KinematicWorld
from tests.command import call

CONFLICT = Path(__file__).parents[2] / "library" / "conflicts" / "obstacle_ahead.xml"

CONTROLLER = '''
"""Controllers that fail in different ways."""

import sys

from scenario_compiler import Control, ControllerModel


class Raises(ControllerModel):
    """Raises after a while."""

    def control(self, sensor_data, speed, vehicle):
        """Drive for half a second."""
        if sensor_data.t > 0.5:
            return deeper([])
        return Control(0.0, 0.0, 0.0)


class Exits(ControllerModel):
    """Ends the program."""

    def control(self, sensor_data, speed, vehicle):
        """End it."""
        sys.exit(0)


class NeedsAFile(ControllerModel):
    """Loads a model when it is made."""

    def __init__(self, params):
        """Read a file that is not there."""
        super().__init__(params)
        self.weights = open("no_such_model.onnx", "rb").read()

    def control(self, sensor_data, speed, vehicle):
        """Never called."""
        return Control(0.0, 0.0, 0.0)


def deeper(values):
    """Fail below the controller's own method."""
    return values[0]
'''


@pytest.mark.parametrize(
    ("name", "message", "least"),
    [
        ("Raises", "controller 'failing:Raises', failing.py:42: IndexError: list index out of range", 0.5),
        ("Exits", "controller 'failing:Exits', failing.py:24: SystemExit: 0", 0.0),
        ("NeedsAFile", "controller 'failing:NeedsAFile', failing.py:33: FileNotFoundError: [Errno 2]", 0.0),
    ],
)
def test_a_controller_that_fails_is_a_diagnostic(
    tmp_path: Path,
    name: str,
    message: str,
    least: float,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    (tmp_path / "failing.py").write_text(CONTROLLER, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "failing", raising=False)
    controller = ("--controller", f"failing:{name}", "--duration", "1")
    assert call("run", CONFLICT, *controller, "-o", tmp_path / "out", "--format", "json") == 1
    told = capsys.readouterr()
    found = [one for one in json.loads(told.out) if one["code"] == "SC521"]
    assert [one["message"].startswith(message) for one in found] == [True]
    assert "Traceback" not in told.err
    recording = read_recording(tmp_path / "out" / "recording.parquet")
    assert recording.stop_reason == "controller_failed"
    assert recording.t[-1] >= least


def test_an_engine_without_a_result_is_a_diagnostic(monkeypatch: pytest.MonkeyPatch) -> None:
    plan = compile_scenario(CONFLICT, overrides=Overrides(perception="ideal", duration=3.0))
    usual = Simulation.end

    def failing(simulation: Simulation) -> None:
        if simulation.state.clock[0] > 1.0:
            raise EngineError("division by zero", "motion.py", 7)
        usual(simulation)

    monkeypatch.setattr(Simulation, "end", failing)
    with KinematicWorld(plan, load_network(plan.map.file)) as world:
        recording = run(plan, world)
    assert recording.stop_reason == "error"
    assert recording.t[-1] == pytest.approx(1.0, abs=0.051)
    broken = next(event for event in recording.events if event.kind == "broken_off")
    assert (broken.cause, broken.message) == ("SC522", "the engine broke off at motion.py:7: division by zero")


def test_both_forms_leave_the_same_recording() -> None:
    plan = compile_scenario(CONFLICT, overrides=Overrides(perception="ideal", duration=8.0))
    with KinematicWorld(plan, load_network(plan.map.file)) as world:
        assert run(plan, world) == run(plan, world, interpreted=True)
