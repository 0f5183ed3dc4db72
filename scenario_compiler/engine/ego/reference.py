"""Reference drivers: the careful and competent driver of UN R157, RSS, and the fuzzy safety model.

They keep their lane and the wanted speed, slow down for bends as every driver (`bends`), and brake for what is ahead or
cuts in. The formulas are those of the JRC's program for the three models as far as they are published (RSS:
Shalev-Shwartz et al. 2017; FSM: Mattas et al. 2020). The condition under which the fuzzy safety model recognises a
cut-in is that of esmini's R157 controller. The text of UN R157 does not define when the careful and competent driver
perceives a cut-in, so there are three readings.
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.extent import front_of
from scenario_compiler.engine.columns.numbers import clip
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.bends import DRIVER_BRAKING, DRIVER_LATERAL, acceleration_for_bends
from scenario_compiler.engine.ego.driver import BRAKE_JERK, STEER_ACCELERATION
from scenario_compiler.engine.ego.foresight import LIFT_OFF
from scenario_compiler.engine.motion.following import idm_acceleration
from scenario_compiler.engine.motion.steering import command_acceleration, command_angle, pursuit_angle
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables

WANDERING = 0.375
"""Lateral displacement that is not yet a lane change, m: UN R157, careful and competent driver."""

RISK_TIME = 0.4
RISK_WAY = 0.72
"""Time to evaluate the risk, s, and the lateral distance moved in it at 1.8 m/s, m: UN R157."""

DELAY = 0.75
"""Time from the perceived risk to braking, s: UN R157; in the JRC's program also the response time of RSS and FSM."""

STRONGEST = 7.59
"""Greatest deceleration, m/s2: 0.774 g, UN R157."""

CRITICAL_TIME = 2.0
"""Time to collision of a cut-in, and time gap to a vehicle in the lane, below which the driver brakes, s: UN R157."""

RSS_ACCELERATION = 3.0
RSS_BRAKING = 6.0
RSS_MARGIN = 0.3
RSS_ASIDE = 1.0
"""Parameters of RSS in the JRC's program for UN R157: acceleration during the response time, m/s2; braking of both
vehicles, m/s2; lateral margin, m; lateral acceleration, m/s2.
"""

FSM_GENTLE = 4.0
FSM_HARD = 6.0
FSM_LEADER = 7.0
FSM_SPACE = 2.0
FSM_LATERAL = 0.1
"""Parameters of FSM in the JRC's program, after Mattas et al. 2020: comfortable and hardest braking of the follower,
m/s2; braking of the leader, m/s2; gap at standstill, m; time by which a cutting-in vehicle must arrive earlier, s.
"""

STEADY = 0.05
"""Lateral speed below which a vehicle keeps its position in the lane, m/s; chosen."""


@compiled
def proactive(gap: float, v: float, lead: float) -> float:
    """Return the proactive fuzzy surrogate safety metric PFS, 0 (safe) to 1, for a gap, m, and two speeds, m/s."""
    needed = v * DELAY - lead * lead / (2.0 * FSM_LEADER)
    safe = needed + v * v / (2.0 * FSM_GENTLE) + FSM_SPACE
    unsafe = needed + v * v / (2.0 * FSM_HARD)
    return clip((safe - gap + FSM_SPACE) / max(safe - unsafe, 1.0e-6), 0.0, 1.0)


@compiled
def critical(gap: float, v: float, lead: float, a: float) -> float:
    """Return the critical fuzzy surrogate safety metric CFS, 0 (safe) to 1; `a` is the follower's acceleration."""
    if v <= lead:
        return 0.0
    now = max(a, -FSM_GENTLE)
    if v + DELAY * now < lead:
        return 1.0 if gap < (v - lead) * (v - lead) / max(2.0 * abs(a), 1.0e-6) else 0.0
    begin = (v + 0.5 * now * DELAY - lead) * DELAY
    rest = v + now * DELAY - lead
    safe = begin + rest * rest / (2.0 * FSM_GENTLE)
    unsafe = begin + rest * rest / (2.0 * FSM_HARD)
    if gap >= safe:
        return 0.0
    if gap <= unsafe:
        return 1.0
    return clip((safe - gap) / max(safe - unsafe, 1.0e-6), 0.0, 1.0)


@compiled
def rss_distance(v: float, lead: float) -> float:
    """Return the safe longitudinal distance of RSS behind a leader, m."""
    faster = v + DELAY * RSS_ACCELERATION
    stopping = faster * faster / (2.0 * RSS_BRAKING)
    return v * DELAY + 0.5 * RSS_ACCELERATION * DELAY * DELAY + stopping - lead * lead / (2.0 * RSS_BRAKING)


@compiled
def rss_side_distance(aside: float) -> float:
    """Return the safe lateral distance of RSS to a vehicle with the lateral speed `aside`, m."""
    faster = aside + RSS_ASIDE * DELAY
    return RSS_MARGIN + abs(2.0 * aside + RSS_ASIDE * DELAY) * 0.5 * DELAY + faster * faster / (2.0 * RSS_ASIDE)


@compiled
def side_room(p: Program, st: State, i: int, j: int) -> float:
    """Return the lateral distance between the sides of i and j, m; not positive if they overlap."""
    half = 0.5 * p.const[p.entity_const[i] + slot.E_WIDTH]
    return max(st.low[j] - st.path_off[0] - half, st.path_off[0] - half - st.high[j])


