"""Judging: criteria, timeline, and the outcome's file."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenario_compiler.expressions import parse_expression
from scenario_compiler.recording.names import EventKind
from scenario_compiler.recording.outcome import OutcomeError, judge, read_outcome, timeline, write_outcome
from scenario_compiler.vocabulary.criteria import MinimumTimeToCollision, ReachDestination, StayOnRoad
from tests.recording.made import Row, approach, plan_of, record

IDS = ("ego", "parked")


def test_a_run_without_incident_passes(tmp_path: Path) -> None:
    outcome = judge(plan_of(*IDS), record(IDS, 51, approach()))
    assert (outcome.result, outcome.resolution, outcome.cause) == ("pass", "no_request", "")
    assert [one.passed for one in outcome.criteria] == [True, True]
    write_outcome(outcome, tmp_path / "outcome.json")
    assert read_outcome(tmp_path / "outcome.json") == outcome


def test_a_collision_fails_and_says_with_whom_and_when() -> None:
    outcome = judge(plan_of(*IDS), record(IDS, 71, approach(), [(6.0, "collision", "parked")]))
    assert (outcome.result, outcome.collision_with) == ("fail", "parked")
    assert outcome.criteria[0].model_dump() == {
        "criterion": "no_collision",
        "passed": False,
        "when": 6.0,
        "where": {"road": "1", "lane": -1, "s": 60.0, "x": 60.0, "y": 0.0},
        "why": "collision with parked at 6.00 s",
    }


@pytest.mark.parametrize(("road", "lane"), [(-1, 0), (0, 0), (0, -3)])
def test_leaving_the_road_fails(road: int, lane: int) -> None:
    """The ego leaves every lane, or drives onto lane -3, which is a pavement."""

    def row(t: float) -> Row:
        on = t < 0.25
        return {"x": (t,), "road": (0 if on else road,), "lane": (-1 if on else lane,), "on_road": (on,)}

    outcome = judge(plan_of("ego", criteria=(StayOnRoad(),)), record(("ego",), 5, row))
    assert outcome.criteria[0].when == pytest.approx(0.3)


@pytest.mark.parametrize(("stop", "passed"), [("destination", True), ("duration", False)])
def test_reaching_the_destination(stop: str, passed: bool) -> None:
    plan = plan_of(*IDS, criteria=(ReachDestination(),))
    outcome = judge(plan, record(IDS, 5, approach(), stop=stop))
    assert outcome.criteria[0].passed is passed


@pytest.mark.parametrize(("least", "when"), [(0.9, None), (2.0, 4.1)])
def test_least_time_to_collision_may_be_a_parameter(least: float, when: float | None) -> None:
    plan = plan_of(*IDS, criteria=(MinimumTimeToCollision(at_least=parse_expression("$least")),))
    outcome = judge(plan, record(IDS, 51, approach(), parameters={"least": least}))
    assert outcome.criteria[0].when == pytest.approx(when) if when else outcome.criteria[0].passed


def test_a_run_that_broke_off_is_an_error() -> None:
    assert judge(plan_of(*IDS), record(IDS, 3, approach(), stop="error")).result == "error"


@pytest.mark.parametrize(
    ("after", "resolution"),
    [
        ([], "open"),
        ([(3.0, "response", "")], "driver"),
        ([(5.0, "escalation", "")], "unanswered"),
        ([(5.0, "escalation", ""), (5.1, "response", "")], "driver"),
        ([(3.0, "minimum_risk", ""), (4.0, "response", "")], "minimum_risk"),
        ([(3.0, "collision", "parked")], "unanswered"),
        ([(3.0, "collision", "parked"), (4.0, "minimum_risk", "")], "minimum_risk"),
    ],
)
def test_how_a_request_ends(after: list[tuple[float, EventKind, str]], resolution: str) -> None:
    before: list[tuple[float, EventKind, str]] = [(0.5, "collision", "parked")] if not after else []
    run = record(IDS, 51, approach(), [*before, (1.0, "request", "path_blocked"), *after])
    assert judge(plan_of(*IDS), run).resolution == resolution


def test_a_run_without_rows_has_an_outcome() -> None:
    outcome = judge(plan_of(*IDS), record(IDS, 0, approach(), stop="error"))
    assert (outcome.result, outcome.measures, outcome.timeline) == ("error", {}, ())


def test_the_timeline_has_a_state_for_each_stretch() -> None:
    events = [
        (0.0, "activation", ""),
        (0.5, "warning", "path_blocked"),
        (1.0, "request", "path_blocked"),
        (2.0, "merge", ""),
        (5.0, "escalation", ""),
        (6.0, "response", ""),
    ]
    run = record(IDS, 71, approach(), events)
    found = [(one.state, one.begin, one.end) for one in timeline(run)]
    assert found == [
        ("automated", 0.0, 0.5),
        ("warning", 0.5, 1.0),
        ("request", 1.0, 5.0),
        ("escalation", 5.0, 6.0),
        ("manual", 6.0, pytest.approx(7.0)),
    ]
    assert judge(plan_of(*IDS), run).resolution == "driver"


def test_a_collision_ends_the_takeover_in_the_timeline() -> None:
    """The vehicle stands after the collision; before, the request went on until the end of the run."""
    events = [(1.0, "request", "path_blocked"), (3.0, "collision", "parked"), (4.0, "standstill", "")]
    found = [(one.state, one.begin, one.end) for one in timeline(record(IDS, 71, approach(), events))]
    assert found == [("automated", 0.0, 1.0), ("request", 1.0, 3.0), ("collision", 3.0, pytest.approx(7.0))]


def test_of_several_states_at_one_instant_the_last_one_counts() -> None:
    run = record(IDS, 21, approach(), [(0.0, "warning", ""), (0.0, "request", ""), (1.0, "minimum_risk", "")])
    assert [one.state for one in timeline(run)] == ["request", "minimum_risk"]
    assert judge(plan_of(*IDS), run).resolution == "minimum_risk"


def test_an_undefined_measure_is_null_and_says_why(tmp_path: Path) -> None:
    write_outcome(judge(plan_of(*IDS), record(IDS, 51, approach())), tmp_path / "o.json")
    measure = read_outcome(tmp_path / "o.json").measures["takeover_time"]
    assert measure.value is None
    assert measure.undefined == "there was no request, or no response to it"
    assert "null" in (tmp_path / "o.json").read_text(encoding="utf-8")


@pytest.mark.parametrize("text", ["", "{", "{}", "[1]", '{"format": "other"}'])
def test_a_file_that_is_not_an_outcome_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / "o.json").write_text(text, encoding="utf-8")
    with pytest.raises(OutcomeError, match="not an outcome") as refused:
        read_outcome(tmp_path / "o.json")
    assert "\n" not in str(refused.value)
    assert "pydantic" not in str(refused.value)
