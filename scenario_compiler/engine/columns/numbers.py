"""Guarded arithmetic: the same value in both forms, and never an exception."""

from __future__ import annotations

from math import atan2, exp, pi, sqrt, tau

from scenario_compiler.marker import compiled

LARGEST = 1.0e15
"""Bound of every meaningful number: NaN or a greater absolute value is a fault."""

SAME_TIME = 1.0e-6
"""Greatest difference between two times that count as equal, s: more than the rounding of summed steps."""


@compiled
def is_number(value: float) -> int:
    """Return 1 if a value is finite and of sensible size, else 0; also 0 for NaN."""
    if value > -LARGEST and value < LARGEST:
        return 1
    return 0


@compiled
def clip(value: float, low: float, high: float) -> float:
    """Return the value, limited to the range from `low` to `high`."""
    if value < low:
        return low
    if value > high:
        return high
    return value


@compiled
def ratio(a: float, b: float, otherwise: float) -> float:
    """Return a / b, or `otherwise` if b is almost zero."""
    if b > 1.0e-9 or b < -1.0e-9:
        return a / b
    return otherwise


@compiled
def safe_sqrt(value: float) -> float:
    """Return the square root, or 0 for a value that is not positive."""
    if value > 0.0:
        return sqrt(value)
    return 0.0


@compiled
def logistic(logit: float) -> float:
    """Return the probability of a logit (the logistic function); logits are limited to -50 to 50."""
    return 1.0 / (1.0 + exp(clip(-logit, -50.0, 50.0)))


@compiled
def length_of(x: float, y: float) -> float:
    """Return the length of a vector in the plane."""
    return sqrt(x * x + y * y)


@compiled
def angle_between(a: float, b: float) -> float:
    """Return a - b reduced to (-pi, pi]."""
    around = (a - b) % tau
    if around > pi:
        return around - tau
    return around


@compiled
def bearing(x: float, y: float) -> float:
    """Return the direction of a vector, rad; 0 for the zero vector."""
    if x == 0.0 and y == 0.0:
        return 0.0
    return atan2(y, x)
