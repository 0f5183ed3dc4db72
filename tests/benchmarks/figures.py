"""Prints a table of the program's work per CPU second, measured in one run: `python tests/benchmarks/figures.py`.

Every figure is the median of several runs, in CPU time (user and system). Ratios are against figures of esmini 3.6
that were measured on a like machine (two shared cores); a figure of both programs from one run on one machine counts
more, and the entity-steps per CPU second printed here are for that.
"""

from __future__ import annotations

import argparse
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from scenario_compiler.compiler import Compilation, Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.engine.columns.state import make_draws
from scenario_compiler.engine.program import Numbers, build_program
from scenario_compiler.engine.simulation import Simulation
from scenario_compiler.vocabulary.sensors import Perception

HERE = Path(__file__).parent
SCRIPTED = HERE / "scripted.xosc"
"""Three vehicles that the storyboard alone moves, 30 s along a bending motorway: of such a run esmini's figures are."""

CUT_IN = HERE / "cut_in.xml"
OBSTACLE = HERE.parents[1] / "library" / "conflicts" / "obstacle_ahead.xml"

ESMINI_STEPS = (250e3, 430e3)
"""Entity-steps a CPU second of esmini in process: a 30 s cut-in with 3 entities at 0.05 s."""

ESMINI_COLLISIONS = 321e3
"""The same with 50 entities and `--collision`."""

ESMINI_VARIANT = 0.054
"""CPU seconds a variant of `esmini --param_dist`, which reads a small road for each."""

CROWD = 50


@dataclass(frozen=True)
class Figure:
    """A line of the table."""

    what: str
    value: str
    ratio: str = ""
    held_to: str = ""


def cpu_of(work: Callable[[], object]) -> float:
    """Return the CPU time that some work in this process takes, s."""
    begin = time.process_time()
    work()
    return time.process_time() - begin


