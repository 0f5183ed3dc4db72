"""A driver's foresight: predicted positions of moving entities, their conflicts with an evasion, and reaction times.

The driver acts on something new after a perception time and a reaction time (0.4 s and 0.75 s, those of the careful and
competent driver of UN R157). It is noticed when it first requires more than gentle braking, or blocks the path, while
the driver's eyes are on the road.
"""

from __future__ import annotations

from math import cos, pi

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.extent import front_of
from scenario_compiler.engine.columns.numbers import clip, ratio
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.sensor import SLOW
from scenario_compiler.engine.motion.following import idm_acceleration
from scenario_compiler.marker import compiled

CALL = 1.0
"""Required deceleration above which the driver reacts to something, m/s2; chosen."""

FORGET = 2.0
"""Time after which something that no longer requires a reaction counts as new again, s; chosen."""

LIFT_OFF = 0.4
"""Deceleration without the accelerator, m/s2: that of the careful and competent driver of UN R157 during the delay."""

ONCOMING = -0.5
"""Speed along the path below which a vehicle is oncoming, m/s; chosen."""

HORIZON_STEP = 0.1
HORIZON_STEPS = 50
"""Length, s, and number of the steps of the prediction; chosen: 5 s in all."""

DRIFT = 0.2
"""Lateral speed above which a vehicle is assumed to change its lane, m/s; chosen."""

DRIFT_LEAST = 1.0
"""Least lateral speed that is assumed for a vehicle that changes its lane, m/s; chosen: a lane change in about 3.5 s.
"""

AHEAD_TIME = 1.5
"""Time for which a vehicle's entry into the corridor is predicted, s; chosen."""

SPACE_ALONG = 1.0
SPACE_ACROSS = 0.3
"""Distance that an evasion keeps to everything that it passes, along and across the path, m; chosen."""


@compiled
def drift_of(st: State, j: int, time: float) -> float:
    """Return the predicted displacement to the left of an entity on the path after a time, m.

    A vehicle that changes its lane is assumed to stop at the next lane's centre: one that approaches the path's lane at
    that lane's centre, one that leaves it a lane width further out.
    """
    if abs(st.across[j]) < DRIFT or st.along[j] < SLOW:
        return st.across[j] * time
    speed = max(abs(st.across[j]), DRIFT_LEAST)
    middle = 0.5 * (st.low[j] + st.high[j])
    width = st.border_left[j] - st.border_right[j]
    rest = width - abs(middle) if middle * st.across[j] > 0.0 else abs(middle)
    gone = min(speed * time, max(rest, 0.0))
    return gone if st.across[j] > 0.0 else -gone


@compiled
def in_corridor(p: Program, st: State, i: int, j: int, centre: float) -> int:
    """Return 1 if an entity is in the corridor of i around the offset `centre`, or will be within AHEAD_TIME."""
    half = 0.5 * p.const[p.entity_const[i] + slot.E_WIDTH] + 0.1
    if st.low[j] < centre + half and st.high[j] > centre - half:
        return 1
    shift = drift_of(st, j, AHEAD_TIME)
    return 1 if st.low[j] + shift < centre + half and st.high[j] + shift > centre - half else 0


@compiled
def called_for(p: Program, st: State, i: int, j: int, centre: float, slowest: float) -> float:
    """Return the acceleration that an entity ahead requires by the following model, m/s2; FAR if it is not in the way.

    Entities with a speed along the path below `slowest`, m/s, are left out.
    """
    if j == i or st.on_way[j] == 0 or st.seen[j] == 0 or st.along[j] < slowest:
        return op.FAR
    front = front_of(p, i)
    if st.far[j] <= front or in_corridor(p, st, i, j, centre) == 0:
        return op.FAR
    gap = st.near[j] - front
    return idm_acceleration(p, i, st.v[i], max(st.target_speed[0], 1.0), max(gap, 0.1), st.along[j])


@compiled
def notice(p: Program, st: State, i: int, blocker: int) -> None:
    """Record since when each entity has required a reaction, while the driver's eyes are on the road."""
    now = st.clock[0]
    if st.looking[0] == 0:
        return
    for j in range(p.entity_count[0]):
        calls = 1 if j == blocker else 0
        if st.seen[j] == 1 and st.on_way[j] == 1 and st.along[j] < ONCOMING:
            calls = 1
        if calls == 0 and called_for(p, st, i, j, 0.0, -op.FAR) < -CALL:
            calls = 1
        if calls == 1:
            st.called_at[j] = now
            if st.noticed_at[j] < 0.0:
                st.noticed_at[j] = now
        elif st.noticed_at[j] >= 0.0 and now - st.called_at[j] > FORGET:
            st.noticed_at[j] = -1.0


@compiled
def reacts_to(p: Program, st: State, j: int) -> int:
    """Return 1 if the driver acts on an entity, because the perception and reaction times have passed."""
    due = p.const[slot.K_PERCEPTION_TIME] + p.const[slot.K_REACTION_TIME]
    return 1 if st.noticed_at[j] >= 0.0 and st.clock[0] - st.noticed_at[j] >= due - op.TOLERANCE else 0


@compiled
def meets(p: Program, st: State, i: int, target: float, over: float, deceleration: float, jerk: float) -> float:
    """Return the time until i first meets something on the path, s; FAR if nothing within the horizon.

    The deceleration of i grows by `jerk` up to `deceleration`, and i moves from its offset to `target` along a cosine
    in the time `over`, s. Other entities keep their speed and move sideways as `drift_of` predicts.
    """
    base = p.entity_const[i]
    front = front_of(p, i)
    rear = front - p.const[base + slot.E_LENGTH]
    half = 0.5 * p.const[base + slot.E_WIDTH] + SPACE_ACROSS
    v = st.v[i]
    a = min(max(-st.pedal[0], 0.0), deceleration)
    gone = 0.0
    time = 0.0
    for _ in range(HORIZON_STEPS):
        time += HORIZON_STEP
        a = min(a + jerk * HORIZON_STEP, deceleration)
        slower = max(v - a * HORIZON_STEP, 0.0)
        gone += 0.5 * (v + slower) * HORIZON_STEP
        v = slower
        share = 0.5 * (1.0 - cos(pi * clip(ratio(time, over, 1.0), 0.0, 1.0)))
        off = st.path_off[0] + (target - st.path_off[0]) * share
        for j in range(p.entity_count[0]):
            if j == i or st.on_way[j] == 0:
                continue
            moved = st.along[j] * time - gone
            if st.near[j] + moved > front + SPACE_ALONG or st.far[j] + moved < rear - SPACE_ALONG:
                continue
            shift = drift_of(st, j, time)
            if st.low[j] + shift < off + half and st.high[j] + shift > off - half:
                return time
    return op.FAR
