"""Makes the machine code: writes one C file and builds it with the machine's compiler.

The code is made with the package: by the build hook for a wheel, by `make setup` in a checkout, and by
`python -m scenario_compiler.forms.making` at any time. Beside the library lies a note of what it was made of,
so that code which is older than its sources is noticed.
"""

from __future__ import annotations

import hashlib
import importlib.util
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

FORMS = Path(__file__).resolve().parent
PACKAGE = FORMS.parent

LIBRARY = FORMS / "engine.library"
"""The engine's machine code: a shared library that knows nothing of Python, by a name that is no module's."""

NOTE = FORMS / "engine.json"
"""What is known of the library: how it was made, of which sources, and which entries it has."""

FLAGS = (
    *("-std=gnu11", "-O3", "-fwrapv", "-ffp-contract=off", "-fno-math-errno"),
    *("-fvisibility=hidden", "-shared", "-fPIC"),
)
"""Two forms of one source: no contraction and no fast arithmetic, and whole numbers wrap as Python's are masked to.
Whether a function has a result is seen from what it returns, so that none needs to set `errno`."""

WARNINGS = ("-Wall", "-Wextra", "-Wno-unused-parameter", "-Wno-unused-function")

SOURCE_FOLDERS = ("forms", "roads", "engine")
SOURCE_MODULES = ("marker.py", "randomness.py")
"""Where the marked functions are, what they are made of, and what translates them."""


class NoCompilerError(Exception):
    """There is no C compiler on this machine."""

    def __init__(self) -> None:
        """Say what to do."""
        super().__init__("there is no C compiler: install gcc or clang, or `pip install ziglang`")


class BuildError(Exception):
    """A C compiler refused the translated engine; the text is what it said."""


@dataclass(frozen=True)
class Note:
    """What is known of a built library.

    Attributes:
        made_by: The compiler and its version.
        entries: The kinds of the arguments of each entry by its name, and last that of its result.
        sources: Size, time of change (ns) and SHA-256 of each source; empty for a library that is part of a wheel.
    """

    made_by: str
    entries: dict[str, list[str]]
    sources: dict[str, tuple[int, int, str]]

    @classmethod
    def read(cls) -> Note | None:
        """Return the note beside the library; None where there is no library."""
        if not LIBRARY.is_file() or not NOTE.is_file():
            return None
        known: dict[str, Any] = json.loads(NOTE.read_text(encoding="utf-8"))
        sources = {name: (size, time, digest) for name, (size, time, digest) in known["sources"].items()}
        return cls(known["made_by"], known["entries"], sources)

    def write(self, path: Path = NOTE) -> None:
        """Keep the note."""
        path.write_text(json.dumps(vars(self), indent=1) + "\n", encoding="utf-8")

    @property
    def is_fresh(self) -> bool:
        """Whether the sources are those that the library was made of."""
        if not self.sources:
            return True
        now = {path.relative_to(PACKAGE).as_posix(): path for path in source_files()}
        return now.keys() == self.sources.keys() and all(
            _is_the_same(now[name], *known) for name, known in self.sources.items()
        )


def _is_the_same(path: Path, size: int, time: int, digest: str) -> bool:
    stated = path.stat()
    if stated.st_size != size:
        return False
    return stated.st_mtime_ns == time or _digest(path) == digest


def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def source_files() -> Iterator[Path]:
    """Yield the files that the library is made of."""
    yield from (PACKAGE / name for name in SOURCE_MODULES)
    for folder in SOURCE_FOLDERS:
        yield from sorted((PACKAGE / folder).rglob("*.py"))
    yield FORMS / "engine.h"


def compiler() -> list[str]:
    """Return the command of a C compiler: $CC, gcc, clang, or that of the Python package ziglang.

    Raises:
        NoCompilerError: There is none.
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
        library: The file to write; it is there as a whole or not at all.
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
        noting_sources: Whether the library is held to the sources that it was made of, as in a checkout.

    Raises:
        NotTranslatableError: A marked function uses what the language of the engine lacks.
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
        path.relative_to(PACKAGE).as_posix(): (path.stat().st_size, path.stat().st_mtime_ns, _digest(path))
        for path in (source_files() if noting_sources else ())
    }
    note = Note(made_by, kinds, sources)
    note.write()
    return note


def main() -> int:
    """Make the library unless it is fresh, and say which form of the engine there is."""
    note = Note.read()
    try:
        if note is None or not note.is_fresh:
            note = make()
    except NoCompilerError as error:
        sys.stderr.write(f"the engine runs interpreted: {error}\n")
    else:
        sys.stderr.write(f"the engine runs as C, built by {note.made_by}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
