"""Distributions of a parameter: parsing their notation, and computing their quantiles.

A distribution is written as a call: `uniform(5, 40)`, `choice(10, 20, 30)`, `grid(1, 10, 4)`. It is drawn from by its
quantile function alone, so that every sampling method works with every distribution.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from statistics import NormalDist
from typing import Literal

from scenario_compiler.diagnostics import suggestion
from scenario_compiler.expressions import WHOLE_BELOW, Value, format_value
from scenario_compiler.vocabulary.grammar import outside
from scenario_compiler.vocabulary.scenario import ParameterKind
from scenario_compiler.vocabulary.variation import GREATEST_MEAN, in_far_tail
from scenario_compiler.vocabulary.word import AttributeSpelling

ValueKind = Literal["number", "boolean", "text"]


class SweepError(ValueError):
    """A sweep is not possible as requested; the message gives the reason."""


@dataclass(frozen=True)
class Distribution:
    """The distribution of a parameter's values.

    Attributes:
        text: Its spelling, normalised.
        kind: Type of its values.
        quantile: Returns the value at a probability in the open interval (0, 1).
        points: All its values in order if it is a list of values; empty otherwise.
        listed: Whether each value is used in turn and not drawn: a grid.
        limits: The range of the uniform distribution, in which a search looks.
        extent: Values that it takes or comes arbitrarily close to, with the least and the greatest; empty if it is
            unbounded.
    """

    text: str
    kind: ValueKind
    quantile: Callable[[float], Value]
    points: tuple[Value, ...] = ()
    listed: bool = False
    limits: tuple[float, float] | None = None
    extent: tuple[Value, ...] = ()


def parse_distribution(text: str) -> Distribution:
    """Parse the spelling of a distribution; SweepError when it is not one."""
    match = re.fullmatch(r"\s*([a-z]+)\s*\((.*)\)\s*", text, re.DOTALL)
    if match is None or match.group(1) not in DISTRIBUTIONS:
        hint = suggestion("" if match is None else match.group(1), DISTRIBUTIONS)
        raise SweepError(f"'{text}' is not a distribution{hint}")
    name, inside = match.groups()
    parts = tuple(part.strip() for part in inside.split(","))
    if parts == ("",):
        raise SweepError(f"{name}() needs arguments: {USAGE[name]}")
    normalised = f"{name}({', '.join(parts)})"
    if name == "choice":
        return _choice(normalised, parts)
    if name == "values":
        return replace(_choice(normalised, parts), listed=True)
    if name == "weighted":
        return _weighted(normalised, parts)
    try:
        numbers = [float(part) for part in parts]
    except ValueError:
        raise SweepError(f"the arguments of '{normalised}' are not all numbers: {USAGE[name]}") from None
    if not all(math.isfinite(number) for number in numbers):
        raise SweepError(f"the arguments of '{normalised}' are not all finite")
    return DISTRIBUTIONS[name](normalised, numbers)


def misfit(axis: Distribution, kind: ParameterKind) -> str:
    """Return the distributions that fit a parameter of a kind, if the given one does not; otherwise empty."""
    if kind in ("text", "boolean"):
        fits = axis.kind == "boolean" if kind == "boolean" else bool(axis.points)
        values = "true, false" if kind == "boolean" else "value, value, ..."
        return "" if fits else f"choice({values}) or values({values})"
    if axis.kind != "number":
        return "numbers only"
    counts = axis.text.startswith("poisson") or (
        axis.points and all(float(value) % 1.0 == 0.0 and abs(float(value)) < WHOLE_BELOW for value in axis.points)
    )
    if kind == "integer" and not counts:
        return "whole numbers: choice(1, 2, ...), values(1, 2, ...), grid(first, last, count) or poisson(mean)"
    return ""


def beyond(axis: Distribution, limits: AttributeSpelling) -> str:
    """Return a value of a distribution that is outside the limits, and the requirement; empty if all are within."""
    for value in axis.extent:
        fault = outside(value, limits) if isinstance(value, float) else ""
        if fault:
            return f"{format_value(value)}, but must be {fault}"
    return ""


def value_of(text: str) -> Value:
    """Return the parameter's value for a text: a truth value, a number, or else the text."""
    if text in ("true", "false"):
        return text == "true"
    try:
        number = float(text)
    except ValueError:
        return text
    return number if math.isfinite(number) else text


