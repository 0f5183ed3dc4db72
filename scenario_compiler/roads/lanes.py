"""Lanes: from (road, lane, s, offset) to t and to a pose, and from (road, s, t) to the lane.

Left and right are as seen along increasing s. A width below 0 counts as 0.
"""

from math import atan, cos, sin, tau

from scenario_compiler.marker import compiled
from scenario_compiler.roads.geometry import (
    cubic_slope,
    cubic_value,
    piece_point,
    road_curvature,
    road_frame,
    road_piece_at,
    wrap_heading,
)
from scenario_compiler.roads.lane_types import NONE
from scenario_compiler.roads.tables import ARC, LINE, RoadTables


@compiled
def section_at(n: RoadTables, road: int, s: float) -> int:
    """Return the row of the lane section that contains s, -1 on a road without lanes.

    It is the last one that starts at or before s.
    """
    low = n.road_section[road]
    high = n.road_section[road + 1] - 1
    if low > high:
        return -1
    while low < high:
        middle = (low + high + 1) // 2
        if n.section_s[middle] <= s:
            low = middle
        else:
            high = middle - 1
    return low


@compiled
def lane_row_in(n: RoadTables, section: int, lane: int) -> int:
    """Return the row of a lane in a section, -1 if it has none."""
    if section < 0:
        return -1
    first = n.section_lane[section]
    last = n.section_lane[section + 1]
    row = first + n.section_left[section] - lane
    if row >= first and row < last and n.lane_id[row] == lane:
        return row
    for row in range(first, last):
        if n.lane_id[row] == lane:
            return row
    return -1


@compiled
def lane_row(n: RoadTables, road: int, lane: int, s: float) -> int:
    """Return the row of a lane at s, -1 if it does not exist."""
    return lane_row_in(n, section_at(n, road, s), lane)


@compiled
def lane_inside(lane: int) -> int:
    """Return the id of the next lane towards the centre lane; its outer mark is this lane's inner one."""
    return lane + 1 if lane < 0 else lane - 1


@compiled
def row_width(n: RoadTables, row: int, s: float) -> float:
    """Return the width of a lane's row at s, m, never below 0."""
    if n.lane_steady[row] == 1:
        return n.lane_wide[row]
    w = cubic_value(n, n.lane_width_first[row], n.lane_width_last[row], s)
    if w < 0.0:
        w = 0.0
    return w


@compiled
def row_width_slope(n: RoadTables, row: int, s: float) -> float:
    """Return the derivative of a lane's width at s, 0 if the width is not positive."""
    slope = cubic_slope(n, n.lane_width_first[row], n.lane_width_last[row], s)
    if slope != 0.0 and cubic_value(n, n.lane_width_first[row], n.lane_width_last[row], s) < 0.0:
        slope = 0.0
    return slope


@compiled
def lane_offset(n: RoadTables, road: int, s: float) -> float:
    """Return t of the centre lane, m."""
    return cubic_value(n, n.road_offset_first[road], n.road_offset_last[road], s)


@compiled
def row_inner_border(n: RoadTables, road: int, row: int, s: float) -> float:
    """Return t of the border of a lane's row towards the centre lane."""
    t = lane_offset(n, road, s)
    section = n.lane_section[row]
    centre = n.section_lane[section] + n.section_left[section]
    if row < centre:
        for i in range(row + 1, centre):
            t = t + row_width(n, i, s)
    if row > centre:
        for i in range(centre + 1, row):
            t = t - row_width(n, i, s)
    return t


@compiled
def row_centre(n: RoadTables, road: int, row: int, s: float) -> tuple[float, float]:
    """Return (t, dt/ds) of the centre of a lane's row."""
    if n.lane_steady[row] == 1:
        return n.lane_middle[row], 0.0
    t = lane_offset(n, road, s)
    slope = cubic_slope(n, n.road_offset_first[road], n.road_offset_last[road], s)
    section = n.lane_section[row]
    centre = n.section_lane[section] + n.section_left[section]
    if row < centre:
        for i in range(row + 1, centre):
            t = t + row_width(n, i, s)
            slope = slope + row_width_slope(n, i, s)
        t = t + 0.5 * row_width(n, row, s)
        slope = slope + 0.5 * row_width_slope(n, row, s)
    if row > centre:
        for i in range(centre + 1, row):
            t = t - row_width(n, i, s)
            slope = slope - row_width_slope(n, i, s)
        t = t - 0.5 * row_width(n, row, s)
        slope = slope - 0.5 * row_width_slope(n, row, s)
    return t, slope