@compiled
def minds_cut_in(st: State, j: int, kind: int, room: float) -> int:
    """Return 1 if the careful and competent driver has perceived the cut-in of j and evaluated its risk."""
    moved = abs(0.5 * (st.low[j] + st.high[j]) - st.place_before[j])
    perceived = room <= 0.0
    if kind == op.REFERENCE_CAREFUL:
        perceived = perceived or moved >= WANDERING
    elif kind == op.REFERENCE_CAREFUL_WAY:
        perceived = perceived or moved >= WANDERING + RISK_WAY
    if not perceived:
        st.minded_at[j] = -1.0
        return 0
    if st.minded_at[j] < 0.0:
        st.minded_at[j] = st.clock[0]
    evaluation = RISK_TIME if kind == op.REFERENCE_CAREFUL else 0.0
    return 1 if st.clock[0] - st.minded_at[j] >= evaluation - op.TOLERANCE else 0


@compiled
def danger_of(p: Program, st: State, i: int, j: int, kind: int, gap: float) -> float:
    """Return the deceleration that j requires under the model's condition, m/s2; 0 if none."""
    v = st.v[i]
    lead = st.along[j]
    room = side_room(p, st, i, j)
    if v <= lead or gap <= 0.0:
        return 0.0
    if kind == op.REFERENCE_RSS:
        safe = room > 0.0 and room >= rss_side_distance(abs(st.across[j]))
        return 0.0 if safe or gap >= rss_distance(v, max(lead, 0.0)) else STRONGEST
    if kind == op.REFERENCE_FUZZY:
        coming = -st.across[j] if st.low[j] > st.path_off[0] else st.across[j]
        if room > 0.0 and (coming <= 0.0 or room / max(coming, 1.0e-6) > gap / max(v - lead, 1.0e-6) + FSM_LATERAL):
            return 0.0
        severe = critical(gap, v, lead, st.a[i])
        if severe > 0.0:
            return FSM_GENTLE + severe * (FSM_HARD - FSM_GENTLE)
        return FSM_GENTLE * proactive(gap, v, max(lead, 0.0))
    if minds_cut_in(st, j, kind, room) == 0:
        return 0.0
    if st.in_lane_before[j] == 1:
        return STRONGEST if gap < CRITICAL_TIME * v else 0.0
    return STRONGEST if gap < CRITICAL_TIME * (v - lead) else 0.0


@compiled
def note_place(p: Program, st: State, i: int, j: int) -> None:
    """Record the lateral position of j while it does not move sideways, and whether it is in i's lane there."""
    if abs(st.across[j]) < STEADY or st.place_known[j] == 0:
        st.place_known[j] = 1
        st.place_before[j] = 0.5 * (st.low[j] + st.high[j])
        st.in_lane_before[j] = 1 if side_room(p, st, i, j) <= 0.0 else 0


@compiled
def reference_braking(p: Program, st: State, i: int, kind: int) -> float:
    """Return the acceleration of a reference driver now, m/s2; FAR if there is nothing to brake for.

    During the delay the driver lifts off the accelerator or holds the speed. After braking for a vehicle, the driver
    does not accelerate again behind it.
    """
    front = front_of(p, i)
    called = 0.0
    waiting = 0
    holding = 0
    for j in range(p.entity_count[0]):
        if j == i or st.on_way[j] == 0 or st.seen[j] == 0 or st.far[j] <= front:
            continue
        note_place(p, st, i, j)
        holding = max(holding, st.was_danger[j])
        gap = st.near[j] - front
        danger = danger_of(p, st, i, j, kind, gap)
        if danger <= 0.0 and (kind == op.REFERENCE_FUZZY or st.v[i] <= st.along[j]):
            st.danger_at[j] = -1.0
            continue
        if danger > 0.0 and st.danger_at[j] < 0.0:
            st.danger_at[j] = st.clock[0]
            st.was_danger[j] = 1
        if st.danger_at[j] < 0.0:
            continue
        if st.clock[0] - st.danger_at[j] < DELAY - op.TOLERANCE:
            waiting = 1
        elif kind == op.REFERENCE_FUZZY:
            called = max(called, min(danger, STRONGEST))
        else:
            called = STRONGEST
    if called > 0.0:
        return -called
    if waiting == 1:
        return 0.0 if kind in (op.REFERENCE_RSS, op.REFERENCE_FUZZY) else -LIFT_OFF
    return 0.0 if holding == 1 else op.FAR


@compiled
def drive_by_reference(n: RoadTables, p: Program, st: State, i: int, kind: int) -> None:
    """Drive the ego for one control step as a reference driver; the path ahead must have been measured before."""
    step = BRAKE_JERK * p.const[slot.K_STEP] * p.control_every[0]
    wanted = reference_braking(p, st, i, kind)
    if wanted >= op.FAR:
        free = idm_acceleration(p, i, st.v[i], st.target_speed[0], op.FAR, 0.0)
        wanted = min(free, st.pedal[0] + step) if st.pedal[0] < 0.0 else free
    else:
        wanted = clip(wanted, min(st.pedal[0], 0.0) - step, min(st.pedal[0], 0.0) + step)
    in_bends = acceleration_for_bends(n, p, st, i, DRIVER_LATERAL, DRIVER_BRAKING)
    wanted = min(wanted, in_bends)
    command_acceleration(p, st, i, wanted)
    command_angle(p, st, i, pursuit_angle(n, p, st, i, STEER_ACCELERATION))