def _need(good: bool, text: str) -> None:
    if not good:
        raise SweepError(f"'{text}' is not possible: {USAGE[text.partition('(')[0]]}")


def _choice(text: str, parts: Sequence[str]) -> Distribution:
    values = tuple(value_of(part) for part in parts)
    _need("" not in parts, text)
    kinds = {type(value) for value in values}
    if kinds == {float}:
        kind: ValueKind = "number"
    elif kinds == {bool}:
        kind = "boolean"
    else:
        kind, values = "text", tuple(parts)

    def quantile(u: float) -> Value:
        return values[min(int(u * len(values)), len(values) - 1)]

    return Distribution(text, kind, quantile, values, extent=values)


def _weighted(text: str, parts: Sequence[str]) -> Distribution:
    weights = [value_of(part) for part in parts[1::2]]
    _need(len(parts) % 2 == 0 and all(isinstance(one, float) and one >= 0.0 for one in weights), text)
    shares = [one for one in weights if isinstance(one, float)]
    _need(sum(shares) > 0.0, text)
    plain = _choice(text, parts[::2])
    ends = [sum(shares[: k + 1]) / sum(shares) for k in range(len(shares))]
    last = max(k for k, share in enumerate(shares) if share > 0.0)

    def quantile(u: float) -> Value:
        return plain.points[next((k for k, end in enumerate(ends) if u < end), last)]

    likely = tuple(value for value, share in zip(plain.points, shares, strict=True) if share > 0.0)
    return Distribution(text, plain.kind, quantile, plain.points, extent=likely)


def _grid(text: str, numbers: Sequence[float]) -> Distribution:
    _need(len(numbers) == 3 and numbers[2] == int(numbers[2]) and 1 <= numbers[2] <= 1e7, text)
    low, high, count = numbers[0], numbers[1], int(numbers[2])
    values = (*(low + (high - low) * k / (count - 1) for k in range(count - 1)), high if count > 1 else low)

    def quantile(u: float) -> Value:
        return values[min(int(u * count), count - 1)]

    return Distribution(text, "number", quantile, values, listed=True, extent=(low, high)[:count])


def _uniform(text: str, numbers: Sequence[float]) -> Distribution:
    _need(len(numbers) == 2 and numbers[0] <= numbers[1], text)
    low, high = numbers
    return Distribution(text, "number", lambda u: low + (high - low) * u, limits=(low, high), extent=(low, high))


def _bounded(text: str, mean: float, deviation: float, limits: Sequence[float]) -> Callable[[float], float]:
    """Return the quantiles of a normal distribution cut off at limits.

    Limits above the mean are mirrored to below it: probabilities near 1 would have no digits left.
    """
    if not limits:
        return NormalDist(mean, deviation).inv_cdf
    if in_far_tail(mean, deviation, limits):
        raise SweepError(f"'{text}' is not possible: its limits are too many standard deviations away from its mean")
    low, high = ((limit - mean) / deviation for limit in limits)
    side = -1.0 if low > 0.0 else 1.0
    ends = (-high, -low) if side < 0.0 else (low, high)
    below, above = (0.5 * math.erfc(-end / math.sqrt(2.0)) for end in ends)
    standard = NormalDist()

    def quantile(u: float) -> float:
        inside = below + (above - below) * (u if side > 0.0 else 1.0 - u)
        far = standard.inv_cdf(min(max(inside, 1e-300), 1.0 - 1e-16))
        return min(max(mean + deviation * side * far, limits[0]), limits[1])

    return quantile


