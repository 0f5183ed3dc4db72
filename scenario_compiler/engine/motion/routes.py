"""The road that an entity takes at a junction: by its guide, at random, or straight on.

A guide is a row of `Program.guide_next`. For every road and each direction of travel it holds the next road, so that an
entity finds its route from any place. The guide ends when the entity enters its last road.
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.seeds import run_seed
from scenario_compiler.engine.columns.state import State
from scenario_compiler.marker import compiled
from scenario_compiler.randomness import random_hash
from scenario_compiler.roads.lanes import lane_direction, lane_row_in
from scenario_compiler.roads.tables import AT_END, AT_START, RoadTables


@compiled
def random_turn(n: RoadTables, p: Program, st: State, i: int, road: int, sense: int) -> int:
    """Return the road that an entity takes at random where several follow its lane; it is the same every time."""
    section = n.road_section[road]
    end = AT_START
    if sense > 0:
        section = n.road_section[road + 1] - 1
        end = AT_END
    row = lane_row_in(n, section, st.kept_lane[i])
    if row < 0:
        return op.NONE
    first = n.lane_link[2 * row + end]
    count = n.lane_link[2 * row + end + 1] - first
    if count <= 0:
        return op.NONE
    bits = random_hash(run_seed(st, p.entity_seed[i]), op.STREAM_TURN, i, road)
    return n.section_road[n.lane_section[n.link_lane[first + bits % max(count, 1)]]]


@compiled
def against_traffic(n: RoadTables, p: Program, st: State, i: int, ahead: int, at_end: int) -> int:
    """Return the next road for an entity that drives against its lane's direction of travel.

    No lane of the guide's next road continues its lane; the road of the opposite direction does, and is returned.
    """
    road = st.road[i]
    section = n.road_section[road + at_end] - at_end
    row = lane_row_in(n, section, st.kept_lane[i])
    beyond = 2 * (st.guide[i] * p.road_count[0] + ahead)
    onward = max(p.guide_next[beyond], p.guide_next[beyond + 1])
    if row < 0 or onward < 0:
        return ahead
    end = AT_END if at_end == 1 else AT_START
    for link in range(n.lane_link[2 * row + end], n.lane_link[2 * row + end + 1]):
        other = n.section_road[n.lane_section[n.link_lane[link]]]
        if n.road_start_road[other] == onward or n.road_end_road[other] == onward:
            return other
    return ahead


@compiled
def next_turn(n: RoadTables, p: Program, st: State, i: int, road: int) -> int:
    """Return the road that an entity takes at the junction after `road`, or -1 for straight on."""
    if p.entity_motion[i] == op.MOTION_TRAFFIC:
        return st.turn_to[i] if st.turn_from[i] == road else -1
    guide = st.guide[i]
    if guide == op.NONE or road < 0:
        return -1
    sense = st.facing[i]
    if road == st.road[i] and st.v[i] < 0.0:
        sense = -sense
    if guide == op.RANDOM_GUIDE:
        return random_turn(n, p, st, i, road, sense)
    at = 2 * (guide * p.road_count[0] + road)
    ahead = p.guide_next[at + 1] if sense > 0 else p.guide_next[at]
    if ahead == op.NONE and road != st.road[i]:
        ahead = p.guide_next[at] if sense > 0 else p.guide_next[at + 1]
    if ahead >= 0 and road == st.road[i] and sense * lane_direction(n, road, st.kept_lane[i], st.s[i]) < 0:
        return against_traffic(n, p, st, i, ahead, 1 if sense > 0 else 0)
    return ahead


@compiled
def leave_guide(p: Program, st: State, i: int) -> None:
    """Remove an entity's guide when the entity has reached its last road."""
    guide = st.guide[i]
    if guide >= 0 and p.guide_last[guide] == st.road[i]:
        st.guide[i] = op.NONE
