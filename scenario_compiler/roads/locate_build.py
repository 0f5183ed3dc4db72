"""Builds the spatial index: short chunks of the reference line, and the list of those that touch each cell."""

from math import ceil, cos, sin, sqrt

from scenario_compiler.marker import compiled
from scenario_compiler.roads.geometry import piece_point, road_grade, wrap_angle
from scenario_compiler.roads.locate import cell_key_of, cell_number
from scenario_compiler.roads.ordering import order_by_key
from scenario_compiler.roads.tables import ARC, LINE, POLYNOMIAL, RoadTables

CHUNK_LENGTH = 25.0
"""Greatest length of a chunk, m."""

POLYNOMIAL_CHUNK_LENGTH = 5.0
"""Greatest length of a chunk of a polynomial, m: its curvature may change quickly."""

CHUNK_TURN = 0.5
"""Greatest change of direction in a chunk, rad."""

POLYNOMIAL_CHUNK_TURN = 0.2
"""Greatest change of direction in a chunk of a polynomial, rad: a point beside a tight bend then has only one foot in
it.
"""

PART_LIMIT = 1000
"""Greatest number of chunks of one piece because of its changes of direction."""

CHUNK_LIMIT = 100_000
"""Approximate limit of the number of chunks of a network; chunks of a network of more than 10 000 km are longer."""

CELLS_LIMIT = 400
"""Greatest number of cells for a chunk; a wider one (hundreds of metres of lanes) is listed separately and always
checked.
"""

ENTRIES_LIMIT = 1_000_000
"""Greatest number of entries of chunks into cells; limits the memory for absurdly long roads."""

JOINT_TURN_LIMIT = 0.05
"""Largest kink of a reference line beside which a point is still located, rad."""

JOINT_GAP_LIMIT = 0.05
"""Largest gap at a joint of a reference line beside which a point is still located, m."""

IN_NO_CELL = -1
"""Key of an entry for a chunk that is too wide for the cells."""

SLACK = 1e-6
"""Amount by which bounds are extended because of rounding, m."""


@compiled
def cubic_extremes(n: RoadTables, row: int, low: float, high: float) -> tuple[float, float]:
    """Return (highest, lowest) value of a cubic from `low` to `high`, distances from its start."""
    a = n.cubic_a[row]
    b = n.cubic_b[row]
    c = n.cubic_c[row]
    d = n.cubic_d[row]
    value = a + low * (b + low * (c + low * d))
    end = a + high * (b + high * (c + high * d))
    most = max(value, end)
    least = min(value, end)
    turning = low
    other = low
    if d != 0.0:
        root = c * c - 3.0 * b * d
        if root >= 0.0:
            turning = (-c + sqrt(root)) / (3.0 * d)
            other = (-c - sqrt(root)) / (3.0 * d)
    elif c != 0.0:
        turning = -b / (2.0 * c)
    if turning > low and turning < high:
        value = a + turning * (b + turning * (c + turning * d))
        most = max(most, value)
        least = min(least, value)
    if other > low and other < high:
        value = a + other * (b + other * (c + other * d))
        most = max(most, value)
        least = min(least, value)
    return most, least


@compiled
def range_extremes(n: RoadTables, first: int, last: int, s0: float, s1: float) -> tuple[float, float]:
    """Return (highest, lowest) value of a range of cubics over [s0, s1]; zeros of an empty range."""
    if first >= last:
        return 0.0, 0.0
    most = -1e300
    least = 1e300
    for i in range(first, last):
        start = n.cubic_s[i]
        stop = s1
        if i + 1 < last and n.cubic_s[i + 1] < s1:
            stop = n.cubic_s[i + 1]
        low = max(0.0, s0 - start)
        high = stop - start
        if high >= low or (i == first and high <= 0.0):
            one, other = cubic_extremes(n, i, low, max(low, high))
            most = max(most, one)
            least = min(least, other)
    if most < least:
        return 0.0, 0.0
    return most, least


@compiled
def section_extent(n: RoadTables, section: int) -> tuple[float, float]:
    """Return bounds (left, right) of t over the lanes of a section, m."""
    s0 = n.section_s[section]
    s1 = n.section_end[section]
    road = n.section_road[section]
    left, right = range_extremes(n, n.road_offset_first[road], n.road_offset_last[road], s0, s1)
    centre = n.section_lane[section] + n.section_left[section]
    for row in range(n.section_lane[section], n.section_lane[section + 1]):
        widest, _ = range_extremes(n, n.lane_width_first[row], n.lane_width_last[row], s0, s1)
        if row < centre:
            left = left + max(0.0, widest)
        else:
            right = right - max(0.0, widest)
    return left + SLACK, right - SLACK


