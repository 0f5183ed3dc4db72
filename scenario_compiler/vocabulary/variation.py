"""Variation: the parameters that a sweep varies, their distributions, and the condition that every variant meets."""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Literal

from scenario_compiler.expressions import format_value
from scenario_compiler.vocabulary.word import IDENTIFIER, Word, attribute, child

FARTHEST = 36.0
"""Greatest distance of both limits of a normal distribution from its mean, in standard deviations, on the same side.

The probability beyond it is below 1e-283, near the least numbers that can be computed with.
"""

GREATEST_MEAN = 500
"""Greatest mean of a Poisson distribution: its quantiles are summed up from exp(-mean)."""


def in_far_tail(mean: float, deviation: float, limits: Sequence[float]) -> bool:
    """Return whether the limits of a normal distribution, if there are any, leave out nearly all of its probability."""
    distances = [(limit - mean) / deviation for limit in limits]
    return bool(distances) and (min(distances) > FARTHEST or max(distances) < -FARTHEST)


class Axis(Word):
    """A parameter that varies. Numbers are in the unit in which XML writes the parameter."""

    parameter: str = attribute("Name of the parameter.", pattern=IDENTIFIER, names="parameter")

    def spelling(self) -> str:
        """Return NAME=DISTRIBUTION, as `sweep --vary` expects it."""
        return f"{self.parameter}={self.model_dump().get('word')}({', '.join(self.arguments())})"

    def arguments(self) -> Sequence[str]:
        """Return the distribution's arguments in order."""
        raise NotImplementedError

    def extent(self) -> Sequence[float]:
        """Return values that are drawn or that limit the drawn values; empty if nothing limits them."""
        return ()

    def fault(self) -> tuple[str, str]:
        """Return an attribute that contradicts the others, and the reason; two empty texts if all are consistent."""
        return "", ""


class Between(Axis):
    """A distribution with limits, which are either both given or both left out."""

    least: float | None = attribute("Least value; smaller values are drawn again.", default=None)
    greatest: float | None = attribute("Greatest value.", default=None)

    def _limits(self) -> tuple[float, ...]:
        return () if self.least is None or self.greatest is None else (self.least, self.greatest)

    def extent(self) -> Sequence[float]:
        """Return the limits."""
        return self._limits()

    def fault(self) -> tuple[str, str]:
        """Return the fault of the limits."""
        if (self.least is None) != (self.greatest is None):
            return ("least" if self.greatest is None else "greatest"), "least and greatest are given together or not"
        limits = self._limits()
        return ("greatest", "greatest must be above least") if limits and limits[0] >= limits[1] else ("", "")


class Uniform(Axis):
    """A uniform distribution: all values between two limits are equally likely."""

    word: Literal["uniform"] = "uniform"

    least: float = attribute("Least value.")
    greatest: float = attribute("Greatest value.")

    def arguments(self) -> Sequence[str]:
        """Return least, greatest."""
        return _texts(self.least, self.greatest)

    def extent(self) -> Sequence[float]:
        """Return the limits."""
        return (self.least, self.greatest)

    def fault(self) -> tuple[str, str]:
        """Return whether the limits are in the wrong order."""
        return ("greatest", "greatest must not be below least") if self.greatest < self.least else ("", "")


_TOO_FAR = "the limits are too many standard deviations away from the mean"


class Normal(Between):
    """A normal distribution, truncated at the limits if they are given."""

    word: Literal["normal"] = "normal"

    mean: float = attribute("Mean before truncation.")
    deviation: float = attribute("Standard deviation before truncation.", minimum=0, exclusive=True)

    def arguments(self) -> Sequence[str]:
        """Return mean, deviation and the limits."""
        return _texts(self.mean, self.deviation, *self._limits())

    def fault(self) -> tuple[str, str]:
        """Return the fault of the limits."""
        far = in_far_tail(self.mean, self.deviation, self._limits())
        return ("mean", _TOO_FAR) if far else super().fault()


class Lognormal(Between):
    """A lognormal distribution, truncated at the limits if they are given."""

    word: Literal["lognormal"] = "lognormal"

    mu: float = attribute("Mean of the logarithm.")
    sigma: float = attribute("Standard deviation of the logarithm.", minimum=0, exclusive=True)

    def arguments(self) -> Sequence[str]:
        """Return mu, sigma and the limits."""
        return _texts(self.mu, self.sigma, *self._limits())

    def fault(self) -> tuple[str, str]:
        """Return the fault of the limits, which must be above 0."""
        limits = self._limits()
        if limits and limits[0] <= 0.0:
            return "least", "least must be above 0"
        far = in_far_tail(self.mu, self.sigma, [math.log(limit) for limit in limits if limit > 0.0])
        return ("mu", _TOO_FAR) if far else super().fault()


