"""Loads the library of machine code, or gives the reason why there is none."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

from scenario_compiler.forms.note import LIBRARY, Note

SCALARS = {"int": ctypes.c_int64, "real": ctypes.c_double}
"""The ctypes types of numbers by kind."""


class MachineCode:
    """A loaded library.

    Attributes:
        made_by: Name and version of the compiler that made it.
        entries: The kinds of each entry's arguments, followed by that of its result.
    """

    def __init__(self, path: Path, entries: Mapping[str, list[str]], made_by: str) -> None:
        """Load the library.

        Args:
            path: The library.
            entries: The kinds of each entry's arguments, followed by that of its result.
            made_by: Name and version of the compiler that made it.

        Raises:
            OSError: It cannot be loaded.
        """
        self.made_by = made_by
        self.entries = entries
        self._library = ctypes.CDLL(str(path))

    def function(self, entry: str) -> Any:
        """Return the function of an entry, with its argument types set."""
        *arguments, result = self.entries[entry]
        types: list[Any] = [ctypes.c_void_p]
        for kind in arguments:
            types += [SCALARS[kind]] if kind in SCALARS else [ctypes.c_void_p]
            types += [ctypes.c_int64] if kind in ("ints", "reals") else []
        if result in SCALARS:
            types.append(ctypes.c_void_p)
        function = self._library[f"enter_{entry}"]
        function.argtypes = types
        function.restype = ctypes.c_int32
        return function


@lru_cache(maxsize=1)
def library() -> MachineCode | None:
    """Return the package's library; None if there is none, it cannot be loaded, or it is older than its sources."""
    note = Note.read()
    if note is None or not note.is_fresh:
        return None
    try:
        return MachineCode(LIBRARY, note.entries, note.made_by)
    except OSError:
        return None


def why_interpreted() -> str:
    """Return why there is no compiled form and what to do about it; empty if there is one."""
    if library() is not None:
        return ""
    note = Note.read()
    if note is None:
        return "the engine's machine code has not been built: `make setup` in a checkout, with gcc, clang or ziglang"
    return (
        "the engine's machine code is older than its sources: `make setup` builds it again"
        if not note.is_fresh
        else "the engine's machine code cannot be loaded on this machine"
    )