@compiled
def joint_reach(n: RoadTables, road: int, piece: int, left: float, right: float) -> float:
    """Return the distance in s within which a gap or kink at the start of a piece may mislocate points beside it, m."""
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


@compiled
def piece_turning(n: RoadTables, piece: int, low: float, high: float) -> float:
    """Return the sum of the absolute changes of direction of a piece between samples at most 1 m apart, rad."""
    samples = min(max(8, ceil(high - low)), PART_LIMIT)
    turning = 0.0
    _, _, last, _, _ = piece_point(n, piece, low)
    for i in range(1, samples + 1):
        _, _, h, _, _ = piece_point(n, piece, low + (high - low) * i / max(samples, 1))
        turning = turning + abs(wrap_angle(h - last))
        last = h
    return turning


@compiled
def surface_lean(n: RoadTables, road: int, s0: float, s1: float, wide: float) -> float:
    """Return a bound of the distance that a surface leans along the reference line on a rolled slope, m.

    Its lanes lie within `wide` of the reference line.
    """
    first = n.road_superelevation_first[road]
    last = n.road_superelevation_last[road]
    if first >= last:
        return 0.0
    most, least = range_extremes(n, first, last, s0, s1)
    roll = max(abs(most), abs(least))
    grade = 0.0
    for i in range(9):
        grade = max(grade, abs(road_grade(n, road, s0 + (s1 - s0) * i / 8)))
    return wide * min(1.0, 1.5 * grade) * min(1.0, roll)


@compiled
def bound_chunk(n: RoadTables, chunk: int, beyond: float) -> None:
    """Write bounds of a chunk's surface: those of sampled corners, extended for the curvature between samples."""
    piece = n.chunk_piece[chunk]
    s0 = n.chunk_s[chunk]
    s1 = n.chunk_end[chunk]
    left = n.chunk_left[chunk]
    right = n.chunk_right[chunk]
    wide = max(abs(left), abs(right))
    beyond = beyond + surface_lean(n, n.chunk_road[chunk], s0, s1, wide)
    kind = n.piece_kind[piece]
    parts = 2
    bulge = 0.2
    if kind == LINE:
        parts = 1
    elif kind == POLYNOMIAL:
        parts = 4
        bulge = 0.5
    margin = beyond + SLACK
    last = 0.0
    x0 = 1e300
    x1 = -1e300
    y0 = 1e300
    y1 = -1e300
    for i in range(parts + 1):
        x, y, h, _, speed = piece_point(n, piece, s0 + (s1 - s0) * i / max(parts, 1))
        c = cos(h)
        w = sin(h)
        x0 = min(x0, x - left * w, x - right * w)
        x1 = max(x1, x - left * w, x - right * w)
        y0 = min(y0, y + left * c, y + right * c)
        y1 = max(y1, y + left * c, y + right * c)
        if i > 0 and kind != LINE:
            turn = abs(wrap_angle(h - last))
            edge = (s1 - s0) / max(parts, 1) * max(1.0, speed) + wide * turn
            margin = max(margin, beyond + edge * min(1.0, turn * bulge) + SLACK)
        last = h
    n.chunk_x0[chunk] = x0 - margin
    n.chunk_x1[chunk] = x1 + margin
    n.chunk_y0[chunk] = y0 - margin
    n.chunk_y1[chunk] = y1 + margin


@compiled
def lay_part(
    n: RoadTables,
    chunk: int,
    section: int,
    piece: int,
    low: float,
    high: float,
    left: float,
    right: float,
    before: float,
    after: float,
    stretch: float,
) -> int:
    """Divide the part of a piece that lies in a section into chunks, from number `chunk` on; return the next number.

    Chunks for which there is no room are only counted.
    """
    kind = n.piece_kind[piece]
    longest = CHUNK_LENGTH
    if kind == POLYNOMIAL:
        longest = POLYNOMIAL_CHUNK_LENGTH
    count = ceil((high - low) / max(longest * stretch, 1.0))
    if kind == ARC:
        count = max(count, min(ceil(abs(n.piece_k[piece]) * (high - low) / CHUNK_TURN), PART_LIMIT))
    elif kind == POLYNOMIAL:
        count = max(count, min(ceil(piece_turning(n, piece, low, high) / POLYNOMIAL_CHUNK_TURN), PART_LIMIT))
    if chunk > 2 * CHUNK_LIMIT:
        count = 1
    step = (high - low) / max(count, 1)
    for i in range(count):
        at = chunk + i
        if at < len(n.chunk_s):
            n.chunk_road[at] = n.section_road[section]
            n.chunk_section[at] = section
            n.chunk_piece[at] = piece
            n.chunk_s[at] = low + step * i
            n.chunk_end[at] = low + step * (i + 1)
            n.chunk_before[at] = 0.0
            n.chunk_after[at] = 0.0
            if i == 0:
                n.chunk_before[at] = before
            if i == count - 1:
                n.chunk_end[at] = high
                n.chunk_after[at] = after
            n.chunk_left[at] = left
            n.chunk_right[at] = right
            bound_chunk(n, at, max(before, after))
    return chunk + count


