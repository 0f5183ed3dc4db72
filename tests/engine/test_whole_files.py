"""Whole scenarios run interpreted and compiled: every row of every entity and the summary have the same bytes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import pytest

from scenario_compiler.compiler import Compilation, Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.state import make_draws
from scenario_compiler.engine.columns.totals import SUMMARY
from scenario_compiler.engine.program import Program, build_program
from scenario_compiler.listing import list_library
from scenario_compiler.resources import library_folder
from tests.conformance.esmini import recorded_runs
from tests.engine.both import Both, run_both

STEP = 0.1
LONGEST = 12.0
"""Length of a step and of the longest run, s."""

BROKEN = ("#obstacle_ahead", "#customramp", "#cutting_in", "#jaywalker")
"""Library scenarios that are run with broken numbers."""

BROKEN_ROWS, BROKEN_LONGEST = 50, 4.0
"""Number of broken runs of each, and the length of the longest, s: those that break off do so in their first rows."""


def library_targets() -> list[str]:
    """Return FILE#name of every scenario of the library."""
    return [one.target for one in list_library(library_folder(), Diagnostics()) if one.kind == "conflict"]


def compiled_plan(target: str | Path, step: float = STEP) -> Compilation | None:
    """Return a scenario's plan as a sweep runs it; None if it has none."""
    overrides = Overrides(perception="ideal", step=step, duration=LONGEST)
    return compile_target(target, {}, Diagnostics(), overrides=overrides)


def both_of(done: Compilation, rows: Sequence[Sequence[float]] | None = None, longest: float = LONGEST) -> Both:
    """Return what both forms leave of a plan, or of rows of its numbers, in runs of a greatest length, s."""
    program = build_program(done.plan, done.network)
    numbers = [program.const] if rows is None else rows
    draws = [make_draws(1, k) for k in range(len(numbers))]
    return run_both(done.network.tables, program, numbers, draws, round(longest / done.plan.step) + 1)


def differing(targets: Sequence[str | Path]) -> tuple[list[str], int]:
    """Return the scenarios whose two forms differ, and how many ran."""
    found, ran = [], 0
    for target in targets:
        done = compiled_plan(target)
        if done is not None:
            both = both_of(done)
            ran += 1
            if both.interpreted != both.compiled:
                found.append(str(target))
    return found, ran


@pytest.mark.parametrize("step", [0.05, 0.01])
def test_the_probes_leave_the_same_bytes(golden: Path, step: float) -> None:
    done = compiled_plan(golden / "esmini_probes" / "probes.xosc", step)
    assert done is not None
    both = both_of(done)
    assert both.summaries[0][SUMMARY.index("rows")] > 100
    assert both.interpreted == both.compiled


def test_every_library_scenario_leaves_the_same_bytes() -> None:
    targets = library_targets()
    assert differing(targets) == ([], len(targets))


@pytest.mark.slow
def test_every_recorded_scenario_leaves_the_same_bytes(golden: Path) -> None:
    scenarios = [run.scenario for run in recorded_runs(golden.parent / "corpus")]
    different, ran = differing(scenarios)
    assert different == []
    assert ran >= 0.9 * len(scenarios)


def broken_rows(program: Program) -> list[list[float]]:
    """Return the program's numbers with one that is none or without end, one row for some of them."""
    rows = []
    for k, where in enumerate(range(0, len(program.const), max(len(program.const) // BROKEN_ROWS, 1))):
        row = list(program.const)
        row[where] = (math.nan, math.inf, -1.0e300)[k % 3]
        rows.append(row)
    return rows


def test_faulty_runs_end_with_the_same_code() -> None:
    targets = [target for target in library_targets() if target.endswith(BROKEN)]
    flag, stop = SUMMARY.index("flag"), SUMMARY.index("stop")
    faults = []
    for target in targets:
        done = compiled_plan(target)
        assert done is not None
        both = both_of(done, broken_rows(build_program(done.plan, done.network)), BROKEN_LONGEST)
        assert both.interpreted == both.compiled
        faults += [int(row[flag]) for row in both.summaries if row[stop] == op.STOP_ERROR]
    assert len(targets) == len(BROKEN)
    assert len(set(faults)) >= 2
    assert op.FAULT_NONE not in faults
