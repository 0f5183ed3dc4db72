"""Samples of the parameters: grid, random, Latin hypercube and Sobol, each reproducible from a seed.

A grid axis is crossed with everything else: with `speed=grid(10, 20, 3)` each of the `samples` draws of the other axes
is tried at three speeds; where there are no other axes, each speed is run `samples` times. Every draw at every point is
run by `repeats` variants, each with a seed of its own. A random draw depends on nothing but the seed and its number; a
Latin hypercube's on the number of samples too. A random draw that does not meet a constraint at one point of the grid
is made again there, and only there.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from scenario_compiler.batch.distributions import Distribution, SweepError
from scenario_compiler.batch.spec import SweepSpec
from scenario_compiler.expressions import Expression, ExpressionError, Value, format_value, parse_expression
from scenario_compiler.randomness import hash_bits, uniform
from scenario_compiler.recording.recording import Floats

ATTEMPTS = 10_000
"""Draws after which a constraint counts as impossible to fulfil."""

Sample = dict[str, Value]


@dataclass
class Sampler:
    """The variants of a sweep by index: `total` of them, 0 to total - 1.

    Attributes:
        crossed: Grid axes by name; the last one varies fastest.
        drawn: The other axes by name.
        units: For Latin hypercube and Sobol the points in the unit cube, (samples, drawn axes); None for random.
        samples: Number of draws.
        seed: The seed.
        repeats: Number of variants of each point, which have the seeds `seed`, `seed` + 1 and so on.
        where: Constraints.
        fixed: Values of the parameters that do not vary, which constraints may name.
        chosen: Numbers of the points that fulfil the constraints which another draw cannot change; None without such
            constraints.
    """

    crossed: dict[str, Distribution]
    drawn: dict[str, Distribution]
    units: Floats | None
    samples: int
    seed: int
    repeats: int = 1
    where: tuple[Expression, ...] = ()
    fixed: Sample = field(default_factory=dict)
    chosen: array[int] | None = None

    @property
    def points(self) -> int:
        """Number of points before constraints."""
        return self.samples * math.prod(len(axis.points) for axis in self.crossed.values())

    @property
    def total(self) -> int:
        """Number of variants."""
        return self.repeats * (self.points if self.chosen is None else len(self.chosen))

    def seed_of(self, index: int) -> int:
        """Return the seed of a variant."""
        return self.seed + index % self.repeats

    def sample(self, index: int) -> Sample:
        """Return the values of a variant, in the order of the axes.

        Raises:
            SweepError: No draw fulfils the constraints, or one of them has no value.
        """
        number = index // self.repeats
        if self.chosen is not None:
            number = self.chosen[number]
        for attempt in range(ATTEMPTS):
            values = self._point(number, attempt)
            if not self._drawn_again or self._holds(values, self._drawn_again):
                return values
        at = " and ".join(f"{name} = {format_value(values[name])}" for name in self.crossed) or "one variant"
        raise SweepError(f"no sample meets {self.constraints} in {ATTEMPTS} draws for {at}")

    @property
    def constraints(self) -> str:
        """The constraints, as text."""
        return " and ".join(expression.text for expression in self.where)

    def meets(self, values: Sample) -> bool:
        """Return whether the values of a variant fulfil the constraints.

        Raises:
            SweepError: A constraint has no value.
        """
        return self._holds(values, self.where)

    def choose(self) -> None:
        """Keep the points that fulfil the constraints which another draw cannot change.

        Raises:
            SweepError: None does, no draw of the first one fulfils the other constraints, or a constraint has no value.
        """
        settled = tuple(one for one in self.where if one not in self._drawn_again)
        if settled:
            good = (number for number in range(self.points) if self._holds(self._point(number, 0), settled))
            self.chosen = array("q", good)
            if not len(self.chosen):
                raise SweepError(f"no sample meets {self.constraints}")
        if self._drawn_again:
            self.sample(0)

    @cached_property
    def _drawn_again(self) -> tuple[Expression, ...]:
        """The constraints on random axes: points that do not fulfil them are drawn again."""
        if self.units is not None:
            return ()
        return tuple(one for one in self.where if any(name in self.drawn for name in one.names))

    def _point(self, number: int, attempt: int) -> Sample:
        values: Sample = {}
        left = number
        for name, axis in reversed(self.crossed.items()):
            left, at = divmod(left, len(axis.points))
            values[name] = axis.points[at]
        for column, (name, axis) in enumerate(self.drawn.items()):
            if self.units is None:
                unit = uniform(self.seed, left, f"sweep/{name}/{attempt}")
            else:
                unit = float(self.units[left, column])
            values[name] = axis.quantile(unit)
        return values

    def _holds(self, values: Sample, constraints: tuple[Expression, ...]) -> bool:
        try:
            return all(expression.evaluate({**self.fixed, **values}) for expression in constraints)
        except ExpressionError as fault:
            raise SweepError(f"the constraint cannot be evaluated: {fault}") from None


def make_sampler(spec: SweepSpec, fixed: Sample | None = None) -> Sampler:
    """Return the variants of a sweep; `fixed` holds the other parameters, for the constraints.

    Raises:
        SweepError: The sweep is not possible as it is asked for.
    """
    axes = spec.axes
    listed = {name: axis for name, axis in axes.items() if axis.listed or (spec.method == "grid" and axis.points)}
    drawn = {name: axis for name, axis in axes.items() if name not in listed}
    if spec.method == "grid" and drawn:
        name, axis = next(iter(drawn.items()))
        raise SweepError(f"a grid needs points: '{name}={axis.text}' has none; write {name}=grid(first, last, count)")
    units = None
    if drawn and spec.method == "latin":
        units = latin_hypercube(list(drawn), spec.samples, spec.seed)
    elif drawn and spec.method == "sobol":
        units = sobol(list(drawn), spec.samples, spec.seed)
    sampler = Sampler(listed, drawn, units, spec.samples, spec.seed, spec.repeat, constraints_of(spec), fixed or {})
    sampler.choose()
    return sampler


def constraints_of(spec: SweepSpec) -> tuple[Expression, ...]:
    """Return the constraints that every variant of a sweep meets; SweepError if one cannot be read."""
    try:
        return tuple(parse_expression(text) for text in spec.where)
    except ExpressionError as fault:
        raise SweepError(f"the constraint cannot be read: {fault}") from None


def latin_hypercube(names: Sequence[str], samples: int, seed: int) -> Floats:
    """Return points in the unit cube, (samples, names): each axis has one point in each of `samples` equal strata.

    McKay, Beckman and Conover (1979). An axis depends on the seed and its name alone.
    """
    columns = []
    for name in names:
        keys = np.fromiter((hash_bits(seed, k, f"latin/{name}/order") for k in range(samples)), np.uint64, samples)
        inside = np.fromiter((uniform(seed, k, f"latin/{name}/inside") for k in range(samples)), np.float64, samples)
        columns.append((np.argsort(keys, kind="stable") + inside) / samples)
    return np.stack(columns, axis=-1)


def sobol(names: Sequence[str], samples: int, seed: int) -> Floats:
    """Return the first points of Sobol's sequence, (samples, names), turned by a random shift of each axis.

    The shift is that of Cranley and Patterson (1976): it keeps the evenness and takes the points off the cube's edges.
    """
    from scipy.stats import qmc

    power = max(0, math.ceil(math.log2(samples)))
    points = np.asarray(qmc.Sobol(len(names), scramble=False).random_base2(power))[:samples]
    shift = np.array([uniform(seed, 0, f"sobol/{name}") for name in names])
    turned = np.mod(points + shift, 1.0)
    return np.asarray(np.clip(turned, 1e-12, 1.0 - 1e-12), dtype=np.float64)
