"""The time that a request leaves if no object causes it: until the paint ends, or the ego leaves its lane.

Both times assume that the ego keeps its speed and the angle of its front wheels.
"""

from __future__ import annotations

from math import cos, sin, tan

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.extent import front_of
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.lane_confidence import mark_visibility
from scenario_compiler.engine.motion.path import path_ahead
from scenario_compiler.marker import compiled
from scenario_compiler.roads.lanes import lane_inside, lane_pose, row_width
from scenario_compiler.roads.tables import RoadTables

PAINT_AHEAD = 60
"""Distance ahead of the front bumper up to which the end of the paint is searched, m: as far as a camera follows a
line.
"""

LOOK_EACH = 0.1
"""Time between two predicted positions, s."""

LOOKS = 300
"""Number of predicted positions: 30 s, which is also the horizon of times to collision."""

STRAIGHT = 1.0e-6
"""Curvature below which a path counts as straight, 1/m."""

LEAST_LOSS = 1.0e-6
"""Least decrease of the room beside the ego between two predicted positions by which is divided, m."""


@compiled
def distance_to_paint_end(n: RoadTables, p: Program, st: State, i: int) -> float:
    """Return the distance from the front bumper to where neither side has usable paint, m; FAR if there is none.

    Paint is usable if its confidence in the present weather is not below the automation's threshold for a request.
    """
    front = front_of(p, i)
    for k in range(PAINT_AHEAD):
        road, lane, _, s, rest = path_ahead(n, p, st, front + k)
        if rest > 0.0:
            return op.FAR
        outer = mark_visibility(n, p, road, lane, s)
        inner = mark_visibility(n, p, road, lane_inside(lane), s)
        if st.paint_seen[0] * max(outer, inner) < p.const[slot.K_CONFIDENCE_REQUEST]:
            return 1.0 * k
    return op.FAR


@compiled
def time_to_leave(n: RoadTables, p: Program, st: State, i: int) -> float:
    """Return the time until a side of the ego is outside its lane, or the lane ends, s; FAR beyond the horizon."""
    base = p.entity_const[i]
    bend = tan(st.steer[i]) / max(p.const[base + slot.E_WHEELBASE], 0.1)
    h = st.h[i]
    before = 0.0
    for k in range(LOOKS + 1):
        way = LOOK_EACH * k * st.v[i]
        dx = way * cos(h)
        dy = way * sin(h)
        if abs(bend) > STRAIGHT:
            dx = (sin(h + bend * way) - sin(h)) / bend
            dy = (cos(h) - cos(h + bend * way)) / bend
        road, lane, row, s, rest = path_ahead(n, p, st, way)
        if rest > 0.0 or row < 0:
            return LOOK_EACH * k
        x, y, _, along, _, _ = lane_pose(n, road, lane, s, 0.0)
        left = (st.y[i] + dy - y) * cos(along) - (st.x[i] + dx - x) * sin(along)
        room = 0.5 * (row_width(n, row, s) - p.const[base + slot.E_WIDTH]) - abs(left)
        if room <= 0.0:
            return LOOK_EACH * (k - 1 + before / max(before - room, LEAST_LOSS)) if k > 0 else 0.0
        before = room
    return op.FAR


@compiled
def time_left(n: RoadTables, p: Program, st: State, i: int, cause: int) -> float:
    """Return the time budget of a request that is not about an obstacle or the end of the lane, s; FAR for one that is.

    For the cause lane confidence, this is the time to the end of the paint. For other causes, and if no end is in
    sight, it is the time until the ego leaves its lane. It is also FAR if the ego stands or has no path.
    """
    if cause in (op.CAUSE_PATH_BLOCKED, op.CAUSE_LANE_ENDS) or st.v[i] <= 0.0 or st.path_road[0] < 0:
        return op.FAR
    if cause == op.CAUSE_LANE_CONFIDENCE:
        distance = distance_to_paint_end(n, p, st, i)
        if distance < op.FAR:
            return distance / st.v[i] if st.v[i] > 0.0 else op.FAR
    return time_to_leave(n, p, st, i)
