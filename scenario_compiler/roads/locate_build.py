"""The index over the plane: the reference line in short chunks, and which chunks' surfaces touch each cell."""

from __future__ import annotations

from itertools import pairwise
from math import ceil, cos, floor, sin, sqrt

from scenario_compiler.roads.geometry import piece_point, road_grade, wrap_angle
from scenario_compiler.roads.locate import CELL, cell_key_of
from scenario_compiler.roads.tables import ARC, LINE, POLYNOMIAL, RoadTables

CHUNK_LENGTH = 25.0
"""Longest chunk, m."""

POLYNOMIAL_CHUNK_LENGTH = 5.0
"""Longest chunk of a polynomial, m: its curvature may change quickly."""

CHUNK_TURN = 0.5
"""Most turning of a chunk, rad."""

POLYNOMIAL_CHUNK_TURN = 0.2
"""Most turning of a chunk of a polynomial, rad: a point beside a tight bend then has one foot in it."""

PART_LIMIT = 1000
"""Most chunks of one piece for the sake of its turning."""

CHUNK_LIMIT = 100_000
"""Rough bound on the number of chunks of one network; chunks of a network of more than 10 000 km are
longer."""

CELLS_LIMIT = 400
"""Most cells that a chunk is entered into; a wider one (hundreds of metres of lanes) goes to the list that
is always looked at."""

ENTRIES_LIMIT = 1_000_000
"""Most entries of chunks into cells; a bound on memory for absurdly long roads."""

JOINT_TURN_LIMIT = 0.05
"""Largest kink of a reference line, rad, that a point beside it is still located across."""

JOINT_GAP_LIMIT = 0.05
"""Largest gap at a joint of a reference line, m, that a point is still located across."""


def build_index(n: RoadTables) -> None:
    """Fill the chunk and cell columns."""
    stretch = max(1.0, sum(n.road_length) / CHUNK_LENGTH / CHUNK_LIMIT)
    for road in range(len(n.road_length)):
        _add_road(n, road, stretch)
    cells: dict[int, list[int]] = {}
    entries = 0
    for chunk in range(len(n.chunk_s)):
        x0, x1 = floor(n.chunk_x0[chunk] / CELL), floor(n.chunk_x1[chunk] / CELL)
        y0, y1 = floor(n.chunk_y0[chunk] / CELL), floor(n.chunk_y1[chunk] / CELL)
        touched = (x1 - x0 + 1) * (y1 - y0 + 1)
        if touched > CELLS_LIMIT or entries + touched > ENTRIES_LIMIT:
            n.wide_chunk.append(chunk)
            continue
        entries += touched
        for ix in range(x0, x1 + 1):
            for iy in range(y0, y1 + 1):
                cells.setdefault(cell_key_of(ix, iy), []).append(chunk)
    for key in sorted(cells):
        n.cell_key.append(key)
        n.chunk_of_cell.extend(cells[key])
        n.cell_chunk.append(len(n.chunk_of_cell))


def _add_road(n: RoadTables, road: int, stretch: float) -> None:
    """Cut a road at its pieces and lane sections, and each part into chunks."""
    length = n.road_length[road]
    piece, last_piece = n.road_piece[road], n.road_piece[road + 1] - 1
    low = 0.0
    for section in range(n.road_section[road], n.road_section[road + 1]):
        left, right = _extent(n, road, section)
        stop = n.section_end[section]
        while low < stop:
            high = stop
            if piece < last_piece and n.piece_s[piece + 1] < high:
                high = n.piece_s[piece + 1]
            if high > low and (left > right):
                before = _joint(n, road, piece, left, right) if low <= n.piece_s[piece] else 0.0
                after = 0.0
                if piece < last_piece and high == n.piece_s[piece + 1] and high < length:
                    after = _joint(n, road, piece + 1, left, right)
                _add_part(n, (road, section, piece), (low, high), (left, right), (before, after), stretch)
            low = max(low, high)
            if piece < last_piece and n.piece_s[piece + 1] <= low:
                piece += 1


def _add_part(
    n: RoadTables,
    rows: tuple[int, int, int],
    span: tuple[float, float],
    extent: tuple[float, float],
    beyond: tuple[float, float],
    stretch: float,
) -> None:
    road, section, piece = rows
    low, high = span
    kind = n.piece_kind[piece]
    longest = POLYNOMIAL_CHUNK_LENGTH if kind == POLYNOMIAL else CHUNK_LENGTH
    count = ceil((high - low) / (longest * stretch))
    if kind == ARC:
        count = max(count, min(ceil(abs(n.piece_k[piece]) * (high - low) / CHUNK_TURN), PART_LIMIT))
    elif kind == POLYNOMIAL:
        count = max(count, min(ceil(_turning(n, piece, low, high) / POLYNOMIAL_CHUNK_TURN), PART_LIMIT))
    if len(n.chunk_s) > 2 * CHUNK_LIMIT:
        count = 1
    step = (high - low) / count
    for i in range(count):
        s0 = low + step * i
        s1 = high if i == count - 1 else low + step * (i + 1)
        n.chunk_road.append(road)
        n.chunk_section.append(section)
        n.chunk_piece.append(piece)
        n.chunk_s.append(s0)
        n.chunk_end.append(s1)
        n.chunk_before.append(beyond[0] if i == 0 else 0.0)
        n.chunk_after.append(beyond[1] if i == count - 1 else 0.0)
        n.chunk_left.append(extent[0])
        n.chunk_right.append(extent[1])
        _add_bounds(n, piece, s0, s1, extent, max(beyond) + _lean(n, road, s0, s1, extent))


