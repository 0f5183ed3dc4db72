"""The lane that an entity belongs to, and neighbouring lanes, counted to the left as an entity faces.

A scripted entity that moves to an offset still belongs to its lane, however far it drifts over the border. Only a lane
change, a teleport, a trajectory or the link to the next lane changes its lane (esmini 3.6).
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.marker import compiled
from scenario_compiler.roads.lanes import lane_exists
from scenario_compiler.roads.tables import RoadTables


@compiled
def own_lane(p: Program, st: State, i: int) -> tuple[int, float]:
    """Return the lane that an entity belongs to, and its offset from that lane's centre."""
    if p.entity_motion[i] == op.MOTION_SCRIPTED and st.changing[i] == 0:
        return st.kept_lane[i], st.kept_off[i]
    return st.lane[i], st.off[i]


@compiled
def settle_in_lane(st: State, i: int) -> None:
    """Assign an entity whose lane change is over to the lane that contains its reference point."""
    if st.changing[i] == 1:
        st.kept_lane[i] = st.lane[i]
        st.kept_off[i] = st.off[i]
        st.changing[i] = 0


@compiled
def count_lanes(lane: int, by: int, facing: int) -> int:
    """Return the id `by` lanes to the left of a lane as seen along `facing` (1: along s), skipping the centre lane."""
    step = facing
    count = by
    if by < 0:
        step = -facing
        count = -by
    at = lane
    for _ in range(count):
        at = at + step
        if at == 0:
            at = at + step
    return at


@compiled
def neighbour_lane(n: RoadTables, road: int, lane: int, s: float, by: int, facing: int) -> int:
    """Return the lane `by` lanes to the left as seen along `facing`; 0 if there is none."""
    at = count_lanes(lane, by, facing)
    return at if lane_exists(n, road, at, s) == 1 else 0
