"""Measures surrogate perception's cost relative to ideal perception: `python tests/benchmarks/surrogate_figures.py`.

The steps of a sweep in a CPU second, for each of five conflicts of the library as they are: the best of several rounds,
both perceptions in turn. And one sweep of many variants from the scenario file to the table of results.
"""

from __future__ import annotations

import math
import time
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np
import pyarrow.parquet as pq
from numpy.typing import NDArray

from scenario_compiler import compile_scenario, load_network
from scenario_compiler.batch.execute import run_sweep
from scenario_compiler.batch.spec import SweepSpec
from scenario_compiler.compiler import Overrides
from scenario_compiler.engine.columns.state import make_draws
from scenario_compiler.engine.columns.totals import SUMMARY
from scenario_compiler.engine.program import build_program
from scenario_compiler.engine.simulation import Simulation
from scenario_compiler.resources import library_folder
from scenario_compiler.vocabulary.sensors import Perception

CONFLICTS = ("markings_missing", "obstacle_ahead", "ramp_blocked", "road_narrows", "sensor_failure")
SEEDS, ROUNDS = 100, 3
"""Runs of each conflict in a sweep, and how often it is measured."""

VARIANTS = 10_000
VARIED = ("from=uniform(100,400)", "over=uniform(1,250)")
"""The sweep of `markings_missing` that is timed as a whole."""


class Rate(NamedTuple):
    """Steps of a conflict's sweep in a CPU second."""

    conflict: str
    ideal: float
    surrogate: float


class Timed(NamedTuple):
    """The CPU time of a sweep, s, and the times of its requests, NaN without one, s."""

    seconds: float
    requests: NDArray[np.float64]


def rate(conflict: str) -> Rate:
    """Measure a conflict with both perceptions."""
    found = {}
    for perception in ("ideal", "surrogate"):
        found[perception] = _steps_in_a_second(library_folder() / "conflicts" / f"{conflict}.xml", perception)
    return Rate(conflict, found["ideal"], found["surrogate"])


def share_of(rates: list[Rate]) -> float:
    """Return the share of ideal perception's rate that the surrogate has over the same steps of all conflicts."""
    return sum(1.0 / one.ideal for one in rates) / sum(1.0 / one.surrogate for one in rates)


def whole_sweep() -> Timed:
    """Measure the sweep over where the paint begins to fade and along which length."""
    with TemporaryDirectory() as folder:
        spec = SweepSpec(vary=VARIED, samples=VARIANTS, perception="surrogate")
        began = time.process_time()
        target = library_folder() / "conflicts" / "markings_missing.xml"
        result = run_sweep(target, spec, Path(folder) / "sweep", report=False, workers=1)
        seconds = time.process_time() - began
        column = pq.read_table(result.table, columns=["request_time"])["request_time"]
        return Timed(seconds, np.array([math.nan if one is None else one for one in column.to_pylist()]))


def _steps_in_a_second(file: Path, perception: Perception) -> float:
    plan = compile_scenario(file, overrides=Overrides(perception=perception))
    network = load_network(plan.map.file)
    assert network is not None
    program = build_program(plan, network)
    simulation = Simulation(network.tables, program)
    rows, draws = [list(program.const)] * SEEDS, [make_draws(k) for k in range(SEEDS)]
    seconds = []
    for _ in range(ROUNDS):
        began = time.process_time()
        summaries, _ = simulation.sweep(rows, draws, plan.step_limit)
        seconds.append(time.process_time() - began)
    return float(summaries[:, SUMMARY.index("rows")].sum()) / min(seconds)


def main() -> None:
    """Print the table."""
    rates = [rate(conflict) for conflict in CONFLICTS]
    for one in rates:
        print(
            f"{one.conflict:20s} ideal {one.ideal / 1e6:.2f}, surrogate {one.surrogate / 1e6:.2f} million steps in a "
            f"CPU second: {one.surrogate / one.ideal:.2f}"
        )
    print(f"together {share_of(rates):.2f}")
    print(f"{VARIANTS} variants of markings_missing: {whole_sweep().seconds:.1f} CPU seconds")


if __name__ == "__main__":
    main()
