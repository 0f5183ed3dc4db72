"""The note on the built library: how it was made and of which sources, so that code older than its sources is noticed.

Every run reads it. Building is in `making.py`, which needs a compiler and the modules that call one.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

FORMS = Path(__file__).resolve().parent
PACKAGE = FORMS.parent

LIBRARY = FORMS / "engine.library"
"""The engine's machine code: a shared library without Python; its suffix is not that of a Python module."""

NOTE = FORMS / "engine.json"
"""Notes on the library: how it was made, from which sources, and its entries."""

SOURCE_FOLDERS = ("forms", "roads", "engine")
SOURCE_MODULES = ("marker.py", "randomness.py")
"""Folders and modules with the marked functions, their dependencies and the translator."""


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
    return stated.st_mtime_ns == time or digest_of(path) == digest


def digest_of(path: Path) -> str:
    """Return the SHA-256 of a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def source_files() -> Iterator[Path]:
    """Yield the files that the library is made of."""
    yield from (PACKAGE / name for name in SOURCE_MODULES)
    for folder in SOURCE_FOLDERS:
        yield from sorted((PACKAGE / folder).rglob("*.py"))
    yield FORMS / "engine.h"
