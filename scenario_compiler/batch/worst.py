"""Chooses the variants of a sweep that deserve a closer look, and records them."""

from __future__ import annotations

import math
import shlex
from collections.abc import Sequence
from pathlib import Path

from scenario_compiler.batch.codebook import PARAMETER
from scenario_compiler.batch.measuring import Columns
from scenario_compiler.batch.runner import record
from scenario_compiler.batch.spec import SweepSpec
from scenario_compiler.batch.tally import OnProgress, Progress
from scenario_compiler.batch.variants import Families, with_values
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.expressions import format_value
from scenario_compiler.files import is_plan_file
from scenario_compiler.outputs import whole_folder
from scenario_compiler.randomness import hash_bits
from scenario_compiler.recording.outcome import judge
from scenario_compiler.report.folder import write_run_folder
from scenario_compiler.report.run import Run
from scenario_compiler.resources import templates_given

TRACES = "traces"
LAST = "recording.parquet"
"""File of a trace that is moved into its folder last."""


def by_severity(rows: Columns) -> list[int]:
    """Return the variants that have a run, the worst first.

    Collisions come first, in descending order of speed; then the other runs in ascending order of `SEVERITY`.
    """
    return sorted(
        (index for index, result in enumerate(rows["result"]) if result != "error"),
        key=lambda index: (
            rows["collision_time"][index] is None,
            -(rows["collision_speed"][index] or 0.0),
            *(math.inf if rows[name][index] is None else rows[name][index] for name in SEVERITY),
            index,
        ),
    )


SEVERITY = ("minimum_time_to_collision", "minimum_distance")
"""Measures by which runs without a collision are ordered, ascending."""


def chosen(rows: Columns, spec: SweepSpec) -> list[int]:
    """Return the variants whose traces the sweep keeps."""
    kind, count = spec.traces_wanted()
    order = by_severity(rows)
    if kind == "worst":
        return order[:count]
    if kind == "random":
        return sorted(sorted(order, key=lambda index: hash_bits(spec.seed, index, "sweep/traces"))[:count])
    return sorted(order) if kind == "all" else []


def run_again(families: Families, rows: Columns, index: int) -> Run:
    """Run a variant of a finished sweep again, interpreted, and return all that belongs to it.

    Raises:
        ValueError: The variant's structure does not compile any more.
    """
    from scenario_compiler.batch.runner import Variant

    sample = {
        name.removeprefix(PARAMETER): values[index] for name, values in rows.items() if name.startswith(PARAMETER)
    }
    family = families.of(sample)
    if isinstance(family, Diagnostics):
        raise ValueError(f"variant {index} does not compile any more")
    variant = Variant(index, rows["seed"][index], family.number, family.values(sample))
    plan = with_values(family.plan, variant.values)
    recording = record(family.plan, family.network, variant, families.trust)
    return Run(plan, family.network, recording, judge(plan, recording))


def write_traces(
    families: Families, rows: Columns, indices: Sequence[int], folder: Path, progress: OnProgress | None = None
) -> list[Path]:
    """Write the plan, map, recording, events and outcome of variants, one at a time, into folders; return those.

    A folder that is whole already is left as it is.
    """
    written = []
    for number, index in enumerate(indices):
        if progress is not None:
            progress(Progress("traces", number, len(indices)))
        place = folder / TRACES / f"{index:08}"
        written.append(place)
        if (place / LAST).is_file():
            continue
        with whole_folder(place) as draft:
            write_run_folder(run_again(families, rows, index), draft, report=False)
    return written


def folder_options(maps: Sequence[Path]) -> list[str]:
    """Return the options of a command for the folders in which maps and templates are looked for first."""
    named = (("--maps", maps), ("--templates", templates_given()))
    return [word for option, folders in named for one in folders for word in (option, str(one))]


def repeat_command(target: str, spec: SweepSpec, rows: Columns, index: int, maps: Sequence[Path] = ()) -> str:
    """Return the command that runs a single variant with the same trajectories; `maps` are the folders of --maps."""
    words = ["scenario-compiler", "run", target]
    if not is_plan_file(target):
        settings = dict(spec.settings)
        for name, values in rows.items():
            if name.startswith(PARAMETER):
                settings[name.removeprefix(PARAMETER)] = format_value(values[index])
        words += [word for name, text in settings.items() for word in ("--set", f"{name}={text}")]
        options = (
            ("--perception", spec.perception),
            ("--controller", spec.controller),
            *(("--trust", name) for name in spec.trust),
            ("--dt", spec.step),
            ("--duration", spec.duration),
        )
        words += [word for option, value in options if value is not None for word in (option, str(value))]
    words += folder_options(maps)
    words += ["--seed", str(rows["seed"][index]), "--variant", str(index), "-o", f"variant-{index}"]
    return shlex.join(words)
