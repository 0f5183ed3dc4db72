"""Classifies each object ahead of the vehicle as followed, blocking, or neither.

Followed is a leader that moves along the way, and a vehicle that stands in a queue behind one or before a red signal:
a vehicle keeps its distance to these, and stops where they stop. Whatever else reaches into the corridor that is
driven blocks it: standing and crossing objects, and oncoming ones. All that makes the automation slow down for an
object, and all that makes it ask because of one, stands on this one answer, so that it never stops for an object that
it does not ask about.

The corridor is that of a vehicle that keeps to the middle of its lane: the automation does not swerve.
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.extent import front_of
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.limits import behaviour
from scenario_compiler.engine.ego.sensor import CROSSING, SLOW
from scenario_compiler.marker import compiled

QUEUE_GAP = 12.0
"""Distance from a standing vehicle to the one before it, or to the line of a red signal, up to which it stands in a
queue, m: chosen, the length of a truck that has not closed up."""

BESIDE_LEADER = 0.1
"""How near to the vehicle's side, m, an object that moves along the way must reach to lead it."""


ROW_GAP = 20.0
"""Distance from one thing that stands in the path to the next up to which they block it together, m: chosen, too short
to move back between them and out again.
"""

ROW_TIME = 2.0
"""The same as a time at the speed driven, s; chosen."""


@compiled
def in_corridor(p: Program, st: State, i: int, j: int, beside: float) -> int:
    """Return 1 where a seen object ahead reaches into the corridor of i's width and `beside` on either side."""
    base = p.entity_const[i]
    front = front_of(p, i)
    half = 0.5 * p.const[base + slot.E_WIDTH] + beside
    if st.seen[j] == 0 or st.on_way[j] == 0 or st.far[j] <= front:
        return 0
    return 1 if st.low[j] < half and st.high[j] > -half else 0


@compiled
def queues_behind(p: Program, st: State, j: int, k: int) -> int:
    """Return 1 where k is close ahead of j on the way, and beside no part of it."""
    if k == j or st.on_way[k] == 0 or st.near[k] < st.far[j] - 0.5 or st.near[k] > st.far[j] + QUEUE_GAP:
        return 0
    return 1 if st.low[k] < st.high[j] and st.high[k] > st.low[j] else 0


@compiled
def stands_in_queue(p: Program, st: State, j: int) -> int:
    """Return 1 where a slow vehicle stands behind a leader that moves or before a red signal, or behind one that does.

    Vehicles further ahead need not be seen: the row is followed from one to the next.
    """
    at = j
    for _ in range(p.entity_count[0]):
        if p.entity_motion[at] in (op.MOTION_STATIC, op.MOTION_WALKER) or p.entity_type[at] != op.KIND_VEHICLE:
            return 0
        if st.along[at] <= -SLOW or abs(st.across[at]) > SLOW:
            return 0
        if st.red_line[0] < op.FAR:
            room = st.red_line[0] - st.far[at]
            if room > -QUEUE_GAP and room < QUEUE_GAP:
                return 1
        following = op.NONE
        for k in range(p.entity_count[0]):
            if queues_behind(p, st, at, k) == 1 and (following < 0 or st.near[k] < st.near[following]):
                following = k
        if following < 0:
            return 0
        if st.along[following] >= SLOW:
            return 1
        at = following
    return 0


@compiled
def judge_objects(p: Program, st: State, i: int) -> None:
    """Write what every object of the last look ahead is."""
    beside = max(0.5 * p.const[slot.K_BLOCKED_MARGIN], 0.0)
    for j in range(p.entity_count[0]):
        st.ahead_is[j] = op.AHEAD_NOTHING
        if j == i:
            continue
        if st.along[j] >= SLOW:
            if in_corridor(p, st, i, j, BESIDE_LEADER) == 1:
                st.ahead_is[j] = op.AHEAD_FOLLOWED
                st.led_at[j] = st.clock[0]
        elif in_corridor(p, st, i, j, beside) == 1:
            st.ahead_is[j] = op.AHEAD_FOLLOWED if stands_in_queue(p, st, j) == 1 else op.AHEAD_BLOCKING


