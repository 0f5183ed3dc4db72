"""`validate`: check scenario and road files."""

from __future__ import annotations

import argparse
from pathlib import Path

from scenario_compiler.cli.options import AT_FAULT, FINE, Commands, WrongUse, add_diagnostics, add_maps, judged, show
from scenario_compiler.diagnostics import Diagnostics, Severity


def add(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser("validate", help="check scenario and road files")
    parser.add_argument("paths", nargs="+", type=Path, metavar="PATH", help="file or folder")
    add_maps(parser)
    add_diagnostics(parser)
    parser.add_argument("--strict", action="store_true", dest="strict_warnings", help="warnings are errors")
    parser.set_defaults(command=validate_command)


def validate_command(options: argparse.Namespace) -> int:
    """Check files, or all files of folders."""
    from scenario_compiler.compiler import files_below, validate_file

    sink = Diagnostics()
    files = [file for path in options.paths for file in files_below(path)]
    if not files:
        raise WrongUse("there is no .xml, .xosc or .xodr file to check")
    for file in files:
        validate_file(file, sink, options.maps)
    failed = show(sink, options)
    if options.format == "text":
        errors = sum(d.severity is Severity.ERROR for d in judged(sink, options))
        print(f"{len(files)} file{'s' * (len(files) != 1)} checked, {errors} error{'s' * (errors != 1)}")
    return AT_FAULT if failed else FINE