class Triangular(Axis):
    """A triangular distribution between two limits, with the most likely value in between."""

    word: Literal["triangular"] = "triangular"

    least: float = attribute("Least value.")
    likeliest: float = attribute("Likeliest value.")
    greatest: float = attribute("Greatest value.")

    def arguments(self) -> Sequence[str]:
        """Return least, likeliest, greatest."""
        return _texts(self.least, self.likeliest, self.greatest)

    def extent(self) -> Sequence[float]:
        """Return the limits."""
        return (self.least, self.greatest)

    def fault(self) -> tuple[str, str]:
        """Return whether the three values are in the wrong order."""
        ordered = self.least <= self.likeliest <= self.greatest and self.least < self.greatest
        return ("", "") if ordered else ("likeliest", "likeliest must lie between least and a greater greatest")


class Poisson(Axis):
    """A Poisson distribution: the number of events at a mean rate."""

    word: Literal["poisson"] = "poisson"

    mean: float = attribute("Mean count.", minimum=0, exclusive=True, maximum=GREATEST_MEAN)

    def arguments(self) -> Sequence[str]:
        """Return the mean."""
        return _texts(self.mean)


class Histogram(Axis):
    """A piecewise uniform distribution: between each pair of neighbouring edges, with a weight for each pair."""

    word: Literal["histogram"] = "histogram"

    edges: tuple[float, ...] = attribute("Edges in rising order, one more than weights.", separated=True)
    weights: tuple[float, ...] = attribute("Weight between each edge and the next.", separated=True, minimum=0)

    def arguments(self) -> Sequence[str]:
        """Return edge, weight, edge, ..., edge."""
        pairs = zip(self.edges, self.weights, strict=False)
        return _texts(*(number for pair in pairs for number in pair), self.edges[-1])

    def extent(self) -> Sequence[float]:
        """Return the first and the last edge."""
        return (self.edges[0], self.edges[-1])

    def fault(self) -> tuple[str, str]:
        """Return the fault of the edges or weights."""
        if any(one >= other for one, other in pairwise(self.edges)):
            return "edges", "the edges must rise"
        if len(self.edges) != len(self.weights) + 1:
            return "weights", f"{len(self.edges)} edges need {len(self.edges) - 1} weights, not {len(self.weights)}"
        return ("", "") if sum(self.weights) > 0.0 else ("weights", "one of the weights must be above 0")


class Choice(Axis):
    """One of several values, each equally likely."""

    word: Literal["choice"] = "choice"

    of: tuple[str, ...] = attribute("The values: numbers or names, separated by spaces.", separated=True)

    def arguments(self) -> Sequence[str]:
        """Return the values."""
        return self.of

    def fault(self) -> tuple[str, str]:
        """Return whether a value contains a comma, which separates values in other lists."""
        return ("of", "values are separated by spaces and contain no commas") if "," in "".join(self.of) else ("", "")


class Values(Choice):
    """Each of several values in order, combined with every value of the other axes."""

    word: Literal["values"] = "values"  # type: ignore[assignment]  # another word of the same shape


class Weighted(Choice):
    """One of several values, with a probability in proportion to its weight."""

    word: Literal["weighted"] = "weighted"  # type: ignore[assignment]  # another word of the same shape

    weights: tuple[float, ...] = attribute("Weight of each value.", separated=True, minimum=0)

    def arguments(self) -> Sequence[str]:
        """Return value, weight, value, weight, ..."""
        return tuple(
            text for value, weight in zip(self.of, self.weights, strict=False) for text in (value, *_texts(weight))
        )

    def fault(self) -> tuple[str, str]:
        """Return the fault of the values or weights."""
        if len(self.of) != len(self.weights):
            return "weights", f"{len(self.of)} values need {len(self.of)} weights, not {len(self.weights)}"
        return super().fault() if sum(self.weights) > 0.0 else ("weights", "one of the weights must be above 0")


class Grid(Axis):
    """Evenly spaced values in order, combined with every value of the other axes."""

    word: Literal["grid"] = "grid"

    first: float = attribute("First value.")
    last: float = attribute("Last value.")
    count: int = attribute("Number of values; 1 gives the first one only.", minimum=1)

    def arguments(self) -> Sequence[str]:
        """Return first, last, count."""
        return _texts(self.first, self.last, self.count)

    def extent(self) -> Sequence[float]:
        """Return the first and the last value."""
        return (self.first, self.last)


class Constraint(Word):
    """A condition that every variant must meet. Draws that do not meet it are repeated."""

    word: Literal["constraint"] = "constraint"

    holds: str = attribute("Expression over the parameters, such as `$gap > 2 * $speed`.", expression=True)


class Vary(Word):
    """How a sweep varies the scenario. A single run uses the defaults."""

    word: Literal["vary"] = "vary"

    samples: int | None = attribute(
        "Number of draws at each listed point, if the command does not give one; 1 if left out.",
        default=None,
        minimum=1,
    )
    seed: int | None = attribute("Seed of the draws, if the command does not give one; 1 if left out.", default=None)
    axes: tuple[
        Uniform | Normal | Lognormal | Triangular | Poisson | Histogram | Choice | Weighted | Values | Grid, ...
    ] = child("The varied parameters.")
    constraints: tuple[Constraint, ...] = child("Conditions that every variant must meet.", default=())


def _texts(*numbers: float) -> tuple[str, ...]:
    return tuple(format_value(float(number)) for number in numbers)
