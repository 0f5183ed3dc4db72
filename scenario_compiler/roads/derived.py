"""Columns that are computed from the contents of a road file.

They are the knots of curves, the links and constants of lanes, and the spatial index.
"""

from __future__ import annotations

from array import array

from scenario_compiler.forms.declaration import Of, columns_of, start_of
from scenario_compiler.forms.form import Form, form_of
from scenario_compiler.roads.locate_build import IN_NO_CELL
from scenario_compiler.roads.tables import (
    CELL,
    CELL_CHUNK,
    CHUNK,
    EXIT,
    KNOT,
    LANE,
    LANE_END,
    LINK,
    POLYNOMIAL_PIECE,
    ROAD_END,
    WIDE,
    RoadTables,
)
from scenario_compiler.roads.topology import StatedLinks

LINKS_A_LANE = 4
"""Initial room for links, for each lane."""

CHUNKS_A_PART = 2
"""Initial room for chunks, for each piece of a reference line and each lane section."""

CELLS_A_CHUNK = 6
"""Initial room for entries into cells, for each chunk."""


def with_knots(tables: RoadTables) -> RoadTables:
    """Return tables in which the knots of curves are filled, so that reference lines can be evaluated.

    Args:
        tables: The roads of a file, as lists; they are consumed. Their links may be missing.
    """
    n: RoadTables = _form(tables).containers["n"]
    _resize(n, POLYNOMIAL_PIECE, len(n.poly_last))
    if len(n.poly_last) > 0:
        _resize(n, KNOT, _form(n).enter("count_knots"))
        _form(n).enter("store_knots")
    return n


def with_derived_columns(n: RoadTables, stated: StatedLinks) -> RoadTables:
    """Return tables as arrays, with all computed columns filled.

    Args:
        n: The contents of a file, with the knots and the links of roads; they are consumed.
        stated: What the file states about links of lanes.
    """
    _fill_links(n, stated)
    _resize(n, LANE, len(n.lane_id))
    _resize(n, CHUNK, CHUNKS_A_PART * (len(n.piece_s) + len(n.section_s)))
    _form(n).enter("note_lanes")
    while (count := _form(n).enter("lay_chunks")) > len(n.chunk_s):
        _resize(n, CHUNK, count)
    _resize(n, CHUNK, count)
    _fill_cells(n)
    return n.in_arrays()


def _fill_links(n: RoadTables, stated: StatedLinks) -> None:
    inputs = stated.of_ends, stated.lanes, stated.of_junctions, stated.connections, stated.pairs
    room = LINKS_A_LANE * len(n.lane_id)
    ends, others = _ints(room), _ints(room)
    while (count := _form(n).enter("list_links", *inputs, ends, others)) > len(ends):
        ends, others = _ints(count), _ints(count)
    del ends[count:], others[count:]
    for one, other in stated.branches:
        ends.extend((one, other))
        others.extend((other, one))
    for of, size in ((LANE_END, 2 * len(n.lane_id)), (LINK, len(ends)), (ROAD_END, 2 * len(n.road_length))):
        _resize(n, of, size)
    memory = _ints(2 * len(n.lane_id)), _ints(len(ends)), _ints(len(ends))
    _resize(n, LINK, _form(n).enter("store_links", ends, others, count, *memory))
    _resize(n, EXIT, len(n.link_lane))
    _resize(n, EXIT, _form(n).enter("store_exits", _ints(2 * len(n.road_length))))


def _fill_cells(n: RoadTables) -> None:
    room = CELLS_A_CHUNK * len(n.chunk_s)
    keys, chunks = _ints(room), _ints(room)
    while (count := _form(n).enter("list_cells", keys, chunks)) > len(keys):
        keys, chunks = _ints(count), _ints(count)
    wide = keys[:count].count(IN_NO_CELL)
    for of, size in ((CELL, count), (CELL_CHUNK, count - wide), (WIDE, wide)):
        _resize(n, of, size)
    _resize(n, CELL, _form(n).enter("store_cells", keys, chunks, _ints(count), _ints(count)))


def _resize(n: RoadTables, of: Of, size: int) -> None:
    """Change the size of the columns that are filled here."""
    for name, declared in columns_of(RoadTables).items():
        if declared.of is of and declared.written:
            column = getattr(n, name)
            wanted = size + (declared.starts is not None)
            del column[wanted:]
            more = column[:0]
            more.append(start_of(RoadTables, name))
            column.extend(more * (wanted - len(column)))


def _ints(count: int) -> array[int]:
    return array("q", bytes(8 * count))


def _form(n: RoadTables) -> Form:
    return form_of("scenario_compiler.roads.entries", n=n)
