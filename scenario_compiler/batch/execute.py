"""Runs sweeps: chooses how variants are run, runs them, and stores their rows."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

from scenario_compiler.batch.codebook import PARAMETER, Column, parameter_column
from scenario_compiler.batch.distributions import Distribution, SweepError, beyond, misfit, value_of
from scenario_compiler.batch.finished import read_results
from scenario_compiler.batch.measuring import Columns
from scenario_compiler.batch.results import ResultStore, tally_of
from scenario_compiler.batch.runner import Batch, Form, Part, Runner, SentPlan, Variant
from scenario_compiler.batch.sampling import Sample, Sampler, constraints_of, make_sampler
from scenario_compiler.batch.spec import SweepSpec
from scenario_compiler.batch.tally import TALLIED, OnProgress, Progress, Tally
from scenario_compiler.batch.variants import Families, Family
from scenario_compiler.compiler import declared_parameters, found_target
from scenario_compiler.diagnostics import CompileError, Diagnostics, Severity
from scenario_compiler.files import is_plan_file
from scenario_compiler.forms.machine_code import library, why_interpreted
from scenario_compiler.processes import available_cores
from scenario_compiler.recording.versions import version_of
from scenario_compiler.source.declared import Declaration
from scenario_compiler.trust import Trust
from scenario_compiler.vocabulary.scenario import parameter_values

PRESENTED = 1_000_000
"""Greatest number of variants whose rows are held in memory, for the report and the choice of traces."""

WORTH_A_WORKER: dict[Form, int] = {"camera": 1, "interpreted": 80, "compiled": 2000}
"""Number of variants from which on another process is worth its start, by the form of execution."""


@dataclass(frozen=True)
class SweepResult:
    """A finished sweep.

    Attributes:
        folder: Its folder.
        table: The file of the rows.
        tally: Counts of the variants' results.
        automated: Whether there is an automated vehicle, which can request a takeover.
        commonest: Most frequent reason in rows without a result; empty if all rows have one.
        form: How the variants were run.
        workers: Number of processes; 1 for this process alone.
    """

    folder: Path
    table: Path
    tally: Tally
    automated: bool
    commonest: str
    form: Form
    workers: int


class Executor(Protocol):
    """Runs parts of a sweep, in this process, in a pool of processes, or on a cluster."""

    def run(self, parts: Iterator[Part]) -> Iterator[tuple[int, Batch]]:
        """Yield the rows of all parts as (number of the part, batch); the batches of a part are in order."""
        ...

    def close(self) -> None:
        """Release all processes and connections."""
        ...


class Inline:
    """Runs parts in this process."""

    def __init__(self, runner: Runner) -> None:
        """Take the runner."""
        self.runner = runner

    def run(self, parts: Iterator[Part]) -> Iterator[tuple[int, Batch]]:
        """Yield the rows of all parts, part by part."""
        for part in parts:
            for batch in self.runner.batches(part):
                yield part.number, batch

    def close(self) -> None:
        """Do nothing: there is nothing to release."""


@dataclass
class Sweep:
    """A sweep that is ready to run.

    Attributes:
        target: FILE, FILE#name or a plan's file.
        spec: Its options.
        sampler: Samples the variants.
        families: The plans of the variants.
        form: How the variants are run.
        part_size: Number of variants in a part.
        declared: The scenario's declarations of its parameters.
    """

    target: str
    spec: SweepSpec
    sampler: Sampler
    families: Families
    form: Form
    part_size: int
    declared: Mapping[str, Declaration]
    _on_the_way: dict[int, SentPlan] = field(default_factory=dict)

    @property
    def trust(self) -> Trust:
        """The code that workers may import: what was trusted when the sweep was prepared."""
        trust, controller = self.spec.trusted(self.target), self.families.base.plan.controller
        if controller is None:
            return trust
        detector = () if controller.detector is None else (controller.detector.model,)
        return Trust((*trust.named, controller.model, *detector), trust.beside)

    @property
    def parts(self) -> int:
        """Number of parts."""
        return math.ceil(self.sampler.total / self.part_size)

    def variant(self, index: int, sample: Sample) -> Variant:
        """Return a variant with its family, or with the reason why it has none."""
        seed = self.sampler.seed_of(index)
        found = self.families.of(sample)
        if isinstance(found, Diagnostics):
            error = next((one.message for one in found if one.severity is Severity.ERROR), "it does not compile")
            return Variant(index, seed, -1, sample, error)
        try:
            return Variant(index, seed, found.number, found.values(sample))
        except SweepError as fault:
            return Variant(index, seed, found.number, {}, str(fault))

    def part(self, number: int) -> tuple[Part, Columns]:
        """Return a part of the work, and those columns of its rows that are known before it runs."""
        first = number * self.part_size
        indices = range(first, min(first + self.part_size, self.sampler.total))
        samples = [self.sampler.sample(index) for index in indices]
        variants = tuple(self.variant(index, sample) for index, sample in zip(indices, samples, strict=True))
        plans = {one.family: self.families.plan(one.family) for one in variants if not one.error}
        columns: Columns = {"variant": list(indices)}
        columns |= {PARAMETER + name: [sample[name] for sample in samples] for name in samples[0]}
        columns |= {
            "seed": [one.seed for one in variants],
            "digest": [plans[one.family].plan.digest if one.family in plans else None for one in variants],
        }
        return Part(number, variants, tuple(self._sent(family) for family in plans.values())), columns

    def _sent(self, family: Family) -> SentPlan:
        """Return a family's plan, always the same value, so that its JSON is made once at most."""
        return self._on_the_way.setdefault(family.number, SentPlan(family.number, family.plan, family.plan.map.file))

    def manifest(self) -> dict[str, Any]:
        """Return everything that determines the rows; it identifies the sweep to which a folder belongs."""
        return {
            "target": Path(self.target).name,
            "spec": self.spec.of_rows,
            "digest": self.families.base.plan.digest,
            "variants": self.sampler.total,
            "part_size": self.part_size,
            "version": version_of("scenario-compiler"),
        }

    def store(self, folder: Path) -> ResultStore:
        """Return the folder's store."""
        return ResultStore(folder, self.parameters, self.manifest())

    @property
    def parameters(self) -> list[Column]:
        """The columns of the parameters that vary, in the table's order."""
        axes, order = self.spec.axes, (*self.sampler.crossed, *self.sampler.drawn)
        return [parameter_column(name, axes[name], self.declared.get(name)) for name in order]


