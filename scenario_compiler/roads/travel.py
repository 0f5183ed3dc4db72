"""Travel along lanes: the next lane, moving by a distance, and the remaining length of a lane.

Forward is a lane's direction of travel. At a junction the preferred road is taken if it can be entered, otherwise the
straightest exit (the smallest change of heading), and of equal ones the first in the file.
"""

from math import sqrt

from scenario_compiler.marker import compiled
from scenario_compiler.roads.geometry import road_curvature, road_piece_at
from scenario_compiler.roads.lane_types import is_drivable
from scenario_compiler.roads.lanes import lane_centre, lane_direction, lane_row_in, row_width, section_at
from scenario_compiler.roads.tables import AT_END, AT_START, RoadTables

HOP_LIMIT = 10000
"""Greatest number of lane rows passed in one call; guards against cyclic links of very short lanes."""

MIN_DRIVING_WIDTH = 2.0
"""Width below which a driving lane counts as ended, m: less than a car needs (cars are 1.7 to 2.0 m wide)."""

LANE_STEP = 2.0
"""Length of a lane's centre line over which its direction is taken from the middle, m."""

LEAST_LENGTH = 0.1
"""Least length of a lane's centre line for each metre of the reference line, in tight bends."""

WIDTH_STEP = 2.0
"""Distance between the places where a changing width is tested, m."""


@compiled
def stretch_at(n: RoadTables, road: int, lane: int, s: float) -> tuple[int, int, float, float]:
    """Return (the lane's row or -1, the road's piece, from, to); row and piece are valid for s in [from, to).

    Without such a lane the range is empty.
    """
    section = section_at(n, road, s)
    row = lane_row_in(n, section, lane)
    piece = road_piece_at(n, road, s)
    if row < 0:
        return row, piece, s, s
    end = n.road_length[road]
    if piece + 1 < n.road_piece[road + 1]:
        end = n.piece_s[piece + 1]
    return row, piece, max(n.piece_s[piece], n.section_s[section]), min(end, n.section_end[section])


@compiled
def row_next(n: RoadTables, row: int, end: int, forward: int, preferred_road: int) -> tuple[int, int]:
    """Return (row, the end that is entered) of the lane after an end of a row, or (-1, 0).

    Args:
        n: The tables.
        row: The lane's row.
        end: `AT_START` or `AT_END`: the end that is left.
        forward: 1 when moving in the direction of travel, -1 against it. Only lanes with the same direction follow.
        preferred_road: Road to enter if possible, or -1.
    """
    best = -1
    contact = 0
    best_turn = 0.0
    for link in range(n.lane_link[2 * row + end], n.lane_link[2 * row + end + 1]):
        other = n.link_lane[link]
        road = n.section_road[n.lane_section[other]]
        sense = n.lane_sense[other] * forward
        if (sense == 1 and n.link_contact[link] == AT_START) or (sense == -1 and n.link_contact[link] == AT_END):
            turn = n.link_turn[link]
            if road == preferred_road:
                turn = -1.0
            if best < 0 or turn < best_turn:
                best = other
                best_turn = turn
                contact = n.link_contact[link]
    return best, contact


@compiled
def way_out(n: RoadTables, row: int, s: float, sense: int) -> tuple[int, float]:
    """Return (end, distance) of the end of a row to which a way leads, m; `sense` is 1 if s grows along the way."""
    section = n.lane_section[row]
    if sense == 1:
        return AT_END, max(n.section_end[section] - s, 0.0)
    return AT_START, max(s - n.section_s[section], 0.0)


@compiled
def way_in(n: RoadTables, row: int, contact: int) -> tuple[int, float]:
    """Return (sense, s) of a way that enters a row at an end; the sense is 1 if s grows along the way."""
    section = n.lane_section[row]
    if contact == AT_END:
        return -1, n.section_end[section]
    return 1, n.section_s[section]


@compiled
def advance(n: RoadTables, road: int, lane: int, s: float, ds: float, next_road: int) -> tuple[int, int, float, float]:
    """Return (road, lane, s, rest) after ds along the lane's direction of travel (against it for ds < 0).

    The rest, m, is above 0 if the lane ends before.
    """
    row = lane_row_in(n, section_at(n, road, s), lane)
    if row < 0:
        return road, lane, s, abs(ds)
    row, s, rest = advance_row(n, row, s, ds, next_road)
    return n.section_road[n.lane_section[row]], n.lane_id[row], s, rest


