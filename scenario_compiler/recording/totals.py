"""The engine's totals of many runs, by which sweeps are judged instead of recordings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from scenario_compiler.engine.columns.totals import SUMMARY, TAKEOVER_FIELDS, TAKEOVERS, TAKEOVERS_AT, Totals
from scenario_compiler.forms.declaration import columns_of
from scenario_compiler.recording.names import EventKind
from scenario_compiler.recording.recording import Floats
from scenario_compiler.recording.traces import TIMED_EVENTS


def finite_or_none(values: Floats) -> list[float | None]:
    """Return numbers (n) as a list, with None for those that are NaN or infinite."""
    numbers = values.astype(object)
    numbers[~np.isfinite(values)] = None
    found: list[float | None] = numbers.tolist()
    return found


@dataclass(frozen=True)
class RunTotals:
    """The totals of runs.

    Attributes:
        summaries: (runs, SUMMARY_SIZE), as `Simulation.sweep` returns them.
        step: Length of a time step, s.
    """

    summaries: Floats
    step: float

    def column(self, name: str) -> Floats:
        """Return a total of each run, (runs,); NaN if it still has its start value, because nothing was measured."""
        values = self.raw(name)
        return np.where(values == columns_of(Totals)[name].start, np.nan, values)

    def raw(self, name: str) -> Floats:
        """Return a total of each run, (runs,), unchanged."""
        return np.asarray(self.summaries[:, SUMMARY.index(name)])

    def of_takeovers(self, name: str) -> Floats:
        """Return a total of each takeover of each run, (runs, TAKEOVERS), NaN if it still has its start value."""
        each = self.summaries[:, TAKEOVERS_AT:].reshape(len(self.summaries), TAKEOVERS, len(TAKEOVER_FIELDS))
        values = each[:, :, TAKEOVER_FIELDS.index(name)]
        return np.where(values == columns_of(Totals)[name].start, np.nan, values)

    def code(self, name: str) -> list[int]:
        """Return a code or index of each run."""
        return [int(value) for value in self.raw(name)]

    @cached_property
    def times(self) -> Mapping[EventKind, Floats]:
        """First time of each kind of event that a measure uses, (runs,), s; NaN if it never occurred."""
        return {kind: self.column(f"time_{kind}") for kind in TIMED_EVENTS}

    @property
    def last_time(self) -> Floats:
        """Time of each run's last row, s, (runs,)."""
        return self.raw("row_time")
