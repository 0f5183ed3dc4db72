"""Starts the program as `scenario-compiler` or as `python -m scenario_compiler`.

It imports little, so that an interruption during the import of the command line ends like any other interruption.
"""

from __future__ import annotations

import os
import sys

INTERRUPTED = 130
"""Exit code of a program that Ctrl-C or SIGTERM ended: 128 plus the number of SIGINT, as in shells."""


def main() -> None:
    """Run the command line and exit; an interruption prints one line instead of a traceback."""
    try:
        from scenario_compiler.interruption import ignore_from_now_on, raise_when_ended

        raise_when_ended()
        import datetime  # noqa: F401  # pydantic's machine code takes an interruption of this import for a missing module

        start_lightly()
        from scenario_compiler.cli import main as run_command_line

        code = run_command_line()
        ignore_from_now_on()
    except KeyboardInterrupt:
        _say_interrupted()
        code = INTERRUPTED
    sys.exit(code)


def start_lightly() -> None:
    """Turn off what makes commands slow, before modules are loaded.

    These are pydantic's search for plug-ins, most rounds of the garbage collector, and the threads of numpy's linear
    algebra. Those threads wait in loops that take the processor: where other programs use the cores too, a fit of the
    confidence takes twenty times as long with two threads as with one, and its result depends on their number.
    """
    from scenario_compiler.garbage_collection import collect_seldom

    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    collect_seldom()


def _say_interrupted() -> None:
    """Write the line, if stderr takes it, without modules that may be imported only in part."""
    from contextlib import suppress

    from scenario_compiler.interruption import ignore_from_now_on

    ignore_from_now_on()
    with suppress(OSError):
        os.write(2, b"scenario-compiler: interrupted\n")


def _forget_current_folder() -> None:
    """Import nothing from the current folder, which `python -m` searches before Python's own library."""
    if not getattr(sys.flags, "safe_path", False):  # `python -P`, from 3.11 on, leaves it out already
        del sys.path[0]


if __name__ == "__main__":
    _forget_current_folder()
    main()
