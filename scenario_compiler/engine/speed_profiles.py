"""A series of speeds: each entry is reached after its time, or as soon as the limits let it.

Followed by position, the speed goes in straight lines. Followed smoothly, with a limit of the jerk, the acceleration of
an entry rises, stays and falls again, as a trapezium; without such a limit the lines are straight too. An entry whose
time is too short for the limits takes longer.
"""

from __future__ import annotations

from scenario_compiler.engine.numbers import clip, safe_sqrt
from scenario_compiler.engine.opcodes import (
    FAR,
    FLAG_SMOOTH,
    TOLERANCE,
)
from scenario_compiler.engine.slots import (
    A_ACCELERATION,
    A_ACCELERATION_RATE,
    A_DECELERATION,
    A_DECELERATION_RATE,
    A_ENTRIES,
    A_MOST_SPEED,
    E_MAX_ACCELERATION,
    E_MAX_DECELERATION,
    E_MAX_SPEED,
)
from scenario_compiler.engine.speeds import set_speed, speed_before
from scenario_compiler.engine.state import State
from scenario_compiler.engine.tables import Program
from scenario_compiler.marker import compiled


@compiled
def profile_jerk(p: Program, k: int, change: float) -> float:
    """Return the jerk of an entry, 0 for straight lines."""
    if p.action_flags[k] & FLAG_SMOOTH == 0:
        return 0.0
    slot = A_ACCELERATION_RATE if change > 0.0 else A_DECELERATION_RATE
    return max(p.const[p.action_const[k] + slot], 0.0)


@compiled
def profile_limit(p: Program, k: int, change: float, timed: int) -> float:
    """Return the greatest acceleration of an entry: the action's, else, where no time is given, the vehicle's."""
    slot = A_ACCELERATION if change > 0.0 else A_DECELERATION
    limit = p.const[p.action_const[k] + slot]
    if limit >= 0.0:
        return limit
    if timed == 1:
        return FAR
    of_vehicle = E_MAX_ACCELERATION if change > 0.0 else E_MAX_DECELERATION
    return p.const[p.entity_const[p.action_entity[k]] + of_vehicle]


@compiled
def begin_entry(p: Program, st: State, k: int, entry: int) -> None:
    """Prepare the way from the present speed to an entry's."""
    i = p.action_entity[k]
    slot = p.action_const[k] + A_ENTRIES + 2 * entry
    other = p.action_other[k]
    target = p.const[slot]
    if other >= 0:
        target = target + st.v[other]
    fastest = p.const[p.entity_const[i] + E_MAX_SPEED]
    if p.const[p.action_const[k] + A_MOST_SPEED] >= 0.0:
        fastest = min(fastest, p.const[p.action_const[k] + A_MOST_SPEED])
    begin = speed_before(p, st, i)
    change = clip(target, -fastest, fastest) - begin
    time = p.const[slot + 1]
    most = max(profile_limit(p, k, change, 1 if time >= 0.0 else 0), TOLERANCE)
    jerk = profile_jerk(p, k, change)
    least = abs(change) / most
    if jerk > TOLERANCE:
        least = 2.0 * safe_sqrt(abs(change) / jerk)
        if abs(change) * jerk >= most * most:
            least = abs(change) / most + most / jerk
    span = max(time, least)
    st.action_a[k] = 1.0 * entry
    st.action_b[k] = 0.0
    if jerk > TOLERANCE:
        st.action_b[k] = 0.5 * (jerk * span - safe_sqrt(jerk * jerk * span * span - 4.0 * jerk * abs(change)))
    st.action_from[k] = begin
    st.action_change[k] = change
    st.action_span[k] = span
    st.action_progress[k] = 0.0


@compiled
def speed_in_entry(p: Program, st: State, k: int, progress: float) -> float:
    """Return the speed at a time after an entry was begun, before its end."""
    change = st.action_change[k]
    span = max(st.action_span[k], TOLERANCE)
    jerk = profile_jerk(p, k, change)
    most = st.action_b[k]
    if jerk <= TOLERANCE or most <= TOLERANCE:
        return st.action_from[k] + change * progress / span
    ramp = most / jerk
    done = most * (progress - 0.5 * ramp)
    if progress < ramp:
        done = 0.5 * jerk * progress * progress
    elif progress > span - ramp:
        done = abs(change) - 0.5 * jerk * (span - progress) * (span - progress)
    return st.action_from[k] + (done if change > 0.0 else -done)


@compiled
def start_profile(p: Program, st: State, k: int) -> None:
    """Begin the first entry."""
    st.longitudinal[p.action_entity[k]] = k
    begin_entry(p, st, k, 0)


@compiled
def step_profile(p: Program, st: State, k: int, dt: float) -> int:
    """Set the speed after dt; return 1 in the step that reaches the last entry."""
    i = p.action_entity[k]
    progress = st.action_progress[k] + dt
    entries = p.action_lanes[k]
    for _ in range(entries):
        span = st.action_span[k]
        if progress < span - TOLERANCE:
            st.action_progress[k] = progress
            set_speed(p, st, i, speed_in_entry(p, st, k, progress))
            return 0
        set_speed(p, st, i, st.action_from[k] + st.action_change[k])
        progress = max(progress - span, 0.0)
        entry = int(clip(st.action_a[k], 0.0, 1.0e6)) + 1
        if entry >= entries:
            return 1
        begin_entry(p, st, k, entry)
    return 1
