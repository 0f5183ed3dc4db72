"""The interpreted form: the marked functions as they stand in the source, over lists."""

from __future__ import annotations

from array import array
from collections.abc import Callable
from typing import Any

from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.columns.totals import Totals
from scenario_compiler.engine.forms.entries import ENTRIES
from scenario_compiler.engine.forms.failure import of_exception
from scenario_compiler.roads.tables import RoadTables


class Interpreted:
    """The engine as plain Python: the reference, and what a debugger can step through.

    Attributes:
        name: What the form is called.
        tables: The roads.
        program: The program; a sweep writes its numbers.
        state: The state.
        totals: The measures' totals.
    """

    name = "interpreted"

    def __init__(self, tables: RoadTables, program: Program, state: State, totals: Totals) -> None:
        """Take the containers, whose columns are lists; they are written to."""
        self.tables, self.program, self.state, self.totals = tables, program, state, totals
        self._functions = {function.__name__: self._bound(function) for function in ENTRIES}

    def _bound(self, function: Callable[..., Any]) -> tuple[Callable[..., Any], tuple[object, ...]]:
        containers = {"n": self.tables, "p": self.program, "st": self.state, "m": self.totals}
        names = function.__code__.co_varnames[: function.__code__.co_argcount]
        return function, tuple(containers[name] for name in names if name in containers)

    def enter(self, entry: str, *arguments: Any) -> Any:
        """Call an entry; return its result.

        Args:
            entry: Its name.
            *arguments: What it takes beside the containers: numbers, and for arrays whatever has a writable buffer of
                numbers in one piece.

        Raises:
            EngineError: The engine's arithmetic had no result.
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
