"""How `compare` prints what differs between two runs or two sweeps."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import astuple
from typing import TYPE_CHECKING, NamedTuple

from scenario_compiler.cli.terminal import put, put_table

if TYPE_CHECKING:
    from scenario_compiler.batch.comparison import Change, NumberPair, SweepComparison, TablePair
    from scenario_compiler.recording.comparison import Comparison, Fact

MOST_EVENTS = 40
"""Greatest number of events that are printed; --format json has all."""

MOST_CHANGES = 40
"""Greatest number of rows of changed outcomes that are printed; --format json has all."""

MOST_VARIANTS = 10
"""Greatest number of variants that are listed in a row; --format json has all."""


def print_comparison(found: Comparison, tolerance: float | None) -> None:
    """Print a comparison as tables, leaving out empty ones, and in sentences."""
    put_table(*_facts(found.facts))
    put_table(
        ("entity", "rows", "alone", "apart, m", "at, s", "x, m", "y, m", "h, rad", "v, m/s"),
        [
            (entity, str(rows), str(alone), *map(_number, greatest))
            for entity, rows, alone, *greatest in map(astuple, found.apart)
        ],
    )
    put_table(
        ("event", "entity", "cause", "message", "first, s", "second, s"),
        [
            (one.kind, one.entity, one.cause, one.message, _number(one.first), _number(one.second))
            for one in found.events[:MOST_EVENTS]
        ],
    )
    if len(found.events) > MOST_EVENTS:
        put(f"and {len(found.events) - MOST_EVENTS} more events")
        put()
    put_table(
        ("measure", "unit", "first", "second", "difference"),
        [
            (one.name, one.unit, _number(one.first), _number(one.second), _number(one.difference))
            for one in found.measures
            if one.first is not None or one.second is not None
        ],
    )
    for sentence in verdict(found, tolerance):
        put(sentence)


def _facts(facts: Iterable[Fact]) -> tuple[Sequence[str], Sequence[Sequence[str]]]:
    """Return the headings and rows of a table of properties that are known of one side at least."""
    return ("", "first", "second"), [
        (one.what, one.first, "=" if one.first == one.second else one.second)
        for one in facts
        if one.first or one.second
    ]


def verdict(found: Comparison, tolerance: float | None) -> Iterable[str]:
    """Yield the result of the comparison, in sentences."""
    parting = found.parting
    if parting is not None:
        name, unit = _called(parting.column)
        whose = f"the {name} of {parting.entity}" if parting.entity else f"the {name}"
        values = f"{_valued(parting.first, unit)} in the first, {_valued(parting.second, unit)} in the second"
        yield f"The rows first differ at {parting.t:.6g} s: {whose} is {values}."
    if not found.same_times:
        yield f"The runs have different rows: {found.rows} rows are at times that both have."
    for fact in found.facts:
        if fact.counts and fact.first != fact.second:
            yield f"The runs differ in: {fact.what}."
    times = [min(t for t in (one.first, one.second) if t is not None) for one in found.events if one.counts]
    counting = len(times)
    if counting:
        yield f"Events that differ: {counting}, the first of them at {min(times):.6g} s."
    if counting < len(found.events):
        yield f"Events that only the sensors of one world report: {len(found.events) - counting}."
    within = "" if tolerance is None else f" within {tolerance:g} m"
    yield f"The same happened in both{within}." if found.equal else "The runs differ."


def _valued(value: str, unit: str) -> str:
    """Return a value with its unit; one that is not there has none."""
    return {"nan": "missing", "absent": "absent"}.get(value, f"{value}{unit}")


def _called(column: str) -> tuple[str, str]:
    """Return the name of a recording's column for a sentence, and its unit after a space."""
    from scenario_compiler.recording.recording import COLUMNS
    from scenario_compiler.report.wording import unit_words

    known = {one.name: one for one in COLUMNS}.get(column)
    unit = unit_words(known.unit) if known is not None else "m" if column == "x, y" else ""
    name = {"x, y": "position", "v": "speed", "a": "acceleration", "h": "heading"}.get(column, column.replace("_", " "))
    return name, f" {unit}" if unit else ""


def _number(value: float | None) -> str:
    return "–" if value is None else f"{value:.4g}"


class TextTable(NamedTuple):
    """A table of texts: its title, its headings, its rows, and the number of further rows that are left out."""

    title: str
    headings: Sequence[str]
    rows: Sequence[Sequence[str]]
    more: int = 0


def print_sweeps(found: SweepComparison, tolerance: float | None) -> None:
    """Print a comparison as tables and in sentences."""
    for table in sweep_tables(found):
        put_table(table.headings, table.rows)
        if table.more:
            put(f"and {table.more} more rows")
            put()
    for sentence in sweeps_verdict(found, tolerance):
        put(sentence)


def sweep_tables(found: SweepComparison) -> list[TextTable]:
    """Return a comparison as tables, without empty ones and without measures and outcomes that are the same."""
    tables = [
        TextTable("How the sweeps were made", *_facts(found.facts)),
        *_tables_of("variants", "", found.variants),
        *_tables_of("takeovers", "takeover's ", found.takeovers),
    ]
    return [table for table in tables if table.rows]


def _tables_of(what: str, whose: str, pair: TablePair) -> Iterator[TextTable]:
    measure = (f"{whose}measure", "unit", "differ", "first only", "second only", "median", "largest", "variant")
    rows = [_row_of(one) for one in pair.numbers if one.variants is not None]
    yield TextTable(f"Measures of {what}", measure, rows)
    changed = {one.what for one in pair.changes if one.first != one.second}
    shown = [
        (one.what, _told(one.first), "=" if one.first == one.second else _told(one.second), str(one.rows), _listed(one))
        for one in pair.changes
        if one.what in changed
    ]
    outcome = (f"{whose}outcome", "first", "second", "pairs", "variants")
    yield TextTable(f"Outcomes of {what}", outcome, shown[:MOST_CHANGES], max(len(shown) - MOST_CHANGES, 0))


def _row_of(one: NumberPair) -> tuple[str, ...]:
    counts = map(str, (one.differ, one.first_alone, one.second_alone))
    where = "" if one.variants is None else _variant(*one.variants)
    return one.name, one.unit, *counts, _number(one.median), _number(one.largest), where


def _told(text: str | None) -> str:
    return "–" if text is None else text or "none"


def _listed(change: Change) -> str:
    shown = [_variant(*pair) for pair in change.variants[:MOST_VARIANTS].tolist()]
    return ", ".join([*shown, "..."] if len(change.variants) > MOST_VARIANTS else shown)


def _variant(first: int, second: int) -> str:
    """Return the number of a variant, and that of the other sweep after a slash if it is another one."""
    return str(first) if first == second else f"{first}/{second}"


def sweeps_verdict(found: SweepComparison, tolerance: float | None) -> Iterable[str]:
    """Yield the result of the comparison, in sentences."""
    yield f"Variants with the same parameters in both sweeps: {len(found.pairs)} pairs."
    for name, alone in (("first", found.first_alone), ("second", found.second_alone)):
        if len(alone):
            yield f"Variants of the {name} sweep that are left out: {len(alone)}."
    takeovers = found.takeovers
    for name, count in (("first", takeovers.first_alone), ("second", takeovers.second_alone)):
        if count:
            yield f"Takeovers that only the {name} sweep has: {count}."
    more, within = ("", "") if tolerance is None else (f" by more than {tolerance:g}", f" within {tolerance:g}")
    if found.differ:
        yield f"Pairs that differ{more}: {found.differ}."
    yield f"The sweeps are equal{within}." if found.equal else "The sweeps differ."
