"""The output of `compare` for two sweeps."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterable
from dataclasses import asdict
from typing import TYPE_CHECKING

from scenario_compiler.cli.compare import number_text, put_facts
from scenario_compiler.cli.options import AT_FAULT, FINE, WrongUse
from scenario_compiler.cli.terminal import put, put_raw, put_table
from scenario_compiler.legible import legible_json

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from scenario_compiler.batch.comparison import Change, NumberPair, SweepComparison, TablePair

MOST_CHANGES = 40
"""Greatest number of rows of changed outcomes that are printed; --format json has all."""

MOST_VARIANTS = 10
"""Greatest number of variants that are listed in a row; --format json has all."""


def compare_folders(options: argparse.Namespace) -> int:
    """Print the differences between two sweeps.

    Raises:
        WrongUse: A folder contains no finished sweep, no variants belong together, or a page is asked for.
    """
    from scenario_compiler.batch.comparison import compare_sweeps
    from scenario_compiler.batch.distributions import SweepError

    if options.html is not None:
        raise WrongUse("--html plays two runs; for sweeps there are the tables and --format json")
    try:
        found = compare_sweeps(options.first, options.second, tolerance=options.tolerance)
    except SweepError as fault:
        raise WrongUse(str(fault)) from None
    if options.format == "json":
        put_raw(legible_json(as_json(found)))
    else:
        print_sweeps(found, options.tolerance)
    return FINE if found.equal else AT_FAULT


def as_json(found: SweepComparison) -> str:
    """Return a comparison as JSON, with the numbers of all variants that differ."""

    def as_list(array: NDArray[np.int64]) -> object:
        return array.tolist()

    about = {"equal": found.equal, "paired": len(found.pairs), **asdict(found)}
    del about["pairs"]
    return json.dumps(about, default=as_list, allow_nan=False, ensure_ascii=False)


def print_sweeps(found: SweepComparison, tolerance: float | None) -> None:
    """Print a comparison as tables, leaving out empty ones and measures that are the same, and in sentences."""
    put_facts(found.facts)
    _put_table_pair("", found.variants)
    _put_table_pair("takeover's ", found.takeovers)
    for sentence in verdict(found, tolerance):
        put(sentence)


def _put_table_pair(whose: str, pair: TablePair) -> None:
    put_table(
        (f"{whose}measure", "unit", "differ", "first only", "second only", "median", "largest", "variant"),
        [_row_of(one) for one in pair.numbers if one.variants is not None],
    )
    changed = {one.what for one in pair.changes if one.first != one.second}
    shown = [one for one in pair.changes if one.what in changed]
    put_table(
        (f"{whose}outcome", "first", "second", "pairs", "variants"),
        [
            (
                one.what,
                _told(one.first),
                _told(one.second) if one.first != one.second else "=",
                str(one.rows),
                _listed(one),
            )
            for one in shown[:MOST_CHANGES]
        ],
    )
    if len(shown) > MOST_CHANGES:
        put(f"and {len(shown) - MOST_CHANGES} more rows")
        put()


def _row_of(one: NumberPair) -> tuple[str, ...]:
    counts = map(str, (one.differ, one.first_alone, one.second_alone))
    where = "" if one.variants is None else _variant(*one.variants)
    return one.name, one.unit, *counts, number_text(one.median), number_text(one.largest), where


def _told(text: str | None) -> str:
    return "–" if text is None else text or "none"


def _listed(change: Change) -> str:
    shown = [_variant(*pair) for pair in change.variants[:MOST_VARIANTS].tolist()]
    return ", ".join([*shown, "..."] if len(change.variants) > MOST_VARIANTS else shown)


def _variant(first: int, second: int) -> str:
    """Return the number of a variant, and that of the other sweep after a slash if it is another one."""
    return str(first) if first == second else f"{first}/{second}"


def verdict(found: SweepComparison, tolerance: float | None) -> Iterable[str]:
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
