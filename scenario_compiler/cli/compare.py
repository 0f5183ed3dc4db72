"""`compare`: the differences between two runs, or between two sweeps."""

from __future__ import annotations

import argparse
import json
import math
import sys
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from scenario_compiler.cli.differences import print_comparison, print_sweeps, sweep_tables, sweeps_verdict, verdict
from scenario_compiler.cli.options import (
    AT_FAULT,
    FINE,
    Commands,
    WrongUse,
    add_maps,
    keep_inputs,
    refuse_idle,
    text_stream,
)
from scenario_compiler.cli.terminal import put, put_raw
from scenario_compiler.diagnostic_formats import formatted
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.files import suffix_of
from scenario_compiler.legible import legible_json

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from scenario_compiler.batch.comparison import SweepComparison
    from scenario_compiler.recording.comparison import Comparison
    from scenario_compiler.recording.outcome import Outcome
    from scenario_compiler.recording.recording import Recording


def add(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "compare",
        help="compare two runs, or two sweeps variant by variant: where they differ, and by how much",
        description="Compare two runs: when they begin to differ, by how much, and which events are in one of them "
        "only. Or compare two sweeps: variants with the same parameters are paired, and the measures and outcomes of "
        "each pair are compared. The exit code is 0 if the same happened in both, else 1. Differences between plans, "
        "seeds and versions are shown, but do not count; nor do reports of sensors that only one of two worlds has.",
    )
    for name in ("first", "second"):
        parser.add_argument(
            name,
            type=Path,
            metavar="RUN|SWEEP",
            help="folder of a run, its recording.parquet, or a trajectory as .csv; or the folder of a finished sweep",
        )
    parser.add_argument(
        "--tolerance",
        type=tolerance,
        metavar="X",
        help="allow differences: in runs of X m in positions and of one step in the times of events and ends, in "
        "sweeps of X in each measure, in its unit; by default every bit counts",
    )
    parser.add_argument("--format", choices=("text", "json"), default="text", help="format of the output")
    parser.add_argument(
        "--html",
        type=Path,
        metavar="FILE.html",
        help="write a page that plays both runs together, which must be run folders, or that has the tables of sweeps",
    )
    parser.add_argument("--camera", action="store_true", help="draw first-person pictures of both runs into the page")
    add_maps(parser)
    parser.set_defaults(command=compare_command)


def tolerance(text: str) -> float:
    """Return a difference that an option allows."""
    value = float(text)
    if not 0.0 <= value < math.inf:
        raise argparse.ArgumentTypeError(f"{text} is not a finite number from 0 on")
    return value


def compare_command(options: argparse.Namespace) -> int:
    """Print the differences between two runs, or between two sweeps."""
    if options.html is None:
        refuse_idle(options, "only with --html", "camera")
    if _are_sweeps(options.first, options.second):
        return _compare_sweeps(options)
    from scenario_compiler.recording.comparison import compare

    (first, outcome), (second, other) = read_run(options.first), read_run(options.second)
    outcomes = None if outcome is None or other is None else (outcome, other)
    found = compare(first, second, outcomes, tolerance=options.tolerance)
    if options.format == "json":
        put_raw(legible_json(as_json(found)))
    else:
        print_comparison(found, options.tolerance)
    if options.html is not None:
        _write_page(found, options)
    return FINE if found.equal else AT_FAULT


