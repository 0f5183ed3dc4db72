"""Runs variants in this process, a worker process or on a cluster: plans and values in, rows out.

A part of a sweep comes as a `Part` of plain values, with the plans that the worker has not seen yet, and leaves as
batches of rows. Nothing in a row depends on how a sweep is split.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import groupby
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.batch.distributions import SweepError
from scenario_compiler.batch.measuring import Columns, error_columns, row_of_recording, rows_of_totals
from scenario_compiler.batch.sampling import Sample
from scenario_compiler.batch.variants import with_values
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.state import make_draws
from scenario_compiler.engine.program import Numbers, build_program
from scenario_compiler.engine.reference_runs import avoided_by
from scenario_compiler.engine.simulation import Simulation
from scenario_compiler.expressions import ExpressionError
from scenario_compiler.plan.model import Plan
from scenario_compiler.plan.store import plan_text
from scenario_compiler.plan.variants import VariantChecks
from scenario_compiler.recording.recording import Recording
from scenario_compiler.recording.totals import RunTotals
from scenario_compiler.roads import Network, load_network
from scenario_compiler.runtime import open_world, run
from scenario_compiler.trust import Trust
from scenario_compiler.vocabulary.criteria import references_in
from scenario_compiler.vocabulary.driver import ReferenceName
from scenario_compiler.vocabulary.scenario import parameter_values

Form = Literal["camera", "interpreted", "compiled"]

TOGETHER = 4096
"""Greatest number of variants in one call of the engine, so that their rows of numbers and totals stay small."""

FAMILIES_KEPT = 64
"""Number of plans that a runner keeps ready."""


@dataclass(frozen=True)
class Variant:
    """A variant: its index, seed, family and values of the family's slots, or the reason why it cannot run."""

    index: int
    seed: int
    family: int
    values: Sample
    error: str = ""


@dataclass(frozen=True)
class SentPlan:
    """A plan that is sent to a worker. The map is sent as a path, and as content if the worker does not have the file.

    Attributes:
        family: Number of its family.
        made: The plan, or its JSON, as which it is sent to another process.
        map_file: File of the map.
    """

    family: int
    made: Plan | str
    map_file: str

    def __reduce__(self) -> tuple[type[SentPlan], tuple[int, str, str]]:
        """Pickle as JSON; none is made if the plan stays in its process."""
        return SentPlan, (self.family, self.text, self.map_file)

    @cached_property
    def text(self) -> str:
        """The plan as JSON."""
        return self.made if isinstance(self.made, str) else plan_text(self.made)

    @cached_property
    def plan(self) -> Plan:
        """The plan."""
        return Plan.model_validate_json(self.made) if isinstance(self.made, str) else self.made


@dataclass(frozen=True)
class Part:
    """A part of a sweep's work.

    Attributes:
        number: Its number, by which the parts are merged in order.
        variants: The variants to run.
        plans: Plans of their families, which the worker may not have yet.
        one_by_one: Whether to run one variant at a time, to find the one that ends the process.
    """

    number: int
    variants: tuple[Variant, ...]
    plans: tuple[SentPlan, ...] = ()
    one_by_one: bool = False


@dataclass(frozen=True)
class Batch:
    """Rows of variants that ran together, by column."""

    variants: tuple[Variant, ...]
    columns: Columns


@dataclass
class Runner:
    """Runs the variants of a sweep; there is one in each process that works on it.

    Attributes:
        form: How they are run.
        trust: Code that the plans may name as their controllers.
    """

    form: Form
    trust: Trust = field(default_factory=Trust)
    _families: dict[int, _Family] = field(default_factory=dict)

    def __reduce__(self) -> tuple[type[Runner], tuple[Form, Trust]]:
        """Pickle without the plans: each process makes them ready itself."""
        return Runner, (self.form, self.trust)

    def add(self, family: int, plan: Plan, network: Network) -> None:
        """Add a plan; if there are too many, the oldest is dropped."""
        if family not in self._families:
            while len(self._families) >= FAMILIES_KEPT:
                del self._families[next(iter(self._families))]
            self._families[family] = _Family(plan, network, self.form, self.trust)

    def batches(self, part: Part, begin: Callable[[tuple[Variant, ...]], None] | None = None) -> Iterator[Batch]:
        """Yield the rows of a part's variants, in order; `begin` is called with each batch before it runs."""
        sent = {one.family: one for one in part.plans}
        for (number, failed), members in groupby(part.variants, key=lambda one: (one.family, one.error)):
            together = tuple(members)
            if failed:
                yield Batch(together, error_columns(len(together), failed))
                continue
            if number not in self._families:
                plan = sent[number].plan
                self.add(number, plan, _network(sent[number].map_file, plan))
            family = self._families[number]
            start = 0
            while start < len(together):
                size = 1 if part.one_by_one or self.form == "camera" else TOGETHER
                batch = together[start : start + size]
                start += size
                if begin is not None:
                    begin(batch)
                yield Batch(batch, self._rows(family, batch))

    def _rows(self, family: _Family, batch: tuple[Variant, ...]) -> Columns:
        """Return the rows; a variant that raises is a row with its error."""
        try:
            return family.rows(batch)
        except Exception as fault:
            if len(batch) == 1:
                return error_columns(1, f"{type(fault).__name__}: {fault}")
            return joined([self._rows(family, (one,)) for one in batch])


