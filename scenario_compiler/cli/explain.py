"""`explain`: the explanation of a diagnostic code."""

from __future__ import annotations

import argparse
import textwrap

from scenario_compiler.cli.options import FINE, Commands, WrongUse
from scenario_compiler.cli.terminal import put, put_raw
from scenario_compiler.diagnostics import CODES, code_named, suggestion


def add(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser("explain", help="explain a diagnostic code")
    parser.add_argument("code", metavar="CODE", help="code such as SC101")
    parser.set_defaults(command=explain_command)


def explain_command(options: argparse.Namespace) -> int:
    """Print the explanation of a diagnostic code."""
    code = code_named(options.code)
    if code is None:
        raise WrongUse(f"there is no code '{options.code}'{suggestion(options.code.upper(), CODES)}")
    put(f"{code.id} {code.name} ({code.severity.value})")
    put()
    parts = code.explanation.split("\n\n")
    put_raw("\n\n".join(part if part.startswith("    ") else textwrap.fill(part, 100) for part in parts))
    return FINE
