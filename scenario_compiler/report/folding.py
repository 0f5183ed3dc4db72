"""Folds repeated events of a run, so that a page gives an overview."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from scenario_compiler.recording.events import EventRow

LONGEST = 8
"""Greatest number of events in a repeated group."""


@dataclass(frozen=True, slots=True)
class Folded:
    """An event that stands for `times` events of its kind, the last of them at `until`, s."""

    event: EventRow
    times: int
    until: float


def folded(events: Sequence[EventRow]) -> tuple[Folded, ...]:
    """Return events in order, with each repeated group of events (equal except for their times) only once."""
    found: list[Folded] = []
    at = 0
    while at < len(events):
        length, times = _repeat_at(events, at)
        last = at + (times - 1) * length
        found += [Folded(events[at + k], times, events[last + k].t) for k in range(length)]
        at += times * length
    return tuple(found)


def _repeat_at(events: Sequence[EventRow], at: int) -> tuple[int, int]:
    """Return the length of the shortest repeated group that starts here, and the number of repetitions; else (1, 1)."""
    alike = [one.model_copy(update={"t": 0.0}) for one in events[at : at + 64 * LONGEST]]
    for length in range(1, LONGEST + 1):
        times = 1
        while alike[times * length : (times + 1) * length] == alike[:length] and len(alike) >= (times + 1) * length:
            times += 1
        if times > 1:
            return length, times
    return 1, 1
