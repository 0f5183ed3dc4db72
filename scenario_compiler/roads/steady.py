"""What is constant in a lane section and computed once: directions of travel, centres and widths of many lanes."""

from scenario_compiler.marker import compiled
from scenario_compiler.roads.lanes import row_centre, row_width
from scenario_compiler.roads.tables import RoadTables


@compiled
def is_constant(n: RoadTables, first: int, last: int) -> int:
    """Return 1 if a range of cubics has the same value everywhere."""
    for c in range(first, last):
        if n.cubic_a[c] != n.cubic_a[first]:
            return 0
        if n.cubic_b[c] != 0.0 or n.cubic_c[c] != 0.0 or n.cubic_d[c] != 0.0:
            return 0
    return 1


@compiled
def note_steady_side(n: RoadTables, section: int, row: int, outwards: int, stop: int) -> None:
    """Mark the steady lanes of a section from a row outwards: those with constant widths inside of them."""
    s = n.section_s[section]
    while row != stop and is_constant(n, n.lane_width_first[row], n.lane_width_last[row]) == 1:
        centre, _ = row_centre(n, n.section_road[section], row, s)
        n.lane_middle[row] = centre
        n.lane_wide[row] = row_width(n, row, s)
        n.lane_steady[row] = 1
        row = row + outwards


@compiled
def note_lanes(n: RoadTables) -> None:
    """Fill `lane_sense`, `lane_steady`, `lane_middle` and `lane_wide`; sections, lanes and widths have been read."""
    for section in range(len(n.section_s)):
        road = n.section_road[section]
        for row in range(n.section_lane[section], n.section_lane[section + 1]):
            right = n.lane_id[row] <= 0
            n.lane_sense[row] = n.road_rule[road] if right != (n.lane_direction[row] == 1) else -n.road_rule[road]
        if is_constant(n, n.road_offset_first[road], n.road_offset_last[road]) == 1:
            first = n.section_lane[section]
            centre = first + n.section_left[section]
            note_steady_side(n, section, centre, -1, first - 1)
            if n.lane_steady[centre] == 1:
                note_steady_side(n, section, centre + 1, 1, n.section_lane[section + 1])
