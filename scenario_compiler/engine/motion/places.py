"""Resolves the positions of the conflict language: in lanes, ahead of and beside entities, at random.

A position relative to an entity is measured from where that entity starts. A random position is drawn with the counter
hash, so that it depends only on the run's seed (or its own), its row and the attempt.
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.numbers import clip, is_number, length_of
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.seeds import run_seed
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.beside import neighbour_lane
from scenario_compiler.marker import compiled
from scenario_compiler.randomness import random_unit
from scenario_compiler.roads.lanes import lane_direction, lane_exists, lane_pose
from scenario_compiler.roads.tables import RoadTables
from scenario_compiler.roads.travel import advance


@compiled
def draw_place(n: RoadTables, p: Program, st: State, k: int, attempt: int) -> tuple[int, int, float, float, int]:
    """Return the random place of an attempt, as `resolve_position` does."""
    return place_by_share(n, p, k, random_unit(run_seed(st, p.position_seed[k]), op.STREAM_PLACE, k, attempt))


@compiled
def place_by_share(n: RoadTables, p: Program, k: int, unit: float) -> tuple[int, int, float, float, int]:
    """Return the random place at the share `unit` in (0, 1) of a position's stretches, as `resolve_position` does.

    The share is measured in length of the stretches; if they are points, each has the same share.
    """
    total = 0.0
    for q in range(p.position_first[k], p.position_last[k]):
        total = total + p.const[p.span_const[q] + slot.L_TO] - p.const[p.span_const[q] + slot.L_FROM]
    count = p.position_last[k] - p.position_first[k]
    if count <= 0:
        return -1, 0, 0.0, 0.0, 1
    chosen = p.position_first[k] + min(int(clip(unit * count, 0.0, 1.0e6)), count - 1)
    rest = 0.0
    if total > 0.0:
        rest = unit * total
        chosen = p.position_first[k]
        for q in range(p.position_first[k], p.position_last[k] - 1):
            size = p.const[p.span_const[q] + slot.L_TO] - p.const[p.span_const[q] + slot.L_FROM]
            if q == chosen and rest > size:
                rest = rest - size
                chosen = q + 1
    road = p.span_road[chosen]
    lane = p.span_lane[chosen]
    s = clip(p.const[p.span_const[chosen] + slot.L_FROM] + rest, 0.0, n.road_length[road])
    if lane_exists(n, road, lane, s) == 0:
        return -1, 0, 0.0, 0.0, 1
    return road, lane, s, p.const[p.position_const[k] + slot.P_OFFSET], lane_direction(n, road, lane, s)


@compiled
def place_beside(n: RoadTables, st: State, other: int, ahead: float, left: float) -> tuple[int, int, float, float, int]:
    """Return the place ahead of and to the left of an entity's present place, as `resolve_position` does."""
    road = st.road[other]
    if road < 0:
        return -1, 0, 0.0, 0.0, 1
    aside = st.off[other] * lane_direction(n, road, st.lane[other], st.s[other]) + left
    road, lane, s, rest = advance(n, road, st.lane[other], st.s[other], ahead, -1)
    if rest > 0.0:
        return -1, 0, 0.0, 0.0, 1
    direction = lane_direction(n, road, lane, s)
    return road, lane, s, aside * direction, direction


@compiled
def nearest_placed(p: Program, st: State, order: int, x: float, y: float) -> float:
    """Return the distance from a point to the nearest entity before `order`, m; FAR if there is none."""
    nearest = op.FAR
    for q in range(order):
        j = p.entity_order[q]
        if st.present[j] == 1:
            nearest = min(nearest, length_of(st.x[j] - x, st.y[j] - y))
    return nearest


@compiled
def clear_place(
    n: RoadTables, p: Program, st: State, k: int, order: int, first: int, attempts: int
) -> tuple[int, int, float, float, int]:
    """Return a random place that is clear of the entities placed before; road -1 if no attempt finds one."""
    clear = p.const[p.position_const[k] + slot.P_S]
    for attempt in range(first, first + attempts):
        road, lane, s, offset, direction = draw_place(n, p, st, k, attempt)
        if road >= 0:
            x, y, _, _, _, _ = lane_pose(n, road, lane, s, offset)
            if nearest_placed(p, st, order, x, y) >= clear:
                return road, lane, s, offset, direction
    return -1, 0, 0.0, 0.0, 1


@compiled
def resolve_position(n: RoadTables, p: Program, st: State, k: int) -> tuple[int, int, float, float, int]:
    """Return (road, lane, s, offset to the left along s, direction of travel) of a position; road -1 if there is none.

    A relative position is measured from where the entity starts: sideways first, then along that lane as the entity
    faces.
    """
    base = p.position_const[k]
    s = p.const[base + slot.P_S]
    offset = p.const[base + slot.P_OFFSET]
    road = p.position_road[k]
    lane = p.position_lane[k]
    if is_number(s) == 0 or is_number(offset) == 0:
        return -1, 0, 0.0, 0.0, 1
    if p.position_op[k] == op.POSITION_RANDOM:
        return draw_place(n, p, st, k, 0)
    if p.position_op[k] == op.POSITION_BESIDE:
        return place_beside(n, st, p.position_entity[k], s, offset)
    if p.position_op[k] == op.POSITION_RELATIVE:
        other = p.position_entity[k]
        if st.road[other] < 0:
            return -1, 0, 0.0, 0.0, 1
        road = st.road[other]
        facing = lane_direction(n, road, st.lane[other], st.s[other])
        lane = neighbour_lane(n, road, st.lane[other], st.s[other], p.position_lane[k], facing)
        if lane == 0:
            return -1, 0, 0.0, 0.0, 1
        same = facing * lane_direction(n, road, lane, st.s[other])
        road, lane, s, rest = advance(n, road, lane, st.s[other], same * s, -1)
        if rest > 0.0:
            return -1, 0, 0.0, 0.0, 1
        direction = lane_direction(n, road, lane, s)
        return road, lane, s, offset * same * direction, direction
    s = clip(s, 0.0, n.road_length[road])
    if lane_exists(n, road, lane, s) == 0:
        return -1, 0, 0.0, 0.0, 1
    return road, lane, s, offset, lane_direction(n, road, lane, s)


@compiled
def reset_positions(n: RoadTables, p: Program, st: State) -> None:
    """Evaluate the plan's positions; those relative to an entity refer to where it starts."""
    for k in range(p.position_count[0]):
        if p.position_op[k] < op.POSITION_FREE:
            road, lane, s, offset, _ = resolve_position(n, p, st, k)
            if road >= 0:
                x, y, _, _, _, _ = lane_pose(n, road, lane, s, offset)
                st.position_x[k] = x
                st.position_y[k] = y
