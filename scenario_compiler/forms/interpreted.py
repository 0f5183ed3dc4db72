"""The interpreted form, which runs the marked functions as Python over lists."""

from __future__ import annotations

from array import array
from collections.abc import Sequence
from typing import Any

from scenario_compiler.forms.failure import of_exception
from scenario_compiler.forms.language import Marked


class Interpreted:
    """Containers of lists, and the functions that are called with them: the reference, which a debugger steps through.

    Attributes:
        name: What the form is called.
        containers: The containers, by the arguments that take them.
    """

    name = "interpreted"

    def __init__(self, entries: Sequence[Marked], **containers: Any) -> None:
        """Take the functions that may be called, and containers whose columns are lists; they are written to."""
        self.containers = containers
        self._functions = {function.__name__: self._bound(function) for function in entries}

    def _bound(self, function: Marked) -> tuple[Marked, tuple[object, ...]]:
        names = function.__code__.co_varnames[: function.__code__.co_argcount]
        return function, tuple(self.containers[name] for name in names if name in self.containers)

    def enter(self, entry: str, *arguments: Any) -> Any:
        """Call an entry; return its result.

        Args:
            entry: Its name.
            *arguments: What it takes beside the containers: numbers, and for arrays whatever has a writable buffer of
                numbers in one piece.

        Raises:
            EngineError: The entry's arithmetic had no result.
        """
        function, containers = self._functions[entry]
        lists = [one if isinstance(one, int | float) else memoryview(one).tolist() for one in arguments]
        try:
            result = function(*containers, *lists)
        except (ArithmeticError, ValueError, IndexError) as error:
            raise of_exception(error) from error
        for given, values in zip(arguments, lists, strict=True):
            if isinstance(values, list):
                view = memoryview(given)
                view[:] = array(view.format, values)
        return result
