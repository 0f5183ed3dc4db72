"""Finds all lanes of many points in the plane.

A place where two chunks of a road meet, or that lies beyond a kink of its reference line, is found twice and counts
once.
"""

from scenario_compiler.marker import compiled
from scenario_compiler.roads.locate import cell_at, chunk_near, chunks_near, in_plane, lane_on_chunk
from scenario_compiler.roads.tables import RoadTables

SAME_PLACE = 1e-6
"""Difference in s up to which two places of a point on one road count as one, m."""

SAME_PLACE_OVER_KINK = 1.0
"""The same if one of them was found beyond a kink, m."""


@compiled
def is_before(
    kind: int, row: int, s: float, offset: float, other_kind: int, other_row: int, other_s: float, other_offset: float
) -> int:
    """Return 1 if a place comes before another one: by kind, then by distance from the centre, row, s and offset."""
    if kind != other_kind:
        return 1 if kind < other_kind else 0
    if abs(offset) != abs(other_offset):
        return 1 if abs(offset) < abs(other_offset) else 0
    if row != other_row:
        return 1 if row < other_row else 0
    if s != other_s:
        return 1 if s < other_s else 0
    return 1 if offset < other_offset else 0


@compiled
def sort_in(kinds: list[int], rows: list[int], ss: list[float], offsets: list[float], first: int, at: int) -> None:
    """Insert the place at index `at` into the sorted places from `first` on."""
    kind = kinds[at]
    row = rows[at]
    s = ss[at]
    offset = offsets[at]
    while at > first and is_before(kind, row, s, offset, kinds[at - 1], rows[at - 1], ss[at - 1], offsets[at - 1]) == 1:
        kinds[at] = kinds[at - 1]
        rows[at] = rows[at - 1]
        ss[at] = ss[at - 1]
        offsets[at] = offsets[at - 1]
        at = at - 1
    kinds[at] = kind
    rows[at] = row
    ss[at] = s
    offsets[at] = offset


@compiled
def is_known(n: RoadTables, kinds: list[int], rows: list[int], ss: list[float], first: int, last: int, at: int) -> int:
    """Return 1 if the place at index `at` repeats one of those from `first` to before `last`.

    A place beyond a kink does not count beside one on a lane of the same road.
    """
    road = n.section_road[n.lane_section[rows[at]]]
    near = SAME_PLACE
    if kinds[at] == 2:
        near = SAME_PLACE_OVER_KINK
    for k in range(first, last):
        same = n.section_road[n.lane_section[rows[k]]] == road
        if same and (abs(ss[k] - ss[at]) < near or (kinds[at] == 2 and kinds[k] == 1)):
            return 1
    return 0


@compiled
def locate_point(
    n: RoadTables,
    x: float,
    y: float,
    kinds: list[int],
    rows: list[int],
    ss: list[float],
    offsets: list[float],
    first: int,
) -> int:
    """Write every lane that contains a point, the nearest centre first, from `first` on; return the end index.

    There must be room for all chunks near the point; otherwise -1 is returned.

    Args:
        n: The roads.
        x: x of the point, m.
        y: y of the point, m.
        kinds: Working memory.
        rows: Receives the rows of the lanes.
        ss: Receives s, m.
        offsets: Receives the offsets from the lanes' centres, m.
        first: Index of the first lane to write.
    """
    if in_plane(x, y) == 0:
        return first
    cell = cell_at(n, x, y)
    if first + chunks_near(n, cell) > len(rows):
        return -1
    found = first
    for i in range(chunks_near(n, cell)):
        kind, row, s, offset = lane_on_chunk(n, chunk_near(n, cell, i), x, y)
        if kind > 0:
            kinds[found] = kind
            rows[found] = row
            ss[found] = s
            offsets[found] = offset
            sort_in(kinds, rows, ss, offsets, first, found)
            found = found + 1
    kept = first
    for k in range(first, found):
        if is_known(n, kinds, rows, ss, first, kept, k) == 0:
            kinds[kept] = kinds[k]
            rows[kept] = rows[k]
            ss[kept] = ss[k]
            offsets[kept] = offsets[k]
            kept = kept + 1
    for k in range(first, kept):
        kinds[k] = 0
        sort_in(kinds, rows, ss, offsets, first, k)
    return kept


@compiled
def locate_points(
    n: RoadTables,
    xs: list[float],
    ys: list[float],
    starts: list[int],
    kinds: list[int],
    rows: list[int],
    ss: list[float],
    offsets: list[float],
) -> int:
    """Write every lane that contains each of some points; return 1, or 0 if there is not enough room.

    The arrays are those of `locate_point`; `starts` receives the start index of each point's lanes, and the final end.
    """
    end = 0
    for k in range(len(xs)):
        starts[k] = end
        end = locate_point(n, xs[k], ys[k], kinds, rows, ss, offsets, end)
        if end < 0:
            return 0
    starts[len(xs)] = end
    return 1
