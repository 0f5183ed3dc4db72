"""Ranges of values whose end is below their start."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.markup.codes import EMPTY_RANGE
from scenario_compiler.vocabulary.actions import SpeedRange
from scenario_compiler.vocabulary.conditions import RelativeLaneRange
from scenario_compiler.vocabulary.entities import Traffic
from scenario_compiler.vocabulary.grammar import grammar_of
from scenario_compiler.vocabulary.traversal import walk
from scenario_compiler.vocabulary.word import Word

RANGES: Mapping[type[Word], tuple[str, str]] = {
    Traffic: ("slowest", "fastest"),
    SpeedRange: ("low", "high"),
    RelativeLaneRange: ("least", "greatest"),
}
"""Fields with the least and the greatest of several values, which may be equal."""


def report_empty_ranges(words: Iterable[Word], sink: Diagnostics) -> None:
    """Report each range at or below the words whose end is below its start."""
    for word in (one for root in words for one in walk(root) if type(one) in RANGES):
        least, greatest = (getattr(word, field) for field in RANGES[type(word)])
        if least is not None and greatest is not None and greatest < least:
            name = next(
                name for name, rule in grammar_of(type(word)).attributes.items() if rule.field == RANGES[type(word)][1]
            )
            message = f"the range ends at {greatest:g}, below its start at {least:g}"
            sink.add(EMPTY_RANGE, message, word.place_of(name))
