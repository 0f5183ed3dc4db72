"""Runs in words."""

from __future__ import annotations

import pytest

from scenario_compiler.report.run import Run
from scenario_compiler.report.wording import command, decimal, fixed, outcome_words, summary_of


@pytest.mark.parametrize(
    ("value", "text"), [(1.0, "1"), (2.504, "2.5"), (-0.001, "0"), (-1.25, "−1.25"), (120.0, "120"), (0.126, "0.13")]
)
def test_numbers(value: float, text: str) -> None:
    assert decimal(value) == text


def test_columns_of_numbers() -> None:
    assert [fixed(value) for value in (4.0, -0.001, -1.5)] == ["4.00", "0.00", "−1.50"]


def test_a_run_in_one_row(finished: Run) -> None:
    row = summary_of(finished)
    assert (row.name, row.number, row.urgency, row.cause) == ("obstacle_ahead", "9", "3", "path blocked")
    assert (row.request_time, row.takeover_time, row.result) == ("4.00", "2.40", "pass")


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({}, "driver took over, stopped safely"),
        ({"collision_with": "parked"}, "driver took over, collision with parked"),
        ({"resolution": "minimum_risk", "stop_reason": "duration"}, "minimum-risk manoeuvre, no collision"),
        ({"resolution": "no_request", "stop_reason": "destination"}, "no takeover request, destination reached"),
        ({"resolution": "unanswered", "result": "error"}, "request unanswered, run broke off"),
    ],
)
def test_what_came_of_a_run(finished: Run, changes: dict[str, str], words: str) -> None:
    assert outcome_words(finished.outcome.model_copy(update=changes)) == words


def test_the_command_that_repeats_a_run(finished: Run) -> None:
    assert command(finished) == "scenario-compiler run plan.json --seed 1 -o again"
