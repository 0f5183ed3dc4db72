"""The page on scenarios in Python: its code runs, prints what it says, and has types."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from scenario_compiler import CompileError, compile_built
from scenario_compiler.expressions import parse_expression
from scenario_compiler.vocabulary.entities import Dynamic, Ego
from scenario_compiler.vocabulary.positions import LanePosition, RelativeLanePosition
from scenario_compiler.vocabulary.scenario import Scenario
from scenario_compiler.vocabulary.weather import Weather

PAGE = Path(__file__).resolve().parent.parent / "docs" / "python-api.md"
BLOCK = re.compile(r"```python\n(.*?)```", re.DOTALL)


def program() -> str:
    return "\n".join(BLOCK.findall(PAGE.read_text(encoding="utf-8")))


def test_code_of_the_page_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    exec(compile(program(), str(PAGE), "exec"), {"__name__": "page"})
    printed = capsys.readouterr().out.splitlines()
    assert printed[0] == "['ego', 'car']"
    assert printed[1].startswith("SC204 there is no map 'town_gird' did you mean 'town_grid'?")
    assert "['gap']" in printed
    assert "True True" in printed
    assert printed[-1] == "['afterwards', 'story']"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["cut_in.xosc", "town_grid.xodr"]


def test_code_of_the_page_has_types(tmp_path: Path) -> None:
    file = tmp_path / "page.py"
    file.write_text(program(), encoding="utf-8")
    command = [sys.executable, "-m", "mypy", "--strict", "--no-error-summary", str(file)]
    checked = subprocess.run(command, cwd=PAGE.parent.parent, capture_output=True, text=True, check=False)
    assert checked.stdout + checked.stderr == ""


def test_names_that_mean_nothing_are_reported_at_once() -> None:
    scenario = Scenario(
        name="wrong",
        map="town_grid",
        duration=5.0,
        weather=Weather(preset="ClearNon"),
        ego=Ego(model="vehicle.audi.tx", speed=10.0, start=LanePosition(road="9", lane=-2, s=30.0)),
        actors=(
            Dynamic(id="car", start=RelativeLanePosition(entity="eg0", distance=parse_expression("$gap"))),
            Dynamic(id="car", start=LanePosition(road="9", lane=-2, s=80.0)),
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
