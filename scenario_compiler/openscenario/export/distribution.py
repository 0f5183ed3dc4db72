"""The variation of a scenario, as a <ParameterValueDistribution> for the exported file."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection
from typing import Any

from lxml import etree

from scenario_compiler.expressions import format_value
from scenario_compiler.openscenario.export.header import file_header
from scenario_compiler.openscenario.output import Output
from scenario_compiler.openscenario.spelling import made
from scenario_compiler.vocabulary.variation import (
    Axis,
    Choice,
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


def export_variation(
    vary: Vary, parameters: Collection[str], scenario_file: str, output: Output
) -> etree._Element | None:
    """Return the <OpenSCENARIO> element of a distribution of parameter values; if that is impossible, report it.

    Args:
        vary: The variation of the scenario.
        parameters: Names of the parameters that the exported scenario declares.
        scenario_file: The exported scenario, as the file is to name it.
        output: The context for writing.
    """
    if output.version == (1, 0):
        output.tell_lost(vary, "<ParameterValueDistribution> is not known before 1.1")
        return None
    for constraint in vary.constraints:
        output.tell_lost(constraint, f"the constraint '{constraint.holds}' between parameters cannot be expressed")
    axes = [one for one in vary.axes if _is_said(one, parameters, output)]
    drawn = [one for one in axes if type(one) in _DRAWN]
    listed = [one for one in axes if type(one) in _LISTED]
    for one in listed if drawn else []:
        output.tell_lost(one, f"'{one.parameter}' is not varied: values are either all drawn or all listed")
    if not axes:
        return None
    values = _stochastic(vary, drawn) if drawn else _deterministic(listed)
    distribution = made("ParameterValueDistribution", made("ScenarioFile", filepath=scenario_file), values)
    return made("OpenSCENARIO", file_header(f"Variation of {scenario_file}", output), distribution)


def _is_said(axis: Axis, parameters: Collection[str], output: Output) -> bool:
    if axis.parameter not in parameters:
        output.tell_lost(axis, f"'{axis.parameter}' changes the structure, so it is fixed in the exported file")
        return False
    if type(axis) not in _DRAWN and type(axis) not in _LISTED:
        output.tell_lost(axis, f"OpenSCENARIO has no distribution such as <{axis.tag()}>")
        return False
    if isinstance(axis, Lognormal) and output.version < (1, 2):
        output.tell_lost(axis, "<LogNormalDistribution> is not known before 1.2")
        return False
    return True


def _stochastic(vary: Vary, axes: list[Any]) -> etree._Element:
    element = made("Stochastic", numberOfTestRuns=str(vary.samples or 1))
    if vary.seed is not None:
        element.set("randomSeed", str(vary.seed))
    for one in axes:
        element.append(made("StochasticDistribution", _DRAWN[type(one)](one), parameterName=one.parameter))
    return element


def _deterministic(axes: list[Any]) -> etree._Element:
    inner = [
        made("DeterministicSingleParameterDistribution", _LISTED[type(one)](one), parameterName=one.parameter)
        for one in axes
    ]
    return made("Deterministic", *inner)


def _range(least: float, greatest: float) -> etree._Element:
    return made("Range", lowerLimit=format_value(least), upperLimit=format_value(greatest))


def _moments(tag: str, mean: float, variance: float, axis: Normal | Lognormal) -> etree._Element:
    element = made(tag, expectedValue=format_value(mean), variance=format_value(variance))
    if axis.least is not None and axis.greatest is not None:
        element.append(_range(axis.least, axis.greatest))
    return element


def _normal(axis: Normal) -> etree._Element:
    return _moments("NormalDistribution", axis.mean, axis.deviation**2, axis)


def _lognormal(axis: Lognormal) -> etree._Element:
    """Return the distribution by the mean and variance of the values, where ours has those of their logarithm."""
    mean = math.exp(axis.mu + axis.sigma**2 / 2.0)
    return _moments("LogNormalDistribution", mean, math.expm1(axis.sigma**2) * mean**2, axis)


def _histogram(axis: Histogram) -> etree._Element:
    bins = zip(axis.edges[:-1], axis.edges[1:], axis.weights, strict=True)
    return made(
        "Histogram", *(made("Bin", _range(low, high), weight=format_value(weight)) for low, high, weight in bins)
    )


def _weighted(axis: Choice) -> etree._Element:
    weights = axis.weights if isinstance(axis, Weighted) else (1.0,) * len(axis.of)
    elements = (
        made("Element", value=value, weight=format_value(weight))
        for value, weight in zip(axis.of, weights, strict=True)
    )
    return made("ProbabilityDistributionSet", *elements)


def _values(axis: Values) -> etree._Element:
    return made("DistributionSet", *(made("Element", value=value) for value in axis.of))


def _grid(axis: Grid) -> etree._Element:
    if axis.count == 1 or axis.last <= axis.first:
        steps = max(axis.count - 1, 1)
        values = [axis.first + (axis.last - axis.first) * k / steps for k in range(axis.count)]
        return made("DistributionSet", *(made("Element", value=format_value(value)) for value in values))
    step = (axis.last - axis.first) / (axis.count - 1)
    return made("DistributionRange", _range(axis.first, axis.last), stepWidth=format_value(step))


_DRAWN: dict[type[Axis], Callable[[Any], etree._Element]] = {
    Uniform: lambda axis: made("UniformDistribution", _range(axis.least, axis.greatest)),
    Normal: _normal,
    Lognormal: _lognormal,
    Poisson: lambda axis: made("PoissonDistribution", expectedValue=format_value(axis.mean)),
    Histogram: _histogram,
    Choice: _weighted,
    Weighted: _weighted,
}
"""Distributions of axes that are drawn."""

_LISTED: dict[type[Axis], Callable[[Any], etree._Element]] = {Values: _values, Grid: _grid}
"""Lists of axes that are tried value by value."""