def _normal(text: str, numbers: Sequence[float]) -> Distribution:
    _need(len(numbers) in (2, 4) and numbers[1] > 0 and (len(numbers) == 2 or numbers[2] < numbers[3]), text)
    quantile = _bounded(text, numbers[0], numbers[1], numbers[2:])
    return Distribution(text, "number", quantile, extent=tuple(numbers[2:]))


def _lognormal(text: str, numbers: Sequence[float]) -> Distribution:
    _need(len(numbers) in (2, 4) and numbers[1] > 0 and (len(numbers) == 2 or 0 < numbers[2] < numbers[3]), text)
    inner = _bounded(text, numbers[0], numbers[1], [math.log(limit) for limit in numbers[2:]])
    return Distribution(text, "number", lambda u: math.exp(inner(u)), extent=tuple(numbers[2:]))


def _triangular(text: str, numbers: Sequence[float]) -> Distribution:
    _need(len(numbers) == 3 and numbers[0] <= numbers[1] <= numbers[2] and numbers[0] < numbers[2], text)
    low, mode, high = numbers
    span, share = high - low, (mode - low) / (high - low)

    def quantile(u: float) -> Value:
        if u < share:
            return low + math.sqrt(u * span * (mode - low))
        return high - math.sqrt((1.0 - u) * span * (high - mode))

    return Distribution(text, "number", quantile, extent=(low, high))


def _poisson(text: str, numbers: Sequence[float]) -> Distribution:
    _need(len(numbers) == 1 and 0 < numbers[0] <= GREATEST_MEAN, text)
    mean = numbers[0]

    def quantile(u: float) -> Value:
        k, term = 0, math.exp(-mean)
        total = term
        while total < u and k < 10 * (mean + 10):
            k += 1
            term *= mean / k
            total += term
        return float(k)

    return Distribution(text, "number", quantile)


def _histogram(text: str, numbers: Sequence[float]) -> Distribution:
    edges, weights = list(numbers[::2]), list(numbers[1::2])
    good = len(numbers) >= 3 and len(numbers) % 2 == 1 and sorted(set(edges)) == edges
    _need(good and min(weights) >= 0 and sum(weights) > 0, text)
    whole = sum(weights)
    filled = [k for k, weight in enumerate(weights) if weight > 0]

    def quantile(u: float) -> Value:
        below = u * whole
        for k in filled[:-1]:
            if below < weights[k]:
                return edges[k] + (edges[k + 1] - edges[k]) * below / weights[k]
            below -= weights[k]
        k = filled[-1]
        return edges[k] + (edges[k + 1] - edges[k]) * min(below / weights[k], 1.0)

    return Distribution(text, "number", quantile, extent=(edges[filled[0]], edges[filled[-1] + 1]))


DISTRIBUTIONS: dict[str, Callable[[str, Sequence[float]], Distribution]] = {
    "uniform": _uniform,
    "normal": _normal,
    "lognormal": _lognormal,
    "triangular": _triangular,
    "poisson": _poisson,
    "histogram": _histogram,
    "choice": lambda text, numbers: _choice(text, [format_value(number) for number in numbers]),
    "values": lambda text, numbers: _choice(text, [format_value(number) for number in numbers]),
    "weighted": lambda text, numbers: _weighted(text, [format_value(number) for number in numbers]),
    "grid": _grid,
}
"""The distributions by name."""

USAGE = {
    "uniform": "uniform(least, greatest)",
    "normal": "normal(mean, deviation) or normal(mean, deviation, least, greatest), the deviation above 0",
    "lognormal": "lognormal(mu, sigma) of the logarithm, or with limits above 0: lognormal(mu, sigma, least, greatest)",
    "triangular": "triangular(least, most likely, greatest)",
    "poisson": f"poisson(mean), the mean above 0 and at most {GREATEST_MEAN}",
    "histogram": "histogram(edge, weight, edge, weight, ..., edge) with rising edges",
    "choice": "choice(value, value, ...)",
    "values": "values(value, value, ...)",
    "weighted": "weighted(value, weight, value, weight, ...), one of the weights above 0",
    "grid": "grid(first, last, count)",
}
"""The notation of each distribution."""
