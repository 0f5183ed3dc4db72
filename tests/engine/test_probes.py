"""Scripted motion and the storyboard against trajectories recorded from esmini 3.6, one action for each entity."""

from __future__ import annotations

import csv
import gzip
from pathlib import Path

import pytest

from scenario_compiler.compiler import Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.engine.columns.opcodes import STOP_TRIGGER
from scenario_compiler.engine.columns.state import State, make_draws, new_state
from scenario_compiler.engine.program import build_program
from scenario_compiler.engine.story.step import reset, step


@pytest.mark.parametrize(("file", "dt"), [("dt050.csv.gz", 0.05), ("dt010.csv.gz", 0.01)])
def test_the_probes_are_reproduced_to_the_last_printed_digit(golden: Path, file: str, dt: float) -> None:
    sink = Diagnostics()
    overrides = Overrides(perception="ideal", step=dt, duration=60.0)
    done = compile_target(golden / "esmini_probes" / "probes.xosc", {}, sink, overrides=overrides)
    assert done is not None, list(sink)
    names = [entity.id for entity in done.plan.entities]
    program, n = build_program(done.plan, done.network), done.network.tables
    state = new_state(program)
    state.draw[:] = make_draws(1, 0)
    with gzip.open(golden / "esmini_probes" / file, "rt", encoding="utf-8") as text:
        rows = list(csv.DictReader(text))
    reset(n, program, state)
    worst: dict[str, float] = {}
    for first in range(0, len(rows), len(names)):
        if first:
            assert step(n, program, state) == 1, f"stopped before row {first // len(names)}"
        for row in rows[first : first + len(names)]:
            name = row["name"]
            worst[name] = max(worst.get(name, 0.0), deviation(row, state, names.index(name)))
    assert step(n, program, state) == 0
    assert state.stop[0] == STOP_TRIGGER
    assert {name: size for name, size in worst.items() if size > 1.0} == {}
    assert len(worst) == 35


def deviation(row: dict[str, str], st: State, i: int) -> float:
    """Return the largest difference of a row, in units of twice the last printed digit.

    A point on the border of two lanes (half of 3.5 m from either centre) may be reported in either.
    """
    off = float(row["off"])
    border = abs(abs(off) - 1.75) < 0.0005 and abs(abs(st.off[i]) - 1.75) < 0.0005
    return max(
        abs(st.x[i] - float(row["x"])) / 0.002,
        abs(st.y[i] - float(row["y"])) / 0.002,
        abs((st.h[i] - float(row["h"]) + 3.0) % 6.283185307179586 - 3.0) / 0.00002,
        abs(st.v[i] - float(row["v"])) / 0.0002,
        0.0 if border else 2.0 * abs(st.lane[i] - int(row["lane"])),
        abs(st.s[i] - float(row["s"])) / 0.002,
        0.0 if border else abs(st.off[i] - off) / 0.0002,
    )