def _turning(n: RoadTables, piece: int, low: float, high: float) -> float:
    """Return the sum of absolute turns of a piece between samples at most 1 m apart, rad."""
    samples = min(max(8, ceil(high - low)), PART_LIMIT)
    headings = [piece_point(n, piece, low + (high - low) * i / samples)[2] for i in range(samples + 1)]
    return sum(abs(wrap_angle(b - a)) for a, b in pairwise(headings))


def _add_bounds(n: RoadTables, piece: int, s0: float, s1: float, extent: tuple[float, float], beyond: float) -> None:
    """Append bounds of the surface over [s0, s1]: those of sampled corners, widened by what curves between samples."""
    kind = n.piece_kind[piece]
    samples = 2 if kind == LINE else 5 if kind == POLYNOMIAL else 3
    xs, ys = [], []
    margin = beyond + 1e-6
    wide = max(abs(extent[0]), abs(extent[1]))
    last = 0.0
    for i in range(samples):
        x, y, h, _, speed = piece_point(n, piece, s0 + (s1 - s0) * i / (samples - 1))
        c, w = cos(h), sin(h)
        for t in extent:
            xs.append(x - t * w)
            ys.append(y + t * c)
        if i > 0 and kind != LINE:
            turn = abs(wrap_angle(h - last))
            edge = (s1 - s0) / (samples - 1) * max(1.0, speed) + wide * turn
            margin = max(margin, beyond + edge * min(1.0, turn * (0.5 if kind == POLYNOMIAL else 0.2)) + 1e-6)
        last = h
    n.chunk_x0.append(min(xs) - margin)
    n.chunk_x1.append(max(xs) + margin)
    n.chunk_y0.append(min(ys) - margin)
    n.chunk_y1.append(max(ys) + margin)


def _lean(n: RoadTables, road: int, s0: float, s1: float, extent: tuple[float, float]) -> float:
    """Return a bound of how far the surface leans along the reference line on a rolled slope, m."""
    if n.road_superelevation_first[road] >= n.road_superelevation_last[road]:
        return 0.0
    roll = max(abs(v) for v in _range(n, n.road_superelevation_first[road], n.road_superelevation_last[road], s0, s1))
    samples = (abs(road_grade(n, road, s0 + (s1 - s0) * i / 8)) for i in range(9))
    return max(abs(extent[0]), abs(extent[1])) * min(1.0, 1.5 * max(samples)) * min(1.0, roll)


def _joint(n: RoadTables, road: int, piece: int, left: float, right: float) -> float:
    """Return how far, in s, a gap or kink where a piece of a road starts may lead points beside it astray."""
    if piece == n.road_piece[road]:
        return 0.0
    s = n.piece_s[piece]
    x0, y0, h0, _, _ = piece_point(n, piece - 1, s)
    x1, y1, h1, _, _ = piece_point(n, piece, s)
    turn = abs(wrap_angle(h1 - h0))
    if turn > JOINT_TURN_LIMIT:
        return 0.0
    gap = sqrt((x1 - x0) * (x1 - x0) + (y1 - y0) * (y1 - y0))
    return min(gap, JOINT_GAP_LIMIT) + turn * max(abs(left), abs(right))


def _extent(n: RoadTables, road: int, section: int) -> tuple[float, float]:
    """Return bounds (left, right) of t over the lanes of a section."""
    s0, s1 = n.section_s[section], n.section_end[section]
    high, low = _range(n, n.road_offset_first[road], n.road_offset_last[road], s0, s1)
    centre = n.section_lane[section] + n.section_left[section]
    for row in range(n.section_lane[section], n.section_lane[section + 1]):
        widest = _range(n, n.lane_width_first[row], n.lane_width_last[row], s0, s1)[0]
        if row < centre:
            high += max(0.0, widest)
        else:
            low -= max(0.0, widest)
    return high + 1e-6, low - 1e-6


def _range(n: RoadTables, first: int, last: int, s0: float, s1: float) -> tuple[float, float]:
    """Return (highest, lowest) value of a range of cubics over [s0, s1]."""
    if first >= last:
        return 0.0, 0.0
    if last - first == 1 and n.cubic_b[first] == n.cubic_c[first] == n.cubic_d[first] == 0.0:
        return n.cubic_a[first], n.cubic_a[first]
    high, low = -1e300, 1e300
    for i in range(first, last):
        start = n.cubic_s[i]
        d0 = max(0.0, s0 - start)
        d1 = (s1 if i + 1 == last else min(s1, n.cubic_s[i + 1])) - start
        if d1 < d0 and not (i == first and d1 <= 0.0):
            continue
        d1 = max(d0, d1)
        a, b, c, d = n.cubic_a[i], n.cubic_b[i], n.cubic_c[i], n.cubic_d[i]
        places = [d0, d1]
        if d != 0.0:
            root = c * c - 3.0 * b * d
            if root >= 0.0:
                places += [(-c + sqrt(root)) / (3.0 * d), (-c - sqrt(root)) / (3.0 * d)]
        elif c != 0.0:
            places.append(-b / (2.0 * c))
        for place in places:
            if d0 <= place <= d1:
                value = a + place * (b + place * (c + place * d))
                high, low = max(high, value), min(low, value)
    return (high, low) if high >= low else (0.0, 0.0)
