"""The planned way ahead of the ego vehicle, as a navigation would hand it to whatever drives."""

from __future__ import annotations

from math import cos, sin

from scenario_compiler.engine.path import advance_routed
from scenario_compiler.engine.state import State
from scenario_compiler.engine.tables import Program
from scenario_compiler.roads.lanes import lane_pose
from scenario_compiler.roads.tables import RoadTables

ROUTE_REACH = 40
"""How far ahead the way is handed on, m: what a camera sees of the ground, and some more."""


def route_ahead(n: RoadTables, p: Program, st: State) -> tuple[tuple[tuple[float, float], ...], float | None]:
    """Return the way ahead of the ego vehicle and how far its next junction is, as `SensorData` has them.

    The way is the middle of the lanes that the plan's route leads over; without a route, and off it, of those that go
    on straight. It ends where the lanes do.
    """
    points: list[tuple[float, float]] = []
    junction = None
    road, lane, s = st.path_road[0], st.path_lane[0], st.path_s[0]
    left = 0.0 if st.path_found[0] == 1 else 1.0
    c, w = cos(st.h[0]), sin(st.h[0])
    while left <= 0.0 and len(points) <= ROUTE_REACH:
        if junction is None and n.road_junction[road] >= 0:
            junction = float(len(points))
        x, y, _, _, _, _ = lane_pose(n, road, lane, s, 0.0)
        dx, dy = x - st.x[0], y - st.y[0]
        points.append((c * dx + w * dy, c * dy - w * dx))
        road, lane, s, left = advance_routed(n, p, st, road, lane, s, 1.0)
    return tuple(points), junction
