"""The controller's view of what is ahead: the gap to keep, the speed for the bends and the planned route.

The route follows the centres of the lanes of the plan's route. Without a route, or off it, it goes straight on. It ends
where the lanes end.
"""

from __future__ import annotations

from math import cos, sin, tan

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.bends import speed_for_bends
from scenario_compiler.engine.ego.objects_ahead import gap_to_keep, judge_objects
from scenario_compiler.engine.ego.reach import look_with_sensor
from scenario_compiler.engine.motion.path import advance_routed
from scenario_compiler.engine.motion.signals_ahead import red_ahead
from scenario_compiler.marker import compiled
from scenario_compiler.roads.lanes import lane_direction, lane_pose, lane_width
from scenario_compiler.roads.tables import RoadTables


@compiled
def look_out(n: RoadTables, p: Program, st: State, out: list[float]) -> int:
    """Write what lies ahead of the ego; return the number of points of the route, which are 1 m apart.

    `out` has OUTLOOK_SIZE numbers: the gap from the front bumper to what the automation keeps its distance to, m (see
    `gap_to_keep`; FAR without such an object), and its speed along the path, m/s; the distance to the next junction, m
    (FAR if there is none in reach); the speed for the bends ahead, m/s (see `speed_for_bends`); then for each point x
    (ahead) and y (left) in the ego's axes, m, the width of the lane there, m, its height above the plane of the road at
    the first point, m, and by how much the road rises to the left there against that plane.
    """
    ego = p.ego[0]
    st.looked[0] = 0
    look_with_sensor(n, p, st, ego)
    st.red_line[0] = red_ahead(n, p, st, ego) if p.head_count[0] > 0 else op.FAR
    judge_objects(p, st, ego)
    gap, lead = gap_to_keep(p, st, ego)
    out[0] = gap
    out[1] = lead
    out[2] = op.FAR
    out[3] = speed_for_bends(n, p, st, ego, p.const[slot.K_LATERAL], p.const[slot.K_DECELERATION])
    road = st.path_road[0]
    lane = st.path_lane[0]
    s = st.path_s[0]
    left = 0.0 if st.path_found[0] == 1 else 1.0
    c = cos(st.h[ego])
    w = sin(st.h[ego])
    count = 0
    plane_x = 0.0
    plane_y = 0.0
    begin_x = 0.0
    begin_y = 0.0
    begin_z = 0.0
    while left <= 0.0 and count <= op.ROUTE_REACH:
        if out[2] >= op.FAR and n.road_junction[road] >= 0:
            out[2] = 1.0 * count
        x, y, z, heading, pitch, roll = lane_pose(n, road, lane, s, 0.0)
        ahead_x = cos(heading)
        ahead_y = sin(heading)
        rise_ahead = -tan(pitch)
        rise_left = tan(roll)
        rise_x = rise_ahead * ahead_x - rise_left * ahead_y
        rise_y = rise_ahead * ahead_y + rise_left * ahead_x
        if count == 0:
            plane_x = rise_x
            plane_y = rise_y
            begin_x = x
            begin_y = y
            begin_z = z
        dx = x - st.x[ego]
        dy = y - st.y[ego]
        sense = 1.0 * lane_direction(n, road, lane, s)
        at = op.OUTLOOK_HEAD + op.OUTLOOK_POINT * count
        out[at] = c * dx + w * dy
        out[at + 1] = c * dy - w * dx
        out[at + 2] = lane_width(n, road, lane, s)
        out[at + 3] = z - begin_z - plane_x * (x - begin_x) - plane_y * (y - begin_y)
        out[at + 4] = sense * ((rise_y - plane_y) * ahead_x - (rise_x - plane_x) * ahead_y)
        count = count + 1
        road, lane, s, left = advance_routed(n, p, st, road, lane, s, 1.0)
    return count
