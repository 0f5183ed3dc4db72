"""The compiled form, which runs machine code over arrays."""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Any

from scenario_compiler.forms.arrays import address_and_size, laid_out
from scenario_compiler.forms.failure import KINDS, EngineError
from scenario_compiler.forms.machine_code import SCALARS, MachineCode

Failure = ctypes.c_int64 * 3
"""What a failed entry writes: kind, line and the address of the file's name, as in engine.h."""


class Compiled:
    """The containers of arrays and the machine code that is called with them.

    Attributes:
        name: The name of the form.
        containers: The containers by argument name.
    """

    name = "compiled"

    def __init__(self, made: MachineCode, **containers: Any) -> None:
        """Copy the containers of lists by argument name to arrays; `BothForms` have their own."""
        laid = {argument: laid_out(container) for argument, container in containers.items()}
        self.containers = {argument: columns for argument, (columns, _) in laid.items()}
        self._made = made
        self._structs = {argument: struct for argument, (_, struct) in laid.items()}
        self._functions: dict[str, tuple[Any, list[int], Any]] = {}

    def _bound(self, entry: str) -> tuple[Any, list[int], Any]:
        """Return an entry's function, the addresses of its containers, and the ctypes type of its result."""
        *kinds, result = self._made.entries[entry]
        addresses = [self._structs[kind].buffer_info()[0] for kind in kinds if kind in self._structs]
        bound = self._functions[entry] = (self._made.function(entry), addresses, SCALARS.get(result))
        return bound

    def enter(self, entry: str, *arguments: Any) -> Any:
        """Call an entry and return its result.

        Args:
            entry: Its name.
            *arguments: Its arguments after the containers: numbers, and for arrays contiguous writable buffers of
                float64 or int64.

        Raises:
            EngineError: The entry's arithmetic had no result.
        """
        function, addresses, kind = self._functions.get(entry) or self._bound(entry)
        failure = Failure()
        given: list[Any] = [ctypes.addressof(failure), *addresses]
        for argument in arguments:
            if isinstance(argument, int | float):
                given.append(argument)
            else:
                given += address_and_size(argument)
        result = None if kind is None else kind()
        if result is not None:
            given.append(ctypes.addressof(result))
        if function(*given) != 0:
            number, line, file = failure
            raise EngineError(KINDS[number - 1], Path(ctypes.string_at(file).decode()).name, line)
        return None if result is None else result.value
