"""takeovers.parquet has every takeover of every variant, as in the outcome of its run."""

from __future__ import annotations

import csv
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from scenario_compiler.batch.execute import prepare, run_sweep
from scenario_compiler.batch.finished import read_results
from scenario_compiler.batch.runner import record
from scenario_compiler.batch.spec import SweepSpec
from scenario_compiler.batch.variants import with_values
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.recording.outcome import judge

CONFLICT = """<scenarios version="1">
  <scenario name="twice" map="highway_loop" duration="40" step="0.05" control_every="2">
    <parameter name="speed" type="speed" default="25" min="1"/>
    <ego speed="$speed"><start><lane road="1" lane="-2" s="20"/></start></ego>
    <markings road="1" from="60" to="130" quality="0"/>
    <markings road="1" from="330" to="400" quality="0"/>
    <takeover hand_back_after="1" minimum_risk_after="10"><cause kind="lane_confidence"/><driver/></takeover>
    <criteria><no_collision/></criteria>
  </scenario>
</scenarios>
"""


@pytest.fixture
def conflict(tmp_path: Path) -> Path:
    """File of a conflict in which the paint is gone twice, and control is handed back between."""
    path = tmp_path / "twice.xml"
    path.write_text(CONFLICT, encoding="utf-8")
    return path


@pytest.mark.parametrize("interpreted", [True, False])
def test_every_takeover_of_a_run_has_a_row(conflict: Path, tmp_path: Path, interpreted: bool) -> None:
    spec = SweepSpec(vary=("speed=uniform(15, 25)",), samples=4, perception="ideal", interpreted=interpreted)
    run_sweep(conflict, spec, tmp_path / "sweep", workers=1, report=False)
    found = pq.read_table(tmp_path / "sweep" / "takeovers.parquet").to_pylist()
    rows, _ = read_results(tmp_path / "sweep")
    sweep = prepare(conflict, spec, Diagnostics())
    expected = []
    for index in range(4):
        variant = sweep.variant(index, sweep.sampler.sample(index))
        family = sweep.families.base
        outcome = judge(with_values(family.plan, variant.values), record(family.plan, family.network, variant))
        expected += [{"variant": index, **one.model_dump()} for one in outcome.takeovers]
        first = outcome.takeovers[0]
        assert rows["requests"][index] == len(outcome.takeovers)
        assert (rows["cause"][index], rows["resolution"][index]) == (first.cause, first.resolution)
        for name in ("request_time", "response_time", "takeover_time", "time_budget"):
            assert rows[name][index] == getattr(first, name), name
    assert found == expected
    assert max(rows["requests"]) >= 2
    again = [one for one in found if one["number"] == 2]
    assert all(one["request_time"] > 5.0 and one["cause"] == "lane_confidence" for one in again)
    assert any(one["hand_back_time"] for one in found)


def test_its_columns_are_in_the_codebook(conflict: Path, tmp_path: Path) -> None:
    spec = SweepSpec(vary=("speed=values(0.5, 25)",), perception="ideal", where=("speed > 0",), duration=1.0)
    run_sweep(conflict, spec, tmp_path / "sweep", workers=1, report=False)
    table = pq.read_table(tmp_path / "sweep" / "takeovers.parquet")
    with (tmp_path / "sweep" / "codebook.csv").open(newline="") as file:
        book = {row["column"]: row for row in csv.DictReader(file) if row["table"] == "takeovers.parquet"}
    assert list(book) == table.column_names
    assert {name: book[name]["unit"] for name in ("speed", "takeover_time", "limit_distance", "cause", "number")} == {
        "speed": "m/s", "takeover_time": "s", "limit_distance": "m", "cause": "", "number": "",
    }  # fmt: skip
    assert table.num_rows == 0