@compiled
def lay_road(n: RoadTables, chunk: int, road: int, stretch: float) -> int:
    """Divide a road at its pieces and lane sections, and each part into chunks; return the next chunk's number."""
    piece = n.road_piece[road]
    last_piece = n.road_piece[road + 1] - 1
    low = 0.0
    for section in range(n.road_section[road], n.road_section[road + 1]):
        left, right = section_extent(n, section)
        stop = n.section_end[section]
        while low < stop:
            high = stop
            if piece < last_piece and n.piece_s[piece + 1] < high:
                high = n.piece_s[piece + 1]
            if high > low and left > right:
                before = 0.0
                if low <= n.piece_s[piece]:
                    before = joint_reach(n, road, piece, left, right)
                after = 0.0
                if piece < last_piece and high == n.piece_s[piece + 1] and high < n.road_length[road]:
                    after = joint_reach(n, road, piece + 1, left, right)
                chunk = lay_part(n, chunk, section, piece, low, high, left, right, before, after, stretch)
            low = max(low, high)
            if piece < last_piece and n.piece_s[piece + 1] <= low:
                piece = piece + 1
    return chunk


@compiled
def lay_chunks(n: RoadTables) -> int:
    """Fill the columns of chunks as far as there is room; return the number of chunks."""
    length = 0.0
    for road in range(len(n.road_length)):
        length = length + n.road_length[road]
    stretch = max(1.0, length / CHUNK_LENGTH / CHUNK_LIMIT)
    chunk = 0
    for road in range(len(n.road_length)):
        chunk = lay_road(n, chunk, road, stretch)
    return chunk


@compiled
def list_cells(n: RoadTables, keys: list[int], chunks: list[int]) -> int:
    """List the keys of the cells that each chunk touches, as far as there is room; return the number of entries.

    A chunk that is too wide for the cells has one entry, with the key IN_NO_CELL.
    """
    count = 0
    entries = 0
    for chunk in range(len(n.chunk_s)):
        x0 = cell_number(n.chunk_x0[chunk])
        x1 = cell_number(n.chunk_x1[chunk])
        y0 = cell_number(n.chunk_y0[chunk])
        y1 = cell_number(n.chunk_y1[chunk])
        touched = (x1 - x0 + 1) * (y1 - y0 + 1)
        if touched > CELLS_LIMIT or entries + touched > ENTRIES_LIMIT:
            if count < len(keys):
                keys[count] = IN_NO_CELL
                chunks[count] = chunk
            count = count + 1
        else:
            entries = entries + touched
            for ix in range(x0, x1 + 1):
                for iy in range(y0, y1 + 1):
                    if count < len(keys):
                        keys[count] = cell_key_of(ix, iy)
                        chunks[count] = chunk
                    count = count + 1
    return count


@compiled
def store_cells(n: RoadTables, keys: list[int], chunks: list[int], order: list[int], merged: list[int]) -> int:
    """Fill the columns of cells from the entries of `list_cells`; return the number of cells.

    Args:
        n: The tables; there is room for the cells.
        keys: The key of each entry.
        chunks: Its chunk.
        order: Working memory, a number for each entry.
        merged: The same.
    """
    order_by_key(keys, order, merged)
    wide = 0
    cells = 0
    held = 0
    for k in range(len(order)):
        key = keys[order[k]]
        if key == IN_NO_CELL:
            n.wide_chunk[wide] = chunks[order[k]]
            wide = wide + 1
        else:
            if cells == 0 or n.cell_key[cells - 1] != key:
                n.cell_key[cells] = key
                cells = cells + 1
            n.chunk_of_cell[held] = chunks[order[k]]
            held = held + 1
            n.cell_chunk[cells] = held
    return cells
