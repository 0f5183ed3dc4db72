"""The end of a lane whose road continues, and the neighbouring lane that continues too."""

from __future__ import annotations

from scenario_compiler.marker import compiled
from scenario_compiler.roads.lanes import lane_centre, lane_direction, row_centre, row_width, section_at
from scenario_compiler.roads.tables import AT_END, AT_START, RoadTables
from scenario_compiler.roads.travel import row_next

STEP_BEYOND = 1.0e-6
"""Distance beyond a lane's end at which the next lane section is looked up, m."""

LEAST_WIDTH = 0.01
"""Width from which a lane exists, m."""

FAR_AWAY = 1.0e9


@compiled
def lane_going_on(n: RoadTables, road: int, lane: int, s: float, t: float, along: int) -> int:
    """Return the lane nearest to t that continues beyond s, where `lane` ends; 0 if there is none.

    Only lanes with the same direction of travel count. A lane of the next section may have the number of the one that
    ends. At the end of the road lanes must have a successor.

    Args:
        n: The tables.
        road: The road.
        lane: The lane that ends.
        s: Where it ends, m.
        t: Where across the road the search starts, m.
        along: 1 when moving along s, -1 against it.
    """
    beyond = s + along * STEP_BEYOND
    at_end = 0
    if beyond < 0.0 or beyond > n.road_length[road]:
        at_end = 1
        beyond = s - along * STEP_BEYOND
    section = section_at(n, road, beyond)
    if section < 0:
        return 0
    direction = lane_direction(n, road, lane, s - along * STEP_BEYOND)
    best = 0
    nearest = FAR_AWAY
    for row in range(n.section_lane[section], n.section_lane[section + 1]):
        beside = n.lane_id[row]
        fits = beside != 0 and n.lane_sense[row] == direction
        if fits and row_width(n, row, beyond) >= LEAST_WIDTH:
            centre, _ = row_centre(n, road, row, beyond)
            follows = 0
            if at_end == 1:
                follows, _ = row_next(n, row, AT_END if along == 1 else AT_START, along * direction, -1)
            if follows >= 0 and abs(centre - t) < nearest:
                nearest = abs(centre - t)
                best = beside
    return best


@compiled
def lane_after_end(n: RoadTables, road: int, lane: int, s: float, offset: float, along: int) -> tuple[int, float]:
    """Return (lane, s) on which an entity continues at the end of a lane; lane 0 if the road ends too.

    `offset` is from the ending lane's centre, m; `along` is 1 when moving along s, -1 against it.
    """
    centre, _ = lane_centre(n, road, lane, s - along * STEP_BEYOND)
    beside = lane_going_on(n, road, lane, s, centre + offset, along)
    beyond = s + along * STEP_BEYOND
    if beyond < 0.0 or beyond > n.road_length[road]:
        beyond = s
    return beside, beyond
