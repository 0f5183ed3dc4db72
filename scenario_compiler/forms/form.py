"""The common interface of both forms, and the choice between them."""

from __future__ import annotations

import importlib
from typing import Any, Protocol

from scenario_compiler.forms.arrays import as_arrays
from scenario_compiler.forms.compiled import Compiled
from scenario_compiler.forms.machine_code import MachineCode, library


class Form(Protocol):
    """Containers, and the entries that are called with them.

    Attributes:
        name: What the form is called.
        containers: The containers as the form has them, with lists or with arrays, by the arguments that take them.
    """

    name: str
    containers: dict[str, Any]

    def enter(self, entry: str, *arguments: Any) -> Any:
        """Call an entry with the containers that it takes and further arguments; EngineError where it breaks off."""
        ...


def form_of(
    entries: str, *, interpreted: bool = False, machine_code: MachineCode | None = None, **containers: Any
) -> Form:
    """Return the compiled form, or the interpreted one where that is asked for or there is no machine code.

    Args:
        entries: The module that lists the functions which are called; the interpreted form alone imports it.
        interpreted: Whether the interpreted form is asked for.
        machine_code: The library to use in place of the package's own.
        **containers: The containers, of lists, by the arguments that take them. The compiled form copies them into
            arrays, unless they keep their columns in both forms.
    """
    made = None if interpreted else machine_code or library()
    if made is not None:
        return Compiled(made, **{argument: as_arrays(container) for argument, container in containers.items()})
    from scenario_compiler.forms.interpreted import Interpreted

    return Interpreted(importlib.import_module(entries).ENTRIES, **containers)
