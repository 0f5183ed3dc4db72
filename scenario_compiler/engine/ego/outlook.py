"""The controller's view of the route ahead: the thing to keep a distance to, and the planned route.

The way is the middle of the lanes that the plan's route leads over; without a route, and off it, of those that go on
straight. It ends where the lanes do.
"""

from __future__ import annotations

from math import cos, sin

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.objects_ahead import gap_to_keep, judge_objects
from scenario_compiler.engine.ego.reach import look_with_sensor
from scenario_compiler.engine.motion.path import advance_routed
from scenario_compiler.engine.motion.signals_ahead import red_ahead
from scenario_compiler.marker import compiled
from scenario_compiler.roads.lanes import lane_pose
from scenario_compiler.roads.tables import RoadTables


@compiled
def look_out(n: RoadTables, p: Program, st: State, out: list[float]) -> int:
    """Write what lies ahead of the ego; return the number of the way's points, each 1 m after the one before.

    `out` has OUTLOOK_SIZE numbers: the gap from the front bumper to what the automation keeps its distance to (see
    `gap_to_keep`), FAR without such a thing, and its speed along the way; the distance to the next junction, FAR where
    there is none in reach; then x (ahead) and y (left) of each point in the ego's axes.
    """
    ego = p.ego[0]
    look_with_sensor(n, p, st, ego)
    st.red_line[0] = red_ahead(n, p, st, ego) if p.head_count[0] > 0 else op.FAR
    judge_objects(p, st, ego)
    gap, lead = gap_to_keep(p, st, ego)
    out[0] = gap
    out[1] = lead
    out[2] = op.FAR
    road = st.path_road[0]
    lane = st.path_lane[0]
    s = st.path_s[0]
    left = 0.0 if st.path_found[0] == 1 else 1.0
    c = cos(st.h[ego])
    w = sin(st.h[ego])
    count = 0
    while left <= 0.0 and count <= op.ROUTE_REACH:
        if out[2] >= op.FAR and n.road_junction[road] >= 0:
            out[2] = 1.0 * count
        x, y, _, _, _, _ = lane_pose(n, road, lane, s, 0.0)
        dx = x - st.x[ego]
        dy = y - st.y[ego]
        out[op.OUTLOOK_HEAD + 2 * count] = c * dx + w * dy
        out[op.OUTLOOK_HEAD + 2 * count + 1] = c * dy - w * dx
        count = count + 1
        road, lane, s, left = advance_routed(n, p, st, road, lane, s, 1.0)
    return count
