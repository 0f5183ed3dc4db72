"""Columns that are computed from the contents of a road file: constants of lanes, and the spatial index."""

from __future__ import annotations

from array import array

from scenario_compiler.forms.declaration import Of, columns_of, start_of
from scenario_compiler.forms.form import Form, form_of
from scenario_compiler.roads.locate_build import IN_NO_CELL
from scenario_compiler.roads.tables import CELL, CELL_CHUNK, CHUNK, LANE, WIDE, RoadTables

CHUNKS_A_PART = 2
"""Initial room for chunks, for each piece of a reference line and each lane section."""

CELLS_A_CHUNK = 6
"""Initial room for entries into cells, for each chunk."""


def with_derived_columns(tables: RoadTables) -> RoadTables:
    """Return tables as arrays, with the computed columns filled.

    Args:
        tables: The contents of a file, as lists; they are consumed.
    """
    n: RoadTables = _form(tables).containers["n"]
    _resize(n, LANE, len(n.lane_id))
    _resize(n, CHUNK, CHUNKS_A_PART * (len(n.piece_s) + len(n.section_s)))
    _form(n).enter("note_lanes")
    while (count := _form(n).enter("lay_chunks")) > len(n.chunk_s):
        _resize(n, CHUNK, count)
    _resize(n, CHUNK, count)
    _fill_cells(n)
    return n.in_arrays()


def _fill_cells(n: RoadTables) -> None:
    room = CELLS_A_CHUNK * len(n.chunk_s)
    keys, chunks = _ints(room), _ints(room)
    while (count := _form(n).enter("list_cells", keys, chunks)) > len(keys):
        keys, chunks = _ints(count), _ints(count)
    order = array("q", sorted(range(count), key=keys.tolist().__getitem__))
    wide = keys[:count].count(IN_NO_CELL)
    for of, size in ((CELL, count), (CELL_CHUNK, count - wide), (WIDE, wide)):
        _resize(n, of, size)
    _resize(n, CELL, _form(n).enter("store_cells", order, keys, chunks))


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
