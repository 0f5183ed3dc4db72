"""Lane confidence without a camera: the marks on both sides, the weather between, and the sensor's health."""

from __future__ import annotations

from scenario_compiler.engine.failures import health_of_camera
from scenario_compiler.engine.numbers import clip
from scenario_compiler.engine.opcodes import ALL_MARKS
from scenario_compiler.engine.path import advance_routed
from scenario_compiler.engine.slots import M_COVERAGE, M_FROM, M_QUALITY, M_QUALITY_TO, M_TO
from scenario_compiler.engine.state import State
from scenario_compiler.engine.tables import Program
from scenario_compiler.engine.visibility import weather_visibility
from scenario_compiler.marker import compiled
from scenario_compiler.roads.lanes import lane_direction
from scenario_compiler.roads.marks import MARK_NONE, mark_at
from scenario_compiler.roads.tables import RoadTables

LOOK_FROM = 6.0
LOOK_STEP = 3.0
LOOK_COUNT = 5
"""The marks are looked at from 6 m to 18 m ahead of the rear axle, every 3 m."""


@compiled
def mark_visibility(n: RoadTables, p: Program, road: int, lane: int, s: float) -> float:
    """Return the quality of the mark on a lane's outer border, the plan's before the map's; 0 without a mark."""
    kind, quality, _, _ = mark_at(n, road, lane, s)
    if kind == MARK_NONE:
        return 0.0
    for k in range(p.stretch_count[0]):
        base = p.stretch_const[k]
        begin = p.const[base + M_FROM]
        end = p.const[base + M_TO]
        of_mark = p.stretch_lane[k] == ALL_MARKS or p.stretch_lane[k] == lane
        if p.stretch_road[k] == road and of_mark and s >= begin and s <= end:
            share = (s - begin) / (end - begin) if end > begin else 0.0
            first = p.const[base + M_QUALITY]
            if first >= 0.0:
                quality = first + share * (p.const[base + M_QUALITY_TO] - first)
            quality = quality * (1.0 - clip(p.const[base + M_COVERAGE], 0.0, 1.0))
    return clip(quality, 0.0, 1.0)


@compiled
def ideal_confidence(n: RoadTables, p: Program, st: State) -> None:
    """Write the confidence of both sides of the path's lane and the sensor's health."""
    health = health_of_camera(p, st)
    st.health[0] = health
    left = 0.0
    right = 0.0
    if st.path_found[0] == 1:
        for k in range(LOOK_COUNT):
            ahead = LOOK_FROM + LOOK_STEP * k
            road, lane, s, rest = advance_routed(n, p, st, st.path_road[0], st.path_lane[0], st.path_s[0], ahead)
            if rest > 0.0:
                continue
            inner = lane + 1 if lane < 0 else lane - 1
            outer_quality = mark_visibility(n, p, road, lane, s)
            inner_quality = mark_visibility(n, p, road, inner, s)
            if (lane > 0) == (lane_direction(n, road, lane) > 0):
                left += outer_quality
                right += inner_quality
            else:
                left += inner_quality
                right += outer_quality
    seen = health * weather_visibility(st)
    st.conf_left[0] = seen * left / LOOK_COUNT
    st.conf_right[0] = seen * right / LOOK_COUNT
