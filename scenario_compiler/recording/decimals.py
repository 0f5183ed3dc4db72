"""Numbers as text that is read back as the same bits."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


def shortest(number: float) -> str:
    """Return the shortest decimal that is read back as the same float; whole numbers have no point, -0 becomes 0."""
    text = repr(float(number) + 0.0)
    return text[:-2] if text.endswith(".0") else text


def shortest_of(numbers: NDArray[np.float64]) -> list[str]:
    """Return `shortest` of each number of an array with one axis."""
    return [text[:-2] if text.endswith(".0") else text for text in map(repr, (numbers + 0.0).tolist())]


def to_the_nanosecond(t: float) -> float:
    """Return a time, s, without the rounding errors of its sum of steps: 13.65 for 13.649999999999999."""
    return round(t, 9)
