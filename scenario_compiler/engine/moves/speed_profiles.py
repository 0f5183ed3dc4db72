"""A series of speeds: each entry is reached after its time, or as soon as the limits let it.

Followed by position, the speed goes in straight lines. Followed smoothly, with a limit of the jerk, the acceleration of
an entry rises, stays and falls again, as a trapezium; without such a limit the lines are straight too. An entry whose
time is too short for the limits takes longer.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.numbers import clip, safe_sqrt
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.rows import ActionRow, ProgramDraft, Slot, flags_of, limits_of
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.moves.entry import HOLDS_SPEED, Entry
from scenario_compiler.engine.moves.speeds import set_speed, speed_before
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables

if TYPE_CHECKING:
    from scenario_compiler.vocabulary.actions import SpeedProfileAction


@compiled
def profile_jerk(p: Program, k: int, change: float) -> float:
    """Return the jerk of an entry, 0 for straight lines."""
    if p.action_flags[k] & op.FLAG_SMOOTH == 0:
        return 0.0
    place = slot.A_ACCELERATION_RATE if change > 0.0 else slot.A_DECELERATION_RATE
    return max(p.const[p.action_const[k] + place], 0.0)


@compiled
def profile_limit(p: Program, k: int, change: float, timed: int) -> float:
    """Return the greatest acceleration of an entry: the action's, else, where no time is given, the vehicle's."""
    place = slot.A_ACCELERATION if change > 0.0 else slot.A_DECELERATION
    limit = p.const[p.action_const[k] + place]
    if limit >= 0.0:
        return limit
    if timed == 1:
        return op.FAR
    of_vehicle = slot.E_MAX_ACCELERATION if change > 0.0 else slot.E_MAX_DECELERATION
    return p.const[p.entity_const[p.action_entity[k]] + of_vehicle]


@compiled
def begin_entry(p: Program, st: State, k: int, entry: int) -> None:
    """Prepare the way from the present speed to an entry's."""
    i = p.action_entity[k]
    place = p.action_const[k] + slot.A_ENTRIES + 2 * entry
    other = p.action_other[k]
    target = p.const[place]
    if other >= 0:
        target = target + st.v[other]
    fastest = p.const[p.entity_const[i] + slot.E_MAX_SPEED]
    if p.const[p.action_const[k] + slot.A_MOST_SPEED] >= 0.0:
        fastest = min(fastest, p.const[p.action_const[k] + slot.A_MOST_SPEED])
    begin = speed_before(p, st, i)
    change = clip(target, -fastest, fastest) - begin
    time = p.const[place + 1]
    most = max(profile_limit(p, k, change, 1 if time >= 0.0 else 0), op.TOLERANCE)
    jerk = profile_jerk(p, k, change)
    least = abs(change) / most
    if jerk > op.TOLERANCE:
        least = 2.0 * safe_sqrt(abs(change) / jerk)
        if abs(change) * jerk >= most * most:
            least = abs(change) / most + most / jerk
    span = max(time, least)
    st.action_a[k] = 1.0 * entry
    st.action_b[k] = 0.0
    if jerk > op.TOLERANCE:
        st.action_b[k] = 0.5 * (jerk * span - safe_sqrt(jerk * jerk * span * span - 4.0 * jerk * abs(change)))
    st.action_from[k] = begin
    st.action_change[k] = change
    st.action_span[k] = span
    st.action_progress[k] = 0.0


@compiled
def speed_in_entry(p: Program, st: State, k: int, progress: float) -> float:
    """Return the speed at a time after an entry was begun, before its end."""
    change = st.action_change[k]
    span = max(st.action_span[k], op.TOLERANCE)
    jerk = profile_jerk(p, k, change)
    most = st.action_b[k]
    if jerk <= op.TOLERANCE or most <= op.TOLERANCE:
        return st.action_from[k] + change * progress / span
    ramp = most / jerk
    done = most * (progress - 0.5 * ramp)
    if progress < ramp:
        done = 0.5 * jerk * progress * progress
    elif progress > span - ramp:
        done = abs(change) - 0.5 * jerk * (span - progress) * (span - progress)
    return st.action_from[k] + (done if change > 0.0 else -done)


@compiled
def start_profile(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Begin the first entry."""
    del n
    st.longitudinal[p.action_entity[k]] = k
    begin_entry(p, st, k, 0)


@compiled
def step_profile(n: RoadTables, p: Program, st: State, k: int, dt: float) -> int:
    """Set the speed after dt; return 1 in the step that reaches the last entry."""
    del n
    i = p.action_entity[k]
    progress = st.action_progress[k] + dt
    entries = p.action_lanes[k]
    for _ in range(entries):
        span = st.action_span[k]
        if progress < span - op.TOLERANCE:
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


def speed_profile_row(draft: ProgramDraft, word: SpeedProfileAction, actor: int) -> ActionRow:
    """Return the row of a speed profile."""
    del actor
    entries: list[Slot] = []
    for entry in word.entries:
        entries += [entry.speed, -1.0 if entry.time is None else entry.time]
    return ActionRow(
        (0.0, 0.0, *limits_of(word.limits), *entries),
        lanes=len(word.entries),
        other=draft.entities[word.to] if word.to else op.NONE,
        flags=flags_of((op.FLAG_SMOOTH, word.following == "follow")),
    )


SPEED_PROFILE = Entry(("speed_profile",), speed_profile_row, start_profile, step_profile, holds=HOLDS_SPEED)
