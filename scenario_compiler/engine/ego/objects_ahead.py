"""Classifies each object ahead of the vehicle as followed, blocking, or neither.

An object is followed if it is a leader that moves along the path, or a vehicle that stands in a queue behind one or
before a red signal. The vehicle keeps its distance to such objects and stops if they stop. Every other object that
reaches into the driven corridor blocks it: standing, crossing and oncoming ones. Slowing down for an object and
requesting a takeover because of one both use this classification, so the automation never stops for an object without
requesting.

The corridor is that of a vehicle in the middle of its lane: the automation does not swerve.
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.extent import front_of
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.limits import behaviour, control_period
from scenario_compiler.engine.ego.sensor import CROSSING, SLOW
from scenario_compiler.marker import compiled

QUEUE_GAP = 12.0
"""Distance from a standing vehicle to the one ahead, or to the line of a red signal, up to which it stands in a queue,
m; chosen: the length of a truck that has not closed up.
"""

BESIDE_LEADER = 0.1
"""Lateral distance to the vehicle's side, m, within which an object that moves along the path is a leader."""


ROW_GAP = 20.0
"""Distance between two standing objects in the path up to which they form one block, m; chosen: too short to move back
between them and out again.
"""

ROW_TIME = 2.0
"""The same distance as a time at the present speed, s; chosen."""


@compiled
def in_corridor(p: Program, st: State, i: int, j: int, beside: float) -> int:
    """Return 1 if a seen object ahead reaches into the corridor of i's width plus `beside` on either side, m."""
    base = p.entity_const[i]
    front = front_of(p, i)
    half = 0.5 * p.const[base + slot.E_WIDTH] + beside
    if st.seen[j] == 0 or st.on_way[j] == 0 or st.far[j] <= front:
        return 0
    return 1 if st.low[j] < half and st.high[j] > -half else 0


@compiled
def queues_behind(st: State, j: int, k: int) -> int:
    """Return 1 if j may queue behind k: k is close ahead of j on the path, and they overlap laterally."""
    if k == j or st.on_way[k] == 0 or st.near[k] < st.far[j] - 0.5 or st.near[k] > st.far[j] + QUEUE_GAP:
        return 0
    return 1 if st.low[k] < st.high[j] and st.high[k] > st.low[j] else 0


@compiled
def stands_in_queue(p: Program, st: State, j: int) -> int:
    """Return 1 if a slow vehicle stands in a queue behind a moving leader or before a red signal.

    The queue is followed from one vehicle to the next; the vehicles further ahead need not be seen.
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
            if queues_behind(st, at, k) == 1 and (following < 0 or st.near[k] < st.near[following]):
                following = k
        if following < 0:
            return 0
        if st.along[following] >= SLOW:
            return 1
        at = following
    return 0


@compiled
def judge_objects(p: Program, st: State, i: int) -> None:
    """Classify every object of the last look ahead."""
    beside = max(0.5 * p.const[slot.K_BLOCKED_MARGIN], 0.0)
    for j in range(p.entity_count[0]):
        st.ahead_is[j] = op.AHEAD_NOTHING
        if j == i:
            continue
        if st.along[j] >= SLOW:
            if in_corridor(p, st, i, j, BESIDE_LEADER) == 1:
                st.ahead_is[j] = op.AHEAD_FOLLOWED
        elif in_corridor(p, st, i, j, beside) == 1:
            st.ahead_is[j] = op.AHEAD_FOLLOWED if stands_in_queue(p, st, j) == 1 else op.AHEAD_BLOCKING
        if st.ahead_is[j] == op.AHEAD_FOLLOWED:
            st.led_at[j] = st.clock[0]


@compiled
def follows_any(p: Program, st: State) -> int:
    """Return 1 if an object ahead is followed."""
    for j in range(p.entity_count[0]):
        if st.ahead_is[j] == op.AHEAD_FOLLOWED:
            return 1
    return 0


@compiled
def nearest_ahead(p: Program, st: State, i: int, what: int) -> tuple[int, float]:
    """Return (entity, gap from the front, m) of the nearest object ahead of a class; (NONE, FAR) if there is none."""
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
    """Return the distance between two standing objects in the path up to which they form one block, m."""
    return max(ROW_GAP, ROW_TIME * st.v[i])


@compiled
def row_end(p: Program, st: State, i: int, blocker: int) -> float:
    """Return the distance from the reference point to the far end of the block that begins with `blocker`, m."""
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
    """Write where the path is first blocked; return the entity that blocks it, or NONE."""
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
    """Return 1 if the automation slows down before a limit ahead: after its request, or if this cause never requests.

    An automation that holds its speed never slows down.
    """
    if behaviour(p, st) == op.BEHAVIOUR_HOLD_SPEED:
        return 0
    if p.cause_on[cause] == 0:
        return 1
    return 1 if st.takeover_state[0] in (op.TAKEOVER_REQUEST, op.TAKEOVER_ESCALATION) else 0


@compiled
def has_just_stopped(p: Program, st: State, j: int) -> int:
    """Return 1 if a blocking object was followed within the control steps that the request for it takes.

    The automation brakes for such a leader until the request, instead of letting go of the brake when the leader stops.
    """
    takes = p.const[slot.K_BLOCKED_COUNT] * control_period(p)
    return 1 if st.clock[0] - st.led_at[j] <= takes + op.TOLERANCE else 0


@compiled
def gap_to_keep(p: Program, st: State, i: int) -> tuple[float, float]:
    """Return (gap from the front, m; speed along the path, m/s) of what the automation keeps its distance to.

    This is the nearest of the followed objects, the line of a red signal, and what blocks the path if the automation
    slows down for it or followed it until just now. Without any of them the gap is FAR.
    """
    front = front_of(p, i)
    gap = op.FAR
    speed = 0.0
    if behaviour(p, st) != op.BEHAVIOUR_HOLD_SPEED:
        leader, gap = nearest_ahead(p, st, i, op.AHEAD_FOLLOWED)
        if leader >= 0:
            speed = st.along[leader]
        blocker, distance = nearest_ahead(p, st, i, op.AHEAD_BLOCKING)
        slows = minds_limit(p, st, op.CAUSE_PATH_BLOCKED) == 1
        if blocker >= 0 and distance < gap and (slows or has_just_stopped(p, st, blocker) == 1):
            gap = distance
            speed = st.along[blocker]
    if st.red_line[0] < op.FAR and st.red_line[0] - front < gap:
        gap = max(st.red_line[0] - front, 0.0)
        speed = 0.0
    return gap, speed
