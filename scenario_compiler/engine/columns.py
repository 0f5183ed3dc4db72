"""The containers' columns as arrays of machine numbers, for the compiled form."""

from __future__ import annotations

from array import array
from typing import Any, TypeVar

Container = TypeVar("Container")
"""RoadTables, Program or State: slots that hold lists of float or of int."""


def column_types(container: type[Any]) -> dict[str, bool]:
    """Return for each column, in the order of the slots, whether it holds floats."""
    return {name: "float" in str(container.__annotations__[name]) for name in container.__slots__}


def as_buffers(container: Container) -> Container:
    """Return a container of the same type whose columns are copies, as arrays of float64 and int64."""
    made = object.__new__(type(container))
    for name, floats in column_types(type(container)).items():
        object.__setattr__(made, name, array("d" if floats else "q", getattr(container, name)))
    return made
