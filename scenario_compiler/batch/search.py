"""Searches for the boundary at which something begins to happen, and for the least value of a measure.

All runs use the random numbers of variant 0, so that the result depends on the parameters alone. Runs are stored like
the parts of a sweep. The searches are deterministic: a resumed one asks for the same values again and finds their runs
in the folder.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, get_args

from scenario_compiler.batch.codebook import PARAMETER
from scenario_compiler.batch.distributions import Distribution, SweepError
from scenario_compiler.batch.execute import Sweep, prepare
from scenario_compiler.batch.finished import read_results
from scenario_compiler.batch.measuring import Columns
from scenario_compiler.batch.results import ResultStore
from scenario_compiler.batch.runner import Part, Runner
from scenario_compiler.batch.sampling import Sample
from scenario_compiler.batch.spec import SweepSpec
from scenario_compiler.batch.tally import OnProgress, Progress
from scenario_compiler.diagnostics import Diagnostics, suggestion
from scenario_compiler.expressions import Expression, ExpressionError, Value, parse_expression
from scenario_compiler.recording.measures import MEASURES
from scenario_compiler.recording.resolution import WITHOUT_REQUEST

UNDEFINED = 1.0e9
"""Value used for an undefined measure when it is minimised."""

Optimizer = Literal["direct", "nelder-mead"]


@dataclass(frozen=True)
class Boundary:
    """The boundary at which something begins to happen.

    Attributes:
        name: The parameter.
        without: The nearest value found at which it does not happen.
        with_it: The nearest value found at which it happens.
        evaluations: Number of runs.
    """

    name: str
    without: float
    with_it: float
    evaluations: int


@dataclass(frozen=True)
class Minimum:
    """The least value of a measure that was found.

    Attributes:
        values: The parameters there.
        measure: The measure's value.
        evaluations: Number of runs.
    """

    values: dict[str, float]
    measure: float
    evaluations: int


class Search:
    """Runs of one scenario, one after the other, each of which is stored."""

    def __init__(
        self,
        target: str | Path,
        spec: SweepSpec,
        folder: str | Path,
        asked: str,
        maps: Sequence[Path] = (),
        sink: Diagnostics | None = None,
        progress: OnProgress | None = None,
    ) -> None:
        """Compile the scenario.

        Args:
            target: FILE, FILE#name or a plan's file.
            spec: The parameters, each with a uniform distribution over the range that is searched, and the run.
            folder: Folder for the evaluations.
            asked: Description of the search, because a folder belongs to one search.
            maps: Folders in which maps are looked for first.
            sink: Receives the diagnostics of the scenario.
            progress: Called with the progress before each run.

        Raises:
            CompileError: The scenario is at fault.
            SweepError: The search is not possible with these options.
        """
        if spec.repeat > 1:
            raise SweepError("a search runs each value once, so it does not accept --repeat")
        if not spec.vary:
            raise SweepError("a search needs a range: write --vary NAME=uniform(least, greatest)")
        sink = Diagnostics() if sink is None else sink
        self.sweep: Sweep = prepare(target, spec, sink, maps)
        self.ranges = {name: _range_of(name, axis) for name, axis in spec.axes.items()}
        self.runner = Runner(self.sweep.form, trust=self.sweep.trust)
        manifest = {**self.sweep.manifest(), "asked": asked}
        self.store = ResultStore(Path(folder), self.sweep.parameters, manifest)
        self.count = 0
        self.expected = 0
        self._progress = progress
        self._kept: dict[int, Columns] = {}

    @contextmanager
    def opened(self, *, resume: bool) -> Iterator[None]:
        """Begin, or continue the search in the folder, and keep other searches out of it meanwhile."""
        self.store.check(resume=resume)
        with self.store.owned():
            self.store.open(resume=resume)
            self.store.drop_damaged()
            self._take_up()
            yield

    def _take_up(self) -> None:
        if self.store.finished:
            rows, _ = read_results(self.store.folder)
            count = len(rows["variant"])
            self._kept = {k: {name: [values[k]] for name, values in rows.items()} for k in range(count)}
        else:
            self._kept = {number: self.store.part_columns(number) for number in self.store.done()}

    def evaluate(self, sample: dict[str, float]) -> Columns:
        """Return the row of a run, from the folder if it is there."""
        number, self.count = self.count, self.count + 1
        if self._progress is not None:
            self._progress(Progress("evaluations", number, max(self.expected, self.count)))
        row = self._kept.get(number)
        if row is not None and all(row[PARAMETER + name] == [value] for name, value in sample.items()):
            return row
        values: Sample = dict(sample)
        variant = self.sweep.variant(0, values)
        columns: Columns = {"variant": [0], "seed": [variant.seed], "digest": [None]}
        columns |= {PARAMETER + name: [value] for name, value in sample.items()}
        if not variant.error:
            family = self.sweep.families.plan(variant.family)
            self.runner.add(family.number, family.plan, family.network)
            columns["digest"] = [family.plan.digest]
        for batch in self.runner.batches(Part(number, (variant,))):
            columns |= batch.columns
        self.store.write_part(number, columns)
        return columns

    def finish(self) -> None:
        """Write the table of all runs."""
        self.store.merge(self.count)


def find_boundary(
    target: str | Path,
    spec: SweepSpec,
    folder: str | Path,
    *,
    when: str,
    tolerance: float,
    resume: bool = False,
    maps: Sequence[Path] = (),
    sink: Diagnostics | None = None,
    progress: OnProgress | None = None,
) -> Boundary:
    """Bisect the range of the one parameter that varies until the boundary is known to `tolerance`.

    Args:
        target: FILE, FILE#name or a plan's file.
        spec: The parameter as `name=uniform(low, high)`, and the run.
        folder: Folder for the evaluations.
        when: What happens: an expression over `collision`, `request`, `passed` and the measures, such as `collision` or
            `minimum_time_to_collision < 1`. It does not happen where a measure in it is not defined.
        tolerance: Greatest distance between the two values returned, in the parameter's unit.
        resume: Whether to continue the search in the folder.
        maps: Folders in which maps are looked for first.
        sink: Receives the diagnostics of the scenario.
        progress: Called with the progress before each run.

    Raises:
        CompileError: The scenario is at fault.
        SweepError: It happens at both ends of the range or at neither, or the search is not possible with these
            options.
    """
    happens = _predicate(when)
    if len(spec.vary) != 1:
        raise SweepError("a boundary is searched along one parameter")
    search = Search(target, spec, folder, f"boundary of {when} to {tolerance!r}", maps, sink, progress)
    ((name, (low, high)),) = search.ranges.items()
    if not tolerance > 0 or high - low > tolerance * 2.0**60:
        raise SweepError(f"the tolerance {tolerance:g} is too small for the range")
    search.expected = 2 + math.ceil(math.log2(max((high - low) / tolerance, 1.0)))

    def happens_at(value: float) -> bool:
        sampler = search.sweep.sampler
        if not sampler.meets({name: value}):
            raise SweepError(f"{name} = {value:g} does not meet {sampler.constraints}: give a range that does")
        return happens(search.evaluate({name: value}))

    with search.opened(resume=resume):
        at_low, at_high = happens_at(low), happens_at(high)
        if at_low == at_high:
            where = "at both ends" if at_low else "at neither end"
            raise SweepError(f"no boundary: '{when}' holds {where} of {name} from {low:g} to {high:g}")
        while high - low > tolerance:
            middle = 0.5 * (low + high)
            if happens_at(middle) == at_low:
                low = middle
            else:
                high = middle
        search.finish()
    return Boundary(name, high if at_low else low, low if at_low else high, search.count)


def minimise(
    target: str | Path,
    spec: SweepSpec,
    folder: str | Path,
    *,
    measure: str,
    evaluations: int,
    optimizer: Optimizer = "direct",
    resume: bool = False,
    maps: Sequence[Path] = (),
    sink: Diagnostics | None = None,
    progress: OnProgress | None = None,
) -> Minimum:
    """Look for the parameters that make a measure least.

    Args:
        target: FILE, FILE#name or a plan's file.
        spec: The parameters as `name=uniform(low, high)`, and the run.
        folder: Folder for the evaluations.
        measure: Name of a measure, such as `minimum_time_to_collision`.
        evaluations: Approximate number of runs, at least 1.
        optimizer: "direct" searches the whole range (Jones, Perttunen and Stuckman 1993), "nelder-mead" starts in its
            middle.
        resume: Whether to continue the search in the folder.
        maps: Folders in which maps are looked for first.
        sink: Receives the diagnostics of the scenario.
        progress: Called with the progress before each run.

    Raises:
        CompileError: The scenario is at fault.
        SweepError: The measure is defined nowhere, or the search is not possible with these options.
    """
    from scipy import optimize

    measures = {one.name for one in MEASURES}
    if measure not in measures:
        raise SweepError(f"there is no measure '{measure}'{suggestion(measure, measures)}")
    if optimizer not in get_args(Optimizer):
        raise SweepError(f"optimizer is one of {', '.join(get_args(Optimizer))}, not {optimizer!r}")
    if evaluations < 1:
        raise SweepError(f"a search needs at least one run, not {evaluations}")
    search = Search(target, spec, folder, f"least {measure} by {optimizer} in {evaluations}", maps, sink, progress)
    search.expected = evaluations
    names = list(search.ranges)
    best: list[tuple[float, dict[str, float]]] = []

    def objective(point: Any) -> float:
        values = {
            name: min(max(float(value), search.ranges[name][0]), search.ranges[name][1])
            for name, value in zip(names, point, strict=True)
        }
        if not search.sweep.sampler.meets({**values}):
            return UNDEFINED
        found = search.evaluate(values)[measure][0]
        if found is not None and (not best or found < best[0][0]):
            best[:] = [(found, values)]
        return UNDEFINED if found is None else float(found)

    bounds = list(search.ranges.values())
    with search.opened(resume=resume):
        if optimizer == "direct":
            optimize.direct(objective, bounds, maxfun=evaluations, maxiter=evaluations, locally_biased=True)
        else:
            middle = [0.5 * (low + high) for low, high in bounds]
            options = {"maxfev": evaluations, "xatol": 1e-4, "fatol": 1e-6}
            optimize.minimize(objective, middle, method="Nelder-Mead", bounds=bounds, options=options)
        if not search.count:
            raise SweepError(f"no sample meets {search.sweep.sampler.constraints}")
        search.finish()
    if not best:
        raise SweepError(f"'{measure}' is defined in none of {search.count} runs")
    return Minimum(best[0][1], best[0][0], search.count)


def _range_of(name: str, axis: Distribution) -> tuple[float, float]:
    if axis.limits is None:
        raise SweepError(f"a search needs a range: write {name}=uniform(least, greatest), not {axis.text}")
    return axis.limits


def _predicate(when: str) -> Callable[[Columns], bool]:
    try:
        expression: Expression = parse_expression(when)
    except ExpressionError as fault:
        raise SweepError(f"'{when}' cannot be read: {fault}") from None
    known = {"collision", "request", "passed"} | {one.name for one in MEASURES}
    unknown = sorted(set(expression.names) - known)
    if unknown:
        hint = suggestion(unknown[0], known)
        raise SweepError(
            f"'{unknown[0]}' in '{when}' is neither a measure nor one of collision, request and passed{hint}"
        )

    def happens(row: Columns) -> bool:
        if row["result"] == ["error"]:
            raise SweepError(f"a run of the search failed: {row['error'][0]}")
        values: dict[str, Value] = {
            "collision": row["collision_time"][0] is not None,
            "request": row["resolution"][0] not in WITHOUT_REQUEST,
            "passed": row["result"][0] == "pass",
        }
        measured = {one.name: row[one.name][0] for one in MEASURES if row[one.name][0] is not None}
        if not set(expression.names) <= set(values | measured):
            return False
        try:
            return bool(expression.evaluate(values | measured))
        except ExpressionError as fault:
            raise SweepError(f"'{when}' cannot be evaluated: {fault}") from None

    return happens
