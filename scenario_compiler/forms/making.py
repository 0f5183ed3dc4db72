"""Makes the machine code: writes one C file and compiles it with the machine's compiler.

This is done by the build hook for a wheel, by `make setup` in a checkout, and by `python -m
scenario_compiler.forms.making` at any time. A note beside the library lists its sources, so that a library that is
older than they are is detected.
"""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from scenario_compiler.forms.note import LIBRARY, PACKAGE, Note, digest_of, source_files

FLAGS = (
    *("-std=gnu11", "-O3", "-fwrapv", "-ffp-contract=off", "-fno-math-errno", "-fno-plt"),
    *("-fvisibility=hidden", "-finline-limit=200", "-shared", "-fPIC"),
)
"""Flags for which C gives Python's results: no contraction, no fast arithmetic, and wrapping integers, because those in
Python are masked. A missing result is detected from its value, so mathematical functions need not set `errno`. They are
called without a procedure linkage table, which saves a jump for each call. The engine's functions are small, so that a
call often costs more than its work: gcc inlines larger ones than by default, and a step takes 0.86 of the time. clang
ignores this limit and has its own.
"""

WARNINGS = ("-Wall", "-Wextra", "-Wno-unused-parameter", "-Wno-unused-function")


class NoCompilerError(Exception):
    """There is no C compiler on this machine."""

    def __init__(self) -> None:
        """Set the message, which tells the user what to install."""
        super().__init__("there is no C compiler: install gcc or clang, or `pip install ziglang`")


class BuildError(Exception):
    """The C compiler rejected the translated engine; the message has its output."""


def compiler() -> list[str]:
    """Return the command of the first of these C compilers that is found: $CC, gcc, clang, the Python package ziglang.

    Raises:
        NoCompilerError: None is found.
    """
    for name in (os.environ.get("CC", ""), "gcc", "clang"):
        if name and shutil.which(name):
            return [name]
    if importlib.util.find_spec("ziglang") is not None:
        return [sys.executable, "-m", "ziglang", "cc"]
    raise NoCompilerError


def build(text: str, library: Path, *more: str) -> str:
    """Compile C to a shared library; return the compiler's name and version.

    Args:
        text: The C.
        library: The file to write; it is replaced in one step, and only if the compiler succeeds.
        *more: Further arguments of the compiler.

    Raises:
        NoCompilerError: There is no compiler.
        BuildError: The compiler failed.
    """
    command = compiler()
    with tempfile.TemporaryDirectory(dir=library.parent) as folder:
        source, made = Path(folder) / "engine.c", Path(folder) / library.name
        source.write_text(text, encoding="utf-8")
        arguments = [*command, *FLAGS, *WARNINGS, *more, str(source), "-o", str(made), "-lm"]
        done = subprocess.run(arguments, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise BuildError(f"{' '.join(command)} failed:\n{done.stderr[-4000:]}")
        made.replace(library)
    version = subprocess.run([*command, "--version"], capture_output=True, text=True, check=False)
    return version.stdout.partition("\n")[0].strip() or command[0]


def make(*, noting_sources: bool = True) -> Note:
    """Translate the marked functions, build the library and write its note.

    Args:
        noting_sources: Whether the note lists the sources, so that changes of them are detected, as in a checkout.

    Raises:
        NotTranslatableError: A marked function uses what the engine's language does not have.
        NoCompilerError: There is no compiler.
        BuildError: The compiler failed.
    """
    from scenario_compiler.forms.language import FunctionSource, entries, marked_functions
    from scenario_compiler.forms.translation import translated

    called = entries()
    made_by = build(translated(marked_functions(), called), LIBRARY)
    kinds = {}
    for function in called:
        signature = FunctionSource.of(function).signature
        kinds[function.__name__] = [str(kind) for kind in (*signature.arguments.values(), signature.result)]
    sources = {
        path.relative_to(PACKAGE).as_posix(): (path.stat().st_size, path.stat().st_mtime_ns, digest_of(path))
        for path in (source_files() if noting_sources else ())
    }
    note = Note(made_by, kinds, sources)
    note.write()
    return note


def main() -> int:
    """Make the library unless it is up to date, and write to stderr which form of the engine there is.

    Returns:
        The exit code: 1 if there is a C compiler and it fails.
    """
    note = Note.read()
    try:
        if note is None or not note.is_fresh:
            note = make()
    except NoCompilerError as error:
        sys.stderr.write(f"the engine runs interpreted: {error}\n")
    except BuildError as error:
        sys.stderr.write(f"the engine cannot be built: {error}\n")
        return 1
    else:
        sys.stderr.write(f"the engine runs as C, built by {note.made_by}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