def prepare(target: str | Path, spec: SweepSpec, sink: Diagnostics, maps: Sequence[Path] = ()) -> Sweep:
    """Compile and sample a sweep without running it.

    Raises:
        CompileError: The scenario is at fault.
        ScenarioNameNeededError: The file has several scenarios and no name is given.
        SweepError: The sweep is not possible with these options.
    """
    axes = spec.axes
    spec.traces_wanted()
    found = found_target(target, sink)
    if found is None:
        raise CompileError(sink)
    if not axes and spec.samples * spec.repeat == 1:
        Families(found, spec, {}, sink, maps)  # what is wrong with the scenario itself comes first
        raise SweepError(
            "nothing varies: give --vary NAME=DISTRIBUTION, or --samples N for runs that differ in their random numbers"
        )
    declared = {} if is_plan_file(found) else declared_parameters(found)
    constrained = {name for expression in constraints_of(spec) for name in expression.names}
    check_axes(axes, declared, constrained)
    middle = {name: axis.points[0] if axis.points else axis.quantile(0.5) for name, axis in axes.items()}
    families = Families(found, spec, middle, sink, maps)
    if not declared:
        declared = {one.name: Declaration.of(one) for one in families.base.plan.parameters}
        check_axes(axes, declared, constrained)
    fixed = {name: one.default for name, one in declared.items() if one.default is not None}
    texts = {name for name, one in declared.items() if one.kind == "text"}
    fixed |= {name: text if name in texts else value_of(text) for name, text in spec.settings.items()}
    sampler = make_sampler(spec, fixed | parameter_values(families.base.plan.parameters))
    form = form_of(spec, families.base)
    return Sweep(str(found), spec, sampler, families, form, part_size_of(form, sampler.total), declared)