@compiled
def lane_centre(n: RoadTables, road: int, lane: int, s: float) -> tuple[float, float]:
    """Return (t, dt/ds) of a lane's centre; those of the centre lane if the lane does not exist."""
    row = lane_row(n, road, lane, s)
    if row < 0:
        t = lane_offset(n, road, s)
        return t, cubic_slope(n, n.road_offset_first[road], n.road_offset_last[road], s)
    return row_centre(n, road, row, s)


@compiled
def lane_borders(n: RoadTables, road: int, lane: int, s: float) -> tuple[float, float]:
    """Return (t of the left border, t of the right border).

    Both are those of the centre lane where the lane does not exist.
    """
    row = lane_row(n, road, lane, s)
    if row < 0:
        t = lane_offset(n, road, s)
        return t, t
    inner = row_inner_border(n, road, row, s)
    width = row_width(n, row, s)
    if lane > 0:
        return inner + width, inner
    return inner, inner - width


@compiled
def lane_width(n: RoadTables, road: int, lane: int, s: float) -> float:
    """Return a lane's width, m; 0 if the lane does not exist."""
    row = lane_row(n, road, lane, s)
    if row < 0:
        return 0.0
    return row_width(n, row, s)


@compiled
def lane_exists(n: RoadTables, road: int, lane: int, s: float) -> int:
    """Return 1 if the lane section at s has the lane (of any width), else 0."""
    if lane_row(n, road, lane, s) < 0:
        return 0
    return 1


@compiled
def lane_type(n: RoadTables, road: int, lane: int, s: float) -> int:
    """Return the code of a lane's type, `NONE` where the lane does not exist."""
    row = lane_row(n, road, lane, s)
    if row < 0:
        return NONE
    return n.lane_type[row]


@compiled
def lane_direction(n: RoadTables, road: int, lane: int, s: float) -> int:
    """Return 1 when travel in the lane at s is along increasing s, -1 against it.

    Right lanes go along s in right-hand traffic, left lanes in left-hand traffic; a lane declared "reversed" goes the
    other way there. The centre lane counts as a right lane. A lane that does not exist at s has the direction of
    the last section before s that has it.
    """
    if n.road_directions[road] == 1:
        section = section_at(n, road, s)
        while section >= n.road_section[road]:
            row = lane_row_in(n, section, lane)
            if row >= 0:
                return n.lane_sense[row]
            section = section - 1
    return -n.road_rule[road] if lane > 0 else n.road_rule[road]


@compiled
def row_height(n: RoadTables, road: int, row: int, s: float, t: float) -> float:
    """Return the height of a lane's surface above the road surface at t, m."""
    first = n.lane_height[row]
    last = n.lane_height[row + 1]
    if first == last:
        return 0.0
    at = first
    while at + 1 < last and n.height_s[at + 1] <= s:
        at = at + 1
    inner = n.height_inner[at]
    outer = n.height_outer[at]
    width = row_width(n, row, s)
    share = 0.0
    if width > 0.0:
        share = (t - row_inner_border(n, road, row, s)) / width
        if share < 0.0:
            share = -share
        if share > 1.0:
            share = 1.0
    return inner + share * (outer - inner)


@compiled
def lane_frame(n: RoadTables, road: int, row: int, s: float, t: float) -> tuple[float, float, float, float, float]:
    """Return (along, across, z, pitch, roll) of a lane's surface at (s, t), as `geometry.road_frame` does.

    A level lane is not rolled: it has the height of its inner border. In the plane it lies where another lane would
    (OpenDRIVE 1.8, 11.6.4).
    """
    if n.road_flat[road] == 1:
        return 0.0, t, 0.0, 0.0, 0.0
    if n.lane_level[row] == 1:
        step = 1
        if n.lane_id[row] < 0:
            step = -1
        at = row
        while n.lane_id[at + step] != 0 and n.lane_level[at + step] == 1:
            at = at + step
        inner = row_inner_border(n, road, at, s)
        _, _, z, pitch, _ = road_frame(n, road, s, inner)
        along, across, _, _, _ = road_frame(n, road, s, t)
        return along, across, z + row_height(n, road, row, s, t), pitch, 0.0
    along, across, z, pitch, roll = road_frame(n, road, s, t)
    return along, across, z + row_height(n, road, row, s, t), pitch, roll


@compiled
def lane_pose(
    n: RoadTables, road: int, lane: int, s: float, offset: float
) -> tuple[float, float, float, float, float, float]:
    """Return (x, y, z, heading, pitch, roll) at an offset to the left of a lane's centre.

    The heading is along increasing s and follows the lane's centre: atan of its slope is part of it. As in esmini, the
    curvature of the road is left out there; in a tight bend this is a degree for a lane that becomes wider fast.
    """
    x, y, z, heading, pitch, roll, _ = lane_place(n, road, lane, s, offset)
    return x, y, z, heading, pitch, roll


