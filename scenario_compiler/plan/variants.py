"""Checks a plan at other values of its parameters, for the errors that compiling with them would report.

A sweep runs thousands of variants of one plan, and compiling each would take longer than running it. For that reason
only what depends on open parameters is checked again: the limits of attributes, positions, overlaps of entities, and
the times along paths.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from scenario_compiler.diagnostics import Diagnostics, Severity
from scenario_compiler.expressions import Value, format_value
from scenario_compiler.plan.binding import Binder
from scenario_compiler.plan.checks.overlap import Overlaps
from scenario_compiler.plan.checks.paths import check_paths
from scenario_compiler.plan.model import Plan
from scenario_compiler.plan.standing import after_init, standings_of
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.grammar import out_of_limits
from scenario_compiler.vocabulary.positions import BoundPosition, LanePositionWord, RandomPosition
from scenario_compiler.vocabulary.scenario import parameter_values
from scenario_compiler.vocabulary.traversal import parameters_in, walk
from scenario_compiler.vocabulary.word import Word


class VariantChecks:
    """The checks of a plan's variants."""

    def __init__(self, plan: Plan, network: Network) -> None:
        """Find what depends on parameters."""
        self._plan, self._network = plan, network
        self._usual = parameter_values(plan.parameters)
        self._limits = tuple((one.name, one.limits) for one in plan.parameters)
        self._forgiving = plan.controller is None
        self._positions = tuple(_open_positions(plan))
        self._starts = {one.id: one.start for one in plan.entities if one.start is not None}
        self._moved = _moved(self._starts)
        self._overlaps = Overlaps(plan)
        fixed = {name: start for name, start in self._starts.items() if name not in self._moved}
        self._fixed, _ = standings_of(self._binder(self._usual, Diagnostics()), fixed)
        self._timed_paths = any(limit.holder == "time" for limit in plan.limits)

    def fault(self, sample: Mapping[str, Value], *, starts: bool = True) -> str:
        """Return the first error of compiling with these values of the parameters; empty if there is none.

        Args:
            sample: The values; missing ones have their defaults.
            starts: Whether to check where entities start. A sweep leaves this out for starts that their runs show to be
                sound (see `Totals.start_tight`).
        """
        values = {**self._usual, **sample}
        fault = self._beyond_limits(values)
        starts = bool(self._moved) and (starts or self._timed_paths)
        if fault or self._forgiving or not (starts or self._positions or self._timed_paths):
            return fault
        sink = Diagnostics()
        binder = self._binder(values, sink)
        for position in self._positions:
            binder.bind(position, 0.0)
        if not sink.has_errors and starts:
            self._check_starts(binder)
        if self._timed_paths:
            check_paths(at_values(self._plan, values), self._network, sink)
        return next((one.message for one in sink if one.severity is Severity.ERROR), "")

    def _beyond_limits(self, values: Mapping[str, Value]) -> str:
        for name, limits in self._limits:
            value = values[name]
            fault = "" if isinstance(value, str) else out_of_limits(name, value, limits)
            if fault:
                return fault
        return next((fault for limit in self._plan.limits if (fault := limit.fault(values))), "")

    def _check_starts(self, binder: Binder) -> None:
        moved, _ = standings_of(binder, {name: self._starts[name] for name in self._moved}, self._fixed)
        standings = after_init(binder, self._plan.storyboard, {**self._fixed, **moved})
        self._overlaps.report({name: standing.pose for name, standing in standings.items()}, binder.sink)

    def _binder(self, values: Mapping[str, Value], sink: Diagnostics) -> Binder:
        return Binder(self._network, values, sink, forgiving=self._forgiving)


def _parts(plan: Plan) -> Iterator[Word]:
    for entity in plan.entities:
        yield from (word for word in (entity.start, entity.follow, entity.path) if word is not None)
    yield from (plan.storyboard, plan.takeover, plan.camera)
    yield from (*plan.criteria, *plan.markings, *plan.secondary_markings, *plan.signal_controllers)


def _open_positions(plan: Plan) -> Iterator[LanePositionWord | RandomPosition]:
    """Yield the absolute positions that depend on parameters, without those relative to an entity."""
    for word in (inner for part in _parts(plan) for inner in walk(part)):
        if isinstance(word, LanePositionWord | RandomPosition) and parameters_in(word):
            yield word


def _moved(starts: Mapping[str, BoundPosition]) -> tuple[str, ...]:
    """Return the entities whose starts depend on parameters, directly or through another entity, in document order."""
    moved = {name for name, start in starts.items() if parameters_in(start)}
    while True:
        more = {name for name, start in starts.items() if getattr(start, "entity", None) in moved} - moved
        if not more:
            return tuple(name for name in starts if name in moved)
        moved |= more


def at_values(plan: Plan, values: Mapping[str, Value]) -> Plan:
    """Return the plan with other default values of its parameters; its digest is still that of the given plan."""
    parameters = tuple(
        one.model_copy(update={"default": format_value(values[one.name])}) if one.name in values else one
        for one in plan.parameters
    )
    return plan.model_copy(update={"parameters": parameters})
