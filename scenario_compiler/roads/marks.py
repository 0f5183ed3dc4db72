"""Codes of road marks, their default widths and lines, and the mark of a lane's border at s with its quality.

The quality says how visible a mark is, from 1 (new) to 0 (gone). A file states it in `<userData code="marking_quality"
value="0.3"/>` inside `<roadMark>`; a scenario overrides it on stretches (`Network.with_mark_quality`).
"""

from scenario_compiler.marker import compiled
from scenario_compiler.roads.lanes import lane_row
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

STANDARD_WIDTH = 0.12
"""Width of a mark without one in the file, m; chosen: a common width of lane lines; a bold mark has twice this."""


@compiled
def mark_row(n: RoadTables, road: int, lane: int, s: float) -> int:
    """Return the row of the mark on a lane's outer border at s (lane 0: of the centre line), -1 if there is none."""
    row = lane_row(n, road, lane, s)
    if row < 0:
        return -1
    return row_mark(n, row, s)


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
    quality = n.mark_quality_from[mark]
    length = n.mark_end[mark] - n.mark_s[mark]
    if length > 0.0 and n.mark_quality_to[mark] != quality:
        share = (s - n.mark_s[mark]) / length
        if share < 0.0:
            share = 0.0
        if share > 1.0:
            share = 1.0
        quality = quality + share * (n.mark_quality_to[mark] - quality)
    return n.mark_type[mark], quality, n.mark_colour[mark], n.mark_width[mark]
