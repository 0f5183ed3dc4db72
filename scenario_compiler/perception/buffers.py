"""Arrays that are reused for each picture, because allocating memory takes longer than most computations in it."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

Number = TypeVar("Number", bound=np.generic)


class Buffers:
    """Arrays by name. Their contents are undefined until they are written; equal names are the same array."""

    def __init__(self) -> None:
        """Start without arrays."""
        self._arrays: dict[str, NDArray[Any]] = {}

    def get(self, name: str, shape: tuple[int, ...], kind: type[Number]) -> NDArray[Number]:
        """Return the array with a name; it is created at first use, and again for another shape."""
        array = self._arrays.get(name)
        if array is None or array.shape != shape:
            array = self._arrays[name] = np.empty(shape, kind)
        return array
