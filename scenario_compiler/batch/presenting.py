"""Makes the report of a finished sweep."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path

from scenario_compiler.batch.codebook import PARAMETER
from scenario_compiler.batch.folder import TABLE
from scenario_compiler.batch.measuring import Columns
from scenario_compiler.batch.spec import SweepSpec
from scenario_compiler.batch.tally import OnProgress, Progress
from scenario_compiler.batch.variants import Families
from scenario_compiler.batch.worst import by_severity, folder_options, repeat_command, run_again
from scenario_compiler.report.sweep_page import Case, SweepPage, write_sweep_report

PICTURED = 3
"""Worst cases that are shown with pictures."""

LISTED = 10
"""Worst cases that are listed."""


def write_page(
    target: str,
    spec: SweepSpec,
    families: Families,
    rows: Columns,
    form: str,
    folder: Path,
    units: Mapping[str, str],
    progress: OnProgress | None = None,
) -> Path:
    """Write the report of a finished sweep; the cases with pictures are run again.

    `units` are those of the parameters, in which XML writes them.
    """
    cases = []
    order = by_severity(rows)[:LISTED]
    for place, index in enumerate(order):
        if progress is not None and place < PICTURED:
            progress(Progress("cases", place, min(PICTURED, len(order))))
        parameters = {name.removeprefix(PARAMETER): rows[name][index] for name in rows if name.startswith(PARAMETER)}
        run = run_again(families, rows, index) if place < PICTURED else None
        cases.append(Case(index, parameters, repeat_command(target, spec, rows, index, families.maps), run))
    plan = families.base.plan
    facts = [
        ("Rows", TABLE),
        ("Run", {"camera": "with a camera in the loop"}.get(form, f"by the {form} engine")),
        ("Sampling", f"{spec.method}, seed {spec.seed}" + "".join(f", where {text}" for text in spec.where)),
        ("Map", plan.map.name),
        ("Plan", plan.digest),
    ]
    page = SweepPage(
        title=plan.name,
        summary=plan.summary,
        rows=rows,
        parameters={name: axis.text for name, axis in spec.axes.items()},
        units=units,
        facts=facts,
        cases=cases,
        command=sweep_command(target, spec, families.maps),
    )
    return write_sweep_report(page, folder)


def sweep_command(target: str, spec: SweepSpec, maps: Sequence[Path] = ()) -> str:
    """Return the command that makes a sweep; `maps` are the folders of --maps."""
    words = ["scenario-compiler", "sweep", target]
    for text in spec.vary:
        words += ["--vary", text]
    for text in spec.where:
        words += ["--where", text]
    for name, value in spec.settings.items():
        words += ["--set", f"{name}={value}"]
    words += ["--method", spec.method, "--samples", str(spec.samples), "--seed", str(spec.seed)]
    words += ["--repeat", str(spec.repeat)] if spec.repeat > 1 else []
    options = (
        ("--perception", spec.perception),
        ("--controller", spec.controller),
        *(("--trust", name) for name in spec.trust),
        ("--dt", spec.step),
        ("--duration", spec.duration),
        *(("--error", code) for code in spec.errors),
        *(("--allow", code) for code in spec.allowed),
        ("--traces", spec.traces or None),
    )
    words += [word for option, value in options if value is not None for word in (option, str(value))]
    return shlex.join([*words, *folder_options(maps), "-o", "sweep"])
