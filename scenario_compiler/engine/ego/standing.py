"""Where the vehicle stands that has been stopped: in its own lane, in another one, on a shoulder, or off the road."""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.state import State
from scenario_compiler.marker import compiled
from scenario_compiler.roads.lane_types import is_drivable, is_roadside
from scenario_compiler.roads.lanes import lane_type, row_width
from scenario_compiler.roads.tables import RoadTables


@compiled
def standing_place(n: RoadTables, st: State, i: int) -> int:
    """Return the STANDS_... code of where the ego's reference point is; its own lane is that of its path."""
    road = st.road[i]
    if road < 0 or st.lane[i] == 0:
        return op.STANDS_OFF_ROAD
    row = st.path_row[0]
    on_path = st.path_anew[0] == 0 and road == st.path_road[0] and row >= 0
    if on_path and abs(st.path_off[0]) <= 0.5 * row_width(n, row, st.path_s[0]):
        return op.STANDS_IN_OWN_LANE
    kind = lane_type(n, road, st.lane[i], st.s[i])
    if is_drivable(kind) == 1:
        return op.STANDS_IN_OTHER_LANE
    return op.STANDS_ON_SHOULDER if is_roadside(kind) == 1 else op.STANDS_OFF_ROAD
