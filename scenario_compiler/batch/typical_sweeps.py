"""Runs typical sweeps in a library of the engine: `python -m scenario_compiler.batch.typical_sweeps LIBRARY NOTE`.

The C compiler learns from them which branches of the engine are often taken (`forms/making.py`). They are what the
program is made for: a conflict of each kind in the AISA paper's table, every parameter drawn between its limits, with
ideal and with surrogate perception.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from scenario_compiler.compiler import Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.engine.columns.state import make_draws
from scenario_compiler.engine.program import Numbers, build_program
from scenario_compiler.engine.simulation import Simulation
from scenario_compiler.forms.machine_code import MachineCode
from scenario_compiler.forms.note import Note
from scenario_compiler.vocabulary.sensors import Perception

CONFLICTS = ("sensor_failure", "ramp_blocked", "road_narrows", "obstacle_ahead", "markings_missing")
VARIANTS = 100
SEED = 1


def run_typical_sweep(conflict: str, perception: Perception, machine_code: MachineCode) -> None:
    """Run variants of a conflict of the library.

    Args:
        conflict: Its name.
        perception: The source of the lane confidence.
        machine_code: The library to run them in.

    Raises:
        ValueError: The conflict does not compile.
    """
    sink = Diagnostics()
    done = compile_target(conflict, {}, sink, overrides=Overrides(perception=perception))
    if done is None:
        raise ValueError("\n".join(str(one) for one in sink))
    generator = np.random.default_rng(SEED)
    limits = [
        (one.name, one.min, one.max)
        for one in done.plan.parameters
        if isinstance(one.min, float) and isinstance(one.max, float)
    ]
    samples = [{name: generator.uniform(low, high) for name, low, high in limits} for _ in range(VARIANTS)]
    simulation = Simulation(
        done.network.tables, build_program(done.plan, done.network), interpreted=False, machine_code=machine_code
    )
    draws = [make_draws(SEED, variant) for variant in range(VARIANTS)]
    simulation.sweep(Numbers(done.plan, done.network).rows(samples), draws, done.plan.step_limit)


def main() -> None:
    """Run all typical sweeps."""
    parser = argparse.ArgumentParser(description="Run typical sweeps in a library of the engine.")
    parser.add_argument("library", type=Path, help="the library")
    parser.add_argument("note", type=Path, help="the note on it")
    options = parser.parse_args()
    note = Note.read(options.library, options.note)
    if note is None:
        parser.error("the library or its note is missing")
    machine_code = MachineCode(options.library, note.entries, note.made_by)
    for conflict in CONFLICTS:
        run_typical_sweep(conflict, "ideal", machine_code)
        run_typical_sweep(conflict, "surrogate", machine_code)


if __name__ == "__main__":
    main()
