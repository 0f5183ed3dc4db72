"""Numbers as text that reads back to the same bits."""

from __future__ import annotations


def shortest(number: float) -> str:
    """Return the shortest decimal that reads back to the same float; no point in whole numbers, no -0."""
    text = repr(float(number) + 0.0)
    return text[:-2] if text.endswith(".0") else text


def to_the_nanosecond(t: float) -> float:
    """Return a time, s, without the rounding of the steps that it is the sum of: 13.65 for 13.649999999999999."""
    return round(t, 9)
