"""The lane closest to a point off the road."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Iterator
from math import cos, floor, hypot, sin

from scenario_compiler.roads.geometry import lateral_axis, piece_point
from scenario_compiler.roads.lanes import lane_offset, row_at, row_width
from scenario_compiler.roads.locate import CELL, MIN_ACROSS, PLANE_LIMIT, cell_key_of, project_on_piece
from scenario_compiler.roads.tables import RoadTables

RINGS = 6
"""Number of rings of cells around the point's own that are searched before all chunks are (6 rings: some 100 m)."""


def nearest_lane(n: RoadTables, x: float, y: float) -> tuple[int, float, float] | None:
    """Return (lane row, s, offset) of the lane whose surface is closest to a point; None without lanes or far away.

    s is limited to the road; the offset is that of the point itself, so it may exceed half the lane's width.
    """
    if not (abs(x) < PLANE_LIMIT and abs(y) < PLANE_LIMIT):
        return None
    best: tuple[float, int, float, float] | None = None
    for ring in range(RINGS + 1):
        best = _closest(n, _ring(n, x, y, ring), x, y, best)
        if best is not None and best[0] <= ring * CELL:
            best = _closest(n, n.wide_chunk, x, y, best)
            break
    else:
        best = _closest(n, range(len(n.chunk_s)), x, y, best)
    return None if best is None else best[1:]


def _ring(n: RoadTables, x: float, y: float, ring: int) -> Iterator[int]:
    """Yield the chunks of the cells at the Chebyshev distance `ring`."""
    ix, iy = floor(x / CELL), floor(y / CELL)
    for dx in range(-ring, ring + 1):
        step = 1 if abs(dx) == ring else max(1, 2 * ring)
        for dy in range(-ring, ring + 1, step):
            cell = _cell(n, cell_key_of(ix + dx, iy + dy))
            if cell >= 0:
                yield from n.chunk_of_cell[n.cell_chunk[cell] : n.cell_chunk[cell + 1]]


def _cell(n: RoadTables, key: int) -> int:
    at = bisect_left(n.cell_key, key)
    return at if at < len(n.cell_key) and n.cell_key[at] == key else -1


Found = tuple[float, int, float, float]
"""Distance, lane row, s and offset."""


def _closest(n: RoadTables, chunks: Iterable[int], x: float, y: float, best: Found | None) -> Found | None:
    """Return the closest lane among those of some chunks and the best so far."""
    for chunk in chunks:
        dx = max(n.chunk_x0[chunk] - x, 0.0, x - n.chunk_x1[chunk])
        dy = max(n.chunk_y0[chunk] - y, 0.0, y - n.chunk_y1[chunk])
        if best is None or dx * dx + dy * dy < best[0] * best[0]:
            found = _on_chunk(n, chunk, x, y)
            if found is not None and (best is None or found < best):
                best = found
    return best


def _on_chunk(n: RoadTables, chunk: int, x: float, y: float) -> Found | None:
    """Return the closest lane on a chunk."""
    road, section, piece = n.chunk_road[chunk], n.chunk_section[chunk], n.chunk_piece[chunk]
    low, high = n.chunk_s[chunk], n.chunk_end[chunk]
    s = min(max(project_on_piece(n, piece, low, high, x, y)[0], low), high)
    px, py, h, _, _ = piece_point(n, piece, s)
    along, across, _ = lateral_axis(n, road, s)
    t = ((y - py) * cos(h) - (x - px) * sin(h)) / max(across, MIN_ACROSS)
    left = right = lane_offset(n, road, s)
    centre = n.section_lane[section] + n.section_left[section]
    for row in range(n.section_lane[section], n.section_lane[section + 1]):
        if row < centre:
            left += row_width(n, row, s)
        elif row > centre:
            right -= row_width(n, row, s)
    inside = min(max(t, right), left)
    row, offset = row_at(n, road, section, s, inside)
    if row < 0:
        return None
    ahead, beside = inside * along, inside * across
    gap = hypot(x - (px + ahead * cos(h) - beside * sin(h)), y - (py + ahead * sin(h) + beside * cos(h)))
    return gap, row, s, offset + t - inside
