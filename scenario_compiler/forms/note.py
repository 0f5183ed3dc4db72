"""The note on the built library: its compiler and its sources, so that a library older than its sources is detected.

Every run reads it. Building is in `making.py`, which needs a compiler and the modules that call one.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

FORMS = Path(__file__).resolve().parent
PACKAGE = FORMS.parent

LIBRARY = FORMS / "engine.library"
"""The engine's machine code: a shared library that does not use Python; its suffix is not that of a Python module."""

NOTE = FORMS / "engine.json"
"""The note on the library: its compiler, its sources and its entries."""

SOURCE_FOLDERS = ("forms", "roads", "engine")
SOURCE_MODULES = (
    "marker.py",
    "randomness.py",
    "vocabulary/horizon.py",
    "vocabulary/kept.py",
    "vocabulary/lane_keeping.py",
)
"""Folders and modules with the marked functions, the modules of which they use numbers, and the translator."""


class Note(NamedTuple):
    """The note on a built library.

    Attributes:
        made_by: Name and version of the compiler.
        entries: The kinds of each entry's arguments, followed by that of its result.
        sources: Size, time of modification (ns) and SHA-256 of each source; empty for a library that is part of a
            wheel.
        guided: Whether the compiler was guided by typical sweeps.
    """

    made_by: str
    entries: dict[str, list[str]]
    sources: dict[str, tuple[int, int, str]]
    guided: bool = False

    @classmethod
    def read(cls, library: Path = LIBRARY, path: Path = NOTE) -> Note | None:
        """Return the note on a library; None if one of both is missing."""
        if not library.is_file() or not path.is_file():
            return None
        known: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        sources = {name: (size, time, digest) for name, (size, time, digest) in known["sources"].items()}
        return cls(known["made_by"], known["entries"], sources, known.get("guided", False))

    def write(self, path: Path = NOTE) -> None:
        """Write the note."""
        path.write_text(json.dumps(self._asdict(), indent=1) + "\n", encoding="utf-8")

    @property
    def is_fresh(self) -> bool:
        """Whether the sources are still those of which the library was made; always true in a wheel."""
        if not self.sources:
            return True
        now = {name: PACKAGE / name for name in source_names()}
        return now.keys() == self.sources.keys() and all(
            _is_the_same(now[name], *known) for name, known in self.sources.items()
        )


def _is_the_same(path: Path, size: int, time: int, digest: str) -> bool:
    stated = path.stat()
    if stated.st_size != size:
        return False
    return stated.st_mtime_ns == time or digest_of(path) == digest


def digest_of(path: Path) -> str:
    """Return the SHA-256 of a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def source_names() -> Iterator[str]:
    """Yield the names, in the package, of the files of which the library is made."""
    yield from SOURCE_MODULES
    for folder in SOURCE_FOLDERS:
        yield from sorted(_modules_in(PACKAGE / folder, folder))
    yield "forms/engine.h"


def _modules_in(folder: Path, name: str) -> Iterator[str]:
    """Yield the names of the modules in a folder and those below it; every run does this, and `rglob` takes longer."""
    with os.scandir(folder) as entries:
        for entry in entries:
            if entry.name.endswith(".py"):
                yield f"{name}/{entry.name}"
            elif entry.is_dir() and entry.name != "__pycache__":
                yield from _modules_in(folder / entry.name, f"{name}/{entry.name}")
