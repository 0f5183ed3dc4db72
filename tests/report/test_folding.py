"""Repeated events are shown once, with their number and last time."""

from __future__ import annotations

from scenario_compiler.recording.events import EventRow
from scenario_compiler.report.folding import folded


def rows(text: str) -> list[EventRow]:
    names = {"w": "warning", "o": "warning_over", "r": "request"}
    return [EventRow(t=float(at), kind=names[letter]) for at, letter in enumerate(text)]


def told(text: str) -> list[tuple[str, int, float]]:
    return [(one.event.kind, one.times, one.until) for one in folded(rows(text))]


def test_a_repeated_warning_is_shown_once() -> None:
    assert told("wowowor") == [("warning", 3, 4.0), ("warning_over", 3, 5.0), ("request", 1, 6.0)]


def test_what_does_not_repeat_stays_as_it_is() -> None:
    assert told("wr") == [("warning", 1, 0.0), ("request", 1, 1.0)]
    assert told("") == []


def test_events_with_other_causes_are_not_repetitions() -> None:
    one, other = (EventRow(t=1.0, kind="warning", cause=cause) for cause in ("lane_confidence", "path_blocked"))
    assert len(folded([one, other])) == 2