def cpu_of_command(command: list[str], folder: Path, **environment: str) -> float:
    """Return the CPU time of a whole process, s."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    whole = {**os.environ, "OMP_NUM_THREADS": "1", **environment}
    subprocess.run(command, check=True, cwd=folder, capture_output=True, env=whole)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return (after.ru_utime - before.ru_utime) + (after.ru_stime - before.ru_stime)


def median(runs: int, work: Callable[[], float]) -> float:
    """Return the median of several measurements."""
    return statistics.median(work() for _ in range(runs))


def compiled_target(target: Path) -> Compilation:
    """Compile a scenario without camera."""
    perception: Perception | None = None if target.suffix == ".xosc" else "ideal"
    done = compile_target(target, {}, Diagnostics(), overrides=Overrides(perception=perception))
    if done is None:
        raise SystemExit(f"{target} does not compile")
    return done


def crowd_of(folder: Path) -> Path:
    """Write a scenario of 50 vehicles on two lanes; return its file."""
    place = (
        '<dynamic id="d{0}" speed="{1}"><start><ahead_of entity="ego" distance="{2}" lanes="{3}"/></start></dynamic>'
    )
    others = "".join(place.format(k, 18 + k % 5, 14 * (k // 2) + 14 - 7 * (k % 2), k % 2) for k in range(CROWD - 1))
    path = folder / "crowd.xml"
    path.write_text(
        '<scenarios version="1"><scenario name="crowd" map="highway_loop" duration="30" step="0.05">'
        f'<ego speed="20"><start><spawn_point name="straight"/></start></ego>{others}</scenario></scenarios>',
        encoding="utf-8",
    )
    return path


def stepping(done: Compilation, variants: int, runs: int, *, interpreted: bool) -> float:
    """Return entity-steps a CPU second, without traces."""
    program = build_program(done.plan, done.network)
    engine = Simulation(done.network.tables, program, interpreted=interpreted)
    numbers = Numbers(done.plan, done.network).rows([{}] * variants)
    draws = [make_draws(1, k) for k in range(variants)]
    limit = done.plan.step_limit
    summaries, _ = engine.sweep(numbers, draws, limit)
    steps = sum(float(summary[0]) - 1 for summary in summaries)
    cpu = median(runs, lambda: cpu_of(lambda: engine.sweep(numbers, draws, limit)))
    return steps * len(done.plan.entities) / cpu


SWEEP = """
import sys
from pathlib import Path
from scenario_compiler.batch.execute import run_sweep
from scenario_compiler.batch.spec import SweepSpec
perception = None if sys.argv[1].endswith(".xosc") else "ideal"
spec = SweepSpec(vary=(sys.argv[2],), samples=int(sys.argv[3]), perception=perception)
run_sweep(sys.argv[1], spec, Path(sys.argv[4]), workers=1, report=False)
"""


def sweep_cpu(target: Path, vary: str, samples: int, folder: Path) -> float:
    """Return the CPU time of a whole process that runs a sweep without traces and report, s."""
    with tempfile.TemporaryDirectory(dir=folder) as place:
        command = [sys.executable, "-c", SWEEP, str(target), vary, str(samples), str(Path(place) / "sweep")]
        return cpu_of_command(command, folder)


def figures(folder: Path, runs: int, *, short: bool) -> list[Figure]:
    """Measure everything; `short` leaves out what takes long and counts for nothing but that it runs."""
    scripted, cut_in, crowd = compiled_target(SCRIPTED), compiled_target(CUT_IN), compiled_target(crowd_of(folder))
    found = []
    for what, done, interpreted, variants, reference, held in (
        ("3 scripted entities, interpreted", scripted, True, 1, ESMINI_STEPS, "0.25x (aim 0.5x)"),
        ("3 scripted entities, compiled", scripted, False, 100, ESMINI_STEPS, "8x (aim 15x)"),
        ("automated vehicle among 3, interpreted", cut_in, True, 1, ESMINI_STEPS, ""),
        ("automated vehicle among 3, compiled", cut_in, False, 100, ESMINI_STEPS, ""),
        (f"{CROWD} entities with collisions, compiled", crowd, False, 10, (ESMINI_COLLISIONS,) * 2, "2x (aim 8x)"),
    ):
        rate = stepping(done, 2 if short else variants, runs, interpreted=interpreted)
        low, high = rate / reference[1], rate / reference[0]
        ratio = f"{low:.2g}x" if low == high else f"{low:.2g}x to {high:.2g}x"
        found.append(Figure(what, f"{rate / 1e3:,.0f} k entity-steps/s", ratio, held))
    sizes = (20,) if short else (1_000, 10_000)
    for target, vary in (
        (SCRIPTED, "gap=uniform(10,40)"),
        (CUT_IN, "after=uniform(2,25)"),
        (OBSTACLE, "distance=uniform(60,350)"),
    ):
        for samples in sizes:
            cpu = median(1 if samples > 1_000 else runs, lambda: sweep_cpu(target, vary, samples, folder))  # noqa: B023  # called at once
            held = "" if target is not SCRIPTED else "15x (aim 60x)" if samples < 10_000 else "60x (aim 120x)"
            each = cpu / samples
            value = f"{cpu:.2f} s, {1e3 * each:.2f} ms a variant"
            found.append(Figure(f"sweep {target.stem}, {samples}", value, f"{ESMINI_VARIANT / each:.3g}x", held))
    program = [sys.executable, "-m", "scenario_compiler"]
    validate = median(runs, lambda: cpu_of_command([*program, "validate", str(OBSTACLE)], folder))
    found.append(Figure("validate one conflict", f"{validate:.2f} s", "", "0.35 s (aim 0.2 s)"))
    run = [*program, "run", str(CUT_IN), "--perception", "ideal", "--trajectory", "cut_in.csv"]
    whole = median(runs, lambda: cpu_of_command(run, folder))
    if not short:
        make = "from scenario_compiler.forms.making import make; make()"
        made = cpu_of_command([sys.executable, "-c", make], folder)
        found.append(Figure("building the engine", f"{made:.0f} s"))
    found.append(Figure("run of the cut-in, --trajectory only", f"{whole:.2f} s", "", "0.6 s (aim 0.3 s)"))
    return found


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description="Print what the program does a CPU second.")
    parser.add_argument("--runs", type=int, default=7, help="measurements of each figure; the median is printed")
    parser.add_argument("--short", action="store_true", help="only show that everything runs")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        table = [
            Figure("figure", "measured", "against esmini 3.6", "held to"),
            *figures(Path(folder), options.runs, short=options.short),
        ]
    widths = [
        max(len(cell) for cell in column) for column in zip(*(vars(line).values() for line in table), strict=True)
    ]
    for line in table:
        print("  ".join(cell.ljust(width) for cell, width in zip(vars(line).values(), widths, strict=True)).rstrip())
    print(f"\nCPU time, median of {options.runs}")


if __name__ == "__main__":
    main()
