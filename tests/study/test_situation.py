"""True answers to the queries of a probe, from a row of a recording, and which answers are right."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenario_compiler.compiler import Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.plan.model import Plan
from scenario_compiler.recording.recording import Recording
from scenario_compiler.runtime import open_world, run
from scenario_compiler.source.study import Query
from scenario_compiler.study.situation import is_right, true_answer
from tests.study import made

PLACE = '<at><ahead_of entity="ego" distance="20" offset="-7"/></at>'

BESIDE = f"""\
    <static id="walker" model="walker.pedestrian.0001">{PLACE}</static>
    <static id="cone" model="static.prop.trafficcone01">{PLACE.replace("-7", "-6")}</static>
    <takeover"""


@pytest.fixture(scope="module")
def driven(tmp_path_factory: pytest.TempPathFactory) -> tuple[Plan, Recording]:
    folder: Path = tmp_path_factory.mktemp("situation")
    made.study(folder)
    conflicts = folder / "conflicts.xml"
    conflicts.write_text(conflicts.read_text().replace("    <takeover", BESIDE))
    overrides = Overrides(perception="ideal", driven_by="model")
    done = compile_target(folder / "conflicts.xml", {}, Diagnostics(), overrides=overrides)
    assert done is not None
    with open_world("kinematic", done.plan, done.network) as world:
        return done.plan, run(done.plan, world)


def test_the_true_answers_are_those_of_the_row(driven: tuple[Plan, Recording]) -> None:
    plan, recording = driven
    request = next(event.t for event in recording.events if event.kind == "request")
    response = next(event.t for event in recording.events if event.kind == "response")
    assert true_answer("speed", plan, recording, 0.0) == 36.0
    assert true_answer("vehicles", plan, recording, 0.0) == 1  # neither the pedestrian nor the cone
    assert true_answer("control", plan, recording, request) == "automation"
    assert true_answer("control", plan, recording, response + 0.1) == "me"
    assert true_answer("blocked", plan, recording, request + 0.1) == "yes"


def test_numbers_are_right_within_their_tolerance() -> None:
    query = Query(name="speed", about="speed", text="How fast?", tolerance=10)
    assert [is_right(query, given, 36.0) for given in ("26", "46.0", "46.1", "25.9", "fast", "", "nan")] == [
        *(True, True, False, False, False, False, False)
    ]


def test_a_choice_is_right_where_it_is_true() -> None:
    query = Query(name="who", about="control", text="Who?")
    assert is_right(query, "me", "me")
    assert not is_right(query, "automation", "me")
