"""Entities that move freely: their position on the road, and the lane that they would follow from there."""

from __future__ import annotations

from math import pi

from scenario_compiler.engine.columns.numbers import angle_between
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.entities import settle
from scenario_compiler.engine.motion.path import locate_free
from scenario_compiler.marker import compiled
from scenario_compiler.roads.lanes import lane_direction, lane_pose
from scenario_compiler.roads.tables import RoadTables


@compiled
def place_free(n: RoadTables, st: State, i: int) -> None:
    """Find the road and lane below a freely moving entity, and its offset and heading if it followed that lane."""
    if locate_free(n, st, i) == 0:
        return
    road = st.road[i]
    lane = st.lane[i]
    st.kept_lane[i] = lane
    st.kept_off[i] = st.off[i]
    st.changing[i] = 0
    _, _, _, along, _, _ = lane_pose(n, road, lane, st.s[i], st.off[i])
    direction = lane_direction(n, road, lane, st.s[i])
    away = angle_between(st.h[i], along if direction > 0 else along + pi)
    st.facing[i] = direction
    st.turn[i] = away
    if abs(away) > 0.5 * pi:
        st.facing[i] = -direction
        st.turn[i] = angle_between(away, pi)
    settle(n, st, i)