@compiled
def lane_place(
    n: RoadTables, road: int, lane: int, s: float, offset: float
) -> tuple[float, float, float, float, float, float, float]:
    """Return the results of `lane_pose`, and t of the point."""
    return row_place(n, road, lane_row(n, road, lane, s), road_piece_at(n, road, s), s, offset)


@compiled
def row_place(
    n: RoadTables, road: int, row: int, piece: int, s: float, offset: float
) -> tuple[float, float, float, float, float, float, float]:
    """Return the results of `lane_place`, on a known row of the lane (-1: it does not exist) and piece of the road."""
    x, y, h, _, _ = piece_point(n, piece, s)
    slope = 0.0
    if row < 0:
        centre = lane_offset(n, road, s)
        slope = cubic_slope(n, n.road_offset_first[road], n.road_offset_last[road], s)
    elif n.lane_steady[row] == 1:
        centre = n.lane_middle[row]
    else:
        centre, slope = row_centre(n, road, row, s)
    t = centre + offset
    along = 0.0
    across = t
    z = 0.0
    pitch = 0.0
    roll = 0.0
    if n.road_flat[road] == 0:
        if row < 0:
            along, across, z, pitch, roll = road_frame(n, road, s, t)
        else:
            along, across, z, pitch, roll = lane_frame(n, road, row, s, t)
    heading = h
    if slope != 0.0:
        heading = h + atan(slope)
    if heading <= 0.0 or heading >= tau:
        heading = wrap_heading(heading)
    c = n.piece_cos[piece]
    w = n.piece_sin[piece]
    if h != n.piece_h[piece]:
        c = cos(h)
        w = sin(h)
    return x + along * c - across * w, y + along * w + across * c, z, heading, pitch, roll, t


@compiled
def row_at(n: RoadTables, road: int, section: int, s: float, t: float) -> tuple[int, float]:
    """Return (row of the lane that contains t, offset from its centre), or (-1, 0) off the lanes.

    A border belongs to the lane further out; the outermost border belongs to the outermost lane.
    """
    if section < 0:
        return -1, 0.0
    edge = lane_offset(n, road, s)
    centre = n.section_lane[section] + n.section_left[section]
    row = centre
    beside = t - edge
    outwards = -1
    stop = n.section_lane[section] - 1
    if beside < 0.0 or stop + 1 == centre:
        beside = -beside
        outwards = 1
        stop = n.section_lane[section + 1]
    if beside < 0.0:
        return -1, 0.0
    inner = 0.0
    row = row + outwards
    while row != stop:
        width = row_width(n, row, s)
        if beside < inner + width or (beside <= inner + width + BORDER_TOLERANCE and row + outwards == stop):
            offset = beside - inner - 0.5 * width
            if outwards == 1:
                offset = -offset
            return row, offset
        inner = inner + width
        row = row + outwards
    return -1, 0.0


BORDER_TOLERANCE = 1e-7


@compiled
def lane_at(n: RoadTables, road: int, s: float, t: float) -> int:
    """Return the id of the lane that contains t at s; 0 off the lanes."""
    row, _ = row_at(n, road, section_at(n, road, s), s, t)
    if row < 0:
        return 0
    return n.lane_id[row]


@compiled
def lane_curvature(n: RoadTables, road: int, lane: int, row: int, s: float) -> float:
    """Return the curvature of a lane's centre in the direction of travel, 1/m, positive to the left."""
    if row < 0:
        return 0.0
    k = road_curvature(n, road, s)
    if k == 0.0:
        return 0.0
    return lane_direction(n, road, lane, s) * curvature_in_lane(n, road, row, s, k)


@compiled
def curvature_in_lane(n: RoadTables, road: int, row: int, s: float, k: float) -> float:
    """Return the curvature of a lane's centre where that of the reference line is k, 1/m, both along it."""
    t, _ = row_centre(n, road, row, s)
    return k / max(1.0 - k * t, 0.1)


@compiled
def curvature_ahead(n: RoadTables, road: int, lane: int, row: int, s: float) -> tuple[float, int]:
    """Return how far the road's piece continues ahead, m, and whether the lane's curvature is constant until there.

    The section of a lane in an arc ends a piece too, because its distance from the reference line may change there.
    """
    piece = road_piece_at(n, road, s)
    kind = n.piece_kind[piece]
    begin = n.piece_s[piece]
    end = n.piece_s[piece + 1] if piece + 1 < n.road_piece[road + 1] else n.road_length[road]
    constant = 1 if kind == LINE else 0
    if kind == ARC and row >= 0:
        section = n.lane_section[row]
        begin = max(begin, n.section_s[section])
        end = min(end, n.section_end[section])
        constant = n.lane_steady[row]
    return end - s if lane_direction(n, road, lane, s) > 0 else s - begin, constant
