"""Durations in a run: a whole number of steps times the step, so that equal durations are equal numbers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

import numpy as np

from scenario_compiler.recording.names import EventKind
from scenario_compiler.recording.recording import Floats


class Timed(Protocol):
    """Traces or totals, which both have the first times of events."""

    @property
    def step(self) -> float:
        """Length of a time step, s."""
        ...

    @property
    def times(self) -> Mapping[EventKind, Floats]:
        """First time of each kind of `TIMED_EVENTS`, (...), s; NaN if it never occurred."""
        ...


def whole_steps(step: float, durations: Floats) -> Floats:
    """Return durations as whole numbers of steps times the step, s, so that equal ones are equal numbers."""
    return np.asarray(np.round(durations / step) * step)


def after_request(runs: Timed, time: Floats) -> Floats:
    """Return the time from the first request to a time, s, (...); NaN if that is before the request."""
    waited = whole_steps(runs.step, time - runs.times["request"])
    return np.where(waited >= 0, waited, np.nan)
