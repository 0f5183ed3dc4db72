"""`calibrate`: measures how well the confidence of lane detection agrees with its errors, on any maps."""

from __future__ import annotations

import argparse
import sys
import time
from importlib import import_module
from pathlib import Path

from scenario_compiler.cli.options import (
    AT_FAULT,
    FINE,
    Commands,
    WrongUse,
    add_workers,
    needing,
    refuse_filled,
    whole_number,
)
from scenario_compiler.cli.terminal import complain, put, put_raw
from scenario_compiler.diagnostic_formats import formatted
from scenario_compiler.diagnostics import CompileError, did_you_mean
from scenario_compiler.files import files_in
from scenario_compiler.perception.detectors import DETECTORS, detector_class
from scenario_compiler.resources import maps_folder

CLIPS, PICTURES = 480, 60
"""Clips of each map and pictures of each situation; the packaged maps take about three minutes on two cores."""

DRAWN = 15
"""Number of random situations for each picture of a situation of the bank."""


def add(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "calibrate", help="measure how well lane detection's confidence is calibrated, and fit it"
    )
    parser.add_argument(
        "maps",
        nargs="*",
        type=Path,
        metavar="MAP",
        help="road file, or folder with road files; the packaged maps by default",
    )
    parser.add_argument(
        "-o", dest="output", type=Path, required=True, metavar="DIR", help="folder for the page of results"
    )
    parser.add_argument("--detector", choices=list(DETECTORS), default="classical", help="lane detector")
    parser.add_argument("--force", action="store_true", help="write into a folder that is not empty")
    parser.add_argument(
        "--leave-out",
        action="append",
        default=[],
        metavar="NAME",
        help="evaluate this map, on twelve times as many clips, with a confidence fitted on all other maps (needs "
        "the extra 'fit'); the tables then have such maps only",
    )
    parser.add_argument(
        "--fit",
        action="store_true",
        help="fit the confidence, and write the fit beside the page (needs the extra 'fit')",
    )
    count = whole_number(1, 100_000)
    parser.add_argument("--clips", type=count, default=CLIPS, metavar="N", help="number of clips of each map")
    parser.add_argument(
        "--pictures",
        type=count,
        default=PICTURES,
        metavar="N",
        help="number of pictures of each situation",
    )
    add_workers(parser)
    parser.set_defaults(command=calibrate_command)


def calibrate_command(options: argparse.Namespace) -> int:
    """Measure the calibration, and write the page."""
    from scenario_compiler.perception.calibration.cross_fit import MORE, seen_across, with_left_out
    from scenario_compiler.perception.calibration.figures import figures_of, fitted
    from scenario_compiler.perception.calibration.gather import Gathered, gather_bank, gather_drawn, gather_maps
    from scenario_compiler.perception.confidence import confidence_text
    from scenario_compiler.report.perception_page import PAGES, Measured, write_perception_page

    refuse_filled(options.output, force=options.force)
    if options.fit or options.leave_out:
        with needing("xgboost"):
            import_module("xgboost")
    maps = _road_files(options.maps)
    _check_left_out(options.leave_out, [one.stem for one in maps])
    began = time.monotonic()
    progress = _shown if sys.stderr.isatty() else None
    named, workers, left_out = options.detector, options.workers, options.leave_out
    try:
        seen = gather_maps(named, maps, options.clips, workers, progress=progress)
    except CompileError as error:
        put_raw(formatted(error.diagnostics, "text"), sys.stderr)
        return AT_FAULT
    missing = sorted(set(left_out) - set(seen))
    if missing or not seen:
        complain(f"there is no driving lane in {', '.join(missing) or 'any map'}")
        return AT_FAULT
    bank = gather_bank(named, options.pictures, workers, progress)
    drawn = gather_drawn(named, DRAWN * options.pictures, workers, progress)
    gathered = Gathered(seen, bank, drawn, options.clips)
    if options.fit or left_out:
        gathered = seen_across(named, maps, gathered, workers, left_out, progress)
    confidence = fitted(gathered) if options.fit else None
    if left_out:
        gathered = with_left_out(named, maps, gathered, workers, left_out, progress)
    figures = figures_of(gathered, left_out, confidence)
    minutes = (time.monotonic() - began) / 60.0
    given = [
        *(["--fit"] if options.fit else []),
        *(f"--leave-out {name}" for name in options.leave_out),
        *([f"--detector {options.detector}"] if options.detector != "classical" else []),
    ]
    command = " ".join(["scenario-compiler calibrate", *given, "MAPS"])
    looks = f"{options.clips} clips of six images on each of {len(seen)} maps ({', '.join(sorted(seen))})"
    if left_out:
        looks += f", and {MORE * options.clips} on each of those that are left out of a fit"
    measured = Measured(options.detector, command, minutes, options.workers, looks, options.pictures)
    write_perception_page(figures, measured, options.output, confidence)
    if confidence is not None:
        detector = detector_class(named)
        text = confidence_text(confidence, detector.features)
        (options.output / detector.confidence_file).write_text(text, encoding="utf-8")
    driving = figures.driving[-1].outputs[-1]
    put(f"area {driving.area:.3f}, expected error {driving.expected_error:.3f}, largest {driving.largest_error:.3f}")
    put(f"page: {options.output / PAGES[options.detector]}")
    return FINE


def _road_files(given: list[Path]) -> list[Path]:
    found: list[Path] = []
    for one in given or [maps_folder()]:
        if not one.exists():
            raise WrongUse(f"there is no file or folder '{one}'")
        files = [one] if one.is_file() else files_in(one, ".xodr", deep=True)
        if not files:
            raise WrongUse(f"there is no road file (.xodr) in '{one}'")
        found += files
    if len({one.stem for one in found}) < len(found):
        raise WrongUse("two of the maps have the same name")
    return found


def _check_left_out(names: list[str], maps: list[str]) -> None:
    """Refuse, before anything is measured, to leave out maps that were not given, or all of them."""
    from scenario_compiler.perception.calibration.cross_fit import copies_of

    for name in names:
        if name not in maps:
            hint = did_you_mean(name, maps)
            raise WrongUse(f"--leave-out {name}: there is no such map{f'; {hint}' if hint else ''}")
    for name in names:
        if len(copies_of(name, maps)) == len(maps):
            raise WrongUse(f"--leave-out {name}: there is no other map to which the confidence could be fitted")


def _shown(done: int, total: int) -> None:
    if done % 50 == 0:
        complain(f"{done} of {total} parts are done")
