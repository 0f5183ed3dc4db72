"""<ParameterValueDistribution>: values of a scenario's parameters, listed or drawn.

All values of a <DistributionSet> and a <DistributionRange> are used, each with every value of the others. A
<ParameterValueSet> sets several parameters at once; an additional parameter counts the sets. Random values have the
distributions of the standard: the variance is that of the values, also for a lognormal distribution, and a range
truncates a distribution.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

from scenario_compiler.diagnostics import Diagnostics, Place
from scenario_compiler.expressions import format_value
from scenario_compiler.openscenario.codes import BAD_DISTRIBUTION, NOT_READ
from scenario_compiler.openscenario.contents import KINDS, Variation
from scenario_compiler.openscenario.node import Node
from scenario_compiler.openscenario.parameters import fits
from scenario_compiler.openscenario.scope import Bound
from scenario_compiler.vocabulary.variation import (
    FARTHEST,
    GREATEST_MEAN,
    Axis,
    Choice,
    Constraint,
    Grid,
    Histogram,
    Lognormal,
    Normal,
    Poisson,
    Uniform,
    Values,
    Vary,
    Weighted,
)

SETS = "parameter_set"
"""Name of the parameter that counts the first list of value sets."""

MOST_VALUES = 1_000_000
"""Greatest number of values of a range."""

NEGATIVE = "its weights must not be below 0"

AnyAxis: TypeAlias = Uniform | Normal | Lognormal | Poisson | Histogram | Values | Weighted | Grid
Limits: TypeAlias = tuple[float, float] | None


@dataclass
class _Found:
    axes: list[AnyAxis] = field(default_factory=list)
    constraints: list[Constraint] = field(default_factory=list)
    first: dict[str, str] = field(default_factory=dict)
    sets: dict[str, list[dict[str, str]]] = field(default_factory=dict)
    places: dict[str, Place] = field(default_factory=dict)


def read_variation(node: Node) -> Variation:
    """Return the variation that a <ParameterValueDistribution> describes."""
    found = _Found()
    samples: int | None = None
    seed: int | None = None
    node.required("Deterministic", "Stochastic")
    for group in node.children("Deterministic"):
        for one in group.elements():
            _add_listed(one, found)
    for group in node.children("Stochastic"):
        samples = max(1, group.integer("numberOfTestRuns", 1))
        seed = _seed(group)
        for one in group.children("StochasticDistribution"):
            _add_drawn(one, found)
    vary = Vary(samples=samples, seed=seed, axes=tuple(found.axes), constraints=tuple(found.constraints))
    return Variation(vary.written_at(node.origin), found.first, found.sets, found.places)


def _seed(node: Node) -> int | None:
    """Return the seed of the draws, None without one; the standard allows fractions."""
    if not node.has("randomSeed"):
        return None
    number = node.float("randomSeed")
    if number % 1.0 != 0.0:
        message = f"only the whole part of randomSeed has an effect on the draws: {int(number)}"
        node.report(NOT_READ, message, "randomSeed")
    return int(number)


def check_variation(variation: Variation, types: Mapping[str, str], sink: Diagnostics) -> None:
    """Report parameters that are varied twice, and values that do not have the type of their parameter.

    Args:
        variation: The variation.
        types: The ParameterType of each declared parameter by its name; others are reported elsewhere.
        sink: Receives the findings.
    """
    varied: set[str] = set()
    for axis in variation.vary.axes:
        sets = variation.sets.get(axis.parameter)
        names = {axis.parameter} if sets is None else {name for values in sets for name in values}
        for name in sorted(names & varied):
            sink.add(BAD_DISTRIBUTION, f"the parameter '{name}' is varied twice", axis.origin)
        varied |= names
        for name, text in _listed(variation, axis):
            if name in types and not fits(Bound(types[name], text), types[name]):
                message = f"'{text}', a value of '{name}', is not of the type {types[name]}"
                sink.add(BAD_DISTRIBUTION, message, axis.origin)
        if sets is None and axis.parameter in types and not isinstance(axis, Choice):
            _check_numbers(axis, types[axis.parameter], sink)


def _listed(variation: Variation, axis: Axis) -> list[tuple[str, str]]:
    """Return (parameter, value) of the values that an axis lists."""
    if axis.parameter in variation.sets:
        return [pair for values in variation.sets[axis.parameter] for pair in values.items()]
    return [(axis.parameter, text) for text in axis.of] if isinstance(axis, Choice) else []


def varied_values(variation: Variation) -> Iterator[tuple[str, str, Place]]:
    """Yield (parameter, value, place) of each listed value, and of the limits of ranges and of drawn values."""
    for axis in variation.vary.axes:
        listed = _listed(variation, axis)
        for name, text in listed or [(axis.parameter, format_value(number)) for number in axis.extent()]:
            yield name, text, axis.origin


def _check_numbers(axis: Axis, kind: str, sink: Diagnostics) -> None:
    """Report numbers that a parameter of a type cannot have."""
    numbers = KINDS.get(kind, "text")
    if numbers == "number":
        return
    counts = isinstance(axis, Poisson) or (
        isinstance(axis, Grid) and axis.first % 1.0 == 0.0 == (axis.last - axis.first) % max(axis.count - 1, 1)
    )
    if numbers == "text" or not counts:
        needed = "which only a list of values varies" if numbers == "text" else "which needs whole numbers"
        sink.add(BAD_DISTRIBUTION, f"'{axis.parameter}' is of the type {kind}, {needed}", axis.origin)


def _add_listed(node: Node, found: _Found) -> None:
    if node.tag == "DeterministicMultiParameterDistribution":
        sets = [
            {one.text("parameterRef").lstrip("$"): one.text("value") for one in given.children("ParameterAssignment")}
            for group in node.children("ValueSetDistribution")
            for given in group.children("ParameterValueSet")
        ]
        _add_sets(node, SETS, sets, found)
        return
    name = node.text("parameterName").lstrip("$")
    inner = node.required("DistributionSet", "DistributionRange", "UserDefinedDistribution")
    if inner is None:
        return
    found.places[name] = node.place("parameterName")
    if inner.tag == "DistributionSet":
        values = [one.text("value") for one in inner.children("Element")]
        if values and all(_is_plain(value) for value in values):
            found.axes.append(Values(parameter=name, of=tuple(values)).written_at(inner.origin))
            found.first[name] = values[0]
        else:
            _add_sets(inner, f"{name}_number", [{name: value} for value in values], found)
    elif inner.tag == "DistributionRange":
        _add_range(inner, name, found)
    else:
        _report_user_defined(inner)


def _is_plain(value: str) -> bool:
    """Return whether a value is allowed in a comma-separated list."""
    return value != "" and value == value.strip() and not set(value) & set(",()")


def _add_sets(node: Node, name: str, sets: list[dict[str, str]], found: _Found) -> None:
    if not sets:
        node.report(BAD_DISTRIBUTION, f"<{node.tag}> contains no value")
        return
    number = 1
    while (counter := name if number == 1 else f"{name}_{number}") in found.sets:
        number += 1
    found.sets[counter] = sets
    last = float(len(sets) - 1)
    found.axes.append(Grid(parameter=counter, first=0.0, last=last, count=len(sets)).written_at(node.origin))
    for values in sets:
        found.places.update(dict.fromkeys(values, node.origin))


def _add_range(node: Node, name: str, found: _Found) -> None:
    limits = _range(node)
    step = node.float("stepWidth")
    if limits is None or limits[0] > limits[1] or step <= 0.0 or (limits[1] - limits[0]) / step > MOST_VALUES:
        message = (
            "a range needs an upper limit that is not below the lower one, a step above 0, and at most "
            f"{MOST_VALUES} steps"
        )
        node.report(BAD_DISTRIBUTION, message)
        return
    count = math.floor((limits[1] - limits[0]) / step + 1e-9) + 1
    last = limits[0] + (count - 1) * step
    axis = Grid(parameter=name, first=limits[0], last=last, count=count)
    found.axes.append(axis.written_at(node.origin))
    found.first[name] = format_value(limits[0])


def _range(node: Node) -> Limits:
    """Return the limits of a <Range> below a node; None without one."""
    inner = node.child("Range")
    return None if inner is None else (inner.float("lowerLimit"), inner.float("upperLimit"))


def _limits(node: Node) -> Limits:
    """Return the limits of a <Range> below a node; None without one, and if they are in the wrong order (reported)."""
    limits = _range(node)
    if limits is None or limits[0] <= limits[1]:
        return limits
    message = f"the range from {format_value(limits[0])} to {format_value(limits[1])} falls"
    node.report(BAD_DISTRIBUTION, message)
    return None


def _add_drawn(node: Node, found: _Found) -> None:
    name = node.text("parameterName").lstrip("$")
    inner = node.first()
    if inner is None or inner.tag not in _DRAWN:
        if inner is None or inner.tag != "UserDefinedDistribution":
            node.required(*_DRAWN)
        else:
            _report_user_defined(inner)
        return
    found.places[name] = node.place("parameterName")
    axis = _DRAWN[inner.tag](inner, name)
    fault = axis if isinstance(axis, str) else axis.fault()[1]
    if isinstance(axis, str) or fault:
        inner.report(BAD_DISTRIBUTION, f"<{inner.tag}> cannot be sampled: {fault}")
        return
    found.axes.append(axis.written_at(inner.origin))
    if isinstance(axis, Poisson):
        found.constraints += _constraints(inner, name)


def _report_user_defined(node: Node) -> None:
    node.read_whole()
    message = (
        f"the distribution '{node.text('type', '')}' is defined by another program only; the parameter keeps its value"
    )
    node.report(BAD_DISTRIBUTION, message)


def _constraints(node: Node, name: str) -> Iterator[Constraint]:
    limits = _limits(node)
    if limits is not None:
        holds = f"${name} >= {format_value(limits[0])} and ${name} <= {format_value(limits[1])}"
        yield Constraint(holds=holds).written_at(node.origin)


def _uniform(node: Node, name: str) -> Uniform | str:
    limits = _range(node)
    if limits is None or limits[0] > limits[1]:
        return "it needs a <Range> whose upper limit is not below the lower one"
    return Uniform(parameter=name, least=limits[0], greatest=limits[1])


def _normal(node: Node, name: str) -> Normal | str:
    mean, variance = node.float("expectedValue"), node.float("variance")
    least, greatest = _limits(node) or (None, None)
    if variance <= 0.0:
        return "its variance must be above 0"
    return Normal(parameter=name, mean=mean, deviation=math.sqrt(variance), least=least, greatest=greatest)


def _lognormal(node: Node, name: str) -> Lognormal | str:
    """Return the distribution; a lower limit that is not above 0 cuts nothing off, as one far below the median does."""
    mean, variance = node.float("expectedValue"), node.float("variance")
    least, greatest = _limits(node) or (None, None)
    if mean <= 0.0 or variance <= 0.0:
        return "its expected value and its variance must be above 0"
    if variance / mean > MOST_VALUES * mean:
        return "its variance is too great for its expected value"
    if greatest is not None and greatest <= 0.0:
        return "its range contains no value above 0"
    spread = math.log1p(variance / mean / mean)
    mu, sigma = math.log(mean) - spread / 2.0, math.sqrt(spread)
    if least is not None and least <= 0.0:
        least = max(math.exp(mu - FARTHEST * sigma), sys.float_info.min)
    return Lognormal(parameter=name, mu=mu, sigma=sigma, least=least, greatest=greatest)


def _poisson(node: Node, name: str) -> Poisson | str:
    mean = node.float("expectedValue")
    if not 0.0 < mean <= GREATEST_MEAN:
        return f"its expected value must be above 0 and at most {GREATEST_MEAN}"
    limits = _limits(node)
    if limits is not None and math.ceil(limits[0]) > limits[1]:
        return "its range contains no whole number"
    return Poisson(parameter=name, mean=mean)


def _histogram(node: Node, name: str) -> Histogram | str:
    bins = [(_limits(one), one.float("weight")) for one in node.children("Bin")]
    edges: list[float] = []
    weights: list[float] = []
    for limits, weight in sorted((limits, weight) for limits, weight in bins if limits is not None):
        if edges and limits[0] < edges[-1]:
            return f"its bins overlap below {format_value(edges[-1])}"
        if edges and limits[0] > edges[-1]:
            edges.append(limits[0])
            weights.append(0.0)
        edges += [limits[1]] if edges else [limits[0], limits[1]]
        weights.append(weight)
    if not weights:
        return "it needs a <Bin> with a <Range>"
    return NEGATIVE if min(weights) < 0.0 else Histogram(parameter=name, edges=tuple(edges), weights=tuple(weights))


def _weighted(node: Node, name: str) -> Weighted | str:
    elements = [(one.text("value"), one.float("weight")) for one in node.children("Element")]
    if not elements or not all(_is_plain(value) for value, _ in elements):
        return "it needs values without commas, parentheses and outer blanks"
    values, weights = zip(*elements, strict=True)
    return NEGATIVE if min(weights) < 0.0 else Weighted(parameter=name, of=values, weights=weights)


_DRAWN: dict[str, Callable[[Node, str], AnyAxis | str]] = {
    "UniformDistribution": _uniform,
    "NormalDistribution": _normal,
    "LogNormalDistribution": _lognormal,
    "PoissonDistribution": _poisson,
    "Histogram": _histogram,
    "ProbabilityDistributionSet": _weighted,
}
