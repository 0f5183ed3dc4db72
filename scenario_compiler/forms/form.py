"""The common interface of both forms, and the choice between them."""

from __future__ import annotations

import importlib
from typing import Any, Protocol

from scenario_compiler.forms.compiled import Compiled
from scenario_compiler.forms.machine_code import MachineCode, library


class Form(Protocol):
    """The containers, and the entries that are called with them.

    Attributes:
        name: The name of the form.
        containers: The containers by argument name, of lists or of arrays as the form needs them.
    """

    name: str
    containers: dict[str, Any]

    def enter(self, entry: str, *arguments: Any) -> Any:
        """Call an entry with its containers and further arguments, and return its result; EngineError if it fails."""
        ...


def form_of(
    entries: str, *, interpreted: bool = False, machine_code: MachineCode | None = None, **containers: Any
) -> Form:
    """Return the compiled form; the interpreted one if it is requested or there is no machine code.

    Args:
        entries: Name of the module whose ENTRIES are the functions to call; only the interpreted form imports it.
        interpreted: Whether the interpreted form is requested.
        machine_code: The library to use instead of the package's own.
        **containers: The containers of lists by argument name. The compiled form copies them to arrays, except for
            `BothForms`, which keep their arrays.
    """
    made = None if interpreted else machine_code or library()
    if made is not None:
        return Compiled(made, **containers)
    from scenario_compiler.forms.interpreted import Interpreted

    return Interpreted(importlib.import_module(entries).ENTRIES, **containers)
