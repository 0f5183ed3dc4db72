"""Containers for the compiled form: arrays of float64 and int64, and the addresses of their data."""

from __future__ import annotations

import ctypes
from array import array
from collections.abc import Mapping, Sequence
from copy import copy
from typing import Any, TypeVar

from scenario_compiler.forms.declaration import Columns, Container, column_types


def as_arrays(container: Container) -> Container:
    """Return a container of the same type whose columns are arrays of float64 and int64.

    The arrays are copies, except for `BothForms`, which keeps its own.
    """
    return container.in_arrays() if isinstance(container, BothForms) else _copied(container)


def _copied(container: Container) -> Container:
    made = object.__new__(type(container))
    for name in column_types(type(container)):
        setattr(made, name, array(type_code(type(container), name), getattr(container, name)))
    return made


def with_columns(arrays: Container, columns: Mapping[str, Sequence[float]]) -> Container:
    """Return a container of arrays in which some columns are replaced; it shares the other columns."""
    made = copy(arrays)
    for name, values in columns.items():
        setattr(made, name, array(type_code(type(arrays), name), values))
    return made


def type_code(container: type[Any], column: str) -> str:
    """Return the type code of a column for `array`: "d" for float64, "q" for int64."""
    return "d" if column_types(container)[column] else "q"


Both = TypeVar("Both", bound="BothForms")


class BothForms(Columns):
    """A container of lists that also keeps the container of arrays with the same columns, once it is asked for.

    It must not change after that.
    """

    __slots__ = ("_arrays",)
    _arrays: Any

    def __init__(self, **columns: Any) -> None:
        """Set the columns by name, as in `Columns`; the arrays are made later."""
        super().__init__(**columns)
        self._arrays = None

    @classmethod
    def of_arrays(cls: type[Both], arrays: Both) -> Both:
        """Return the container of lists with the columns of a container of arrays, which it keeps."""
        made = object.__new__(cls)
        made._arrays = arrays
        for name in column_types(cls):
            setattr(made, name, getattr(arrays, name).tolist())
        return made

    def in_arrays(self: Both) -> Both:
        """Return the container of arrays with the same columns; it is made at the first call."""
        if isinstance(getattr(self, next(iter(column_types(type(self))))), array):
            return self
        if self._arrays is None:
            self._arrays = _copied(self)
        arrays: Both = self._arrays
        return arrays


def address_table(container: Any) -> array[int]:
    """Return the addresses of the columns of a container of arrays, then their lengths: the container's struct in C."""
    columns: list[array[float]] = [getattr(container, name) for name in column_types(type(container))]
    return array("q", [column.buffer_info()[0] for column in columns] + [len(column) for column in columns])


def address_and_size(values: Any) -> tuple[int, int]:
    """Return the address of an array's data and the number of its elements.

    Raises:
        TypeError: The values are not float64 or int64, not contiguous, or read-only.
    """
    if isinstance(values, array) and values.itemsize == 8:
        return values.buffer_info()
    view = memoryview(values)
    if not view.contiguous or view.format not in ("d", "l", "q") or view.itemsize != 8 or view.readonly:
        raise TypeError("an array for the engine is writable, in one piece, of float64 or int64")
    return (ctypes.addressof(ctypes.c_char.from_buffer(view)) if view.nbytes else 0), view.nbytes // view.itemsize
