"""`validate`: check scenario and road files."""

from __future__ import annotations

import argparse
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
    add_workers,
    judged,
    show,
)
from scenario_compiler.cli.terminal import put
from scenario_compiler.diagnostics import Diagnostic, Severity
from scenario_compiler.garbage_collection import keep_loaded
from scenario_compiler.structure.schemas import Schemas
from scenario_compiler.trust import Trust


def add(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser("validate", help="check scenario and road files")
    parser.add_argument("paths", nargs="*", type=Path, metavar="PATH", help="file, or folder with files")
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
        help="check OpenDRIVE and OpenSCENARIO files against ASAM's schemas in DIR too; without DIR, check "
        "OpenSCENARIO files by ASAM's own checker and its rules (needs the extra 'asam')",
    )
    parser.add_argument("--strict", action="store_true", dest="strict_warnings", help="treat warnings as errors")
    add_workers(parser)
    parser.set_defaults(command=validate_command)


def validate_command(options: argparse.Namespace) -> int:
    """Check files, and all files in folders."""
    from scenario_compiler.validation import files_below, validate_files

    keep_loaded()
    if not options.paths:
        raise WrongUse("name the files or folders to check; if --xsd stands without DIR, put it after them")
    for path in options.paths:
        whole, mark, name = str(path).partition("#")
        if mark and not path.exists() and Path(whole).is_file():
            raise WrongUse(f"files are checked as a whole: write {whole} without #{name}")
    files = list(dict.fromkeys(file for path in options.paths for file in files_below(path)))
    if not files:
        raise WrongUse("there is no .xml, .xosc or .xodr file to check")
    insisted = frozenset(options.error)
    checked = validate_files(files, options.maps, options.workers, options.xsd, insisted, Trust(tuple(options.trust)))
    found = list({one.identity: one for some in checked for one in some}.values())
    failed = show(found, options)
    if options.format == "text":
        put(summary(len(files), judged(found, options)))
    return AT_FAULT if failed else FINE


def _schemas_in(folder: str) -> Schemas:
    """Return the schemas of a folder that --xsd names."""
    if not Path(folder).is_dir():
        raise argparse.ArgumentTypeError(f"'{folder}' is not a folder; write --xsd DIR, or --xsd alone after the files")
    return Schemas(Path(folder))


def summary(files: int, found: Sequence[Diagnostic]) -> str:
    """Return one line with the numbers of files, errors, warnings and faulty files."""
    errors = sum(one.severity is Severity.ERROR for one in found)
    warnings = sum(one.severity is Severity.WARNING for one in found)
    parts = [f"{files} file{'s' * (files != 1)} checked", f"{errors} error{'s' * (errors != 1)}"]
    if warnings:
        parts.append(f"{warnings} warning{'s' * (warnings != 1)}")
    faulty = len({one.place.file for one in found if one.severity is Severity.ERROR})
    if faulty and files > 1:
        parts.append(f"{faulty} file{'s' * (faulty != 1)} at fault")
    return ", ".join(parts)
