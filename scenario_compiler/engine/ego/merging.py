"""Merging from an ending lane into the neighbouring lane that continues, by the automation or the driver.

The path moves to the other lane only while its gap is free. Until the ego's box crosses the border, the gap is checked
at every control step, and the ego returns if it closes.
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.log import log_event
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.sensor import gap_is_free
from scenario_compiler.engine.motion.path import measure_path, set_path
from scenario_compiler.engine.motion.steering import plan_shift, shift_distance
from scenario_compiler.marker import compiled
from scenario_compiler.roads.lanes import lane_width
from scenario_compiler.roads.tables import RoadTables

MERGE_ACCELERATION = 1.0
"""Lateral acceleration of a merge, m/s2: a comfortable lane change of 3.5 m in about 4 s; chosen."""

MERGED = 0.3
"""Offset from the new lane's centre at which a merge is done, m; chosen."""


@compiled
def start_merge(n: RoadTables, st: State, i: int) -> None:
    """Make the neighbouring lane the path, and plan the move to its centre."""
    st.merge_from_road[0] = st.path_road[0]
    st.merge_from_lane[0] = st.path_lane[0]
    set_path(n, st, st.path_road[0], st.through_lane[0], st.path_s[0])
    measure_path(n, st, i)
    plan_shift(st, i, 0.0, shift_distance(st.v[i], st.path_off[0], MERGE_ACCELERATION))
    st.merging[0] = 1
    log_event(st, op.EVENT_MERGE, 1.0 * st.path_lane[0])


@compiled
def abort_merge(n: RoadTables, st: State, i: int) -> None:
    """Return to the lane in which the merge began."""
    set_path(n, st, st.path_road[0], st.merge_from_lane[0], st.path_s[0])
    measure_path(n, st, i)
    plan_shift(st, i, 0.0, shift_distance(st.v[i], st.path_off[0], MERGE_ACCELERATION))
    st.merging[0] = 0
    log_event(st, op.EVENT_MERGE_ABORTED, 1.0 * st.path_lane[0])


@compiled
def watch_merge(n: RoadTables, p: Program, st: State, i: int) -> None:
    """Finish a merge, or abort it while the ego's box is still in its old lane and the gap has closed."""
    off = abs(st.path_off[0])
    if off < MERGED:
        st.merging[0] = 0
        return
    road = st.path_road[0]
    half = 0.5 * lane_width(n, road, st.path_lane[0], st.path_s[0])
    crossed = off < half + 0.5 * p.const[p.entity_const[i] + slot.E_WIDTH]
    if crossed or road != st.merge_from_road[0]:
        return
    if gap_is_free(n, p, st, i, road, st.path_lane[0], st.path_s[0]) == 0:
        abort_merge(n, st, i)


@compiled
def consider_merge(n: RoadTables, p: Program, st: State, i: int, within: float, look: float) -> None:
    """Continue a merge, or start one if the lane ends within a distance and the gap beside is free.

    The gap is checked if the lane ends within the distance `look`, m; the merge starts within the distance `within`, m.
    """
    st.gap_free[0] = 1
    if st.merging[0] == 1:
        watch_merge(n, p, st, i)
        return
    if st.through_lane[0] == 0 or st.lane_end_distance[0] > look:
        return
    st.gap_free[0] = gap_is_free(n, p, st, i, st.path_road[0], st.through_lane[0], st.path_s[0])
    if st.gap_free[0] == 1 and st.lane_end_distance[0] <= within and st.v[i] > 1.0:
        start_merge(n, st, i)
