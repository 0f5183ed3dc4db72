"""Tables with changed marks: the wear and colours of a scenario on stretches of road."""

from __future__ import annotations

from collections.abc import Sequence

from scenario_compiler.forms.arrays import with_columns
from scenario_compiler.forms.declaration import columns_of
from scenario_compiler.roads.marks import MARK_COLOUR_CODES
from scenario_compiler.roads.positions import MarkStretch
from scenario_compiler.roads.tables import RoadTables

MARK_COLUMNS = tuple(name for name in columns_of(RoadTables) if name.startswith("mark_") and name != "mark_line")
LINE_COLUMNS = tuple(name for name in columns_of(RoadTables) if name.startswith("line_"))
PAINT_COLUMNS = (*MARK_COLUMNS, *LINE_COLUMNS, "mark_line", "lane_mark")
"""Columns that overrides replace: all that tells how a map is painted."""

OWN_COLOUR = -1
"""Stands for the colour of the mark and of its lines."""

Piece = tuple[int, float, float, float, float, int]
"""A part of a mark: the mark's row, s and end of the part, quality at both, colour."""


def with_mark_quality(n: RoadTables, roads: dict[str, int], overrides: Sequence[MarkStretch]) -> RoadTables:
    """Return tables, as arrays, whose marks have the overrides (later ones take precedence); all else is shared.

    Raises:
        KeyError: A stretch names a road or a colour that does not exist.
        ValueError: A quality is outside 0 to 1.
    """
    by_road: dict[int, list[MarkStretch]] = {}
    for one in overrides:
        for quality in (one.quality_from, one.quality_to):
            if quality is not None and not 0.0 <= quality <= 1.0:
                raise ValueError(f"mark quality {quality:g} is outside 0 to 1")
        by_road.setdefault(roads[one.road], []).append(one)
    m = RoadTables()
    for row in range(len(n.lane_id)):
        stretches = by_road.get(n.section_road[n.lane_section[row]], ())
        pieces: list[Piece] = [
            (k, n.mark_s[k], n.mark_end[k], n.mark_quality_from[k], n.mark_quality_to[k], OWN_COLOUR)
            for k in range(n.lane_mark[row], n.lane_mark[row + 1])
        ]
        for one in stretches:
            if one.lane is None or one.lane == n.lane_id[row]:
                pieces = [part for piece in pieces for part in _override(piece, one)]
        for piece in pieces:
            _append(n, m, piece)
        m.lane_mark.append(len(m.mark_s))
    return with_columns(n.in_arrays(), {name: getattr(m, name) for name in PAINT_COLUMNS})


def _override(piece: Piece, stretch: MarkStretch) -> list[Piece]:
    """Cut a part of a mark where a stretch starts and ends, and apply the stretch's values to what lies in it."""
    mark, s, end, before, after, colour = piece
    low = max(s, min(stretch.s_from, stretch.s_to))
    high = min(end, max(stretch.s_from, stretch.s_to))
    if low >= high:
        return [piece]
    parts = []
    if s < low:
        parts.append((mark, s, low, before, _between(s, end, before, after, low), colour))
    span = (s, end, before, after)
    if stretch.quality_from is not None and stretch.quality_to is not None:
        span = (stretch.s_from, stretch.s_to, stretch.quality_from, stretch.quality_to)
    within = colour if stretch.colour is None else MARK_COLOUR_CODES[stretch.colour]
    parts.append((mark, low, high, _between(*span, low), _between(*span, high), within))
    if high < end:
        parts.append((mark, high, end, _between(s, end, before, after, high), after, colour))
    return parts


def _between(s0: float, s1: float, q0: float, q1: float, s: float) -> float:
    """Return the quality at s, linear between q0 at s0 and q1 at s1."""
    if s1 == s0 or q0 == q1:
        return q0
    return q0 + (s - s0) / (s1 - s0) * (q1 - q0)


def _append(n: RoadTables, m: RoadTables, piece: Piece) -> None:
    mark, s, end, before, after, colour = piece
    for name in MARK_COLUMNS:
        getattr(m, name).append(getattr(n, name)[mark])
    m.mark_s[-1], m.mark_end[-1] = s, end
    m.mark_quality_from[-1], m.mark_quality_to[-1] = before, after
    first = len(m.line_length)
    for name in LINE_COLUMNS:
        getattr(m, name).extend(getattr(n, name)[n.mark_line[mark] : n.mark_line[mark + 1]])
    m.mark_line.append(len(m.line_length))
    if colour != OWN_COLOUR:
        m.mark_colour[-1] = colour
        for k in range(first, len(m.line_colour)):
            m.line_colour[k] = colour
