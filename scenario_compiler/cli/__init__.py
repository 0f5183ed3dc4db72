"""The command line, and the only package that prints.

Exit codes: 0 fine (warnings too), 1 the input is at fault, 2 wrong use, 3 criteria failed under --strict. One module a
group of commands: each has `add(commands)`, which declares them, and the functions that carry them out.
"""

from __future__ import annotations

import argparse
import gc
import os
import sys
from collections.abc import Sequence
from typing import NoReturn

from scenario_compiler.cli import (
    authoring,
    compare,
    coverage,
    editor,
    explain,
    export,
    library,
    maps,
    run,
    sweep,
    validate,
)
from scenario_compiler.cli.options import FINE, WRONG_USE, WrongUse, reason_of
from scenario_compiler.resources import templates_from

GROUPS = (validate, run, compare, sweep, authoring, library, export, maps, explain, coverage, editor)
"""Groups of commands, in the order of the help."""


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Run the command line and exit."""
    start_lightly()
    parser = make_parser()
    options = parser.parse_args(arguments)
    try:
        with templates_from([one for one in getattr(options, "templates", ()) if one is not None]):
            code = options.command(options)
        sys.stdout.flush()
    except WrongUse as fault:
        print(f"scenario-compiler: {fault}", file=sys.stderr)
        code = WRONG_USE
    except BrokenPipeError:
        sys.stderr.close()
        code = FINE
    except OSError as fault:
        print(f"scenario-compiler: {reason_of(fault)}", file=sys.stderr)
        code = WRONG_USE
        forget_stdout()
    sys.exit(code)


def forget_stdout() -> None:
    """Throw away what could not be printed, so that it is not tried again at the end."""
    try:
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def start_lightly() -> None:
    """Leave out what a command does not need: pydantic's search for plug-ins, and most rounds of the garbage collector.

    Both count in `validate` of one file; what a command loads and makes stays until its end anyhow.
    """
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    gc.set_threshold(100_000, 50, 50)


class ShowVersion(argparse.Action):
    """Prints the version and ends; it is looked up only then."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> NoReturn:
        """Print the name and the version of the program."""
        from importlib.metadata import version

        print(f"{parser.prog} {version('scenario-compiler')}")
        parser.exit()


def make_parser() -> argparse.ArgumentParser:
    """Return the parser of all commands."""
    parser = argparse.ArgumentParser(
        prog="scenario-compiler", description="Compile, check and run conflicts for automated driving."
    )
    parser.add_argument("--version", action=ShowVersion, nargs=0, help="print the version and exit")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for group in GROUPS:
        group.add(commands)
    return parser