def _compare_sweeps(options: argparse.Namespace) -> int:
    """Print the differences between two sweeps.

    Raises:
        WrongUse: A folder contains no finished sweep, or no variants belong together.
    """
    from scenario_compiler.batch.comparison import compare_sweeps
    from scenario_compiler.batch.distributions import SweepError
    from scenario_compiler.batch.folder import TABLE, TAKEOVER_TABLE

    if options.camera:
        raise WrongUse("--camera draws pictures of runs, and these are sweeps")
    keep_inputs(
        [folder / name for folder in (options.first, options.second) for name in (TABLE, TAKEOVER_TABLE)], options.html
    )
    try:
        found = compare_sweeps(options.first, options.second, tolerance=options.tolerance)
    except SweepError as fault:
        raise WrongUse(str(fault)) from None
    if options.format == "json":
        put_raw(legible_json(sweeps_as_json(found)))
    else:
        print_sweeps(found, options.tolerance)
    if options.html is not None:
        from scenario_compiler.report.compare_page import write_tables

        told = list(sweeps_verdict(found, options.tolerance))
        write_tables(_names(options), told, sweep_tables(found), options.html)
        _tell_page(options)
    return FINE if found.equal else AT_FAULT


def _are_sweeps(first: Path, second: Path) -> bool:
    """Return whether both paths are folders of sweeps; raise WrongUse if only one of them is."""
    from scenario_compiler.batch.folder import is_sweep

    there = [is_sweep(path) for path in (first, second)]
    if any(there) and not all(there):
        sweep, other = (first, second) if there[0] else (second, first)
        what = "is not" if other.exists() else "does not exist"
        raise WrongUse(f"{sweep} is the folder of a sweep, and {other} {what}: compare two runs or two such folders")
    return all(there)


def _write_page(found: Comparison, options: argparse.Namespace) -> None:
    """Write the page of both runs; raise WrongUse if one of them is not a readable run folder."""
    from scenario_compiler.cli.report import pictures_to_show, read_files, stored_run
    from scenario_compiler.report.compare_page import write_comparison

    keep_inputs([*read_files(options.first), *read_files(options.second)], options.html)
    sink = Diagnostics()
    first, second = (stored_run(folder, options.maps, sink) for folder in (options.first, options.second))
    if first is None or second is None:
        put_raw(formatted(list(sink), "text"), sys.stderr)
        raise WrongUse("--html shows run folders, as `run -o` writes them: one of these cannot be read")
    if not all(run.recording.present.any() for run in (first, second)):
        raise WrongUse("--html shows runs in motion: one of these has no vehicle")
    pictures = [pictures_to_show(run, options) for run in (first, second)]
    write_comparison(
        (first, second), _names(options), found, list(verdict(found, options.tolerance)), pictures, options.html
    )
    _tell_page(options)


def _names(options: argparse.Namespace) -> tuple[str, str]:
    """Return the names of both folders."""
    return options.first.resolve().name, options.second.resolve().name


def _tell_page(options: argparse.Namespace) -> None:
    put(f"page: {options.html}", text_stream(options))


def read_run(path: Path) -> tuple[Recording, Outcome | None]:
    """Return the recording of a run and its outcome, if it has one; raise WrongUse if `path` is not a run."""
    from scenario_compiler.recording.outcome import OutcomeError, read_outcome
    from scenario_compiler.recording.store import RecordingError, read_recording
    from scenario_compiler.recording.trajectory import TrajectoryError, read_trajectory

    try:
        if suffix_of(path) == ".csv":
            return read_trajectory(path), None
        judged = path / "outcome.json"
        recording = read_recording(path / "recording.parquet" if path.is_dir() else path)
        return recording, read_outcome(judged) if judged.exists() else None
    except (RecordingError, TrajectoryError, OutcomeError, OSError) as fault:
        raise WrongUse(str(fault)) from None


def as_json(found: Comparison) -> str:
    """Return a comparison as JSON."""
    return json.dumps({"equal": found.equal, **asdict(found)}, indent=2, allow_nan=False, ensure_ascii=False)


def sweeps_as_json(found: SweepComparison) -> str:
    """Return a comparison as JSON, with the numbers of all variants that differ."""

    def as_list(array: NDArray[np.int64]) -> object:
        return array.tolist()

    about = {"equal": found.equal, "paired": len(found.pairs), **asdict(found)}
    del about["pairs"]
    return json.dumps(about, default=as_list, allow_nan=False, ensure_ascii=False)
