"""Runs in words."""

from __future__ import annotations

from dataclasses import replace

import pytest

from scenario_compiler.expressions import parse_expression
from scenario_compiler.report.run import Run
from scenario_compiler.report.wording import command, conditions, decimal, fixed, outcome_words, summary_of
from scenario_compiler.vocabulary.scenario import Parameter
from scenario_compiler.vocabulary.takeover import Cause


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (1.0, "1"),
        (2.504, "2.5"),
        (-1.25, "−1.25"),
        (120.0, "120"),
        (0.126, "0.13"),
        (0.0, "0"),
        (-0.0, "0"),
        (0.05, "0.05"),
        (-0.003461, "−0.0035"),
        (5.119e-05, "5.1e−05"),
    ],
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
        ({}, "driver took over, no collision"),
        ({"stands": "own_lane"}, "driver took over, stopped safely in its lane"),
        ({"stands": "shoulder"}, "driver took over, stopped safely on the shoulder"),
        ({"stands": "other_lane"}, "driver took over, stopped in another lane"),
        ({"stands": "across_edge"}, "driver took over, stopped across the edge of its lane"),
        (
            {"stands": "off_road", "resolution": "minimum_risk", "takeovers": ()},
            "minimum-risk manoeuvre, stopped off the road",
        ),
        ({"collision_with": "parked"}, "driver took over, collision with parked"),
        (
            {"resolution": "minimum_risk", "stop_reason": "duration"},
            "minimum-risk manoeuvre, then driver took over, no collision",
        ),
        ({"resolution": "no_request", "stop_reason": "destination"}, "no takeover request, destination reached"),
        ({"resolution": "unanswered", "result": "error"}, "request unanswered, run broke off"),
        ({"resolution": "open", "stop_reason": "duration"}, "request still open, no collision"),
    ],
)
def test_the_result_of_a_run(finished: Run, changes: dict[str, str], words: str) -> None:
    assert outcome_words(finished.outcome.model_copy(update=changes)) == words


def test_values_of_parameters_have_their_unit(finished: Run) -> None:
    plan = finished.plan.model_copy(update={"parameters": (Parameter(name="distance", type="length", default="90"),)})
    assert dict(conditions(replace(finished, plan=plan)))["$distance"] == "120 m"


def test_the_command_that_repeats_a_run(finished: Run) -> None:
    assert command(finished) == "scenario-compiler run plan.json --seed 1 -o again"


def test_the_command_that_repeats_a_run_has_the_chosen_options_of_its_world(finished: Run) -> None:
    chosen = {"ego": "kinematic", "camera": "built-in"}
    header = finished.recording.header.model_copy(update={"world": "carla", "choices": chosen})
    again = command(replace(finished, recording=replace(finished.recording, header=header)))
    assert "run plan.json --world carla --ego kinematic --camera built-in --seed 1" in again


def test_the_speed_at_the_start_is_the_recorded_one(finished: Run) -> None:
    plan = finished.plan
    still = plan.model_copy(update={"entities": (plan.entities[0].model_copy(update={"speed": 0.0}),)})
    assert dict(conditions(replace(finished, plan=still)))["Speed at the start"] == "13.9 m/s"


@pytest.mark.parametrize(("steps", "words"), [(1, "every step"), (2, "every second step"), (5, "every 5 steps")])
def test_how_often_the_vehicle_is_controlled(finished: Run, steps: int, words: str) -> None:
    run = replace(finished, plan=finished.plan.model_copy(update={"control_every": steps}))
    assert dict(conditions(run))["Step, control"].endswith(f" s, {words}")


def test_the_causes_have_their_own_numbers(finished: Run) -> None:
    causes = (
        Cause(kind="path_blocked", budget=6.0, warning_budget=parse_expression("$distance / 12"), margin=0.5),
        Cause(kind="sensor_health", warning_below=0.6, warning_over=0.7, count=5, of=8, minimum_risk_after=0.0),
    )
    takeover = finished.plan.takeover.model_copy(update={"causes": causes})
    assert dict(conditions(replace(finished, plan=finished.plan.model_copy(update={"takeover": takeover}))))[
        "Causes"
    ] == (
        "path blocked (time budget 6 s, warning budget 10 s, margin 0.5 m); sensor health (warning below 0.6, "
        "warning ends over 0.7, minimum-risk manoeuvre after 0 s, 5 of 8 control steps)"
    )
