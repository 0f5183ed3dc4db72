"""Widens lanes that begin or end with no width, because CARLA's clients may compute -2e-13 m there and abort."""

from __future__ import annotations

from itertools import pairwise

from lxml import etree

from scenario_compiler.roads.text_edits import TextEdits, number_of

LEAST = 1e-9
"""Amount by which such a lane is widened, m: far above rounding errors, and negligible on a road."""

NEARLY = 1e-6
"""Amount by which rounding may make a width negative, m; a smaller width is that of the file itself."""


def widen_thin_lanes(edits: TextEdits, road: etree._Element) -> None:
    """Increase widths that begin or end at zero a little.

    Args:
        edits: Receives the changes; one call for each road, whose widths nothing else may change.
        road: The road's element.
    """
    sections = sorted(road.iterfind("{*}lanes/{*}laneSection"), key=lambda one: number_of(one, "s"))
    ends = [*(number_of(one, "s") for one in sections), number_of(road, "length")]
    for section, (start, end) in zip(sections, pairwise(ends), strict=True):
        for lane in section.iterfind("{*}*/{*}lane"):
            records = sorted(lane.iterfind("{*}width"), key=lambda one: number_of(one, "sOffset"))
            offsets = [*(number_of(one, "sOffset") for one in records), end - start]
            for record, (low, high) in zip(records, pairwise(offsets), strict=True):
                a, b, c, d = (number_of(record, name) for name in "abcd")
                ds = high - low
                least = min(a, a + ds * (b + ds * (c + ds * d)))
                if any((b, c, d)) and -NEARLY < least < LEAST:
                    edits.set(record, "a", repr(a + LEAST))