@compiled
def follows_any(p: Program, st: State) -> int:
    """Return 1 where an object ahead is followed."""
    for j in range(p.entity_count[0]):
        if st.ahead_is[j] == op.AHEAD_FOLLOWED:
            return 1
    return 0


@compiled
def nearest_ahead(p: Program, st: State, i: int, what: int) -> tuple[int, float]:
    """Return (entity, gap from the front) of the nearest object ahead that is `what`, (NONE, FAR) for none."""
    front = front_of(p, i)
    found = op.NONE
    gap = op.FAR
    for j in range(p.entity_count[0]):
        if st.ahead_is[j] == what and st.near[j] - front < gap:
            found = j
            gap = st.near[j] - front
    return found, gap


@compiled
def row_gap(st: State, i: int) -> float:
    """Return the distance from one thing that stands in the path to the next up to which they block it together, m."""
    return max(ROW_GAP, ROW_TIME * st.v[i])


@compiled
def row_end(p: Program, st: State, i: int, blocker: int) -> float:
    """Return how far from the reference point the row ends that stands in the path and begins with a blocker, m."""
    between = row_gap(st, i)
    end = st.far[blocker]
    grows = 1
    while grows == 1:
        grows = 0
        for j in range(p.entity_count[0]):
            stands = st.ahead_is[j] == op.AHEAD_BLOCKING and st.along[j] > -SLOW and abs(st.across[j]) < CROSSING
            if stands and st.near[j] <= end + between and st.far[j] > end:
                end = st.far[j]
                grows = 1
    return end


@compiled
def find_block(p: Program, st: State, i: int) -> int:
    """Write where the path is first blocked; return the entity that blocks it, NONE for a free path."""
    front = front_of(p, i)
    st.blocked_distance[0] = op.FAR
    st.blocked_far[0] = op.FAR
    st.blocked_speed[0] = 0.0
    blocker, gap = nearest_ahead(p, st, i, op.AHEAD_BLOCKING)
    if blocker >= 0:
        st.blocked_distance[0] = max(gap, 0.0)
        st.blocked_speed[0] = max(-st.along[blocker], 0.0)
        st.blocked_far[0] = row_end(p, st, i, blocker) - front
    return blocker


@compiled
def minds_limit(p: Program, st: State, cause: int) -> int:
    """Return 1 where the automation slows down before a limit ahead: once it has asked, or if it never asks for it.

    An automation that holds its speed never does.
    """
    if behaviour(p, st) == op.BEHAVIOUR_HOLD_SPEED:
        return 0
    if p.cause_on[cause] == 0:
        return 1
    return 1 if st.takeover_state[0] in (op.TAKEOVER_REQUEST, op.TAKEOVER_ESCALATION) else 0


@compiled
def gap_to_keep(p: Program, st: State, i: int) -> tuple[float, float]:
    """Return (gap from the front, speed along the way) of what the automation keeps its distance to, FAR for nothing.

    That is the nearest of the followed objects, a red signal's line, and what blocks the path where the automation
    minds it.
    """
    front = front_of(p, i)
    gap = op.FAR
    speed = 0.0
    if behaviour(p, st) != op.BEHAVIOUR_HOLD_SPEED:
        leader, gap = nearest_ahead(p, st, i, op.AHEAD_FOLLOWED)
        if leader >= 0:
            speed = st.along[leader]
    if minds_limit(p, st, op.CAUSE_PATH_BLOCKED) == 1:
        blocker, distance = nearest_ahead(p, st, i, op.AHEAD_BLOCKING)
        if blocker >= 0 and distance < gap:
            gap = distance
            speed = st.along[blocker]
    if st.red_line[0] < op.FAR and st.red_line[0] - front < gap:
        gap = max(st.red_line[0] - front, 0.0)
        speed = 0.0
    return gap, speed
