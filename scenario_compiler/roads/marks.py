"""Codes of road marks, their default widths and lines, and the mark of a lane's border at s with its quality.

The quality says how visible a mark is, from 1 (new) to 0 (gone). A file states it in `<userData code="marking_quality"
value="0.3"/>` inside `<roadMark>`; a scenario overrides it on stretches (`Network.with_mark_quality`).
"""

from scenario_compiler.marker import compiled
from scenario_compiler.roads.lanes import lane_row_in, section_at
from scenario_compiler.roads.tables import RoadTables

MARK_NONE = 0
MARK_SOLID = 1
MARK_BROKEN = 2
MARK_SOLID_SOLID = 3
MARK_SOLID_BROKEN = 4
MARK_BROKEN_SOLID = 5
MARK_BROKEN_BROKEN = 6
MARK_BOTTS_DOTS = 7
MARK_GRASS = 8
MARK_CURB = 9
MARK_EDGE = 10
MARK_CUSTOM = 11

MARK_TYPES = (
    *(
        "none",
        "solid",
        "broken",
        "solid solid",
        "solid broken",
        "broken solid",
        "broken broken",
        "botts dots",
    ),
    *("grass", "curb", "edge", "custom"),
)
"""The standard's spelling of each mark type code."""

MARK_TYPE_CODES = {name: code for code, name in enumerate(MARK_TYPES)}

MARK_COLOURS = ("standard", "white", "yellow", "blue", "green", "red", "orange", "violet", "black", "other")
"""The standard's spelling of each colour code; "standard" is white."""

MARK_COLOUR_CODES = {name: code for code, name in enumerate(MARK_COLOURS)}

CHANGE_BOTH = 0
CHANGE_NONE = 1
CHANGE_INCREASE = 2
CHANGE_DECREASE = 3

LANE_CHANGES = ("both", "none", "increase", "decrease")
"""The standard's spelling of each lane change code: towards which lane ids a change is allowed."""

LANE_CHANGE_CODES = {name: code for code, name in enumerate(LANE_CHANGES)}

STANDARD_DASH, STANDARD_GAP = 3.0, 9.0
"""Dash and gap of a broken mark where the file gives none, m: the American and CARLA's habit."""

DOT, DOT_GAP = 0.1, 1.1
"""Size and distance of Botts' dots, m."""

MOST_PERIODS = 1.0e6
"""Dashes that are counted at most: beyond them a line counts as one dash or one gap."""

STANDARD_WIDTH = 0.12
"""Width of a mark without one in the file, m; chosen: a common width of lane lines; a bold mark has twice this."""


@compiled
def mark_row(n: RoadTables, road: int, lane: int, s: float) -> int:
    """Return the row of the mark on a lane's outer border at s (lane 0: of the centre line), -1 if there is none."""
    return border_mark(n, section_at(n, road, s), lane, s)


@compiled
def border_mark(n: RoadTables, section: int, lane: int, s: float) -> int:
    """Return the row of the mark on a lane's outer border at s, in its lane section, -1 if there is none."""
    row = lane_row_in(n, section, lane)
    return row_mark(n, row, s) if row >= 0 else -1


@compiled
def row_mark(n: RoadTables, row: int, s: float) -> int:
    """Return the row of the mark on the outer border of a lane's row at s, -1 if there is none."""
    found = -1
    for mark in range(n.lane_mark[row], n.lane_mark[row + 1]):
        if n.mark_s[mark] <= s:
            found = mark
    return found


@compiled
def mark_at(n: RoadTables, road: int, lane: int, s: float) -> tuple[int, float, int, float]:
    """Return (type code, quality, colour code, width) of the mark on a lane's outer border.

    For lane 0 it is that of the centre line; without a mark the type is `MARK_NONE`.
    """
    mark = mark_row(n, road, lane, s)
    if mark < 0:
        return MARK_NONE, 0.0, 0, 0.0
    return n.mark_type[mark], mark_quality(n, mark, s), n.mark_colour[mark], n.mark_width[mark]


@compiled
def mark_quality(n: RoadTables, mark: int, s: float) -> float:
    """Return the quality, 0 to 1, that the map gives a mark's row at s."""
    quality = n.mark_quality_from[mark]
    length = n.mark_end[mark] - n.mark_s[mark]
    if length > 0.0 and n.mark_quality_to[mark] != quality:
        share = (s - n.mark_s[mark]) / length
        if share < 0.0:
            share = 0.0
        if share > 1.0:
            share = 1.0
        quality = quality + share * (n.mark_quality_to[mark] - quality)
    return quality


