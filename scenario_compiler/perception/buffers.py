"""Arrays that are used again for each picture: fetching fresh memory costs more than most of what is computed in it."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

Number = TypeVar("Number", bound=np.generic)


class Buffers:
    """Arrays by their name. What is in one is undefined until it is written; one name is one array."""

    def __init__(self) -> None:
        """Begin with none."""
        self._arrays: dict[str, NDArray[Any]] = {}

    def get(self, name: str, shape: tuple[int, ...], kind: type[Number]) -> NDArray[Number]:
        """Return the array of a name; it is made when it is first asked for, and again for another shape."""
        array = self._arrays.get(name)
        if array is None or array.shape != shape:
            array = self._arrays[name] = np.empty(shape, kind)
        return array
