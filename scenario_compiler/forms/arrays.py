"""Containers as the compiled form takes them: arrays of float64 and int64, and the addresses of their numbers."""

from __future__ import annotations

import ctypes
from array import array
from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Any, TypeVar

from scenario_compiler.forms.declaration import Container, column_types


def as_arrays(container: Container) -> Container:
    """Return a container of the same type whose columns are copies, as arrays of float64 and int64."""
    made = object.__new__(type(container))
    for name in column_types(type(container)):
        setattr(made, name, array(type_code(type(container), name), getattr(container, name)))
    return made


def type_code(container: type[Any], column: str) -> str:
    """Return the type of a column's numbers as `array` spells it: "d" for float64, "q" for int64."""
    return "d" if column_types(container)[column] else "q"


Both = TypeVar("Both", bound="BothForms")


class BothForms:
    """A container that keeps its columns in both forms, as lists and as arrays; each is made when it is first needed.

    The columns must not change once the arrays have been asked for.
    """

    __slots__ = ("_arrays",)
    _arrays: Any

    @classmethod
    def of_arrays(cls: type[Both], arrays: Both) -> Both:
        """Return a container of lists, each of which is made of the array when it is first asked for."""
        made = object.__new__(cls)
        made._arrays = arrays
        return made

    def in_arrays(self: Both) -> Both:
        """Return the container whose columns are arrays."""
        arrays: Both | None = self._arrays
        if arrays is None:
            arrays = self._arrays = as_arrays(self)
        return arrays

    def with_columns(self: Both, columns: Mapping[str, Sequence[float]]) -> Both:
        """Return a container with some columns replaced, which shares the others in both forms."""
        arrays = object.__new__(type(self))
        made = self.of_arrays(arrays)
        for name in column_types(type(self)):
            if name in columns:
                setattr(arrays, name, array(type_code(type(self), name), columns[name]))
                continue
            setattr(arrays, name, getattr(self.in_arrays(), name))
            with suppress(AttributeError):
                setattr(made, name, object.__getattribute__(self, name))
        return made

    if not TYPE_CHECKING:  # a type checker knows the columns by their declarations

        def __getattr__(self, name: str) -> Any:
            """Return a column that has not been asked for as a list before."""
            if name == "_arrays":
                return None
            if name not in type(self).__slots__ or self._arrays is None:
                raise AttributeError(name)
            values = getattr(self._arrays, name).tolist()
            setattr(self, name, values)
            return values


def address_table(container: Any) -> array[int]:
    """Return a container of arrays as the compiled form takes it: its columns' addresses, then their lengths."""
    columns: list[array[float]] = [getattr(container, name) for name in column_types(type(container))]
    return array("q", [column.buffer_info()[0] for column in columns] + [len(column) for column in columns])


def address_and_size(values: Any) -> tuple[int, int]:
    """Return where an array's numbers lie, and how many there are.

    Raises:
        TypeError: The values are not float64 or int64, are not in one piece, or cannot be written.
    """
    if isinstance(values, array) and values.itemsize == 8:
        return values.buffer_info()
    view = memoryview(values)
    if not view.contiguous or view.format not in ("d", "l", "q") or view.itemsize != 8 or view.readonly:
        raise TypeError("an array for the engine is writable, in one piece, of float64 or int64")
    return (ctypes.addressof(ctypes.c_char.from_buffer(view)) if view.nbytes else 0), view.nbytes // view.itemsize
