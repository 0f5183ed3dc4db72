"""Runs a program in both forms of the engine, and returns the results of each as bytes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.simulation import Simulation
from scenario_compiler.roads.tables import RoadTables


@dataclass(frozen=True)
class Both:
    """What the two forms leave of the same variants.

    Attributes:
        summaries: The summaries of the interpreted form, (variants, SUMMARY_SIZE).
        traces: Its traces, (variants, numbers of a trace).
        interpreted: The bytes of summary and trace of each variant, interpreted.
        compiled: The same, compiled.
        state: The interpreted form's state at the end of the last variant.
    """

    summaries: NDArray[np.float64]
    traces: NDArray[np.float64]
    interpreted: list[bytes]
    compiled: list[bytes]
    state: State


def run_both(
    tables: RoadTables,
    program: Program,
    rows: Sequence[Sequence[float]],
    draws: Sequence[Sequence[float]],
    limit: int,
) -> Both:
    """Run variants in both forms, with a row of the trace for every step."""
    slow, fast = Simulation(tables, program, interpreted=True), Simulation(tables, program)
    assert [slow.form.name, fast.form.name] == ["interpreted", "compiled"]
    summaries, traces = slow.sweep(rows, draws, limit, limit + 1)
    interpreted = [_bytes(*both) for both in zip(summaries, traces, strict=True)]
    compiled = [_bytes(*both) for both in zip(*fast.sweep(rows, draws, limit, limit + 1), strict=True)]
    return Both(summaries, traces, interpreted, compiled, slow.state)


def _bytes(*arrays: NDArray[np.float64]) -> bytes:
    """Return the bytes of numbers; every NaN has the same bytes, whichever sign a processor gives it."""
    return b"".join(np.where(np.isnan(values), np.nan, values).tobytes() for values in arrays)
