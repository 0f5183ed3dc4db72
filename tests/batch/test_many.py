"""Many seeds from Python: a table that agrees with single runs, and its progress."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest
from playwright.sync_api import Browser, expect

from scenario_compiler import Overrides, Report, Run, compile_scenario, judge, open_world, run, run_many
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.plan.maps import open_plan_map
from scenario_compiler.plan.model import Plan
from scenario_compiler.recording.store import read_recording, write_recording
from scenario_compiler.roads import Network
from tests.browser import opened_page
from tests.test_cli import CONFLICT


@pytest.fixture(scope="module")
def plan(tmp_path_factory: pytest.TempPathFactory) -> Plan:
    file = tmp_path_factory.mktemp("many") / "it.xml"
    file.write_text(CONFLICT, encoding="utf-8")
    return compile_scenario(file, overrides=Overrides(perception="ideal"))


@pytest.fixture(scope="module")
def network(plan: Plan) -> Network:
    found = open_plan_map(plan, Diagnostics(), [], Path())
    assert found is not None
    return found


def test_a_table_agrees_with_single_runs(plan: Plan, network: Network) -> None:
    done: list[tuple[int, int]] = []
    table = run_many(plan, [3, 1], progress=lambda count, of: done.append((count, of)))
    assert done == [(1, 2), (2, 2)]
    assert table.columns["seed"] == [3, 1]
    with open_world("kinematic", plan, network) as world:
        outcome = judge(plan, run(plan, world, seed=3))
    assert table.columns["trajectory_hash"][0] == outcome.trajectory_hash
    for name, measure in outcome.measures.items():
        assert table.columns[name][0] == measure.value
        assert table.units[name] == measure.unit
    frame = table.to_pandas()
    assert list(frame["result"]) == table.columns["result"]
    assert repr(table).startswith("<Runs: 2 runs, ")
    html = table._repr_html_()
    assert html.count("<tr>") == 3


def test_a_recording_gives_pandas_the_same_table_as_its_file(plan: Plan, network: Network, tmp_path: Path) -> None:
    with open_world("kinematic", plan, network) as world:
        recording = run(plan, world)
    write_recording(recording, tmp_path / "recording.parquet")
    kept = pd.read_parquet(tmp_path / "recording.parquet")
    frame = recording.to_pandas()
    assert list(frame.columns) == list(kept.columns)
    for name in frame.columns:
        known, shown = kept[name].astype(object), frame[name].astype(object)
        both = known.where(known.notna(), None) == shown.where(shown.notna(), None)
        assert (both | (known.isna() & shown.isna())).all(), name
    assert read_recording(tmp_path / "recording.parquet").to_pandas().equals(frame)


def test_a_report_plays_in_a_notebook(plan: Plan, network: Network, tmp_path: Path, browser: Browser) -> None:
    with open_world("kinematic", plan, network) as world:
        recording = run(plan, world)
    finished = Run(plan, network, recording, judge(plan, recording))
    size = f"{len(recording.t)} rows, entities: {len(plan.entities)}"
    assert repr(recording) == f"<Recording of {plan.name}, seed 1; {size}; see to_pandas()>"
    assert repr(finished) == f"<Run of {plan.name}, seed 1: {finished.outcome.result}; Report([run]) shows it>"
    shown = Report([finished])._repr_html_()
    notebook = tmp_path / "notebook.html"
    notebook.write_text(
        f"<!DOCTYPE html><html><head><meta charset='utf-8'></head><body>{shown}</body></html>", encoding="utf-8"
    )
    with opened_page(browser, notebook.as_uri()) as page:
        frame = page.frame_locator("iframe")
        frame.locator(".player.ready").wait_for()
        frame.get_by_role("button", name="A step on").click()
        expect(frame.locator(".clock")).to_have_text("0.05 s")
