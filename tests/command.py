"""The command line, called in this process."""

from __future__ import annotations

import pytest

from scenario_compiler.cli import main


def call(*arguments: object) -> int:
    """Return the exit code of a command."""
    with pytest.raises(SystemExit) as left:
        main([str(argument) for argument in arguments])
    assert isinstance(left.value.code, int)
    return left.value.code
