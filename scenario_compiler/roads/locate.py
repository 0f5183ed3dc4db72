"""Finds road, s, t and lanes for a point in the plane.

The plane is divided into square cells. Each cell lists the chunks (`locate_build`) whose surface may touch it. A chunk
lies in one piece of the reference line and one lane section, so a point is projected onto this piece only: in closed
form on lines and arcs, by Newton's method on spirals and polynomials.
"""

from math import atan2, cos, floor, sin, sqrt, tau

from scenario_compiler.marker import compiled
from scenario_compiler.roads.geometry import lateral_axis, piece_point, road_piece_at
from scenario_compiler.roads.lane_types import is_drivable
from scenario_compiler.roads.lanes import row_at, section_at
from scenario_compiler.roads.tables import ARC, AT_START, LINE, RoadTables

CELL = 16.0
"""Size of a cell, m."""

CELL_BASE = 33554432
"""2^25: offset that makes cell numbers positive, so that a key contains two of them."""

PLANE_LIMIT = 1e8
"""Largest coordinate that is looked up, m."""

S_TOLERANCE = 1e-7
"""Distance beyond the ends of a road or chunk up to which a point still belongs to it, m."""

MIN_ACROSS = 0.01
"""Lower bound of the cosine of the roll; no road is rolled so far."""

NEWTON_LIMIT = 20
STEP_TOLERANCE = 1e-11
TRACK_BEYOND = 0.5
"""Distance beyond its road's end up to which a tracked point is found if no road follows, m."""


@compiled
def cell_key_of(ix: int, iy: int) -> int:
    """Return the key of a cell."""
    return (ix + CELL_BASE) * (2 * CELL_BASE) + iy + CELL_BASE


@compiled
def in_plane(x: float, y: float) -> int:
    """Return 1 if a point can be looked up: both coordinates are finite and not too large."""
    if x > -PLANE_LIMIT and x < PLANE_LIMIT and y > -PLANE_LIMIT and y < PLANE_LIMIT:
        return 1
    return 0


@compiled
def cell_number(coordinate: float) -> int:
    """Return the number of the row of cells that contains a coordinate; beyond the plane, that of the outermost one."""
    if not coordinate > -PLANE_LIMIT:
        coordinate = -PLANE_LIMIT
    if coordinate > PLANE_LIMIT:
        coordinate = PLANE_LIMIT
    return floor(coordinate / CELL)


@compiled
def cell_at(n: RoadTables, x: float, y: float) -> int:
    """Return the row of the cell that contains a point, -1 if no road is near it."""
    if in_plane(x, y) == 0:
        return -1
    key = cell_key_of(cell_number(x), cell_number(y))
    low = 0
    high = len(n.cell_key) - 1
    while low < high:
        middle = (low + high) // 2
        if n.cell_key[middle] < key:
            low = middle + 1
        else:
            high = middle
    if low == high and n.cell_key[low] == key:
        return low
    return -1


@compiled
def project_on_piece(n: RoadTables, piece: int, low: float, high: float, x: float, y: float) -> tuple[float, float]:
    """Return (s, lateral distance in the plane) of a point on a piece.

    The piece is extended beyond its ends; of several feet, the one nearest to [low, high] is returned.
    """
    start = n.piece_s[piece]
    kind = n.piece_kind[piece]
    if kind <= ARC:
        c = n.piece_cos[piece]
        w = n.piece_sin[piece]
        dx = x - n.piece_x[piece]
        dy = y - n.piece_y[piece]
        u = dx * c + dy * w
        v = dy * c - dx * w
        k = n.piece_k[piece]
        if kind == LINE or k == 0.0:
            return start + u, v
        across = 1.0 - k * v
        q = sqrt(k * k * u * u + across * across)
        d = atan2(k * u, across) / k
        turn = tau / abs(k)
        if turn > 0.0:
            d = d + turn * floor((0.5 * (low + high) - start - d) / turn + 0.5)
        return start + d, (2.0 * v - k * (u * u + v * v)) / (1.0 + q)
    s = 0.5 * (low + high)
    margin = high - low + 1.0
    for _ in range(NEWTON_LIMIT):
        px, py, a, k, speed = piece_point(n, piece, s)
        c = cos(a)
        w = sin(a)
        t = (y - py) * c - (x - px) * w
        bend = 1.0 - k * t
        if bend < 0.2:
            bend = 0.2
        if speed < 0.001:
            speed = 0.001
        step = ((x - px) * c + (y - py) * w) / (bend * speed)
        s = s + step
        if s < low - margin:
            s = low - margin
        if s > high + margin:
            s = high + margin
        if step < STEP_TOLERANCE and step > -STEP_TOLERANCE:
            break
    px, py, a, k, speed = piece_point(n, piece, s)
    return s, (y - py) * cos(a) - (x - px) * sin(a)


