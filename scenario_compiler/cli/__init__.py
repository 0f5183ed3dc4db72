"""The command line, and the only package that prints.

Exit codes: 0 fine (warnings too), 1 the input, the controller or the world is at fault or a run broke off, 2 wrong use,
3 criteria failed under --strict, 130 interrupted. One module a group of commands: each has `add(commands)`, which
declares them, and the functions that carry them out.
"""

from __future__ import annotations

import argparse
import gc
import os
from collections.abc import Sequence
from typing import NoReturn

from scenario_compiler.cli import (
    authoring,
    calibrate,
    carla,
    compare,
    coverage,
    editor,
    explain,
    export,
    library,
    live,
    maps,
    report,
    run,
    study,
    sweep,
    validate,
)
from scenario_compiler.cli.options import WRONG_USE, WrongUse, library_target, reason_of
from scenario_compiler.cli.terminal import complain, flush_streams, prepare_streams, put
from scenario_compiler.legible import legible
from scenario_compiler.resources import templates_from
from scenario_compiler.trust import ConfigurationError

GROUPS = (
    validate,
    run,
    live,
    study,
    report,
    compare,
    sweep,
    authoring,
    library,
    export,
    maps,
    calibrate,
    explain,
    coverage,
    editor,
    carla,
)
"""Groups of commands, in the order of the help."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command and return its exit code; without arguments, those of the program.

    Raises:
        SystemExit: The arguments cannot be parsed, or ask for help.
    """
    start_lightly()
    prepare_streams()
    options = make_parser().parse_args(arguments)
    try:
        with templates_from([one for one in getattr(options, "templates", ()) if one is not None]):
            if "target" in options:
                options.target = library_target(options.target)
            code: int = options.command(options)
        flush_streams()
    except (WrongUse, ConfigurationError) as fault:
        complain(fault)
        code = WRONG_USE
    except OSError as fault:
        complain(reason_of(fault))
        code = WRONG_USE
    return code


def start_lightly() -> None:
    """Leave out what a command does not need: pydantic's search for plug-ins, and most rounds of the garbage collector.

    Both count in `validate` of one file; what a command loads and makes stays until its end anyhow.
    """
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    gc.set_threshold(100_000, 50, 50)


class Parser(argparse.ArgumentParser):
    """A parser whose complaints are legible, whatever the arguments hold."""

    def error(self, message: str) -> NoReturn:
        """Say what is wrong with the arguments and exit with 2."""
        super().error(legible(message))


class ShowVersion(argparse.Action):
    """Prints the version and ends; it is looked up only then."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> NoReturn:
        """Print the name and the version of the program."""
        from importlib.metadata import version

        put(f"{parser.prog} {version('scenario-compiler')}")
        parser.exit()


def make_parser() -> argparse.ArgumentParser:
    """Return the parser of all commands."""
    parser = Parser(prog="scenario-compiler", description="Compile, check and run conflicts for automated driving.")
    parser.add_argument("--version", action=ShowVersion, nargs=0, help="print the version and exit")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for group in GROUPS:
        group.add(commands)
    return parser
