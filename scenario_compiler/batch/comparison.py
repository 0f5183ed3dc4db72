"""Compares two sweeps variant by variant: by how much numbers differ, and which outcomes changed.

The tables are read one column at a time, so that sweeps of a million variants need little memory.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from scenario_compiler.batch.codebook import PARAMETER, Column
from scenario_compiler.batch.distributions import SweepError
from scenario_compiler.batch.finished import FinishedSweep, SweepTable, open_sweep
from scenario_compiler.recording.break_off import kind_of
from scenario_compiler.recording.comparison import Fact
from scenario_compiler.recording.recording import Booleans, Floats, Integers

ROUNDING = 1e-9
"""Amount by which a difference may exceed a tolerance, because the tolerance is written in decimals."""

NOT_COMPARED = ("variant", "number", "seed", "digest")
"""Columns that identify a row or state how it was made."""

SETS = {
    "failed": ("criterion", "fails", "holds"),
    "avoided_by": ("reference driver", "no collision", "collision"),
}
"""Columns of names separated by spaces: the kind of name, and the words for a name that is there and for another."""

SAMPLING = ("method", "samples", "repeat", "seed", "where")
"""The options that determine the samples, besides the distributions."""


@dataclass(frozen=True, slots=True)
class NumberPair:
    """A column of numbers in the paired rows of two tables.

    Attributes:
        name: Its name.
        unit: Its unit.
        both: Number of rows that have a value in both tables.
        first_alone: Number of rows that have a value in the first table only.
        second_alone: Number of rows that have a value in the second table only.
        differ: Number of rows whose values differ by more than the tolerance, or that have only one value.
        median: Median of the differences, second value minus first; None if no row has both values.
        largest: The difference with the greatest absolute value; None if no row has both values.
        variants: The variants of this difference in the first and the second sweep; if there is none, those of the
            first row that has only one value; None if the column is the same in both.
    """

    name: str
    unit: str
    both: int
    first_alone: int
    second_alone: int
    differ: int
    median: float | None
    largest: float | None
    variants: tuple[int, int] | None


@dataclass(frozen=True, slots=True, eq=False)
class Change:
    """The paired rows that have one text in the first table and one in the second: a cell of a contingency table.

    Attributes:
        what: The column, or the criterion or reference driver.
        first: The text in the first table; None if there is none.
        second: The text in the second table.
        rows: Number of these rows.
        variants: The variants of these rows in the first and second sweep, (rows, 2); empty, (0, 2), if both texts are
            the same.
    """

    what: str
    first: str | None
    second: str | None
    rows: int
    variants: Integers


@dataclass(frozen=True, slots=True, eq=False)
class TablePair:
    """The comparison of two tables in the rows that belong together.

    Attributes:
        rows: Number of these rows.
        first_alone: Number of rows without a counterpart in the first table.
        second_alone: Number of those in the second table.
        numbers: The columns of numbers.
        changes: The texts, by column.
    """

    rows: int
    first_alone: int
    second_alone: int
    numbers: tuple[NumberPair, ...]
    changes: tuple[Change, ...]


@dataclass(frozen=True, slots=True, eq=False)
class SweepComparison:
    """The comparison of two sweeps.

    Attributes:
        facts: How both were made.
        pairs: The paired variants, (pairs, 2), in the first sweep's order.
        first_alone: Variants of the first sweep that are left out, because the second has none with their parameters.
        second_alone: Variants of the second sweep that are left out.
        differ: Number of pairs in which anything differs by more than the tolerance.
        variants: The comparison of the tables of variants.
        takeovers: The comparison of the takeovers of paired variants.
    """

    facts: tuple[Fact, ...]
    pairs: Integers
    first_alone: Integers
    second_alone: Integers
    differ: int
    variants: TablePair
    takeovers: TablePair

    @property
    def equal(self) -> bool:
        """Whether both sweeps have the same variants with the same results; how they were made may differ."""
        return not self.differ and not len(self.first_alone) and not len(self.second_alone)


def compare_sweeps(first: str | Path, second: str | Path, *, tolerance: float | None = None) -> SweepComparison:
    """Compare two sweeps variant by variant.

    Variants belong together if their parameters are equal to the bit. Of several with the same parameters, as with
    `repeat`, the first of one sweep belongs to the first of the other, and so on. Without a tolerance, all results have
    to be bitwise equal. Reasons why variants broke off may differ in their numbers.

    Args:
        first: The folder of a finished sweep.
        second: The folder of the other.
        tolerance: Greatest difference of two numbers that counts as equal, in the unit of their column; None for exact
            equality.

    Raises:
        SweepError: One of the folders contains no finished sweep, or there is no pair of variants.
    """
    sweeps = (open_sweep(Path(first)), open_sweep(Path(second)))
    tables = (sweeps[0].variants, sweeps[1].variants)
    rows = _paired_rows(tables)
    indices = [table.integers("variant") for table in tables]
    pairs = np.stack([one[of_table] for one, of_table in zip(indices, rows, strict=True)], axis=1)
    if not len(pairs):
        raise SweepError(f"no variant of {first} has the parameters of one of {second}{_why_apart(sweeps)}")
    alone = [np.delete(one, of_table) for one, of_table in zip(indices, rows, strict=True)]
    differs = np.zeros(len(pairs), dtype=np.bool_)
    variants = _Together(tables, rows, np.arange(len(pairs)), pairs, differs).compared(tolerance)
    takeovers = _takeovers((sweeps[0].takeovers, sweeps[1].takeovers), pairs, differs, tolerance)
    facts = tuple(_facts(sweeps))
    return SweepComparison(facts, pairs, alone[0], alone[1], int(differs.sum()), variants, takeovers)


Tables = tuple[SweepTable, SweepTable]
Rows = tuple[Integers, Integers]


@dataclass(frozen=True)
class _Together:
    """Rows of two tables that belong together.

    Attributes:
        tables: The tables.
        rows: The rows of each, (n,).
        places: The pair of variants of each row, (n,).
        pairs: The paired variants, (pairs, 2).
        differs: The pairs in which something differs, (pairs,); what is found here is added.
    """

    tables: Tables
    rows: Rows
    places: Integers
    pairs: Integers
    differs: Booleans

    def compared(self, tolerance: float | None, alone: tuple[int, int] = (0, 0)) -> TablePair:
        """Return the comparison of all columns that both tables have."""
        columns = [one for one in _shared(self.tables) if one.column not in NOT_COMPARED]
        return TablePair(
            len(self.places),
            *alone,
            tuple(self.number(one, tolerance) for one in columns if one.kind != "text"),
            tuple(change for one in columns if one.kind == "text" for change in self.changes(one.column)),
        )

    def number(self, column: Column, tolerance: float | None) -> NumberPair:
        """Return the comparison of a column of numbers."""
        one, other = (table.numbers(column.column)[of] for table, of in zip(self.tables, self.rows, strict=True))
        there, other_there = np.isfinite(one), np.isfinite(other)
        both = np.flatnonzero(there & other_there)
        with np.errstate(over="ignore"):
            difference: Floats = np.nan_to_num(other[both] - one[both])
        far = there != other_there
        far[both] = np.abs(difference) > (0.0 if tolerance is None else tolerance + ROUNDING)
        self.differs[self.places[far]] = True
        median = largest = at = None
        if len(both):
            greatest = int(np.argmax(np.abs(difference)))
            with np.errstate(over="ignore"):
                median, largest = float(np.nan_to_num(np.median(difference))), float(difference[greatest])
            at = int(both[greatest]) if largest else None
        if at is None and far.any():
            at = int(np.argmax(far))
        return NumberPair(
            column.column,
            column.unit,
            len(both),
            int((there & ~other_there).sum()),
            int((other_there & ~there).sum()),
            int(far.sum()),
            median,
            largest,
            None if at is None else self._variants(at),
        )

    def changes(self, name: str) -> Iterator[Change]:
        """Yield the comparison of a column of texts: one text, or several names, in each row."""
        (one, other), words = _numbered(self.tables, name)
        codes = (one[self.rows[0]], other[self.rows[1]])
        if name not in SETS:
            yield from self._contingency(name, codes, _reasons(words) if name == "error" else words)
            return
        kind, there, absent = SETS[name]
        for member in sorted({member for word in words if word is not None for member in word.split()}):
            told = [None if word is None else there if member in word.split() else absent for word in words]
            yield from self._contingency(f"{kind} {member}", codes, told)

    def _contingency(self, what: str, codes: Rows, words: Sequence[str | None]) -> Iterator[Change]:
        """Yield each combination of texts; different codes may have the same text."""
        number = {word: k for k, word in enumerate(dict.fromkeys(words))}
        texts = list(number)
        code = np.array([number[word] for word in words], dtype=np.int64)
        combined = code[codes[0]] * len(texts) + code[codes[1]]
        found, counts = np.unique(combined, return_counts=True)
        ends = np.cumsum(counts)
        order = np.argsort(combined, kind="stable")
        for pair, count, end in zip(found.tolist(), counts.tolist(), ends.tolist(), strict=True):
            one, other = divmod(pair, len(texts))
            places = self.places[order[end - count : end]] if one != other else self.places[:0]
            self.differs[places] = True
            yield Change(what, texts[one], texts[other], count, self.pairs[places])

    def _variants(self, row: int) -> tuple[int, int]:
        first, second = self.pairs[self.places[row]].tolist()
        return first, second


def _shared(tables: Tables) -> list[Column]:
    """Return the columns that both tables have, without parameters, as the first describes them."""
    first, second = (table.columns for table in tables)
    return [
        column
        for name, column in first.items()
        if not name.startswith(PARAMETER)
        and name in second
        and (column.kind == "text") == (second[name].kind == "text")
    ]


def _numbered(tables: Tables, name: str) -> tuple[Rows, list[str | None]]:
    """Return a column of texts of both tables as numbers in one list, (rows,) each; None for no text is its last."""
    (one, words), (other, other_words) = (table.texts(name) for table in tables)
    number = {word: k for k, word in enumerate(dict.fromkeys((*words, *other_words)))}
    first, second = (
        np.array([*(number[word] for word in some), len(number)], dtype=np.int64) for some in (words, other_words)
    )
    return (first[one], second[other]), [*number, None]


def _reasons(words: Sequence[str | None]) -> list[str | None]:
    """Return each reason as the first one that differs from it only in its numbers."""
    first: dict[str, str] = {}
    return [None if word is None else first.setdefault(kind_of(word), word) for word in words]


def _paired_rows(tables: Tables) -> Rows:
    """Return the rows of variants that belong together, (pairs,) each; SweepError if other parameters vary."""
    names = [[name for name in table.columns if name.startswith(PARAMETER)] for table in tables]
    for these, those, whose in ((*names, "first"), (*reversed(names), "second")):
        alone = [name.removeprefix(PARAMETER) for name in these if name not in those]
        if alone:
            raise SweepError(f"'{alone[0]}' varies in the {whose} sweep only, so that no variants belong together")
    keys = np.zeros(tables[0].rows + tables[1].rows, dtype=np.int64)
    for name in names[0]:
        codes = np.concatenate(_parameter(tables, name))
        _, keys = np.unique(keys * (int(codes.max(initial=0)) + 1) + codes, return_inverse=True)
    of_table = np.split(keys, [tables[0].rows])
    numbers = [_occurrences(one) for one in of_table]
    most = 1 + max(int(one.max(initial=0)) for one in numbers)
    one, other = (key * most + number for key, number in zip(of_table, numbers, strict=True))
    _, first, second = np.intersect1d(one, other, assume_unique=True, return_indices=True)
    order = np.argsort(first)
    return first[order], second[order]


def _parameter(tables: Tables, name: str) -> Rows:
    """Return numbers, (rows,) each, that are equal where the values of a parameter are equal."""
    texts = [table.columns[name].kind == "text" for table in tables]
    if all(texts):
        return _numbered(tables, name)[0]
    if any(texts):
        return np.zeros(tables[0].rows, dtype=np.int64), np.ones(tables[1].rows, dtype=np.int64)
    values = np.concatenate([table.numbers(name) for table in tables])
    _, codes = np.unique(values, return_inverse=True)
    first, second = np.split(codes, [tables[0].rows])
    return first, second


def _occurrences(keys: Integers) -> Integers:
    """Return how many equal keys are before each one, (n,)."""
    order = np.argsort(keys, kind="stable")
    there = np.arange(len(keys))
    begins = np.diff(keys[order], prepend=-1) != 0
    found = np.empty_like(keys)
    found[order] = there - np.maximum.accumulate(np.where(begins, there, 0))
    return found


def _takeovers(tables: Tables, pairs: Integers, differs: Booleans, tolerance: float | None) -> TablePair:
    """Return the comparison of the takeovers of paired variants: the first with the first, and so on."""
    places = [_places(table.integers("variant"), pairs[:, side]) for side, table in enumerate(tables)]
    rows = [np.flatnonzero(place >= 0) for place in places]
    numbers = [table.integers("number")[of] for table, of in zip(tables, rows, strict=True)]
    most = 1 + max(int(one.max(initial=0)) for one in numbers)
    one, other = (place[of] * most + number for place, of, number in zip(places, rows, numbers, strict=True))
    _, first, second = np.intersect1d(one, other, return_indices=True)
    for place, of, common in zip(places, rows, (first, second), strict=True):
        differs[place[np.delete(of, common)]] = True
    chosen = (rows[0][first], rows[1][second])
    together = _Together(tables, chosen, places[0][chosen[0]], pairs, differs)
    return together.compared(tolerance, (len(rows[0]) - len(first), len(rows[1]) - len(second)))


def _places(values: Integers, known: Integers) -> Integers:
    """Return the place of each value among known ones, (values,); -1 if it is not there."""
    order = np.argsort(known)
    at = np.minimum(np.searchsorted(known[order], values), len(known) - 1)
    return np.where(known[order[at]] == values, order[at], -1)


def _facts(sweeps: tuple[FinishedSweep, FinishedSweep]) -> Iterator[Fact]:
    """Yield facts about how both sweeps were made; differences between these do not count."""
    first, second = (_made(one.manifest) for one in sweeps)
    for what in dict.fromkeys((*first, *second)):
        yield Fact(what, first.get(what, ""), second.get(what, ""))
    alone: tuple[list[str], list[str]] = ([], [])
    for tables in zip(*((one.variants, one.takeovers) for one in sweeps), strict=True):
        shared = {one.column for one in _shared(tables)}
        for names, table in zip(alone, tables, strict=True):
            names += [name for name in table.columns if not name.startswith(PARAMETER) and name not in shared]
    yield Fact("columns that are not compared", ", ".join(alone[0]), ", ".join(alone[1]))


def _made(manifest: Mapping[str, Any]) -> dict[str, str]:
    """Return the settings that determine the rows of a sweep, as texts by name, without those that were not given."""
    spec = _mapping(manifest.get("spec"))
    vary = spec.get("vary")
    varied = [str(text).partition("=") for text in (vary if isinstance(vary, list) else ())]
    options = {name: value for name, value in spec.items() if name not in ("vary", "settings")}
    told = {
        "scenario": manifest.get("target"),
        "plan digest": manifest.get("digest"),
        "version of scenario-compiler": manifest.get("version"),
        "variants": manifest.get("variants"),
        **{f"${name.strip()}": text.strip() for name, _, text in varied},
        **{f"${name}": text for name, text in _mapping(spec.get("settings")).items()},
        **options,
    }
    return {name: _text(value) for name, value in told.items()}


def _mapping(value: Any) -> Mapping[str, Any]:
    return value if isinstance(value, dict) else {}


def _text(value: Any) -> str:
    if isinstance(value, list):
        return ", ".join(map(str, value))
    return "" if value is None or value is False else str(value)


def _why_apart(sweeps: tuple[FinishedSweep, FinishedSweep]) -> str:
    """Return the options by which two sweeps have other samples, for the end of a sentence; empty if unknown."""
    made = [_made(one.manifest) for one in sweeps]
    names = [name for name in made[0] if name.startswith("$") or name in SAMPLING]
    differing = [name for name in names if made[0][name] != made[1].get(name)]
    hint = "values(...) and grid(...) give the same samples with every seed"
    return f": they differ in {', '.join(differing)}; {hint}" if differing else ""