@compiled
def lean_on_piece(
    n: RoadTables, road: int, piece: int, foot: float, lateral: float, x: float, y: float
) -> tuple[float, float]:
    """Return (s, t) of a point with a known foot on a piece and lateral distance.

    If the road is both rolled and pitched, the axis of t leans along the reference line, and s differs from the foot's.
    """
    along, across, _ = lateral_axis(n, road, foot)
    if across < MIN_ACROSS:
        across = MIN_ACROSS
    if along == 0.0:
        return foot, lateral / across
    s = foot
    t = lateral / across
    for _ in range(NEWTON_LIMIT):
        px, py, a, k, speed = piece_point(n, piece, s)
        c = cos(a)
        w = sin(a)
        along, across, _ = lateral_axis(n, road, s)
        if across < MIN_ACROSS:
            across = MIN_ACROSS
        lateral = (y - py) * c - (x - px) * w
        t = lateral / across
        bend = 1.0 - k * lateral
        if bend < 0.2:
            bend = 0.2
        if speed < 0.001:
            speed = 0.001
        step = ((x - px) * c + (y - py) * w - t * along) / (bend * speed)
        s = s + step
        if step < STEP_TOLERANCE and step > -STEP_TOLERANCE:
            break
    return s, t


@compiled
def project_on_chunk(n: RoadTables, chunk: int, x: float, y: float) -> tuple[int, float, float]:
    """Return (found, s, t) of a point on a chunk.

    found is 1 inside the chunk; 2 beyond its end by no more than a kink of the reference line explains (s is then that
    of the end); otherwise 0.
    """
    if x < n.chunk_x0[chunk] or x > n.chunk_x1[chunk] or y < n.chunk_y0[chunk] or y > n.chunk_y1[chunk]:
        return 0, 0.0, 0.0
    low = n.chunk_s[chunk]
    high = n.chunk_end[chunk]
    s, t = project_on_piece(n, n.chunk_piece[chunk], low, high, x, y)
    road = n.chunk_road[chunk]
    if n.road_superelevation_first[road] < n.road_superelevation_last[road]:
        s, t = lean_on_piece(n, road, n.chunk_piece[chunk], s, t, x, y)
    found = 1
    if s < low:
        if s < low - S_TOLERANCE:
            found = 2
            if s < low - n.chunk_before[chunk] - S_TOLERANCE:
                return 0, 0.0, 0.0
        s = low
    elif s > high:
        if s > high + S_TOLERANCE:
            found = 2
            if s > high + n.chunk_after[chunk] + S_TOLERANCE:
                return 0, 0.0, 0.0
        s = high
    if t < n.chunk_right[chunk] or t > n.chunk_left[chunk]:
        return 0, 0.0, 0.0
    return found, s, t


@compiled
def lane_on_chunk(n: RoadTables, chunk: int, x: float, y: float) -> tuple[int, int, float, float]:
    """Return (found as by `project_on_chunk`, lane row, s, offset) of a point on a chunk's lanes."""
    found, s, t = project_on_chunk(n, chunk, x, y)
    if found == 0:
        return 0, -1, 0.0, 0.0
    row, offset = row_at(n, n.chunk_road[chunk], n.chunk_section[chunk], s, t)
    if row < 0:
        return 0, -1, 0.0, 0.0
    return found, row, s, offset


@compiled
def better_place(n: RoadTables, row: int, offset: float, best: int, best_offset: float) -> int:
    """Return 1 if a lane is preferred to the best one so far.

    The nearer centre (by more than 1 mm) is preferred, then a drivable lane, then the earlier one in the file.
    """
    if best < 0:
        return 1
    gain = abs(best_offset) - abs(offset)
    if gain > 0.001:
        return 1
    if gain < -0.001:
        return 0
    now = is_drivable(n.lane_type[row])
    before = is_drivable(n.lane_type[best])
    if now > before or (now == before and row < best):
        return 1
    return 0


@compiled
def chunks_near(n: RoadTables, cell: int) -> int:
    """Return the number of chunks on which a point of a cell (-1: outside all cells) may lie."""
    if cell < 0:
        return len(n.wide_chunk)
    return n.cell_chunk[cell + 1] - n.cell_chunk[cell] + len(n.wide_chunk)


@compiled
def chunk_near(n: RoadTables, cell: int, k: int) -> int:
    """Return the k-th of these chunks: those of the cell, then the wide ones, which belong to no cell."""
    if cell >= 0:
        at = n.cell_chunk[cell] + k
        if at < n.cell_chunk[cell + 1]:
            return n.chunk_of_cell[at]
        return n.wide_chunk[at - n.cell_chunk[cell + 1]]
    return n.wide_chunk[k]