@compiled
def dashes_up_to(distance: float, dash: float, gap: float) -> float:
    """Return how much of a distance from the start of a broken line on is painted, m."""
    period = max(dash + gap, 0.01)
    whole = int(max(min(distance / period, MOST_PERIODS) + MOST_PERIODS, 0.0)) - MOST_PERIODS
    return whole * dash + min(distance - whole * period, dash)


@compiled
def dashes_between(begin: float, end: float, dash: float, gap: float) -> float:
    """Return the share of a stretch that a broken line paints, by the distances from its start; 1 of a solid line."""
    if dash <= 0.0 or gap <= 0.0:
        return 1.0
    return (dashes_up_to(end, dash, gap) - dashes_up_to(begin, dash, gap)) / max(end - begin, 0.01)


@compiled
def painted_share(n: RoadTables, mark: int, begin: float, end: float) -> float:
    """Return the share of a stretch of s that a mark's row paints, 0 to 1, of its densest line; 0 without a mark."""
    if mark < 0 or n.mark_type[mark] == MARK_NONE:
        return 0.0
    first = n.mark_s[mark]
    most = 0.0
    for k in range(n.mark_line[mark], n.mark_line[mark + 1]):
        start = first + n.line_s[k]
        if n.line_once[k] == 1:
            covered = max(min(start + n.line_length[k], end) - max(start, begin), 0.0)
            most = max(most, covered / max(end - begin, 0.01))
        else:
            most = max(most, dashes_between(begin - start, end - start, n.line_length[k], n.line_space[k]))
    if n.mark_line[mark + 1] > n.mark_line[mark]:
        return most
    kind = n.mark_type[mark]
    if kind >= MARK_GRASS:
        return 0.0
    return dashes_between(begin - first, end - first, standard_dash(kind), standard_gap(kind))


@compiled
def usual_share(n: RoadTables, mark: int, begin: float, end: float) -> float:
    """Return `painted_share`, but of dashes the share of a line that they paint in the long run, wherever they lie."""
    if mark < 0 or n.mark_type[mark] == MARK_NONE:
        return 0.0
    most = 0.0
    for k in range(n.mark_line[mark], n.mark_line[mark + 1]):
        if n.line_once[k] == 1:
            return painted_share(n, mark, begin, end)
        most = max(most, dashes_share(n.line_length[k], n.line_space[k]))
    if n.mark_line[mark + 1] > n.mark_line[mark]:
        return most
    kind = n.mark_type[mark]
    if kind >= MARK_GRASS:
        return 0.0
    return dashes_share(standard_dash(kind), standard_gap(kind))


@compiled
def standard_dash(kind: int) -> float:
    """Return the length of the dashes of a mark whose file gives no lines, m; 0 of a solid one."""
    if kind in (MARK_BROKEN, MARK_BROKEN_BROKEN):
        return STANDARD_DASH
    return DOT if kind == MARK_BOTTS_DOTS else 0.0


@compiled
def standard_gap(kind: int) -> float:
    """Return the space between them, m; 0 of a solid mark."""
    if kind in (MARK_BROKEN, MARK_BROKEN_BROKEN):
        return STANDARD_GAP
    return DOT_GAP if kind == MARK_BOTTS_DOTS else 0.0


@compiled
def dashes_share(length: float, space: float) -> float:
    """Return the share of a line that dashes of a length, m, paint with a space between them, m; 1 of a solid line."""
    if length <= 0.0 or space <= 0.0:
        return 1.0
    return length / max(length + space, 0.01)


@compiled
def evenly_painted(n: RoadTables, mark: int) -> int:
    """Return 1 if `usual_share` of a mark's row is the same for every stretch: no line of it is painted only once."""
    if mark >= 0:
        for k in range(n.mark_line[mark], n.mark_line[mark + 1]):
            if n.line_once[k] == 1:
                return 0
    return 1


@compiled
def painted_width(n: RoadTables, mark: int) -> float:
    """Return the width of a mark's first line, m; 0 without a mark."""
    if mark < 0 or n.mark_type[mark] == MARK_NONE:
        return 0.0
    line = n.mark_line[mark]
    if n.mark_line[mark + 1] > line and n.line_width[line] > 0.0:
        return n.line_width[line]
    return n.mark_width[mark]


@compiled
def painted_colour(n: RoadTables, mark: int) -> int:
    """Return the colour code of a mark's first line; 0 without a mark."""
    if mark < 0:
        return 0
    line = n.mark_line[mark]
    if n.mark_line[mark + 1] > line:
        return n.line_colour[line]
    return n.mark_colour[mark]
