"""A run that breaks off reports the entity, the quantity, its value and the time, and exits with an error."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from scenario_compiler.batch.finished import read_results
from scenario_compiler.engine.columns import opcodes
from scenario_compiler.recording.break_off import QUANTITIES, break_off_text
from scenario_compiler.recording.store import read_recording
from tests.command import call

CONFLICT = """\
<scenarios version="1">
  <scenario name="s" map="highway_loop" duration="1">
    <parameter name="v" type="speed" default="20"/>
    <ego speed="20"><start><spawn_point name="straight"/></start></ego>
    <dynamic id="lead" speed="$v"><start><ahead_of entity="ego" distance="60"/></start></dynamic>
    <criteria><no_collision/></criteria>
  </scenario>
</scenarios>
"""


@pytest.fixture
def conflict(tmp_path: Path) -> Path:
    file = tmp_path / "s.xml"
    file.write_text(CONFLICT, encoding="utf-8")
    return file


def test_a_run_that_breaks_off_gives_the_reason_and_keeps_its_recording(
    conflict: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan, out = tmp_path / "plan.json", tmp_path / "out"
    assert call("compile", conflict, "--perception", "ideal", "-o", plan) == 0
    content = json.loads(plan.read_text(encoding="utf-8"))
    content["parameters"][0]["default"] = "1e18"
    plan.write_text(json.dumps(content), encoding="utf-8")
    assert call("run", plan, "-o", out) == 1
    assert f"{conflict}:5:5: error[SC523]: 'lead' has the speed 1e+18 m/s at 0 s" in capsys.readouterr().err
    recording = read_recording(out / "recording.parquet")
    told = [(event.entity, event.message) for event in recording.events if event.kind == "broken_off"]
    assert told == [("lead", "'lead' has the speed 1e+18 m/s at 0 s")]
    assert recording.header.processor
    assert {"python", "numpy", "scipy", "opencv", "pyarrow", "lxml", "pydantic"} <= set(recording.header.versions)
    assert call("report", out) == 0


def test_a_sweep_gives_the_reason_in_the_variants_row(conflict: Path, tmp_path: Path) -> None:
    swept = tmp_path / "swept"
    command = ("sweep", conflict, "--perception", "ideal", "--vary", "v=values(10,1e20)", "--no-report", "-o", swept)
    assert call(*command) == 0
    rows, _ = read_results(swept)
    assert rows["error"] == ["", "'lead' has the speed 1e+20 m/s at 0 s"]
    assert rows["result"] == ["pass", "error"]


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"x": math.nan}, "'b' has the x nan m at 1.5 s"),
        ({"v": -math.inf}, "'b' has the speed -inf m/s at 1.5 s"),
        ({"h": 1e16}, "'b' has the heading 1e+16 rad at 1.5 s"),
        ({}, "'b' at 1.5 s: a position or speed is no longer a finite number"),
    ],
)
def test_the_first_quantity_that_is_not_finite_is_named(values: dict[str, float], said: str) -> None:
    whole = dict.fromkeys(QUANTITIES, 0.0) | values
    assert break_off_text(opcodes.FAULT_NOT_FINITE, 1, ["a", "b"], whole, 1.5) == said


def test_every_fault_of_the_engine_has_a_description() -> None:
    codes = [value for name, value in vars(opcodes).items() if name.startswith("FAULT_") and value]
    for code in codes:
        why = break_off_text(code, 0, ["a"], dict.fromkeys(QUANTITIES, 0.0), 0.0)
        assert why
        assert "of the engine" not in why
    assert break_off_text(0, -1, [], {}, 0.0) == ""
