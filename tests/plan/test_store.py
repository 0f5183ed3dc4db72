"""The file of a plan: it agrees with pydantic's models, and is read back as the same plan."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from scenario_compiler import compile_scenario
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.plan.store import digest_of, read_plan, write_plan

SCENARIOS = ("library/conflicts/obstacle_ahead.xml", "tests/benchmarks/cut_in.xml", "tests/benchmarks/scripted.xosc")


@pytest.mark.parametrize("file", SCENARIOS)
def test_a_plan_is_written_as_its_models_say_and_read_back(repository: Path, tmp_path: Path, file: str) -> None:
    plan = compile_scenario(repository / file)
    target = tmp_path / "plan.json"
    write_plan(plan, target)
    assert json.loads(target.read_text(encoding="utf-8")) == plan.model_dump(mode="json")
    read = read_plan(target, Diagnostics())
    assert read is not None
    assert read == plan
    assert digest_of(read) == plan.digest


def test_an_edited_plan_has_another_digest(repository: Path, tmp_path: Path) -> None:
    plan = compile_scenario(repository / SCENARIOS[0])
    write_plan(plan.model_copy(update={"duration": 1.0}), tmp_path / "plan.json")
    read = read_plan(tmp_path / "plan.json", Diagnostics())
    assert read is not None
    assert read.digest == digest_of(read) != plan.digest


def test_an_open_number_is_written_as_its_expression(repository: Path, tmp_path: Path) -> None:
    plan = compile_scenario(repository / "tests" / "benchmarks" / "cut_in.xml")
    write_plan(plan, tmp_path / "plan.json")
    written = json.loads((tmp_path / "plan.json").read_text(encoding="utf-8"))
    assert [one["speed"] for one in written["entities"]] == [20.0, {"expr": "$speed"}, 20.0]


@pytest.mark.parametrize(
    ("part", "value", "said"),
    [
        ("step", 0.0, "step: Input should be greater than or equal to 0.001"),
        ("step", -0.05, "step: Input should be greater than or equal to 0.001"),
        ("control_every", 0, "control_every: Input should be greater than or equal to 1"),
        ("duration", -1.0, "duration: Input should be greater than 0"),
        ("entities", [], "entities: a plan with a controller needs a vehicle that it drives"),
        ("camera/width", 0, "camera: width is 0, but must be at least 64"),
        ("camera/height", 10**9, "camera: height is 1000000000, but must be at most 4096"),
    ],
)
def test_a_plan_that_no_run_can_use_is_reported(
    repository: Path, tmp_path: Path, part: str, value: object, said: str
) -> None:
    write_plan(compile_scenario(repository / SCENARIOS[0]), tmp_path / "plan.json")
    content = json.loads((tmp_path / "plan.json").read_text(encoding="utf-8"))
    *above, name = part.split("/")
    (content[above[0]] if above else content)[name] = value
    (tmp_path / "plan.json").write_text(json.dumps(content), encoding="utf-8")
    sink = Diagnostics()
    assert read_plan(tmp_path / "plan.json", sink) is None
    assert [(one.code.id, one.message) for one in sink] == [("SC130", said)]
