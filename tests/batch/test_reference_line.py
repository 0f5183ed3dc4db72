"""Reference drivers for comparison: a criterion, a column of a sweep and a curve in its report."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scenario_compiler.batch.codebook import PARAMETER
from scenario_compiler.batch.execute import prepare, run_sweep
from scenario_compiler.batch.finished import read_results
from scenario_compiler.batch.runner import record
from scenario_compiler.batch.spec import SweepSpec
from scenario_compiler.batch.variants import with_values
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.recording.outcome import judge

CUT_IN = """<scenarios version="1">
  <scenario name="cut_in" map="highway_loop" duration="12" step="0.05" control_every="2">
    <parameter name="gap" type="length" default="40"/>
    <ego speed="33"><start><spawn_point name="straight"/></start></ego>
    <dynamic id="car" model="vehicle.tesla.model3" speed="20">
      <start><ahead_of entity="ego" distance="$gap" lanes="1"/></start>
      <when><time after="0.2"/><do><lane_change by="-1" over_time="3"/></do></when>
    </dynamic>
    <takeover><cause kind="controller"/><driver preset="absent"/></takeover>
    <criteria>
      <no_avoidable_collision by="careful_and_competent"/>
      <no_avoidable_collision by="fuzzy_safety_model"/>
      <no_collision/>
    </criteria>
  </scenario>
</scenarios>
"""


@pytest.fixture
def conflict(tmp_path: Path) -> Path:
    path = tmp_path / "cut_in.xml"
    path.write_text(CUT_IN, encoding="utf-8")
    return path


@pytest.mark.parametrize("interpreted", [False, True])
def test_a_collision_fails_if_the_reference_driver_has_none(conflict: Path, tmp_path: Path, interpreted: bool) -> None:
    count = 4 if interpreted else 12
    spec = SweepSpec(vary=(f"gap=grid(8, 60, {count})",), method="grid", perception="ideal", interpreted=interpreted)
    run_sweep(conflict, spec, tmp_path / "sweep", workers=1, report=not interpreted)
    rows, _ = read_results(tmp_path / "sweep")
    sweep = prepare(conflict, spec, Diagnostics())
    for index in range(count):
        avoided = rows["avoided_by"][index].split()
        hit = rows["collision_time"][index] is not None
        failed = rows["failed"][index].split()
        assert failed.count("no_avoidable_collision") == (len(avoided) if hit else 0)
        variant = sweep.variant(index, sweep.sampler.sample(index))
        family = sweep.families.base
        recording = record(family.plan, family.network, variant)
        outcome = judge(with_values(family.plan, variant.values), recording)
        assert [one.criterion for one in outcome.criteria if not one.passed] == failed
        assert [name for name, avoids in recording.header.avoided.items() if avoids] == avoided
    assert len(set(rows["avoided_by"])) > 1
    if not interpreted:
        fsm = [gap for gap, row in zip(rows[PARAMETER + "gap"], rows["avoided_by"], strict=True) if "fuzzy" in row]
        careful = [gap for gap, row in zip(rows[PARAMETER + "gap"], rows["avoided_by"], strict=True) if "care" in row]
        assert np.min(fsm) <= np.min(careful)
        assert "collision, careful and competent in its place" in (tmp_path / "sweep" / "report.html").read_text(
            encoding="utf-8"
        )
