"""The lane below a point: if several roads are above each other, the one that carries the entity there."""

from __future__ import annotations

from math import cos

from scenario_compiler.marker import compiled
from scenario_compiler.roads.lane_types import is_drivable
from scenario_compiler.roads.lanes import lane_pose
from scenario_compiler.roads.locate import cell_at, chunk_near, chunks_near, lane_on_chunk
from scenario_compiler.roads.tables import RoadTables

STOREY = 2.0
"""Difference of height above which roads count as being above each other, m: less than any clearance below a bridge."""

ALONG = 0.7071067811865476
"""Least cosine between a heading and a lane's direction of travel that counts as the same direction: 45 degrees."""

SAME_OFFSET = 0.001
"""Offsets closer than this count as equal, m."""


@compiled
def misfit(n: RoadTables, row: int, s: float, offset: float, h: float, z: float, with_height: int) -> int:
    """Return how badly a lane suits an entity on it: by height first, then by type, then by direction."""
    road = n.section_road[n.lane_section[row]]
    lane = n.lane_id[row]
    _, _, surface, along, _, _ = lane_pose(n, road, lane, s, offset)
    rank = 0
    if with_height == 1:
        rank = 4 * int(min(abs(surface - z) / STOREY, 1.0e6))
    if is_drivable(n.lane_type[row]) == 0:
        rank = rank + 2
    if cos(h - along) * n.lane_sense[row] < ALONG:
        rank = rank + 1
    return rank


@compiled
def place_below(
    n: RoadTables, x: float, y: float, h: float, z: float, with_height: int
) -> tuple[int, int, int, float, float]:
    """Return (found, road, lane, s, offset) of the lane that contains a point; (0, -1, 0, 0.0, 0.0) off every road.

    Of several lanes, the one nearest in height is chosen if `with_height` is 1, then one for driving, then one whose
    direction of travel fits the heading `h`, then the one with the nearest centre.
    """
    best = -1
    best_s = 0.0
    best_offset = 0.0
    best_rank = 0
    exact = 2
    cell = cell_at(n, x, y)
    for k in range(chunks_near(n, cell)):
        found, row, s, offset = lane_on_chunk(n, chunk_near(n, cell, k), x, y)
        if found > 0 and found <= exact:
            rank = misfit(n, row, s, offset, h, z, with_height)
            better = best < 0 or found < exact or rank < best_rank
            if rank == best_rank and abs(offset) < abs(best_offset) - SAME_OFFSET:
                better = True
            if better:
                best = row
                best_s = s
                best_offset = offset
                best_rank = rank
                exact = found
    if best < 0:
        return 0, -1, 0, 0.0, 0.0
    return 1, n.section_road[n.lane_section[best]], n.lane_id[best], best_s, best_offset
