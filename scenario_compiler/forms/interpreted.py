"""The interpreted form, which runs the marked functions as Python over lists."""

from __future__ import annotations

from array import array
from collections.abc import Sequence
from typing import Any

from scenario_compiler.forms.failure import of_exception
from scenario_compiler.forms.language import Marked


class Interpreted:
    """The containers of lists and the Python functions that are called with them; it is the reference.

    Attributes:
        name: The name of the form.
        containers: The containers by argument name.
    """

    name = "interpreted"

    def __init__(self, entries: Sequence[Marked], **containers: Any) -> None:
        """Set the functions that may be called and the containers, whose columns are lists and are written to."""
        self.containers = containers
        self._functions = {function.__name__: self._bound(function) for function in entries}

    def _bound(self, function: Marked) -> tuple[Marked, tuple[object, ...]]:
        names = function.__code__.co_varnames[: function.__code__.co_argcount]
        return function, tuple(self.containers[name] for name in names if name in self.containers)

    def enter(self, entry: str, *arguments: Any) -> Any:
        """Call an entry and return its result.

        Args:
            entry: Its name.
            *arguments: Its arguments after the containers: numbers, and for arrays contiguous writable buffers of
                numbers.

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
