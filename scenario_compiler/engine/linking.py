"""The compiled engine as one file of machine code: all functions are linked first and optimised once, with the entry.

On its own numba optimises and emits every function together with all that it calls, so that what lies deep in the
engine is compiled again for each function above it: four times the work.
"""

from __future__ import annotations

from typing import Any

from llvmlite import binding as llvm
from numba.core import codegen
from numba.core.registry import cpu_target

from scenario_compiler.engine.build import ENTRY_NAME

NOTHING_IS_FREED = "define void @NRT_MemInfo_call_dtor(ptr %owner) { unreachable }"
"""What numba's code calls for an array without users: never, as the engine's arrays have no owner that counts them."""


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
        """Link, optimise and emit the entry; leave any other function as it is. None of them is loaded."""
        if self.name == ENTRY_NAME:
            module = self._final_module
            (mangled,) = defined_in(module)
            module.get_function(mangled).name = ENTRY_NAME
            link_below(self, module)
            module.link_in(llvm.parse_assembly(NOTHING_IS_FREED))
            self._optimize_final_module()  # type: ignore[no-untyped-call]
            module.verify()
            made: Any = self._codegen
            made.machine_code = made._tm.emit_object(module)
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
    """Makes such libraries.

    Attributes:
        machine_code: The entry's, as the bytes of an object file; empty until it is emitted.
    """

    _library_class = LinkedOnce
    machine_code = b""

    def set_env(self, env_name: str, env: Any) -> None:
        """Leave a function's environment empty: no function is loaded, and none of ours looks into it."""


def machine_code_of(text: str) -> bytes:
    """Return a generated module's machine code, as the bytes of an object file that has `ENTRY_NAME`."""
    context = cpu_target.target_context
    usual = context.codegen()
    made = LinkedOnceCodegen("scenario_compiler.engine")  # type: ignore[no-untyped-call]
    context._internal_codegen = made
    try:
        exec(compile(text, "<compiled engine>", "exec"), {"__name__": "scenario_compiler.engine.compiled"})
    finally:
        context._internal_codegen = usual
    return made.machine_code
