"""True answers to the queries of a probe, from a row of a recording, and which answers are right."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenario_compiler.compiler import Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.recording.recording import Recording
from scenario_compiler.runtime import open_world, run
from scenario_compiler.source.study import Query
from scenario_compiler.study.situation import is_right, true_answer
from tests.study import made


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    folder: Path = tmp_path_factory.mktemp("situation")
    made.study(folder)
    overrides = Overrides(perception="ideal", driven_by="model")
    done = compile_target(folder / "conflicts.xml", {}, Diagnostics(), overrides=overrides)
    assert done is not None
    with open_world("kinematic", done.plan, done.network) as world:
        return run(done.plan, world)


def test_the_true_answers_are_those_of_the_row(recording: Recording) -> None:
    request = next(event.t for event in recording.events if event.kind == "request")
    response = next(event.t for event in recording.events if event.kind == "response")
    assert true_answer("speed", recording, 0.0) == 36.0
    assert true_answer("vehicles", recording, 0.0) == 1
    assert true_answer("control", recording, request) == "automation"
    assert true_answer("control", recording, response + 0.1) == "me"
    assert true_answer("blocked", recording, request + 0.1) == "yes"


def test_numbers_are_right_within_their_tolerance() -> None:
    query = Query(name="speed", about="speed", text="How fast?", tolerance=10)
    assert [is_right(query, given, 36.0) for given in ("26", "46.0", "46.1", "25.9", "fast", "", "nan")] == [
        *(True, True, False, False, False, False, False)
    ]


def test_a_choice_is_right_where_it_is_true() -> None:
    query = Query(name="who", about="control", text="Who?")
    assert is_right(query, "me", "me")
    assert not is_right(query, "automation", "me")
