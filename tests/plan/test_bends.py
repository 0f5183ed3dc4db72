"""The warning of an ego that is too fast for its bend agrees with the runs: it comes if the tyres do not hold."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from scenario_compiler.compiler import Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.runtime.loop import open_world, run

BENT = Path(__file__).parent.parent / "engine" / "laws" / "bend.xodr"
"""A left bend with a radius of 50 m, 51.75 m in the middle of lane -1: tyres hold up to 20.7 m/s."""

CONFLICT = """<scenarios version="1">
<scenario name="bend" map="{road_file}" duration="2">
<ego speed="{speed}"><start><lane road="{road}" lane="-1" s="{s}"/></start></ego>
</scenario></scenarios>"""


def warned_and_left(folder: Path, **values: object) -> tuple[bool, float]:
    """Return whether the ego is reported as too fast, and its greatest distance from the middle of its lane, m."""
    file = folder / "bend.xml"
    file.write_text(CONFLICT.format(**values), encoding="utf-8")
    sink = Diagnostics()
    found = compile_target(str(file), {}, sink, overrides=Overrides(perception="ideal"))
    assert found is not None
    with open_world("kinematic", found.plan, found.network) as world:
        recording = run(found.plan, world)
    left = np.where(recording.lane[:, 0] == -1, np.abs(recording.off[:, 0]), math.inf)
    return "SC535" in [one.code.id for one in sink], float(left.max())


@pytest.mark.parametrize(("speed", "too_fast"), [(12.0, False), (18.0, False), (22.0, True), (30.0, True)])
def test_an_ego_that_starts_in_a_bend_too_fast_is_reported(tmp_path: Path, speed: float, too_fast: bool) -> None:
    warned, left = warned_and_left(tmp_path, road_file=BENT, road="1", s=20, speed=speed)
    assert warned is too_fast
    assert (left > 0.5) is too_fast


@pytest.mark.parametrize(("s", "too_fast"), [(125.0, True), (60.0, False)])
def test_full_braking_before_a_bend_counts(tmp_path: Path, s: float, too_fast: bool) -> None:
    """Road 10 of town_grid bends with a radius of 30 m behind a clothoid from s = 132 m on."""
    warned, left = warned_and_left(tmp_path, road_file="town_grid", road="10", s=s, speed=25.0)
    assert warned is too_fast
    assert (left > 0.5) is too_fast
