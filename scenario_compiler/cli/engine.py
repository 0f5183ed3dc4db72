"""`prewarm`: the compiled engine, made ready."""

from __future__ import annotations

import argparse

from scenario_compiler.cli.options import FINE, Commands
from scenario_compiler.cli.terminal import put, tell


def add(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser("prewarm", help="compile the engine into the cache")
    parser.set_defaults(command=prewarm_command)


def prewarm_command(options: argparse.Namespace) -> int:
    """Compile the engine into the cache, so that later commands find it there."""
    del options
    from scenario_compiler.engine.build import warm

    warm(say=tell)
    put("the compiled engine is ready")
    return FINE
