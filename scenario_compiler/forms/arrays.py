"""Containers for the compiled form: arrays of float64 and int64, and how they lie in memory."""

from __future__ import annotations

import ctypes
import struct
from array import array
from collections.abc import Mapping, Sequence
from copy import copy
from itertools import accumulate
from typing import Any, TypeVar

from scenario_compiler.forms.declaration import Columns, Container, column_types, columns_of


def _copied(container: Container) -> Container:
    made = object.__new__(type(container))
    for name in column_types(type(container)):
        setattr(made, name, _packed(type_code(type(container), name), getattr(container, name)))
    return made


def _packed(code: str, values: Sequence[float]) -> array[float]:
    """Return an array of the type with this code; packing takes less than half of the time of `array(code, values)`."""
    return array(code, struct.pack(f"{len(values)}{code}", *values))


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


def inside_struct(container: type[Any]) -> dict[str, int]:
    """Return the columns that lie inside of a container's struct in C, with their sizes, in order.

    These are the columns whose size is the same in every program. The struct of `BothForms`, whose columns are shared,
    has none, only addresses.
    """
    if issubclass(container, BothForms):
        return {}
    declared = columns_of(container).items()
    return {name: one.of.fixed for name, one in declared if one.of.fixed > 0 and one.starts is None}


def laid_out(container: Container) -> tuple[Container, array[int]]:
    """Return a container with arrays as its columns, and the memory that begins with its struct in C.

    The struct has the columns that lie inside of it, then the addresses of the others, then the lengths of all. The
    other columns follow in the same memory, so that the numbers which a step uses lie close together. The columns are
    copies, except for those of `BothForms`.

    Raises:
        ValueError: A column inside of the struct does not have the size that it has in every program.
    """
    if isinstance(container, BothForms):
        shared = container.in_arrays()
        columns: list[array[float]] = [getattr(shared, name) for name in column_types(type(shared))]
        return shared, array("q", [one.buffer_info()[0] for one in columns] + [len(one) for one in columns])
    types, inside = column_types(type(container)), inside_struct(type(container))
    beside = {name: len(getattr(container, name)) for name in types if name not in inside}
    sizes = inside | beside
    addresses = sum(inside.values())
    end = addresses + len(beside) + len(types)
    begins = dict(zip(inside, accumulate(inside.values(), initial=0), strict=False))
    begins |= zip(beside, accumulate(beside.values(), initial=end), strict=False)
    memory = array("q", bytes(8 * (end + sum(beside.values()))))
    base = memory.buffer_info()[0]
    memory[addresses:end] = array("q", [base + 8 * begins[name] for name in beside] + [sizes[name] for name in types])
    whole: dict[bool, Any] = {False: memoryview(memory), True: memoryview(memory).cast("B").cast("d")}
    made = object.__new__(type(container))
    for name, floats in types.items():
        view = whole[floats][begins[name] : begins[name] + sizes[name]]
        view[:] = array(view.format, getattr(container, name))
        setattr(made, name, view)
    return made, memory


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
