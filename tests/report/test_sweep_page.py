"""A sweep's page says what its runs can have, and nothing of what they cannot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from scenario_compiler.report.run import Run
from scenario_compiler.report.sweep_page import SHOWN, Case, SweepPage, rates_of, write_sweep_report

ROWS: dict[str, Sequence[Any]] = {
    "variant": [0, 1, 2],
    "result": ["pass", "fail", "pass"],
    "resolution": ["no_request", "driver", "no_request"],
    "collision_time": [None, 3.0, None],
    "collision_with": [None, "parked", None],
    "avoided_by": [None, None, None],
    "error": [None, None, None],
    "parameter.gap": [1.0, 2.0, 3.0],
    **{name: [1.0, 0.5, 2.0] for name in SHOWN},
}


@pytest.mark.parametrize("automated", [True, False])
def test_requests_are_shown_of_automated_vehicles_alone(finished: Run, tmp_path: Path, automated: bool) -> None:
    plan = finished.plan if automated else finished.plan.model_copy(update={"controller": None})
    cases = [Case(1, {"gap": 2.0}, "scenario-compiler run", replace(finished, plan=plan))]
    page = SweepPage(
        "it", "It happens", ROWS, {"gap": "uniform(1, 3)"}, {"gap": "m/s2"}, [], cases, "scenario-compiler sweep"
    )
    text = write_sweep_report(page, tmp_path).read_text(encoding="utf-8")
    along = text.partition("Rates along each parameter")[2].partition("Distributions")[0]
    assert "Runs with a collision" in along
    assert ("takeover request" in along) == automated


def test_requests_that_are_open_at_the_end_are_left_out_of_those_that_were_answered(tmp_path: Path) -> None:
    rows = {**ROWS, "resolution": ["open", "driver", "unanswered"]}
    rates = {rate.name: (rate.hits, rate.count) for rate in rates_of(rows)}
    assert rates["takeover request"] == (3, 3)
    assert rates["request answered by the driver"] == (1, 2)
    assert rates["request ended in a minimum-risk manoeuvre"] == (0, 2)
    for shown, left_out in ((rows, True), (ROWS, False)):
        page = SweepPage("it", "", shown, {"gap": "uniform(1, 3)"}, {"gap": "m/s2"}, [], [], "scenario-compiler sweep")
        text = write_sweep_report(page, tmp_path).read_text(encoding="utf-8")
        assert ("1 still open when the run ended" in text) is left_out


def test_parameters_and_measures_have_their_units(tmp_path: Path) -> None:
    cases = [Case(1, {"gap": 2.0}, "scenario-compiler run")]
    page = SweepPage("it", "", ROWS, {"gap": "uniform(1, 3)"}, {"gap": "m/s2"}, [], cases, "scenario-compiler sweep")
    text = write_sweep_report(page, tmp_path).read_text(encoding="utf-8")
    assert '<td>gap</td><td class="unit">m/s²</td>' in text
    assert '<th class="n">gap (m/s²)</th>' in text
    drawn = text.partition("Rates along each parameter")[2]
    assert ">gap (m/s²)</text>" in drawn
    assert ">maximum lateral acceleration (m/s²)</text>" in drawn
    assert "m/s2" not in text
