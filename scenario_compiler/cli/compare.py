"""`compare`: the differences between two runs."""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Iterable
from dataclasses import asdict, astuple
from pathlib import Path
from typing import TYPE_CHECKING

from scenario_compiler.cli.options import AT_FAULT, FINE, Commands, WrongUse, add_maps, keep_inputs
from scenario_compiler.cli.terminal import put, put_raw, put_table
from scenario_compiler.diagnostic_formats import formatted
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.legible import legible_json

if TYPE_CHECKING:
    from scenario_compiler.recording.comparison import Comparison
    from scenario_compiler.recording.outcome import Outcome
    from scenario_compiler.recording.recording import Recording

MOST_EVENTS = 40
"""Greatest number of events that are printed; --format json has all."""


def add(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "compare",
        help="compare two runs: when they begin to differ, by how much, and which events are in one of them only",
        description="Compare two runs: when they begin to differ, by how much, and which events are in one of them "
        "only. The exit code is 0 if the same happened in both, else 1. Differences between plans, seeds and versions "
        "are shown, but do not count; nor do the reports of sensors that only one of two worlds has.",
    )
    for name in ("first", "second"):
        parser.add_argument(
            name, type=Path, metavar="RUN", help="folder of a run, its recording.parquet, or a trajectory as .csv"
        )
    parser.add_argument(
        "--tolerance",
        type=distance,
        metavar="X",
        help="allow differences of X m in positions and of one step in the times of events and ends; by default "
        "every bit counts",
    )
    parser.add_argument("--format", choices=("text", "json"), default="text", help="format of the output")
    parser.add_argument(
        "--html",
        type=Path,
        metavar="FILE.html",
        help="write a page that plays both runs together; both must be run folders",
    )
    parser.add_argument("--camera", action="store_true", help="draw first-person pictures of both runs into the page")
    add_maps(parser)
    parser.set_defaults(command=compare_command)


def distance(text: str) -> float:
    """Return a distance in metres that an option gives."""
    value = float(text)
    if not 0.0 <= value < math.inf:
        raise argparse.ArgumentTypeError(f"{text} is not a distance in metres")
    return value


def compare_command(options: argparse.Namespace) -> int:
    """Print the differences between two runs."""
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
    names = (options.first.resolve().name, options.second.resolve().name)
    pictures = [pictures_to_show(run, options) for run in (first, second)]
    write_comparison((first, second), names, found, list(verdict(found, options.tolerance)), pictures, options.html)
    put(f"page: {options.html}", sys.stdout if options.format == "text" else sys.stderr)


def read_run(path: Path) -> tuple[Recording, Outcome | None]:
    """Return the recording of a run and its outcome, if it has one; raise WrongUse if `path` is not a run."""
    from scenario_compiler.recording.outcome import OutcomeError, read_outcome
    from scenario_compiler.recording.store import RecordingError, read_recording
    from scenario_compiler.recording.trajectory import TrajectoryError, read_trajectory

    try:
        if path.suffix == ".csv":
            return read_trajectory(path), None
        judged = path / "outcome.json"
        recording = read_recording(path / "recording.parquet" if path.is_dir() else path)
        return recording, read_outcome(judged) if judged.exists() else None
    except (RecordingError, TrajectoryError, OutcomeError, OSError) as fault:
        raise WrongUse(str(fault)) from None


def as_json(found: Comparison) -> str:
    """Return a comparison as JSON."""
    return json.dumps({"equal": found.equal, **asdict(found)}, indent=2, allow_nan=False, ensure_ascii=False)


def print_comparison(found: Comparison, tolerance: float | None) -> None:
    """Print a comparison as tables, leaving out empty ones, and in sentences."""
    put_table(
        ("", "first", "second"),
        [
            (one.what, one.first, "=" if one.first == one.second else one.second)
            for one in found.facts
            if one.first or one.second
        ],
    )
    put_table(
        ("entity", "rows", "alone", "apart, m", "at, s", "x, m", "y, m", "h, rad", "v, m/s"),
        [
            (entity, str(rows), str(alone), *map(_number, greatest))
            for entity, rows, alone, *greatest in map(astuple, found.apart)
        ],
    )
    put_table(
        ("event", "entity", "cause", "message", "first, s", "second, s"),
        [
            (one.kind, one.entity, one.cause, one.message, _number(one.first), _number(one.second))
            for one in found.events[:MOST_EVENTS]
        ],
    )
    if len(found.events) > MOST_EVENTS:
        put(f"and {len(found.events) - MOST_EVENTS} more events")
        put()
    put_table(
        ("measure", "unit", "first", "second", "difference"),
        [
            (one.name, one.unit, _number(one.first), _number(one.second), _number(one.difference))
            for one in found.measures
            if one.first is not None or one.second is not None
        ],
    )
    for sentence in verdict(found, tolerance):
        put(sentence)


def verdict(found: Comparison, tolerance: float | None) -> Iterable[str]:
    """Yield the result of the comparison, in sentences."""
    parting = found.parting
    if parting is not None:
        name, unit = _called(parting.column)
        whose = f"the {name} of {parting.entity}" if parting.entity else f"the {name}"
        values = f"{parting.first}{unit} in the first, {parting.second}{unit} in the second"
        yield f"The runs first differ at {parting.t:.6g} s: {whose} is {values}."
    if not found.same_times:
        yield f"The runs have different rows: {found.rows} rows are at times that both have."
    for fact in found.facts:
        if fact.counts and fact.first != fact.second:
            yield f"The runs differ in: {fact.what}."
    counting = sum(one.counts for one in found.events)
    if counting:
        yield f"Events that differ: {counting}."
    if counting < len(found.events):
        yield f"Events that only the sensors of one world report: {len(found.events) - counting}."
    within = "" if tolerance is None else f" within {tolerance:g} m"
    yield f"The same happened in both{within}." if found.equal else "The runs differ."


def _called(column: str) -> tuple[str, str]:
    """Return the name of a recording's column for a sentence, and its unit after a space."""
    from scenario_compiler.recording.recording import COLUMNS
    from scenario_compiler.report.wording import unit_words

    known = {one.name: one for one in COLUMNS}.get(column)
    unit = unit_words(known.unit) if known is not None else "m" if column == "x, y" else ""
    name = {"x, y": "position", "v": "speed", "a": "acceleration", "h": "heading"}.get(column, column.replace("_", " "))
    return name, f" {unit}" if unit else ""


def _number(value: float | None) -> str:
    return "–" if value is None else f"{value:.4g}"