@compiled
def locate_lane(n: RoadTables, x: float, y: float) -> tuple[int, int, int, float, float]:
    """Return (found, road, lane, s, offset) of the lane with the nearest centre among those that contain a point.

    Driving lanes are preferred on ties. Off the road: (0, -1, 0, 0.0, 0.0).
    """
    best = -1
    best_s = 0.0
    best_offset = 0.0
    exact = 2
    cell = cell_at(n, x, y)
    for i in range(chunks_near(n, cell)):
        found, row, s, offset = lane_on_chunk(n, chunk_near(n, cell, i), x, y)
        if found > 0 and found <= exact:
            better = found < exact
            if not better:
                better = better_place(n, row, offset, best, best_offset) == 1
            if better:
                best = row
                best_s = s
                best_offset = offset
                exact = found
    if best < 0:
        return 0, -1, 0, 0.0, 0.0
    return 1, n.section_road[n.lane_section[best]], n.lane_id[best], best_s, best_offset


@compiled
def project_on_road(n: RoadTables, road: int, hint: float, x: float, y: float) -> tuple[float, float]:
    """Return (s, t) of a point on a road's reference line, extended beyond its ends.

    It is found by Newton's method, starting from the hint.
    """
    s = hint
    length = n.road_length[road]
    if not (s > 0.0):
        s = 0.0
    if s > length:
        s = length
    t = 0.0
    rolled = n.road_superelevation_first[road] < n.road_superelevation_last[road]
    for _ in range(NEWTON_LIMIT):
        piece = road_piece_at(n, road, s)
        if n.piece_kind[piece] == LINE and not rolled:
            foot, t = project_on_piece(n, piece, s, s, x, y)
            if foot >= n.piece_s[piece] and (piece + 1 == n.road_piece[road + 1] or foot < n.piece_s[piece + 1]):
                return min(foot, length + 10.0), t
        px, py, a, k, speed = piece_point(n, piece, s)
        c = cos(a)
        w = sin(a)
        t = (y - py) * c - (x - px) * w
        ahead = (x - px) * c + (y - py) * w
        bend = 1.0 - k * t
        if rolled:
            along, across, _ = lateral_axis(n, road, s)
            if across < MIN_ACROSS:
                across = MIN_ACROSS
            t = t / across
            ahead = ahead - t * along
        if bend < 0.2:
            bend = 0.2
        if speed < 0.001:
            speed = 0.001
        step = ahead / (bend * speed)
        s = s + step
        if s < -10.0:
            s = -10.0
        if s > length + 10.0:
            s = length + 10.0
        if step < 1e-9 and step > -1e-9:
            break
    return s, t


@compiled
def track_on(
    n: RoadTables, road: int, hint: float, x: float, y: float, beyond: float
) -> tuple[int, float, float, float]:
    """Return (found, s, t, |offset| from the lane's centre) of a point on the lanes of one road, found 0 off them."""
    length = n.road_length[road]
    s, t = project_on_road(n, road, hint, x, y)
    if not (s >= -beyond and s <= length + beyond):
        return 0, s, t, 0.0
    if s < 0.0:
        s = 0.0
    if s > length:
        s = length
    row, offset = row_at(n, road, section_at(n, road, s), s, t)
    if row < 0:
        return 0, s, t, 0.0
    return 1, s, t, abs(offset)


@compiled
def track(n: RoadTables, x: float, y: float, road_hint: int, s_hint: float) -> tuple[int, int, float, float]:
    """Return (found, road, s, t) of a point that was at (road, s) a short time ago; found 0 off every road.

    The point is searched on that road, then on the roads linked to the end that it has passed, then by the index. With
    a negative road hint only the index is used.
    """
    if in_plane(x, y) == 0:
        return 0, -1, 0.0, 0.0
    if road_hint >= 0:
        found, s, t, _ = track_on(n, road_hint, s_hint, x, y, S_TOLERANCE)
        if found == 1:
            return 1, road_hint, s, t
        end = 2 * road_hint
        if s > 0.5 * n.road_length[road_hint]:
            end = end + 1
        best = -1
        best_s = 0.0
        best_t = 0.0
        best_offset = 0.0
        for i in range(n.road_exit[end], n.road_exit[end + 1]):
            road = n.exit_road[i]
            start = 0.0
            if n.exit_contact[i] != AT_START:
                start = n.road_length[road]
            found, s, t, offset = track_on(n, road, start, x, y, S_TOLERANCE)
            if found == 1 and (best < 0 or offset < best_offset - 0.001):
                best = road
                best_s = s
                best_t = t
                best_offset = offset
        if best >= 0:
            return 1, best, best_s, best_t
    return track_by_index(n, x, y, road_hint, s_hint)


@compiled
def track_by_index(n: RoadTables, x: float, y: float, road_hint: int, s_hint: float) -> tuple[int, int, float, float]:
    """Return (found, road, s, t) by the index, or else just beyond the end of the hinted road."""
    found, road, _, s, _ = locate_lane(n, x, y)
    if found == 1:
        again, s, t, _ = track_on(n, road, s, x, y, 1.0)
        if again == 1:
            return 1, road, s, t
    if road_hint >= 0:
        found, s, t, _ = track_on(n, road_hint, s_hint, x, y, TRACK_BEYOND)
        if found == 1:
            return 1, road_hint, s, t
    return 0, -1, 0.0, 0.0