def check_axes(
    axes: Mapping[str, Distribution], declared: Mapping[str, Declaration], constrained: Collection[str]
) -> None:
    """Raise SweepError if a distribution gives a parameter values that it cannot have.

    Args:
        axes: The distributions by the parameter's name.
        declared: Declarations of the parameters; the compiler reports parameters without a declaration.
        constrained: Parameters in constraints, which may keep their values inside the limits.
    """
    for name, axis in axes.items():
        if name not in declared:
            continue
        kind = declared[name].kind
        wanted = misfit(axis, kind)
        if wanted:
            raise SweepError(f"'{name}' is of the type {kind}, which {axis.text} does not fit: use {wanted}")
        too_far = "" if name in constrained else beyond(axis, declared[name].limits)
        if too_far:
            raise SweepError(f"with {axis.text}, {name} may become {too_far}")


def form_of(spec: SweepSpec, base: Family) -> Form:
    """Return how a sweep's variants are run: with a camera in Python, without one in the engine alone."""
    if base.plan.perception == "camera":
        return "camera"
    return "interpreted" if spec.interpreted or library() is None else "compiled"


def part_size_of(form: Form, total: int) -> int:
    """Return the number of variants in a part: the most that is lost when a sweep is interrupted."""
    if form == "camera":
        return 1
    if form == "interpreted":
        return 16
    return min(max(total // 64, 1000), 2000)


def workers_for(sweep: Sweep, wanted: int | None) -> int:
    """Return the number of processes: the wanted one, else that of all cores; never more than there is work for."""
    if wanted is not None:
        return max(1, min(wanted, sweep.parts if sweep.form == "camera" else sweep.sampler.total))
    return max(1, min(available_cores(), sweep.parts, sweep.sampler.total // WORTH_A_WORKER[sweep.form]))


def open_executor(sweep: Sweep, workers: int) -> Executor:
    """Return the executor on this machine; it has worker processes if a run may hang or if there are several."""
    spec = sweep.spec
    if workers == 1 and sweep.form != "camera" and spec.time_limit is None:
        runner = Runner(sweep.form, sweep.trust)
        base = sweep.families.base
        runner.add(base.number, base.plan, base.network)
        return Inline(runner)
    from scenario_compiler.batch.pool import Pool

    return Pool(sweep.form, workers, spec.time_limit, trust=sweep.trust)


def connect(sweep: Sweep, scheduler: str) -> Executor:
    """Return the executor on a cluster; raise SweepError if there is no scheduler at the address."""
    from scenario_compiler.batch.cluster import Cluster

    return Cluster(sweep.form, scheduler, trust=sweep.trust)


def execute(sweep: Sweep, store: ResultStore, executor: Executor, progress: OnProgress | None = None) -> Tally:
    """Run the missing parts and store their rows; return the counts of all variants' results.

    Raises:
        OSError: The rows could not be written; rows that were written before are kept.
    """
    there = {number: store.tally(number) for number in sorted(store.done())}
    missing = [number for number in range(sweep.parts) if number not in there]
    tally = sum(there.values(), Tally())
    pending: dict[int, Columns] = {}

    def work() -> Iterator[Part]:
        for number in missing:
            part, pending[number] = sweep.part(number)
            yield part

    def tell() -> None:
        if progress is not None:
            progress(Progress("variants", tally.runs, sweep.sampler.total, tally))

    tell()
    with closing(executor):
        for number, batch in executor.run(work()):
            columns = pending[number]
            for name, values in batch.columns.items():
                columns.setdefault(name, []).extend(values)
            tally += Tally.of(*(batch.columns[name] for name in TALLIED))
            if len(columns["result"]) == len(columns["variant"]):
                store.write_part(number, pending.pop(number))
            tell()
    return tally


def run_sweep(
    target: str | Path,
    spec: SweepSpec,
    folder: str | Path,
    *,
    resume: bool = False,
    progress: OnProgress | None = None,
    scheduler: str | None = None,
    workers: int | None = None,
    maps: Sequence[Path] = (),
    report: bool = True,
    say: Callable[[str], None] | None = None,
    sink: Diagnostics | None = None,
) -> SweepResult:
    """Run a sweep into a folder.

    Args:
        target: FILE, FILE#name, a conflict of the library by its name, or a plan's file.
        spec: Its options.
        folder: Folder for the table, the chosen traces and the report.
        resume: Whether to finish the sweep in the folder.
        progress: Called with the progress whenever a part is done.
        scheduler: Address of a Dask scheduler that runs the variants.
        workers: Number of processes; None chooses it by the amount of work.
        maps: Folders in which maps are looked for first.
        report: Whether to write report.html. It and the traces are left out for more than `PRESENTED` variants.
        say: Called with a text on how the variants are run.
        sink: Receives the diagnostics of the scenario.

    Raises:
        CompileError: The scenario is at fault.
        ScenarioNameNeededError: The file has several scenarios and no name is given.
        SweepError: The sweep is not possible with these options, or the folder belongs to another sweep.
        OSError: Nothing more could be written; `resume` finishes the sweep.
    """
    sweep = prepare(target, spec, Diagnostics() if sink is None else sink, maps)
    store = sweep.store(Path(folder))
    store.check(resume=resume)
    with store.owned():
        return _run_owned(sweep, store, resume, progress, scheduler, workers, report, say)


def _run_owned(
    sweep: Sweep,
    store: ResultStore,
    resume: bool,
    progress: OnProgress | None,
    scheduler: str | None,
    workers: int | None,
    report: bool,
    say: Callable[[str], None] | None,
) -> SweepResult:
    """Run a sweep whose folder is its own now; see `run_sweep`."""
    spec, folder = sweep.spec, store.folder
    store.check(resume=resume)  # another sweep may have had the folder until now
    damaged = store.drop_damaged()
    if damaged and say is not None:
        say(f"damaged, and made again: {', '.join(path.name for path in damaged)}")
    count = workers_for(sweep, workers)
    if not store.finished:
        cluster = None if scheduler is None else connect(sweep, scheduler)  # or there is nothing to resume
        store.begin()
        executor = open_executor(sweep, count) if cluster is None else cluster
        if say is not None:
            say(describe(sweep, count, scheduler))
        execute(sweep, store, executor, progress)
    store.merge(sweep.parts)
    if (report or spec.traces) and sweep.sampler.total <= PRESENTED:
        present(sweep, folder, report=report, progress=progress)
    elif say is not None and (report or spec.traces):
        say(f"more than {PRESENTED} variants: no traces and no report, only the table")
    errors = store.errors()
    commonest = errors[0][0] if errors else ""
    automated = sweep.families.base.plan.controller is not None
    return SweepResult(folder, store.table, tally_of(store.table), automated, commonest, sweep.form, count)


def present(sweep: Sweep, folder: Path, *, report: bool, progress: OnProgress | None = None) -> None:
    """Write the chosen traces and the report of a finished sweep."""
    from scenario_compiler.batch.presenting import write_page
    from scenario_compiler.batch.worst import chosen, write_traces

    rows, _ = read_results(folder)
    spec = sweep.spec
    write_traces(sweep.families, rows, chosen(rows, spec), folder, progress)
    if report:
        units = {one.column.removeprefix(PARAMETER): one.unit for one in sweep.parameters}
        write_page(sweep.target, spec, sweep.families, rows, sweep.form, folder, units, progress)


def describe(sweep: Sweep, workers: int, scheduler: str | None = None) -> str:
    """Return in words how a sweep is run."""
    how = {
        "camera": "with a camera in the loop, each in Python",
        "interpreted": "in the interpreted engine",
        "compiled": "in the compiled engine",
    }[sweep.form]
    if sweep.form == "interpreted" and not sweep.spec.interpreted:
        how += f" ({why_interpreted()})"
    where = f"in {workers} processes"
    if workers == 1:
        where = "in a process of their own" if sweep.form == "camera" or sweep.spec.time_limit else "in this process"
    if scheduler is not None:
        where = f"on the cluster at {scheduler}"
    chosen = sweep.sampler.chosen
    kept = "" if chosen is None else f"; {len(chosen)} of {sweep.sampler.points} points meet the constraints"
    total = sweep.sampler.total
    return f"{total} variant{'s' * (total != 1)} {how}, {where}{kept}"
