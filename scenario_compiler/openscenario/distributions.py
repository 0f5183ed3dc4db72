"""<ParameterValueDistribution>: values of a scenario's parameters, listed or drawn.

All values of a <DistributionSet> and a <DistributionRange> are used, each with every value of the others. A
<ParameterValueSet> sets several parameters at once; an additional parameter counts the sets. Random values have the
distributions of the standard: the variance is that of the values, also for a lognormal distribution, and a range
truncates a distribution.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import TypeAlias

from scenario_compiler.diagnostics import Place
from scenario_compiler.expressions import format_value
from scenario_compiler.openscenario.codes import BAD_DISTRIBUTION
from scenario_compiler.openscenario.contents import Variation
from scenario_compiler.openscenario.node import Node
from scenario_compiler.vocabulary.variation import (
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
        seed = group.integer("randomSeed", 1) if group.has("randomSeed") else None
        for one in group.children("StochasticDistribution"):
            _add_drawn(one, found)
    vary = Vary(samples=samples, seed=seed, axes=tuple(found.axes), constraints=tuple(found.constraints))
    return Variation(vary.written_at(node.origin), found.first, found.sets, found.places)


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
    limits = _limits(node)
    step = node.float("stepWidth")
    if limits is None or step <= 0.0 or (limits[1] - limits[0]) / step > MOST_VALUES:
        node.report(
            BAD_DISTRIBUTION, "a range needs an upper limit above the lower one, and a step above 0 that fits into it"
        )
        return
    count = math.floor((limits[1] - limits[0]) / step + 1e-9) + 1
    last = limits[0] + (count - 1) * step
    axis = Grid(parameter=name, first=limits[0], last=last, count=count)
    found.axes.append(axis.written_at(node.origin))
    found.first[name] = format_value(limits[0])


def _limits(node: Node) -> Limits:
    """Return the limits of a <Range> below a node; None without one, and if they are in the wrong order (reported)."""
    inner = node.child("Range")
    if inner is None:
        return None
    low, high = inner.float("lowerLimit"), inner.float("upperLimit")
    if low > high:
        inner.report(BAD_DISTRIBUTION, f"the range from {format_value(low)} to {format_value(high)} falls")
        return None
    return low, high


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
    fault = "it lacks limits or values" if axis is None else axis.fault()[1]
    if axis is None or fault:
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


def _uniform(node: Node, name: str) -> Uniform | None:
    limits = _limits(node)
    return None if limits is None else Uniform(parameter=name, least=limits[0], greatest=limits[1])


def _normal(node: Node, name: str) -> Normal | None:
    mean, variance = node.float("expectedValue"), node.float("variance")
    least, greatest = _limits(node) or (None, None)
    if variance <= 0.0:
        return None
    return Normal(parameter=name, mean=mean, deviation=math.sqrt(variance), least=least, greatest=greatest)


def _lognormal(node: Node, name: str) -> Lognormal | None:
    mean, variance = node.float("expectedValue"), node.float("variance")
    least, greatest = _limits(node) or (None, None)
    if mean <= 0.0 or variance <= 0.0 or variance / mean > MOST_VALUES * mean:
        return None
    spread = math.log1p(variance / mean / mean)
    mu = math.log(mean) - spread / 2.0
    return Lognormal(parameter=name, mu=mu, sigma=math.sqrt(spread), least=least, greatest=greatest)


def _poisson(node: Node, name: str) -> Poisson | None:
    mean = node.float("expectedValue")
    return Poisson(parameter=name, mean=mean) if 0.0 < mean <= 500.0 else None


def _histogram(node: Node, name: str) -> Histogram | None:
    bins = [(_limits(one), one.float("weight")) for one in node.children("Bin")]
    edges: list[float] = []
    weights: list[float] = []
    for limits, weight in sorted((limits, weight) for limits, weight in bins if limits is not None):
        if edges and limits[0] > edges[-1]:
            edges.append(limits[0])
            weights.append(0.0)
        edges += [limits[1]] if edges else [limits[0], limits[1]]
        weights.append(max(0.0, weight))
    return Histogram(parameter=name, edges=tuple(edges), weights=tuple(weights)) if weights else None


def _weighted(node: Node, name: str) -> Weighted | None:
    elements = [(one.text("value"), max(0.0, one.float("weight"))) for one in node.children("Element")]
    if not elements or not all(_is_plain(value) for value, _ in elements):
        return None
    values, weights = zip(*elements, strict=True)
    return Weighted(parameter=name, of=values, weights=weights)


_DRAWN: dict[str, Callable[[Node, str], AnyAxis | None]] = {
    "UniformDistribution": _uniform,
    "NormalDistribution": _normal,
    "LogNormalDistribution": _lognormal,
    "PoissonDistribution": _poisson,
    "Histogram": _histogram,
    "ProbabilityDistributionSet": _weighted,
}
