"""`validate`: check scenario and road files."""

from __future__ import annotations

import argparse
import os
from collections.abc import Sequence
from pathlib import Path

from scenario_compiler.cli.options import (
    AT_FAULT,
    FINE,
    Commands,
    WrongUse,
    add_diagnostics,
    add_maps,
    add_templates,
    add_trust,
    judged,
    keep_loaded,
    show,
)
from scenario_compiler.cli.terminal import put
from scenario_compiler.diagnostics import Diagnostic, Severity
from scenario_compiler.structure.schemas import Schemas
from scenario_compiler.trust import Trust


def available_cores() -> int:
    """Return the number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def add(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser("validate", help="check scenario and road files")
    parser.add_argument("paths", nargs="*", type=Path, metavar="PATH", help="file or folder")
    add_maps(parser)
    add_templates(parser)
    add_trust(parser)
    add_diagnostics(parser)
    parser.add_argument(
        "--xsd",
        type=_schemas_in,
        nargs="?",
        const=Schemas(),
        metavar="DIR",
        help="judge OpenDRIVE and OpenSCENARIO by ASAM's schemas in a folder; without DIR, OpenSCENARIO by ASAM's "
        "checker (the extra asam), with its rules",
    )
    parser.add_argument("--strict", action="store_true", dest="strict_warnings", help="warnings are errors")
    parser.add_argument(
        "--jobs", type=int, default=available_cores(), metavar="N", help="processes; one for each core when left out"
    )
    parser.set_defaults(command=validate_command)


def validate_command(options: argparse.Namespace) -> int:
    """Check files, or all files of folders."""
    from scenario_compiler.validation import files_below, validate_files

    keep_loaded()
    if not options.paths:
        raise WrongUse("name the files or folders to check, before --xsd if that names no folder")
    files = list(dict.fromkeys(file for path in options.paths for file in files_below(path)))
    if not files:
        raise WrongUse("there is no .xml, .xosc or .xodr file to check")
    insisted = frozenset(options.error)
    checked = validate_files(files, options.maps, options.jobs, options.xsd, insisted, Trust(tuple(options.trust)))
    found = [one for some in checked for one in some]
    failed = show(found, options)
    if options.format == "text":
        put(summary(len(files), judged(found, options)))
    return AT_FAULT if failed else FINE


def _schemas_in(folder: str) -> Schemas:
    """Return the schemas of a folder that --xsd names."""
    if not Path(folder).is_dir():
        raise argparse.ArgumentTypeError(f"'{folder}' is no folder; write --xsd alone after the files, or --xsd DIR")
    return Schemas(Path(folder))


def summary(files: int, found: Sequence[Diagnostic]) -> str:
    """Return one line on a number of files and what was found in them."""
    errors = sum(one.severity is Severity.ERROR for one in found)
    warnings = sum(one.severity is Severity.WARNING for one in found)
    parts = [f"{files} file{'s' * (files != 1)} checked", f"{errors} error{'s' * (errors != 1)}"]
    if warnings:
        parts.append(f"{warnings} warning{'s' * (warnings != 1)}")
    faulty = len({one.place.file for one in found if one.severity is Severity.ERROR})
    if faulty and files > 1:
        parts.append(f"{faulty} file{'s' * (faulty != 1)} at fault")
    return ", ".join(parts)
