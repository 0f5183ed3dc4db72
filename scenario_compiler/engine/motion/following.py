"""Car following: the intelligent driver model of Treiber, Hennecke and Helbing (2000), Physical Review E 62, 1805.

The acceleration is a (1 - (v / v0)^4 - (s* / s)^2) with s* = s0 + max(0, v T + v (v - v_lead) / (2 sqrt(a b))).
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.extent import front_of
from scenario_compiler.engine.columns.numbers import clip, length_of, ratio, safe_sqrt
from scenario_compiler.engine.columns.presence import there_for
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.ahead import measure_on_way, walk
from scenario_compiler.marker import compiled
from scenario_compiler.roads.lanes import lane_direction
from scenario_compiler.roads.tables import RoadTables

FOLLOW_HORIZON = 200.0
"""Distance up to which a leader is searched ahead, m."""


@compiled
def free_pull(v: float, desired: float, least: float) -> float:
    """Return the model's acceleration on a free road as a multiple of the usual one, at least `least`."""
    free = ratio(v, desired, 2.0)
    free = free * free
    pull = 1.0 - free * free
    return least if pull < least else pull


@compiled
def pull_limits(p: Program, i: int) -> tuple[float, float, float]:
    """Return (acceleration, deceleration, least pull) that limit the model for entity i: m/s2, m/s2, and a multiple.

    The acceleration is the usual one, the deceleration that of the brakes.
    """
    base = p.entity_const[i]
    a = p.const[base + slot.E_ACCELERATION]
    return a, p.const[base + slot.E_MAX_DECELERATION], -p.const[base + slot.E_DECELERATION] / max(a, 0.1)


@compiled
def idm_acceleration(p: Program, i: int, v: float, desired: float, gap: float, lead: float) -> float:
    """Return the model's acceleration for entity i, limited by its brakes, m/s2; `gap` is FAR if there is no leader."""
    base = p.entity_const[i]
    a = p.const[base + slot.E_ACCELERATION]
    b = p.const[base + slot.E_DECELERATION]
    pull = free_pull(v, desired, -b / max(a, 0.1))
    if gap < op.FAR:
        closing = ratio(v * (v - lead), 2.0 * safe_sqrt(a * b), 0.0)
        wanted = p.const[base + slot.E_MINIMUM_GAP] + max(0.0, v * p.const[base + slot.E_TIME_GAP] + closing)
        near = wanted / max(gap, 0.1)
        pull = pull - near * near
    return clip(a * pull, -p.const[base + slot.E_MAX_DECELERATION], a)


@compiled
def leader_gap(p: Program, st: State, i: int, centre: float, watched: int, slowest: float) -> tuple[float, float]:
    """Return (gap, speed) of the nearest entity on the way whose box overlaps i's corridor around the offset `centre`.

    The gap is measured from i's front, m; FAR if there is none. With `watched` 1 only seen entities count. Entities
    with a speed along the way below `slowest`, m/s, do not count. The measurements of the last look ahead are used.
    """
    base = p.entity_const[i]
    front = front_of(p, i)
    half = 0.5 * p.const[base + slot.E_WIDTH] + 0.1
    gap = op.FAR
    speed = 0.0
    for j in range(p.entity_count[0]):
        if j == i or st.on_way[j] == 0 or (watched == 1 and st.seen[j] == 0):
            continue
        if st.along[j] < slowest:
            continue
        ahead = st.near[j] - front
        if st.far[j] > front and ahead < gap and st.low[j] < centre + half and st.high[j] > centre - half:
            gap = ahead
            speed = st.along[j]
    return gap, speed


@compiled
def follow_leader(n: RoadTables, p: Program, st: State, i: int, dt: float) -> None:
    """Set the speed of a scripted entity after dt by the model, behind the entity ahead in its lane."""
    road = st.road[i]
    lane = st.lane[i]
    along = st.facing[i] * lane_direction(n, road, lane, st.s[i])
    walk(n, st, road, lane, st.s[i], along, FOLLOW_HORIZON, -1)
    for j in range(p.entity_count[0]):
        st.on_way[j] = 0
        near = length_of(st.x[j] - st.x[i], st.y[j] - st.y[i]) < FOLLOW_HORIZON
        if j != i and near and there_for(st, j, op.SEEN_BY_TRAFFIC) == 1:
            measure_on_way(n, p, st, j)
    gap, speed = leader_gap(p, st, i, st.facing[i] * st.off[i], 0, -op.FAR)
    pull = idm_acceleration(p, i, st.v[i], st.desired[i], gap, speed)
    st.v[i] = max(0.0, st.v[i] + dt * pull)
