"""The entities ahead of and behind a traffic vehicle: listed by road, and searched along a walked way."""

from __future__ import annotations

from math import cos, sin

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.extent import rear_of
from scenario_compiler.engine.columns.presence import there_for
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.marker import compiled
from scenario_compiler.roads.lanes import lane_centre
from scenario_compiler.roads.tables import RoadTables
from scenario_compiler.roads.travel import advance

SIDE_ROOM = 0.2
"""Lateral distance to a vehicle within which an entity is in its way, m."""


@compiled
def list_by_road(p: Program, st: State) -> None:
    """List the present entities by road; a chain holds the entities of all roads that share a bucket."""
    for b in range(op.BUCKETS):
        st.bucket_head[b] = op.NONE
    for i in range(p.entity_count[0]):
        if st.road[i] >= 0 and there_for(st, i, op.SEEN_BY_TRAFFIC) == 1:
            b = st.road[i] % op.BUCKETS
            st.bucket_next[i] = st.bucket_head[b]
            st.bucket_head[b] = i


@compiled
def way_centre(n: RoadTables, st: State, w: int, s: float) -> float:
    """Return t of the centre of the way's lane in row w at s, m."""
    road = st.way_road[w]
    lane = st.way_lane[w]
    if n.road_section[road + 1] - n.road_section[road] > 1:
        gone = s - st.way_s[w]
        if st.way_sign[w] < 0:
            gone = -gone
        if gone > 0.0:
            ahead = gone if st.along_way[0] > 0 else -gone
            to, there, _, rest = advance(n, road, lane, st.way_s[w], ahead, op.NONE)
            if to == road and rest <= 0.0:
                lane = there
    centre, _ = lane_centre(n, road, lane, s)
    return centre


@compiled
def in_corridor(n: RoadTables, p: Program, st: State, i: int, j: int, w: int) -> int:
    """Return 1 if the box of entity j reaches into the corridor of i along the way, or if j is changing into its lane.

    The corridor of a vehicle that changes lanes includes where it comes from.
    """
    if st.kept_lane[j] == st.way_lane[w] and st.lateral[j] >= 0 and st.road[j] == st.road[i]:
        return 1
    centre = way_centre(n, st, w, st.s[j])
    a = p.entity_const[i]
    b = p.entity_const[j]
    half = 0.5 * p.const[a + slot.E_WIDTH] + SIDE_ROOM
    side = abs(sin(st.turn[j]))
    wide = 0.5 * (side * p.const[b + slot.E_LENGTH] + abs(cos(st.turn[j])) * p.const[b + slot.E_WIDTH])
    low = min(0.0, st.kept_off[i]) - half
    high = max(0.0, st.kept_off[i]) + half
    if st.kept_lane[i] != st.way_lane[0] or w > 0:
        low = -half
        high = half
    off = st.t[j] - centre
    return 1 if off + wide > low and off - wide < high else 0


@compiled
def leader_on_way(n: RoadTables, p: Program, st: State, i: int) -> tuple[float, float]:
    """Return (gap from the front, m; speed along the way, m/s) of the nearest entity ahead in the corridor.

    The gap is FAR if there is none.
    """
    base = p.entity_const[i]
    centre = p.const[base + slot.E_CENTER]
    front = centre + 0.5 * p.const[base + slot.E_LENGTH]
    gap = op.FAR
    speed = 0.0
    for w in range(st.way_count[0]):
        road = st.way_road[w]
        j = st.bucket_head[road % op.BUCKETS]
        while j >= 0:
            if j != i and st.road[j] == road:
                b = p.entity_const[j]
                sense = st.facing[j] * st.way_sign[w]
                c = cos(st.turn[j]) * sense
                ahead = st.way_sign[w] * (st.s[j] - st.way_s[w])
                middle = st.way_from[w] + ahead + p.const[b + slot.E_CENTER] * c
                deep = 0.5 * (abs(c) * p.const[b + slot.E_LENGTH] + abs(sin(st.turn[j])) * p.const[b + slot.E_WIDTH])
                near = middle - deep - front
                nearer = middle > centre and near < gap and (w == 0 or ahead >= 0.0)
                if nearer and in_corridor(n, p, st, i, j, w) == 1:
                    gap = near
                    speed = st.v[j] * c
            j = st.bucket_next[j]
        if gap < op.FAR:
            return gap, speed
    return gap, speed


@compiled
def follower_on_way(n: RoadTables, p: Program, st: State, i: int) -> tuple[int, float]:
    """Return (entity, gap to its front in m) of the nearest entity behind on a way walked backwards, or (-1, FAR)."""
    base = p.entity_const[i]
    rear = rear_of(p, i)
    gap = op.FAR
    found = op.NONE
    for w in range(st.way_count[0]):
        road = st.way_road[w]
        j = st.bucket_head[road % op.BUCKETS]
        while j >= 0:
            if j != i and st.road[j] == road and p.entity_motion[j] != op.MOTION_STATIC:
                b = p.entity_const[j]
                back = st.way_from[w] + st.way_sign[w] * (st.s[j] - st.way_s[w])
                near = back - p.const[b + slot.E_CENTER] - 0.5 * p.const[b + slot.E_LENGTH] - rear
                beside = back > p.const[b + slot.E_CENTER] - p.const[base + slot.E_CENTER]
                nearer = beside and near < gap and st.facing[j] * st.way_sign[w] < 0
                if nearer and in_corridor(n, p, st, i, j, w) == 1:
                    gap = near
                    found = j
            j = st.bucket_next[j]
        if found >= 0:
            return found, gap
    return found, gap
