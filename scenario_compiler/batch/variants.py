"""Groups variants by plan: those that differ only in numbers share a plan, the others are compiled again."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from scenario_compiler.batch.distributions import SweepError
from scenario_compiler.batch.sampling import Sample
from scenario_compiler.batch.spec import SweepSpec
from scenario_compiler.compiler import compile_target
from scenario_compiler.controllers.named import refuse_untrusted
from scenario_compiler.diagnostics import CompileError, Diagnostic, Diagnostics, FilePlace, weighed
from scenario_compiler.expressions import Value, format_value
from scenario_compiler.files import is_plan_file
from scenario_compiler.markup.names import MISSING_PARAMETER, UNKNOWN_ARGUMENT
from scenario_compiler.markup.values import COMMAND_LINE
from scenario_compiler.plan.maps import open_plan_map
from scenario_compiler.plan.model import Plan
from scenario_compiler.plan.store import digest_of, read_plan
from scenario_compiler.plan.variants import at_values
from scenario_compiler.roads import Network
from scenario_compiler.runtime.runnable import check_runnable

VARIED = FilePlace("--vary")
"""Place of diagnostics about the values of a varied parameter."""


@dataclass(frozen=True)
class Family:
    """Variants that differ only in numbers.

    Attributes:
        number: Its number, in the order of the families' first variants.
        plan: Their plan, with the slots at their defaults.
        network: The map.
        slots: Varying parameters on which numbers of the plan depend.
    """

    number: int
    plan: Plan
    network: Network
    slots: tuple[str, ...]

    def values(self, sample: Sample) -> Sample:
        """Return the part of a sample that fills slots; SweepError if one is not a number."""
        values: Sample = {}
        for name in self.slots:
            value = sample[name]
            if isinstance(value, (bool, str)):
                raise SweepError(f"{name} is {format_value(value)}, but must be a number")
            values[name] = value
        return values


def with_values(plan: Plan, values: Mapping[str, Value]) -> Plan:
    """Return the plan with other defaults of its parameters, as compiled with `--set`."""
    changed = at_values(plan, values)
    return changed.model_copy(update={"digest": digest_of(changed)})


def _placed(one: Diagnostic, of_settings: Collection[str]) -> Diagnostic:
    """Return a diagnostic about an argument at its option: --vary, unless it also occurs with the settings alone."""
    varied = one.place == COMMAND_LINE and one.message not in of_settings
    return replace(one, place=VARIED) if varied else one


class Families:
    """The families of a sweep, compiled when a variant first needs one.

    A parameter decides structure when it is not among the open parameters of the plan that it is compiled to; which
    ones those are may depend on the other structural ones.
    """

    def __init__(
        self, target: str | Path, spec: SweepSpec, first: Sample, sink: Diagnostics, maps: Sequence[Path] = ()
    ) -> None:
        """Compile the family of the first sample.

        Args:
            target: FILE, FILE#name or a plan's file.
            spec: The sweep.
            first: The first variant's values; they stand in for defaults that are missing.
            sink: Receives the diagnostics of the first compilation.
            maps: Folders in which maps are looked for first.

        Raises:
            CompileError: The scenario is at fault.
            ScenarioNameNeededError: The file has several scenarios and no name is given.
            SweepError: A plan does not leave one of the parameters open.
        """
        self._target, self._spec, self._first, self.maps = target, spec, first, maps
        self.trust = spec.trusted(target)
        self._known: dict[tuple[tuple[str, str], ...], Family | Diagnostics] = {}
        self._numbers: list[Family] = []
        self._digests: dict[str, Family] = {}
        self.base = self._read_plan(sink) if is_plan_file(target) else self._compile_base(sink)

    def of(self, sample: Sample) -> Family | Diagnostics:
        """Return a variant's family, or why its structure cannot be compiled."""
        names: list[str] = []
        while True:
            key = tuple((name, format_value(sample[name])) for name in names)
            if key not in self._known:
                family, faults = self._compile(dict(key))
                self._known[key] = faults if family is None else family
            found = self._known[key]
            if isinstance(found, Diagnostics):
                return found
            more = [name for name in sample if name not in found.slots and name not in names]
            if not more:
                return found
            names += more

    def plan(self, number: int) -> Family:
        """Return a family by its number."""
        return self._numbers[number]

    def _compile_base(self, sink: Diagnostics) -> Family:
        base, found = self._compile({})
        sink.absorb(found)
        if base is None:
            raise CompileError(sink)
        self._known[()] = base
        whole = self.of(self._first)
        if isinstance(whole, Family):
            return whole
        if any(one.code is UNKNOWN_ARGUMENT for one in whole):
            sink.absorb(whole)
            raise CompileError(sink)
        return base

    def _compile(self, structure: Mapping[str, str]) -> tuple[Family | None, Diagnostics]:
        """Return the family of a structure, None if there are errors, and the diagnostics."""
        given = {**self._spec.settings, **structure}
        first = {name: format_value(value) for name, value in self._first.items()}
        of_settings: list[str] = []
        for arguments in (given, {**first, **given}):
            sink = Diagnostics(insisted=frozenset(self._spec.errors))
            done = compile_target(
                self._target, arguments, sink, maps=self.maps, overrides=self._spec.overrides, trust=self.trust
            )
            if done is not None:
                refuse_untrusted(done.plan, sink, self.trust)
            sink.found[:] = weighed(sink.found, self._spec.errors, self._spec.allowed)
            if arguments == self._spec.settings:
                of_settings = [one.message for one in sink]
            sink.found[:] = [_placed(one, of_settings) for one in sink.found]
            if done is not None and not sink.has_errors:
                return self._family(done.plan, done.network), sink
            if not any(one.code is MISSING_PARAMETER for one in sink):
                break
        return None, sink

    def _family(self, plan: Plan, network: Network) -> Family:
        if plan.digest not in self._digests:
            slots = tuple(one.name for one in plan.parameters if one.name in self._first)
            self._digests[plan.digest] = family = Family(len(self._numbers), plan, network, slots)
            self._numbers.append(family)
        return self._digests[plan.digest]

    def _read_plan(self, sink: Diagnostics) -> Family:
        spec = self._spec
        if spec.settings or spec.perception or spec.controller or spec.step or spec.duration:
            raise SweepError("a plan is compiled already: give settings and overrides to compile")
        plan = read_plan(self._target, sink)
        network = None if plan is None else open_plan_map(plan, sink, self.maps)
        if plan is not None:
            refuse_untrusted(plan, sink, self.trust)
        if plan is not None and network is not None:
            check_runnable(plan, network, str(self._target), sink)
        if plan is None or network is None or sink.has_errors:
            raise CompileError(sink)
        family = self._family(plan, network)
        closed = sorted(set(self._first) - set(family.slots))
        if closed:
            raise SweepError(f"the plan has no open parameter '{closed[0]}'; sweep the scenario's file instead")
        self._known[()] = family
        return family
