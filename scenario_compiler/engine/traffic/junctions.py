"""Right of way at junctions: a vehicle claims its connecting road, first come, first served.

A claim is granted if no road that crosses it (see `conflicts`) is claimed, driven on, or waited for longer, and if
there is room behind the junction. It lasts until the vehicle's rear has left the connecting road.
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.extent import front_of, rear_of
from scenario_compiler.engine.columns.numbers import ratio
from scenario_compiler.engine.columns.presence import there_for
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.path import STEP_OVER, preferred_road
from scenario_compiler.marker import compiled
from scenario_compiler.roads.lanes import lane_direction
from scenario_compiler.roads.tables import RoadTables
from scenario_compiler.roads.travel import advance

LINE_ROOM = 1.0
"""Distance between the line at which a vehicle waits and the junction, m."""

ASK_TIME = 1.0
ASK_MORE = 20.0
"""Before the line, a vehicle asks for its connecting road at a braking distance plus this time, s, and this distance,
m.
"""

EXIT_ROOM = 3.0
"""Room needed behind the junction in addition to the vehicle's length, m."""

CRAWL = 2.0
"""Speed below which a vehicle behind the junction counts as standing, m/s."""

OUTSIDER_TIME = 3.0
OUTSIDER_MORE = 5.0
"""Time, s, and distance, m, to the junction within which vehicles yield to one that is not background traffic."""


@compiled
def crosses(p: Program, one: int, other: int) -> int:
    """Return 1 if two connecting roads are so close to each other that only one of them may be driven on."""
    if other < 0:
        return 0
    for q in range(p.conflict_first[one], p.conflict_first[one + 1]):
        if p.conflict_road[q] == other:
            return 1
    return 0


@compiled
def outsider_in_way(n: RoadTables, p: Program, st: State, road: int, j: int) -> int:
    """Return 1 if an entity that is not background traffic drives on a crossing road or is about to."""
    at = st.road[j]
    if at < 0:
        return 0
    if n.road_junction[at] >= 0:
        return crosses(p, road, at)
    if st.v[j] < 0.5 or st.lane[j] == 0:
        return 0
    direction = lane_direction(n, at, st.lane[j], st.s[j])
    if st.facing[j] != direction:
        return 0
    rest = n.road_length[at] - st.s[j] if direction > 0 else st.s[j]
    if rest > OUTSIDER_TIME * st.v[j] + OUTSIDER_MORE:
        return 0
    turn = preferred_road(p, st, at) if j == p.ego[0] else op.NONE
    to, _, _, _ = advance(n, at, st.lane[j], st.s[j], rest + STEP_OVER, turn)
    return crosses(p, road, to)


@compiled
def way_is_free(n: RoadTables, p: Program, st: State, i: int, road: int) -> int:
    """Return 1 if nobody drives on, has claimed, or has waited longer for a road that crosses `road`."""
    for j in range(p.entity_count[0]):
        if there_for(st, j, op.SEEN_BY_TRAFFIC) == 0:
            continue
        kind = p.entity_motion[j]
        if j != i and kind == op.MOTION_TRAFFIC:
            if crosses(p, road, st.claim[j]) == 1 or crosses(p, road, st.road[j]) == 1:
                return 0
            earlier = st.asked[j] < st.asked[i] or (st.asked[j] == st.asked[i] and j < i)
            if st.asked[j] >= 0 and earlier and crosses(p, road, st.turn_to[j]) == 1:
                return 0
        elif (
            kind not in (op.MOTION_STATIC, op.MOTION_TRAFFIC, op.MOTION_WALKER)
            and outsider_in_way(n, p, st, road, j) == 1
        ):
            return 0
    return 1


@compiled
def drop_claim(n: RoadTables, p: Program, st: State, i: int) -> None:
    """Release a claim if the vehicle's rear has left the connecting road."""
    if st.claim[i] < 0:
        return
    road = st.road[i]
    if road == st.claim[i]:
        st.entered[i] = 1
    elif st.entered[i] == 1:
        direction = lane_direction(n, road, st.kept_lane[i], st.s[i])
        gone = st.s[i] if direction > 0 else n.road_length[road] - st.s[i]
        if gone > rear_of(p, i) + LINE_ROOM:
            st.claim[i] = op.NONE
            st.entered[i] = 0


@compiled
def wait_at_red(p: Program, st: State, i: int, red: float) -> float:
    """Return the distance from the front to the line of a red signal, m; a waiting vehicle releases its claim."""
    base = p.entity_const[i]
    st.asked[i] = op.NONE
    if st.claim[i] >= 0 and st.entered[i] == 0 and st.road[i] != st.claim[i]:
        st.claim[i] = op.NONE
    return red - p.const[base + slot.E_CENTER] - 0.5 * p.const[base + slot.E_LENGTH]


@compiled
def distance_to_line(n: RoadTables, p: Program, st: State, i: int, gap: float, lead: float) -> float:
    """Return the distance from the front to the line at which a vehicle must stop, m; FAR if it may drive on.

    The way must have been walked; `gap` and `lead` are those of the leader on it. The vehicle asks for its next
    connecting road if it is near enough.
    """
    if st.way_count[0] < 2:
        return op.FAR
    road = st.way_road[1]
    if n.road_junction[road] < 0 or st.claim[i] == road:
        return op.FAR
    base = p.entity_const[i]
    front = front_of(p, i)
    line = st.way_from[1] - front - LINE_ROOM
    brake = ratio(st.v[i] * st.v[i], 2.0 * p.const[base + slot.E_DECELERATION], 0.0)
    if line > brake + ASK_TIME * st.v[i] + ASK_MORE:
        return op.FAR
    if line < -0.5 * p.const[base + slot.E_LENGTH]:
        st.claim[i] = road
        st.entered[i] = 0
        return op.FAR
    blocked = gap < line
    if st.way_count[0] > 2:
        room = st.way_from[2] - front + p.const[base + slot.E_LENGTH] + EXIT_ROOM
        blocked = blocked or (gap < room and lead < CRAWL)
    if blocked or (st.claim[i] >= 0 and st.claim[i] != st.road[i]):
        st.asked[i] = op.NONE
        return line
    if st.asked[i] < 0:
        st.asked[i] = st.frame[0]
    if way_is_free(n, p, st, i, road) == 0:
        return line
    st.claim[i] = road
    st.entered[i] = 0
    st.asked[i] = op.NONE
    return op.FAR
