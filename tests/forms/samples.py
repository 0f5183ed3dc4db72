"""Functions written like the engine's marked ones, from which a test builds a small library of its own."""

from __future__ import annotations

from math import acos, ceil, exp, floor, log, sin, sqrt

from scenario_compiler.engine.columns.state import State

NUMBERS = (2.5, -1.0, 7.25)
"""A table of numbers."""


def real_arithmetic(a: float, b: float, out: list[float]) -> None:
    """Calculate with two floats in every way that the language has."""
    out[0] = a + b
    out[1] = a - b * a
    out[2] = abs(a)
    out[3] = min(a, b)
    out[4] = max(a, b)
    out[5] = -a
    out[6] = 1.0 if a < b <= 3.0 or not a > b else 0.0
    out[7] = min(a, b, 0.0)


def int_arithmetic(i: int, j: int, out: list[float]) -> None:
    """Calculate with two ints in every way that the language has; products stay below 2 to the power of 63."""
    out[0] = 1.0 * (i + j)
    out[1] = 1.0 * (i - 3 * j)
    out[2] = 1.0 * (((i & 4095) ^ (j & 4095)) | 64)
    out[3] = 1.0 * ((i & 65535) << 3)
    out[4] = 1.0 * (i >> 2)
    out[5] = 1.0 * max(i, j, 5)
    out[6] = 1.0 * abs(j)
    out[7] = 1.0 if i in (1, 2, j) else 0.0


def divides(a: float, b: float) -> float:
    """Divide; the comparison is for the guard alone."""
    return a / b if b < 1.0e308 else 0.0


def remainder(a: float, b: float) -> float:
    """Return Python's remainder of floats."""
    return a % b if b < 1.0e308 else 0.0


def int_quotient(i: int, j: int) -> int:
    """Return Python's quotient of ints."""
    return i // j if j < 1 << 60 else 0


def int_remainder(i: int, j: int) -> int:
    """Return Python's remainder of ints."""
    return i % j if j < 1 << 60 else 0


def root(a: float) -> float:
    """Return a root; the comparison is for the guard alone."""
    return sqrt(a) if a < 1.0e308 else 0.0


def logarithm(a: float) -> float:
    """Return a logarithm."""
    return log(a) if a < 1.0e308 else 0.0


def power_of_e(a: float) -> float:
    """Return e to the power of a number."""
    return exp(a) if a < 1.0e308 else 0.0


def sine(a: float) -> float:
    """Return a sine."""
    return sin(a)


def arc_cosine(a: float) -> float:
    """Return an arc cosine."""
    return acos(a) if a < 1.0e308 else 0.0


def whole(a: float) -> int:
    """Return what int, floor and ceil make of a float."""
    return int(a) + floor(a) + ceil(a) if a < 1.0e308 else 0


def element(st: State, i: int) -> float:
    """Return an element of a column."""
    return st.v[i]


def loops(count: int, out: list[float]) -> int:
    """Loop in every way that the language has; return how often."""
    done = 0
    for k in range(count, 0, -1):
        if k == 3:
            continue
        for step in (1, 10):
            done = done + step
    for k in range(2, count):
        done += k
        if done > 1000:
            break
    at = 0
    while at < len(out):
        out[at] = 1.0 * at
        at = at + 1
    return done


def two(a: float, i: int) -> tuple[float, int]:
    """Return two results."""
    return a + 1.0, i * 2


def takes_apart(a: float, i: int, out: list[float]) -> int:
    """Take two results apart and exchange two variables."""
    b, j = two(a, i)
    b, a = a, b
    out[0] = out[1] = a - b
    _, j = two(b, j)
    return j


def first(a: float, out: list[float]) -> int:
    """Write one, as the first of a table of functions."""
    out[0] = a
    return 1


def second(a: float, out: list[float]) -> int:
    """Write another number, as the second of a table of functions."""
    out[0] = -a
    return 2


CHOICES = (first, second)
"""A table of functions."""


def dispatches(which: int, a: float, out: list[float]) -> int:
    """Call one of a table's functions, and take one of a table's numbers."""
    done = CHOICES[which](a, out)
    out[1] = NUMBERS[which]
    return done


FUNCTIONS = (
    *(real_arithmetic, int_arithmetic, divides, remainder, int_quotient, int_remainder, root, logarithm),
    *(power_of_e, sine, arc_cosine, whole, element, loops, two, takes_apart, first, second, dispatches),
)
ENTRIES = tuple(function for function in FUNCTIONS if function is not two)
