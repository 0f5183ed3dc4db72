"""Lanes whose centre keeps its distance from the reference line all along their section: it is computed once."""

from __future__ import annotations

from scenario_compiler.roads.lanes import row_centre, row_width
from scenario_compiler.roads.tables import RoadTables


def note_steady_lanes(n: RoadTables) -> None:
    """Fill `lane_steady`, `lane_middle` and `lane_wide`, once sections, lanes and widths are there."""
    rows = len(n.lane_id)
    n.lane_steady = [0] * rows
    n.lane_middle = [0.0] * rows
    n.lane_wide = [0.0] * rows
    constant = [_is_constant(n, n.lane_width_first[row], n.lane_width_last[row]) for row in range(rows)]
    for section, road in enumerate(n.section_road):
        if not _is_constant(n, n.road_offset_first[road], n.road_offset_last[road]):
            continue
        first, last = n.section_lane[section], n.section_lane[section + 1]
        centre = first + n.section_left[section]
        for row in range(first, last):
            inwards = range(min(row, centre), max(row, centre) + 1)
            if all(constant[one] for one in inwards):
                n.lane_middle[row] = row_centre(n, road, row, n.section_s[section])[0]
                n.lane_wide[row] = row_width(n, row, n.section_s[section])
                n.lane_steady[row] = 1


def _is_constant(n: RoadTables, first: int, last: int) -> bool:
    """Tell whether a range of cubics has the same value everywhere."""
    return all(
        n.cubic_a[c] == n.cubic_a[first] and n.cubic_b[c] == n.cubic_c[c] == n.cubic_d[c] == 0.0
        for c in range(first, last)
    )
