"""A sweep's page shows what its runs can have, and leaves out what they cannot have."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenario_compiler.report.run import Run
from scenario_compiler.report.sweep_page import SHOWN, Case, SweepPage, rates_of, write_sweep_report
from scenario_compiler.report.sweep_plots import ROUNDING, evenly_chosen, levelled

ROWS: dict[str, Sequence[Any]] = {
    "variant": [0, 1, 2],
    "result": ["pass", "fail", "pass"],
    "resolution": ["no_request", "driver", "no_request"],
    "collision_time": [None, 3.0, None],
    "collision_with": [None, "parked", None],
    "avoided_by": [None, None, None],
    "error": [None, None, None],
    "parameter.gap": [1.0, 2.0, 3.0],
    **{name: [None] * 3 for name in SHOWN},
    "takeover_time": [1.0, 0.5, 2.0],
    "minimum_time_to_collision": [1.0, 0.5, 2.0],
}
"""Three runs with two of the measures: a page draws each one that some run has."""


@pytest.mark.parametrize("automated", [True, False])
def test_requests_are_shown_for_automated_vehicles_only(finished: Run, tmp_path: Path, automated: bool) -> None:
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
    rows = {**ROWS, "resolution": ["open", "driver", "unanswered"], "takeover_time": [None, 2.0, None]}
    rates = {rate.name: (rate.hits, rate.count) for rate in rates_of(rows)}
    assert rates["takeover request"] == (3, 3)
    assert rates["request answered by the driver"] == (1, 2)
    assert rates["minimum-risk manoeuvre before an answer"] == (0, 2)
    for shown, left_out in ((rows, True), (ROWS, False)):
        page = SweepPage("it", "", shown, {"gap": "uniform(1, 3)"}, {"gap": "m/s2"}, [], [], "scenario-compiler sweep")
        text = write_sweep_report(page, tmp_path).read_text(encoding="utf-8")
        assert ("1 still open when the run ended" in text) is left_out


def test_an_answer_during_the_minimum_risk_manoeuvre_is_an_answer_and_a_stop_is_no_request() -> None:
    rows = {**ROWS, "resolution": ["minimum_risk", "minimum_risk", "stopped"], "takeover_time": [1.5, None, None]}
    rates = {rate.name: (rate.hits, rate.count) for rate in rates_of(rows)}
    assert rates["takeover request"] == (2, 3)
    assert rates["request answered by the driver"] == (1, 2)
    assert rates["minimum-risk manoeuvre before an answer"] == (2, 2)


def test_a_rate_of_no_runs_is_not_shown_as_zero(tmp_path: Path) -> None:
    page = SweepPage(
        "it",
        "",
        {**ROWS, "resolution": ["no_request"] * 3},
        {"gap": "uniform(1, 3)"},
        {},
        [],
        [],
        "scenario-compiler sweep",
    )
    text = write_sweep_report(page, tmp_path).read_text(encoding="utf-8")
    row = text.partition("Request answered by the driver")[2].partition("</tr>")[0]
    assert re.findall(r">([^<]+)</td>", row) == ["0", "0", "–", "–"]


def page_of(rows: Mapping[str, Sequence[Any]], *parameters: str, cases: Sequence[Case] = ()) -> SweepPage:
    return SweepPage("it", "", rows, dict.fromkeys(parameters, "values(...)"), {}, [], cases, "scenario-compiler sweep")


def rows_of(count: int, **columns: Sequence[Any]) -> dict[str, Sequence[Any]]:
    """Return the rows of runs that passed, with these columns in place of others."""
    rows: dict[str, Sequence[Any]] = {name: [value[0]] * count for name, value in ROWS.items() if "." not in name}
    rows |= {name: [None] * count for name in SHOWN if name != "takeover_time"}
    return {
        **rows,
        "variant": list(range(count)),
        **{name.replace("__", "."): values for name, values in columns.items()},
    }


def test_a_parameter_of_integers_is_an_axis(tmp_path: Path) -> None:
    rows = rows_of(12, parameter__boxes=list(range(12)), minimum_time_to_collision=[1.0 + k for k in range(12)])
    text = write_sweep_report(page_of(rows, "boxes"), tmp_path).read_text(encoding="utf-8")
    assert "Runs by boxes; crosses are runs with a collision." in text
    assert "Runs with a collision and with a takeover request, along boxes." in text
    assert "shown as conditions" not in text


def test_conditions_of_integers_are_in_the_order_of_numbers(tmp_path: Path) -> None:
    rows = rows_of(12, parameter__boxes=[10, 2, 1] * 4, minimum_time_to_collision=[1.0 + k for k in range(12)])
    text = write_sweep_report(page_of(rows, "boxes"), tmp_path).read_text(encoding="utf-8")
    assert re.findall(r">(\d+|n = 4)</text>", text)[:6] == ["1", "n = 4", "2", "n = 4", "10", "n = 4"]


NEIGHBOURS = [0.1 + 0.2, 0.3, math.nextafter(0.3, 0.0), 0.3]


@pytest.mark.parametrize(
    ("gap", "times"),
    [
        (NEIGHBOURS, NEIGHBOURS),
        pytest.param([*NEIGHBOURS[:3], 8.0], [None, None, None, 0.3], marks=pytest.mark.slow),
        pytest.param([1e15 + 0.125, 1e15, 1e15, 2.0], [None] * 4, marks=pytest.mark.slow),
        ([0.0, 5e-324, 0.0, 1.0], [0.0, 1e-320, 2.0, 3.0]),
    ],
)
def test_values_that_differ_by_rounding_are_drawn(tmp_path: Path, gap: list[float], times: list[float | None]) -> None:
    rows = rows_of(4, parameter__gap=gap, parameter__other=[1.0, 2.0, 3.0, 3.0], minimum_time_to_collision=times)
    text = write_sweep_report(page_of(rows, "gap", "other"), tmp_path).read_text(encoding="utf-8")
    assert ("gap has one value in all runs" in text) == (gap == NEIGHBOURS)
    assert ("No run has a minimum time to collision" in text) == (times == [None] * 4)


@given(st.lists(st.floats(-1e6, 1e6) | st.just(math.nan), max_size=30))
def test_levelling_changes_values_only_by_rounding(values: list[float]) -> None:
    before = np.array(values, dtype=np.float64)
    after = levelled(before)
    assert (np.isnan(after) == np.isnan(before)).all()
    known = ~np.isnan(before)
    assert np.allclose(after[known], before[known], rtol=30 * ROUNDING, atol=0.0)
    rising = np.argsort(before[known], kind="stable")
    assert (np.diff(after[known][rising]) >= 0.0).all()
    edges = np.unique(after[known])
    assert (np.diff(edges) > 0.5 * ROUNDING * np.abs(edges[1:])).all()
    assert levelled(after).tobytes() == after.tobytes()


def test_conditions_are_compared_and_numbers_scattered(tmp_path: Path) -> None:
    gap = [float(k) for k in range(12)]
    rows = rows_of(
        12, parameter__gap=gap, parameter__preset=["slow", "fast"] * 6, parameter__lanes=[2222.0, 11111.0, 3333.0] * 4
    )
    text = write_sweep_report(page_of(rows, "gap", "preset", "lanes"), tmp_path).read_text(encoding="utf-8")
    boxes = text.partition("By condition")[2].partition("Measures over each parameter")[0]
    assert "Measures by preset" in boxes
    assert "Measures by lanes" in boxes
    assert "Measures by gap" not in boxes
    assert boxes.index(">2222</text>") < boxes.index(">3333</text>") < boxes.index(">11111</text>")
    scatter = text.partition("Measures over each parameter")[2].partition("Rates along")[0]
    assert "Runs by gap" in scatter
    assert "preset" not in scatter


def test_conditions_with_long_names_are_numbered(tmp_path: Path) -> None:
    texts = [f"heavy rain and gusts of wind with the sun low ahead, and worn markings, number {k}" for k in (7, 8)]
    rows = rows_of(12, parameter__weather=texts * 6, parameter__view=["rain at night", "noon"] * 6)
    text = write_sweep_report(page_of(rows, "weather", "view"), tmp_path).read_text(encoding="utf-8")
    assert f"1: <code>{texts[0]}</code>; 2: <code>{texts[1]}</code>." in text
    assert "rain at night</text>" in text


def test_omissions_are_stated(tmp_path: Path) -> None:
    count = 1200
    names = [f"p{k}" for k in range(6)]
    many = {f"parameter__{name}": [float(j + k) for j in range(count)] for k, name in enumerate(names)}
    models = [f"m{k % 11}" for k in range(count)]
    results = ["error"] * 2 + ["pass"] * (count - 2)
    rows = rows_of(count, **many, parameter__model=models, result=results, error=["no"] * 2 + [None] * (count - 2))
    cases = [Case(5, dict.fromkeys([*names, "model"], 1.0), "scenario-compiler run")]
    page = page_of(rows, *names, "model", cases=cases)
    left_out = write_sweep_report(page, tmp_path).read_text(encoding="utf-8").partition("Not shown")[2]
    for sentence in (
        "2 of 1200 variants broke off and are in no picture",
        "at most 1000 of the 1198 runs without a collision",
        "Without scatter: p4, p5",
        "6 of 15 pairs",
        "model has 11 values; up to 8 are shown as conditions",
        "1 of 1198 runs. Collisions first",
    ):
        assert sentence in left_out


@pytest.mark.parametrize(("there", "count"), [((), 0), ((1201,), 1), (range(0, 2000, 2), 1000), (range(2000), 1000)])
def test_a_scatter_shows_rare_runs_and_thins_out_frequent_ones(there: Sequence[int], count: int) -> None:
    chosen = evenly_chosen(np.isin(np.arange(2000), there))
    assert len(set(chosen.tolist())) == count
    assert set(chosen.tolist()) <= set(there)


def test_a_case_has_its_values_under_their_names(tmp_path: Path) -> None:
    rows = rows_of(3, parameter__speed=[7.5, 8.5, 9.5], parameter__gap=[31.0, 32.0, 33.0])
    cases = [Case(1, {"speed": 8.5, "gap": 32.0}, "scenario-compiler run")]
    text = write_sweep_report(page_of(rows, "gap", "speed", cases=cases), tmp_path).read_text(encoding="utf-8")
    table = text.partition("The worst cases")[2].partition("</table>")[0]
    assert table.index(">gap<") < table.index(">speed<")
    assert table.index(">32<") < table.index(">8.5<")


def test_measures_of_cases_have_equally_many_decimals(tmp_path: Path) -> None:
    rows = rows_of(3, takeover_time=[2.0, 8.2, 0.25])
    cases = [Case(k, {}, "scenario-compiler run") for k in range(3)]
    text = write_sweep_report(page_of(rows, cases=cases), tmp_path).read_text(encoding="utf-8")
    table = text.partition("The worst cases")[2].partition("</table>")[0]
    assert [value in table for value in (">2.00<", ">8.20<", ">0.25<")] == [True] * 3


def test_parameters_and_measures_have_their_units(tmp_path: Path) -> None:
    cases = [Case(1, {"gap": 2.0}, "scenario-compiler run")]
    rows = {**ROWS, **{name: [1.0, 0.5, 2.0] for name in SHOWN}}
    page = SweepPage("it", "", rows, {"gap": "uniform(1, 3)"}, {"gap": "m/s2"}, [], cases, "scenario-compiler sweep")
    text = write_sweep_report(page, tmp_path).read_text(encoding="utf-8")
    assert '<td>gap</td><td class="unit">m/s²</td>' in text
    assert '<th class="n">gap (m/s²)</th>' in text
    drawn = text.partition("Rates along each parameter")[2]
    assert ">gap (m/s²)</text>" in drawn
    assert ">maximum lateral acceleration (m/s²)</text>" in drawn
    assert "m/s2" not in text
