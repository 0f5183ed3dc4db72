"""The command line, called in this process."""

from __future__ import annotations

from scenario_compiler.cli import main


def call(*arguments: object) -> int:
    """Return the exit code of a command."""
    try:
        return main([str(argument) for argument in arguments])
    except SystemExit as left:
        return int(left.code or 0)
