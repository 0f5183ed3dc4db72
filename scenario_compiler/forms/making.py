"""Makes the machine code: writes one C file and compiles it with the machine's compiler.

This is done by the build hook for a wheel, by `make setup` in a checkout, and by `python -m
scenario_compiler.forms.making` at any time. A note beside the library lists its sources, so that a library that is
older than they are is detected.

A module that runs typical sweeps can be named. gcc then makes the engine twice: the first library counts how often each
branch is taken in these sweeps, and with the counts gcc arranges the code of the second. The results are the same to
the byte, and a step takes 0.85 of the time. Other compilers make the engine once.
"""

from __future__ import annotations

import argparse
import importlib.util
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from scenario_compiler.forms.note import LIBRARY, NOTE, PACKAGE, Note, digest_of, source_names

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

COUNTING = ("-fprofile-generate",)
COUNTED = ("-fprofile-use", "-fprofile-partial-training")
"""The flags of gcc's two libraries. What typical sweeps do not call is compiled as if there were no counts."""

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


def version() -> str:
    """Return the compiler's name and version; raises NoCompilerError."""
    command = compiler()
    done = subprocess.run([*command, "--version"], capture_output=True, text=True, check=False)
    return done.stdout.partition("\n")[0].strip() or command[0]


def build(text: str, library: Path, *more: str) -> None:
    """Compile C to a shared library.

    Args:
        text: The C.
        library: The file to write; it is replaced in one step, and only if the compiler succeeds.
        *more: Further arguments of the compiler.

    Raises:
        NoCompilerError: There is no compiler.
        BuildError: The compiler failed.
    """
    with tempfile.TemporaryDirectory(dir=library.parent) as folder:
        _compile(text, Path(folder) / library.name, *more).replace(library)


def _compile(text: str, library: Path, *more: str) -> Path:
    """Write the C beside a library, and the library; gcc's counts, which have its name, lie there too."""
    source = library.with_name("engine.c")
    source.write_text(text, encoding="utf-8")
    command = [*compiler(), *FLAGS, *WARNINGS, *more, str(source), "-o", str(library), "-lm"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise BuildError(f"{' '.join(compiler())} failed:\n{done.stderr[-4000:]}")
    return library


def _can_be_guided(sweeps: str) -> bool:
    """Return whether the compiler counts branches, as gcc does, and the packages that the sweeps need are installed."""
    done = subprocess.run([*compiler(), "-v"], capture_output=True, text=True, check=False)
    return "gcc version" in done.stderr and _succeeds(sweeps, "--help")


def _succeeds(module: str, *arguments: str) -> bool:
    command = [sys.executable, "-m", module, *arguments]
    return subprocess.run(command, capture_output=True, cwd=PACKAGE.parent, check=False).returncode == 0


def _build_guided(text: str, library: Path, note: Note, sweeps: str) -> bool:
    """Compile C with the counts of its branches in typical sweeps; return whether that succeeded."""
    with tempfile.TemporaryDirectory(dir=library.parent) as folder:
        made, noted = Path(folder) / library.name, Path(folder) / NOTE.name
        note.write(noted)
        try:
            if not _succeeds(sweeps, str(_compile(text, made, *COUNTING)), str(noted)):
                return False
            _compile(text, made, *COUNTED).replace(library)
        except BuildError:
            return False
    return True


def make(*, noting_sources: bool = True, sweeps: str = "") -> Note:
    """Translate the marked functions, build the library and write its note.

    Args:
        noting_sources: Whether the note lists the sources, so that changes of them are detected, as in a checkout.
        sweeps: The module that runs typical sweeps in a library; it is given the library and the note on it. Where it
            or gcc cannot be used, the library is made without.

    Raises:
        NotTranslatableError: A marked function uses what the engine's language does not have.
        NoCompilerError: There is no compiler.
        BuildError: The compiler failed.
    """
    from scenario_compiler.forms.language import FunctionSource, entries, marked_functions
    from scenario_compiler.forms.translation import translated

    called = entries()
    text = translated(marked_functions(), called)
    kinds = {}
    for function in called:
        signature = FunctionSource.of(function).signature
        kinds[function.__name__] = [str(kind) for kind in (*signature.arguments.values(), signature.result)]
    sources = {
        name: (path.stat().st_size, path.stat().st_mtime_ns, digest_of(path))
        for name, path in ((name, PACKAGE / name) for name in (source_names() if noting_sources else ()))
    }
    note = Note(version(), kinds, sources)
    if sweeps and _can_be_guided(sweeps) and _build_guided(text, LIBRARY, note, sweeps):
        note = note._replace(guided=True)
    else:
        build(text, LIBRARY)
    note.write()
    return note


def main() -> int:
    """Make the library unless it is up to date, and write to stderr which form of the engine there is.

    Returns:
        The exit code: 1 if there is a C compiler and it fails.
    """
    parser = argparse.ArgumentParser(description="Make the engine's machine code unless it is up to date.")
    parser.add_argument("sweeps", nargs="?", default="", help="module that runs typical sweeps, which guide gcc")
    sweeps = parser.parse_args().sweeps
    note = Note.read()
    try:
        if note is None or not note.is_fresh or (sweeps and not note.guided and _can_be_guided(sweeps)):
            note = make(sweeps=sweeps)
    except NoCompilerError as error:
        sys.stderr.write(f"the engine runs interpreted: {error}\n")
    except BuildError as error:
        sys.stderr.write(f"the engine cannot be built: {error}\n")
        return 1
    else:
        guided = ", guided by typical sweeps" if note.guided else ""
        sys.stderr.write(f"the engine runs as C, built by {note.made_by}{guided}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
