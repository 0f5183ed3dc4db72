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


def test_an_open_number_is_written_as_its_expression(repository: Path, tmp_path: Path) -> None:
    plan = compile_scenario(repository / "tests" / "benchmarks" / "cut_in.xml")
    write_plan(plan, tmp_path / "plan.json")
    written = json.loads((tmp_path / "plan.json").read_text(encoding="utf-8"))
    assert [one["speed"] for one in written["entities"]] == [20.0, {"expr": "$speed"}, 20.0]