@compiled
def along_reference(n: RoadTables, road: int, lane: int, s: float, ds: float) -> float:
    """Return the distance along the reference line that ds along a lane's centre line is, for at most LANE_STEP.

    ds is in the lane's direction of travel (against it if negative), as is the result.
    """
    sense = lane_direction(n, road, lane, s)
    centre, slope = lane_centre(n, road, lane, s)
    half = 0.5 * ds / max(centre_length(road_curvature(n, road, s), centre, slope), LEAST_LENGTH)
    middle = min(max(s + sense * half, 0.0), n.road_length[road])
    centre, slope = lane_centre(n, road, lane, middle)
    return ds / max(centre_length(road_curvature(n, road, middle), centre, slope), LEAST_LENGTH)


@compiled
def centre_length(curvature: float, t: float, slope: float) -> float:
    """Return the length of a line at t, with the slope dt/ds, for each metre of a curved reference line."""
    stretch = 1.0 - curvature * t
    return sqrt(stretch * stretch + slope * slope)


@compiled
def advance_row(n: RoadTables, row: int, s: float, ds: float, next_road: int) -> tuple[int, float, float]:
    """Return (row, s, rest) as `advance` does, from a known row of a lane.

    An s at which another section of the road begins belongs to that section, and the row is one of it if the lane goes
    on there.
    """
    section = n.lane_section[row]
    forward = 1
    left = ds
    if ds < 0.0:
        forward = -1
        left = -ds
    sense = n.lane_sense[row] * forward
    for _ in range(HOP_LIMIT):
        end = AT_END
        if sense == 1:
            room = n.section_end[section] - s
            last = 1 if section + 1 == n.road_section[n.section_road[section] + 1] else 0
            if left < room or (left <= room and last == 1):
                return row, s + left, 0.0
            s = n.section_end[section]
        else:
            end = AT_START
            room = s - n.section_s[section]
            if left <= room:
                return row, s - left, 0.0
            s = n.section_s[section]
        if room > 0.0:
            left = left - room
        other, contact = row_next(n, row, end, forward, next_road)
        if other < 0:
            return row, s, left
        row = other
        section = n.lane_section[row]
        sense, s = way_in(n, row, contact)
    return row, s, left


@compiled
def row_narrows_after(n: RoadTables, row: int, s: float, sense: int, room: float) -> float:
    """Return the distance from s after which a row is too narrow to drive on, m, or `room` if it is not within it.

    The place is found to 1 cm.
    """
    if row_width(n, row, s) < MIN_DRIVING_WIDTH:
        return 0.0
    first = n.lane_width_first[row]
    single = n.lane_width_last[row] - first == 1
    if single and n.cubic_b[first] == 0.0 and n.cubic_c[first] == 0.0 and n.cubic_d[first] == 0.0:
        return room
    done = 0.0
    while done < room:
        ahead = done + WIDTH_STEP
        if ahead > room:
            ahead = room
        if row_width(n, row, s + sense * ahead) < MIN_DRIVING_WIDTH:
            while ahead - done > 0.01:
                middle = 0.5 * (done + ahead)
                if row_width(n, row, s + sense * middle) < MIN_DRIVING_WIDTH:
                    ahead = middle
                else:
                    done = middle
            return done
        done = ahead
    return room


@compiled
def distance_to_lane_end(n: RoadTables, road: int, lane: int, s: float, limit: float, next_road: int) -> float:
    """Return how far the driving lane continues in its direction of travel, m, at most `limit`.

    It ends where no lane follows, where it is narrower than `MIN_DRIVING_WIDTH`, and where motor traffic may not use
    it.
    """
    row = lane_row_in(n, section_at(n, road, s), lane)
    if row < 0:
        return 0.0
    sense = n.lane_sense[row]
    gone = 0.0
    for _ in range(HOP_LIMIT):
        if is_drivable(n.lane_type[row]) == 0:
            return gone
        end, look = way_out(n, row, s, sense)
        if look > limit - gone:
            look = limit - gone
        clear = row_narrows_after(n, row, s, sense, look)
        gone = gone + clear
        if clear < look:
            return gone
        if gone >= limit:
            return limit
        row, contact = row_next(n, row, end, 1, next_road)
        if row < 0:
            return gone
        sense, s = way_in(n, row, contact)
    return gone