class _Family:
    """A plan that is ready to run."""

    def __init__(self, plan: Plan, network: Network, form: Form, trust: Trust) -> None:
        self.plan, self.network, self.form, self.trust = plan, network, form, trust
        self.usual = parameter_values(plan.parameters)
        self.checks = VariantChecks(plan, network)
        self.engine: Simulation | None = None
        if form != "camera":
            self.numbers = Numbers(plan, network)
            self.program = build_program(plan, network)
            self.engine = Simulation(network.tables, self.program, interpreted=form == "interpreted")

    def rows(self, batch: Sequence[Variant]) -> Columns:
        """Run variants and return their rows; one whose values the scenario does not allow has its error as its row.

        Of several variants, only those starts are checked that their runs do not show to be sound.
        """
        together = self.engine is not None and len(batch) > 1
        errors = [self.checks.fault(one.values, starts=not together) for one in batch]
        sound = [k for k, error in enumerate(errors) if not error]
        ran, doubtful = self._run([batch[k] for k in sound]) if sound else (error_columns(0, ""), [])
        for k in (sound[place] for place in doubtful):
            errors[k] = self.checks.fault(batch[k].values)
        if not any(errors):
            return ran
        places = {k: place for place, k in enumerate(sound)}
        return joined([error_columns(1, error) if error else _row(ran, places[k]) for k, error in enumerate(errors)])

    def _run(self, batch: Sequence[Variant]) -> tuple[Columns, list[int]]:
        """Return the rows of variants, and the places of those whose starts may be at fault."""
        if self.engine is None:
            return row_of_recording(self.plan, record(self.plan, self.network, batch[0], self.trust)), []
        try:
            numbers = self.numbers.rows([one.values for one in batch])
        except ExpressionError as fault:
            raise SweepError(str(fault)) from None
        draws = [make_draws(one.seed, one.index) for one in batch]
        summaries, _ = self.engine.sweep(numbers, draws, self.plan.step_limit)
        parameters = [{**self.usual, **one.values} for one in batch]
        totals = RunTotals(summaries, self.plan.step)
        doubtful = (totals.raw("start_tight") == 1) | (totals.raw("flag") != op.FAULT_NONE)
        return (
            rows_of_totals(self.plan, totals, parameters, self._avoided(numbers, draws)),
            doubtful.nonzero()[0].tolist(),
        )

    def _avoided(
        self, numbers: NDArray[np.float64], draws: Sequence[Sequence[float]]
    ) -> list[dict[ReferenceName, bool]]:
        """Return for each variant whether the reference drivers that criteria name have no collision."""
        interpreted = self.form == "interpreted"
        verdicts = {
            name: avoided_by(
                name, self.network.tables, self.program, numbers, draws, self.plan.step_limit, interpreted=interpreted
            )
            for name in references_in(self.plan.criteria)
        }
        return [{name: values[k] for name, values in verdicts.items()} for k in range(len(numbers))]


def joined(parts: Sequence[Columns]) -> Columns:
    """Return the rows of all parts, one after the other."""
    return {name: [value for columns in parts for value in columns[name]] for name in parts[0]}


def _row(rows: Columns, place: int) -> Columns:
    """Return one of several rows."""
    return {name: [values[place]] for name, values in rows.items()}


def record(plan: Plan, network: Network, variant: Variant, trust: Trust | None = None) -> Recording:
    """Run one variant in the interpreted engine and return its recording; `trust` is the code its plan may name."""
    chosen = with_values(plan, variant.values)
    world = open_world("kinematic", chosen, network)
    try:
        return run(chosen, world, variant.seed, variant=variant.index, trust=trust)
    finally:
        world.close()


def _network(file: str, plan: Plan) -> Network:
    sink = Diagnostics()
    network = load_network(Path(file), sink=sink)
    if network is None or network.sha256 != plan.map.sha256:
        raise SweepError(f"the map '{plan.map.name}' at {file} is not the one of the plan")
    return network
