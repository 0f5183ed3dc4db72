"""Resolves any position, including one along a trajectory, whose vertices are computed for the query."""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.laying import lay_track, point_beside_track
from scenario_compiler.engine.motion.positions import (
    PLACE_FREE,
    PLACE_NONE,
    PLACE_ON_LANE,
    place_of,
    position_is_number,
)
from scenario_compiler.marker import compiled
from scenario_compiler.roads.below import place_below
from scenario_compiler.roads.lanes import lane_pose
from scenario_compiler.roads.tables import RoadTables


@compiled
def place_on_track(
    n: RoadTables, p: Program, st: State, k: int, i: int
) -> tuple[int, int, int, float, float, float, float, float, float]:
    """Return the same as `place_of` for a position along a trajectory; its offset is to the left of the trajectory."""
    if position_is_number(p, k) == 0:
        return PLACE_NONE, -1, 0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    lay_track(n, p, st, p.position_lane[k], i)
    x, y, h = point_beside_track(p, st, k)
    found, road, lane, s, offset = place_below(n, x, y, h, 0.0, 0)
    if found == 0:
        return PLACE_FREE, -1, 0, 0.0, 0.0, x, y, 0.0, h
    _, _, z, _, _, _ = lane_pose(n, road, lane, s, offset)
    return PLACE_ON_LANE, road, lane, s, offset, x, y, z, h


@compiled
def place_anywhere(
    n: RoadTables, p: Program, st: State, k: int, i: int
) -> tuple[int, int, int, float, float, float, float, float, float]:
    """Return (PLACE_... code, road, lane, s, offset, x, y, z, heading) of any position, for entity i or NONE."""
    if p.position_op[k] == op.POSITION_ON_TRAJECTORY:
        return place_on_track(n, p, st, k, i)
    return place_of(n, p, st, k, i)


@compiled
def point_at(n: RoadTables, p: Program, st: State, k: int, i: int) -> tuple[int, float, float]:
    """Return (found, x, y) of a position now; those of the conflict language refer to where the entities started."""
    if p.position_op[k] < op.POSITION_FREE:
        return 1, st.position_x[k], st.position_y[k]
    kind, _, _, _, _, x, y, _, _ = place_anywhere(n, p, st, k, i)
    if kind == PLACE_NONE:
        return 0, 0.0, 0.0
    return 1, x, y
