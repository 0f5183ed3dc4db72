"""OpenSCENARIO files run as in esmini, and the page's statements on the standard's features have evidence."""

from __future__ import annotations

import csv
import gzip
from pathlib import Path

import pytest

from scenario_compiler.compiler import Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.engine.columns.state import make_draws
from scenario_compiler.engine.program import build_program
from scenario_compiler.engine.simulation import Simulation
from tests.conformance.esmini import (
    FEATURES,
    STEP,
    Comparison,
    RecordedRun,
    compare,
    map_folders,
    recorded,
    recorded_runs,
    simulated,
)
from tests.conformance.explained import DECISIONS, EXPLAINED
from tests.conformance.matrix import backings, laws_stated
from tests.conformance.page import matrix_lines
from tests.conformance.variants import VARIANTS

FINER = 0.01
"""Length of the steps of the second recording of the features, s."""

Compared = list[tuple[RecordedRun, Comparison]]


@pytest.fixture(scope="module")
def compared(golden: Path) -> Compared:
    """Every recorded run, and how ours compares with it."""
    runs = recorded_runs(golden.parent / "corpus")
    return [(run, compare(run.name, simulated(run.scenario, run.maps), recorded(run.rows))) for run in runs]


def test_recorded_runs_agree_or_the_difference_is_explained(compared: Compared) -> None:
    differing = {run.name for run, one in compared if not one.agrees}
    assert differing == set(EXPLAINED), "\n".join(str(one) for _, one in compared if not one.agrees)


def test_curves_are_followed_as_in_esmini(compared: Compared) -> None:
    """The roads of these runs have curves whose parameter is not their arc length."""
    apart = {run.name: one.position.size for run, one in compared}
    for name in ("highway_merge", "lane_change", "cut-in", "cut-in_parameter_set"):
        assert apart[f"esmini/resources/xosc/{name}.xosc"] < 2e-3


@pytest.mark.parametrize("every", [3, pytest.param(1, marks=pytest.mark.slow)])
def test_features_agree_at_a_finer_step(compared: Compared, every: int) -> None:
    """The laws were found at steps of 0.05 s; the same scenarios were recorded at 0.01 s."""
    features = [run for run, at_usual_step in compared if run.of_a_feature and at_usual_step.agrees]
    for run in features[::every]:
        rows = run.rows.parent.with_name("golden_dt010") / run.rows.name
        finer = compare(run.name, simulated(run.scenario, run.maps, FINER), recorded(rows, FINER))
        assert finer.agrees, str(finer)


def test_the_table_of_variants_is_fresh(compared: Compared, repository: Path) -> None:
    page = (repository / "docs" / "conformance.md").read_text(encoding="utf-8")
    assert "\n".join(matrix_lines(backings(compared))) in page, "python -m tests.conformance.page"


def test_decisions_and_laws_refer_to_existing_variants() -> None:
    known = {(one.feature, one.name) for one in VARIANTS}
    assert len(known) == len(VARIANTS)
    assert set(DECISIONS) <= known
    assert set(laws_stated()) <= known


def test_an_init_in_another_order_than_its_dependencies_gives_the_recorded_start(golden: Path) -> None:
    """One of the cars has a controller of esmini's own later; the rows of t = 0 are those of the init alone."""
    corpus = golden.parent / "corpus"
    scenario = corpus / "esmini" / "EnvironmentSimulator" / "Unittest" / "xosc" / "init_actions_reorder.xosc"
    ours = simulated(scenario, map_folders(corpus))
    theirs = recorded(golden / "esmini" / "ut__init_actions_reorder.csv.gz")[0]
    assert not isinstance(ours, str)
    for name in ("car0", "car1", "car2"):
        assert ours[0][name] == pytest.approx(theirs[name], abs=1e-3)


def test_a_run_on_a_road_file_with_an_offset_agrees(golden: Path) -> None:
    folder = golden / FEATURES
    sink = Diagnostics()
    overrides = Overrides(perception="ideal", step=STEP)
    done = compile_target(folder / "header_offset_world.xosc", {}, sink, overrides=overrides)
    assert done is not None
    numbers = {entity.id: i for i, entity in enumerate(done.plan.entities)}
    simulation = Simulation(done.network.tables, build_program(done.plan, done.network))
    simulation.reset(make_draws(1, 0))
    with gzip.open(folder / "golden" / "header_offset_world.csv.gz", "rt", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            st = simulation.state
            while st.clock[0] < float(row["t"]) - 0.5 * STEP:
                simulation.step()
            i = numbers[row["name"]]
            assert done.network.road_ids[st.road[i]] == row["road"]
            assert st.lane[i] == int(row["lane"])
            assert (st.s[i], st.off[i]) == pytest.approx((float(row["s"]), float(row["off"])), abs=1e-3)
