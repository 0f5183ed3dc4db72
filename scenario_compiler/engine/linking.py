"""The compiled engine as one module of machine code: all functions are linked first and optimised once, with the entry.

On its own numba optimises and emits every function together with all that it calls, so that what lies deep in the
engine is compiled again for each function above it: four times the work.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from numba.core import codegen
from numba.core.registry import cpu_target

ENTRY_NAME = "entry"
"""The function whose library is optimised and emitted, with all others."""


def libraries_below(library: Any) -> list[Any]:
    """Return the libraries that one needs, and those that they need, each once."""
    found: dict[int, Any] = {}
    waiting = list(library._linking_libraries)
    while waiting:
        one = waiting.pop()
        if id(one) not in found:
            found[id(one)] = one
            waiting.extend(one._linking_libraries if isinstance(one, LinkedOnce) else ())
    return list(found.values())


class LinkedOnce(codegen.JITCodeLibrary):
    """The code of a function alone; what it calls is linked where the entry is finalized."""

    def finalize(self) -> None:
        """Link, optimise and emit the entry; leave any other function as it is."""
        if self.name == ENTRY_NAME:
            link_below(self, self._final_module)
            self._linking_libraries = []
            super().finalize()  # type: ignore[no-untyped-call]
        self._finalized = True

    def _get_module_for_linking(self) -> Any:
        """Return the code with all that it needs, for a library of numba's own kind."""
        if self._shared_module is None:
            module = self._final_module.clone()
            shareable(module, link_below(self, module) | defined_in(module))
            self._shared_module = module
        return self._shared_module


def defined_in(module: Any) -> set[str]:
    """Return the names of the functions that a module gives to others."""
    functions = (one for one in module.functions if not one.is_declaration)
    return {one.name for one in functions if one.linkage.name == "external"}


def shareable(module: Any, names: set[str]) -> None:
    """Let functions be dropped where nothing needs them, and stand in more than one module."""
    for name in sorted(names):
        module.get_function(name).linkage = "linkonce_odr"


def link_below(library: LinkedOnce, module: Any) -> set[str]:
    """Link into a module all that a library needs; return the names of the functions, shareable now.

    They become so when all are there: what nothing needs yet would be dropped at once.
    """
    names: set[str] = set()
    for one in libraries_below(library):
        if isinstance(one, LinkedOnce):
            names |= defined_in(one._final_module)
            module.link_in(one._final_module, preserve=True)
    shareable(module, names)
    for one in libraries_below(library):
        if not isinstance(one, LinkedOnce):
            module.link_in(one._get_module_for_linking(), preserve=True)
    return names


class LinkedOnceCodegen(codegen.JITCPUCodegen):
    """Makes such libraries; the environments of functions that are not emitted alone stay empty, as from a cache."""

    _library_class = LinkedOnce

    def set_env(self, env_name: str, env: Any) -> None:
        """Set a function's environment where the function has been emitted."""
        engine: Any = self._engine
        if engine.is_symbol_defined(env_name):
            super().set_env(env_name, env)  # type: ignore[no-untyped-call]


@contextmanager
def linked_once() -> Iterator[None]:
    """Let numba compile what it is asked to in this context into one module."""
    context = cpu_target.target_context
    usual = context.codegen()
    context._internal_codegen = LinkedOnceCodegen("scenario_compiler.engine")  # type: ignore[no-untyped-call]
    try:
        yield
    finally:
        context._internal_codegen = usual
