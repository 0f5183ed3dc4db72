"""The containers' columns as arrays, for the compiled form."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np

Container = Any
"""An instance of RoadTables, Program or State: slots that hold lists of float or of int."""


def column_types(container: type[Container]) -> dict[str, bool]:
    """Return for each column, in the order of the slots, whether it holds floats."""
    return {name: "float" in str(container.__annotations__[name]) for name in container.__slots__}


def as_arrays(container: Container) -> tuple[np.ndarray, ...]:
    """Return copies of the columns, in the order of the slots, as arrays of float64 and int64."""
    import numpy as np

    return tuple(
        np.array(getattr(container, name), dtype=np.float64 if floats else np.int64)
        for name, floats in column_types(type(container)).items()
    )
