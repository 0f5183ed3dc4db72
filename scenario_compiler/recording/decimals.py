"""Numbers as text that is read back as the same bits."""

from __future__ import annotations


def shortest(number: float) -> str:
    """Return the shortest decimal that is read back as the same float; whole numbers have no point, -0 becomes 0."""
    text = repr(float(number) + 0.0)
    return text[:-2] if text.endswith(".0") else text


def to_the_nanosecond(t: float) -> float:
    """Return a time, s, without the rounding errors of its sum of steps: 13.65 for 13.649999999999999."""
    return round(t, 9)
