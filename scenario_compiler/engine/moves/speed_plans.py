"""The plan of a series of speeds: pieces of constant jerk over time, computed when the action begins. After esmini 3.6.

The entries are the corners of a polyline of speed over time. Followed by position, the polyline itself is the plan.
Followed smoothly, its corners are rounded by parabolas of the greatest jerk that are tangent to both lines; from the
first corner that cannot be rounded, the polyline is the plan. A plan with a single target begins with the present
acceleration and ends with none: the acceleration changes with the greatest jerk, stays constant, and changes back.
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.numbers import clip, ratio, safe_sqrt
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.marker import compiled

SHARPEST = 1.0e9
"""Jerk if none is given, m/s3: the acceleration changes practically at once."""


def pieces_needed(entries: int) -> int:
    """Return the number of pieces for a profile with so many entries: its corners, then its plan and the end of it."""
    return (entries + 1) + (2 * entries + 5)


@compiled
def limit_in_profile(p: Program, k: int, change: float, timed: int) -> float:
    """Return the greatest acceleration of an entry, m/s2: the action's, but no more than the vehicle's.

    Without a limit of the action, an entry without a time has the vehicle's, and one with a time has none.
    """
    place = slot.A_ACCELERATION if change > 0.0 else slot.A_DECELERATION
    limit = p.const[p.action_const[k] + place]
    if limit < 0.0 and timed == 1:
        return op.FAR
    of_vehicle = slot.E_MAX_ACCELERATION if change > 0.0 else slot.E_MAX_DECELERATION
    own = p.const[p.entity_const[p.action_entity[k]] + of_vehicle]
    return own if limit < 0.0 else min(limit, own)


@compiled
def jerk_towards(p: Program, k: int, change: float) -> float:
    """Return the signed jerk with which an acceleration rises (change > 0) or falls, m/s3."""
    place = slot.A_ACCELERATION_RATE if change > 0.0 else slot.A_DECELERATION_RATE
    jerk = p.const[p.action_const[k] + place]
    if jerk < 0.0:
        jerk = SHARPEST
    return max(jerk, op.TOLERANCE) if change > 0.0 else -max(jerk, op.TOLERANCE)


@compiled
def speed_of_entry(p: Program, st: State, k: int, entry: int) -> float:
    """Return an entry's speed, absolute or relative to the reference entity's present speed, within the limits, m/s."""
    speed = p.const[p.action_const[k] + slot.A_ENTRIES + 2 * entry]
    if p.action_other[k] >= 0:
        speed = speed + st.v[p.action_other[k]]
    fastest = p.const[p.entity_const[p.action_entity[k]] + slot.E_MAX_SPEED]
    if p.const[p.action_const[k] + slot.A_MOST_SPEED] >= 0.0:
        fastest = min(fastest, p.const[p.action_const[k] + slot.A_MOST_SPEED])
    return clip(speed, -fastest, fastest)


@compiled
def note_piece(st: State, at: int, time: float, speed: float, slope: float, jerk: float) -> int:
    """Write a piece of a plan, or a corner; return the index of the next one."""
    st.piece_time[at] = time
    st.piece_speed[at] = speed
    st.piece_slope[at] = slope
    st.piece_jerk[at] = jerk
    return at + 1


@compiled
def set_corners(p: Program, st: State, k: int, speed: float) -> int:
    """Write the corners of a profile from a speed, each with the slope of the line after it; return their number.

    The time of an entry counts from the previous one. An entry without a time, or with a line steeper than the limits,
    gets the limit as its slope, and all later ones are delayed. A first entry with time 0 sets the speed at once, and
    is skipped if speeds are followed smoothly.
    """
    first = p.action_piece[k]
    last = note_piece(st, first, st.clock[0], speed, 0.0, 0.0) - 1
    entries = p.action_lanes[k]
    for entry in range(entries):
        time = p.const[p.action_const[k] + slot.A_ENTRIES + 2 * entry + 1]
        if entry == 0 and time >= 0.0 and time < op.TOLERANCE:
            if p.action_flags[k] & op.FLAG_SMOOTH == 0:
                st.piece_speed[first] = speed_of_entry(p, st, k, 0)
            continue
        target = speed_of_entry(p, st, k, entry)
        change = target - st.piece_speed[last]
        timed = 1 if time >= 0.0 else 0
        span = max(time, abs(change) / max(limit_in_profile(p, k, change, timed), op.TOLERANCE))
        if span < op.TOLERANCE:
            st.piece_speed[last] = target
            continue
        slope = change / span
        straight = 1 if last > first and abs(slope - st.piece_slope[last - 1]) < op.TOLERANCE else 0
        st.piece_slope[last] = slope
        if straight == 1:
            st.piece_time[last] = st.piece_time[last] + span
            st.piece_speed[last] = target
            st.piece_slope[last] = 0.0
        else:
            last = note_piece(st, last + 1, st.piece_time[last] + span, target, 0.0, 0.0) - 1
    return last - first + 1


@compiled
def drive_corners(st: State, corner: int, last: int, at: int) -> int:
    """Plan the polyline itself from a corner on; return the index after the plan."""
    for c in range(corner, last + 1):
        at = note_piece(st, at, st.piece_time[c], st.piece_speed[c], st.piece_slope[c], 0.0)
    return at


@compiled
def plan_single(p: Program, st: State, k: int, a: float, at: int) -> int:
    """Plan the speed to a single target from an acceleration a to none; return the index after the plan.

    The acceleration goes to a level q with a jerk i, stays constant, and goes to 0 with a jerk j. The change of speed
    dv and the time T require q^2 (1/j - 1/i) / 2 + q (T + a/i) - a^2 / (2 i) = dv. If no level satisfies this, or the
    limits are below it, the change takes longer. At the level 0 the speed is kept for the rest of the time.
    """
    first = p.action_piece[k]
    begin = st.piece_time[first]
    v = st.piece_speed[first]
    slope = st.piece_slope[first]
    change = st.piece_speed[first + 1] - v
    span = st.piece_time[first + 1] - begin
    rise = jerk_towards(p, k, slope - a)
    fall = jerk_towards(p, k, -slope)
    square = 0.5 * (ratio(1.0, fall, 0.0) - ratio(1.0, rise, 0.0))
    line = span + ratio(a, rise, 0.0)
    rest = -0.5 * ratio(a * a, rise, 0.0) - change
    level = -ratio(rest, line, 0.0)
    if rise * fall < 0.0:
        under = line * line - 4.0 * square * rest
        level = -2.0 * ratio(rest, line + safe_sqrt(under), 0.0)
        if under < 0.0:
            level = safe_sqrt(ratio(rest, square, 0.0)) * (1.0 if rise > 0.0 else -1.0)
    elif line < op.TOLERANCE or (level - a) * rise < 0.0 or level * fall > 0.0:
        return drive_corners(st, first, first + 1, at)
    timed = 1 if p.const[p.action_const[k] + slot.A_ENTRIES + 2 * p.action_lanes[k] - 1] >= 0.0 else 0
    level = clip(level, -limit_in_profile(p, k, -1.0, timed), limit_in_profile(p, k, 1.0, timed))
    begun = 0.5 * ratio(level * level - a * a, rise, 0.0)
    ended = -0.5 * ratio(level * level, fall, 0.0)
    hold = max(ratio(change - begun - ended, level, line), 0.0)
    at = note_piece(st, at, begin, v, a, rise)
    begin = begin + ratio(level - a, rise, 0.0)
    v = v + begun
    at = note_piece(st, at, begin, v, level, 0.0)
    at = note_piece(st, at, begin + hold, v + level * hold, level, fall)
    return note_piece(st, at, begin + hold - ratio(level, fall, 0.0), st.piece_speed[first + 1], 0.0, 0.0)


@compiled
def plan_rounded(p: Program, st: State, k: int, a: float, last: int, at: int) -> int:
    """Plan the polyline with rounded corners from an acceleration a; return the index after the plan.

    A parabola of jerk j from slope q to r takes (r - q) / j; its start follows from its tangency to both lines. The
    first line begins after a parabola from the present acceleration, and is therefore parallel to the one between the
    corners.
    """
    first = p.action_piece[k]
    start = at
    slope = st.piece_slope[first]
    begin = st.piece_time[first]
    v = st.piece_speed[first]
    if abs(slope) > op.TOLERANCE and abs(slope - a) > op.TOLERANCE:
        jerk = jerk_towards(p, k, slope - a)
        at = note_piece(st, at, begin, v, a, jerk)
        span = ratio(slope - a, jerk, 0.0)
        begin = begin + span
        v = v + (a + 0.5 * jerk * span) * span
    at = note_piece(st, at, begin, v, slope, 0.0)
    for c in range(first + 1, last + 1):
        following = st.piece_slope[c]
        turn = following - slope
        if abs(turn) < op.TOLERANCE:
            continue
        jerk = jerk_towards(p, k, turn)
        span = ratio(turn, jerk, 0.0)
        apart = st.piece_speed[c] + following * (begin - st.piece_time[c]) - v
        touch = begin - (apart + 0.5 * jerk * span * span) / turn
        if touch < begin:
            if c == first + 1:
                return drive_corners(st, first, last, start)
            return drive_corners(st, c, last, at)
        v = v + slope * (touch - begin)
        at = note_piece(st, at, touch, v, slope, jerk)
        begin = touch + span
        v = v + (slope + 0.5 * jerk * span) * span
        slope = following
        at = note_piece(st, at, begin, v, slope, 0.0)
    return at


@compiled
def plan_speeds(p: Program, st: State, k: int, speed: float, acceleration: float) -> None:
    """Plan a profile from a speed and an acceleration; a piece that never begins ends the plan."""
    first = p.action_piece[k]
    count = set_corners(p, st, k, speed)
    last = first + count - 1
    at = first + p.action_lanes[k] + 1
    st.action_phase[k] = at
    if p.action_flags[k] & op.FLAG_SMOOTH == 0 or count == 1:
        at = drive_corners(st, first, last, at)
    elif count == 2:
        at = plan_single(p, st, k, acceleration, at)
    else:
        at = plan_rounded(p, st, k, acceleration, last, at)
    note_piece(st, at, op.FAR, 0.0, 0.0, 0.0)
