"""The compiled form: the engine's machine code, over arrays of machine numbers."""

from __future__ import annotations

import ctypes
from array import array
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

from scenario_compiler.engine.columns.declaration import as_buffers, column_types
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.columns.totals import Totals
from scenario_compiler.engine.forms.failure import KINDS, EngineError
from scenario_compiler.engine.forms.making import LIBRARY, Note
from scenario_compiler.roads.tables import RoadTables

CONTAINERS = ("n", "p", "st", "m")
SCALARS = {"int": ctypes.c_int64, "real": ctypes.c_double}


class MachineCode:
    """A built library of the engine, loaded.

    Attributes:
        made_by: The compiler that made it, and its version.
    """

    def __init__(self, path: Path, entries: Mapping[str, list[str]], made_by: str) -> None:
        """Load it.

        Args:
            path: The library.
            entries: The kinds of the arguments of each entry, and last that of its result.
            made_by: The compiler that made it.

        Raises:
            OSError: It cannot be loaded.
        """
        self.made_by = made_by
        self.entries = entries
        self._library = ctypes.CDLL(str(path))

    def function(self, entry: str) -> Any:
        """Return the function of an entry, typed."""
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
    """Return the engine's library; None where there is none, it cannot be loaded, or it is older than its sources."""
    note = Note.read()
    if note is None or not note.is_fresh:
        return None
    try:
        return MachineCode(LIBRARY, note.entries, note.made_by)
    except OSError:
        return None


def why_interpreted() -> str:
    """Return why there is no compiled form, and what to do about it; empty where there is one."""
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


class Compiled:
    """The engine as machine code.

    Attributes:
        name: What the form is called.
        tables: The roads, their columns as arrays.
        program: The program as arrays; a sweep writes its numbers.
        state: The state as arrays.
        totals: The measures' totals as arrays.
    """

    name = "compiled"

    def __init__(self, tables: RoadTables, program: Program, state: State, totals: Totals, made: MachineCode) -> None:
        """Copy the containers into arrays; they are not written to."""
        self.tables, self.program = as_buffers(tables), as_buffers(program)
        self.state, self.totals = as_buffers(state), as_buffers(totals)
        containers = dict(zip(CONTAINERS, (self.tables, self.program, self.state, self.totals), strict=True))
        self._addresses = {name: address_table(container) for name, container in containers.items()}
        self._failure = (ctypes.c_int64 * 3)()
        self._results = {"int": ctypes.c_int64(), "real": ctypes.c_double()}
        self._functions = {entry: self._bound(made, entry) for entry in made.entries}

    def _bound(self, made: MachineCode, entry: str) -> tuple[Any, tuple[int, ...], Any]:
        *kinds, result = made.entries[entry]
        taken = [self._addresses[kind].buffer_info()[0] for kind in kinds if kind in CONTAINERS]
        return made.function(entry), (ctypes.addressof(self._failure), *taken), self._results.get(result)

    def enter(self, entry: str, *arguments: Any) -> Any:
        """Call an entry; return its result.

        Args:
            entry: Its name.
            *arguments: What it takes beside the containers: numbers, and for arrays whatever has a writable buffer of
                float64 or int64 in one piece.

        Raises:
            EngineError: The engine's arithmetic had no result.
        """
        function, taken, result = self._functions[entry]
        given: list[float] = []
        for argument in arguments:
            given += (argument,) if isinstance(argument, int | float) else address_and_size(argument)
        if result is not None:
            given.append(ctypes.addressof(result))
        if function(*taken, *given) != 0:
            kind, line, file = self._failure
            path = ctypes.string_at(file).decode()
            raise EngineError(KINDS[kind - 1], Path(path).name, line)
        return None if result is None else result.value


def address_and_size(values: Any) -> tuple[int, int]:
    """Return where an array's numbers lie, and how many there are."""
    if isinstance(values, array):
        return values.buffer_info()
    view = memoryview(values)
    if not view.contiguous or view.format not in ("d", "l", "q") or view.itemsize != 8 or view.readonly:
        raise TypeError("an array for the engine is writable, in one piece, of float64 or int64")
    return (ctypes.addressof(ctypes.c_char.from_buffer(view)) if view.nbytes else 0), view.nbytes // view.itemsize


def address_table(container: Any) -> array[int]:
    """Return a container as the compiled form takes it: its columns' addresses, then their lengths."""
    columns: list[array[float]] = [getattr(container, name) for name in column_types(type(container))]
    return array("q", [column.buffer_info()[0] for column in columns] + [len(column) for column in columns])
