"""Whether oncoming traffic leaves enough time for an evasion into its lane, including the return.

The driver predicts the whole evasion: moving over, passing and coming back, while accelerating as on a free road.
Oncoming vehicles keep their speed. The driver keeps a time to collision, from both speeds, to every oncoming vehicle
that overlaps the ego laterally at that time. Hidden vehicles within sight count too: as with those beside and behind,
the driver is assumed to know of them. Beyond the driver's sight, a vehicle is presumed in the lane that is entered,
which approaches at the speed that the driver intends to drive.
"""

from __future__ import annotations

from math import cos, pi, sin

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.extent import front_of
from scenario_compiler.engine.columns.numbers import clip, ratio, safe_sqrt
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.foresight import HORIZON_STEP, ONCOMING, reacts_to
from scenario_compiler.engine.motion.following import free_pull, pull_limits
from scenario_compiler.engine.motion.steering import shift_distance
from scenario_compiler.marker import compiled

PASSING_SIGHT = 300.0
"""Distance over which a driver observes an oncoming lane before moving into it, m; chosen. Passing sight distances for
roads of 50 to 100 km/h are of this order.
"""

MEETING_TIME = 1.5
"""Time to collision with an oncoming vehicle that a driver keeps while in its way, s; chosen."""

GIVE_UP_TIME = 0.75
"""Time to collision below which a driver gives up an evasion that has begun, s; chosen, less than the time required to
begin, so that the driver does not waver.
"""

PASSING_STEPS = 200
"""Number of steps of the prediction; an evasion of more than these 20 s is not begun. Chosen."""

CLEARANCE = 0.3
"""Distance that a driver keeps on both sides when passing, m; chosen."""

RETURN_ACCELERATION = 1.5
"""Lateral acceleration of the move back to the lane's centre, and of an evasion that has time, m/s2; chosen."""

PAST = 5.0
"""Distance to a passed moving vehicle from which the driver comes back before it, m; chosen."""

BEHIND_TIME = 1.0
"""Time gap at which the driver comes back behind a moving vehicle, s; chosen."""


@compiled
def is_clear_of(p: Program, st: State, i: int, j: int, v: float, moved: float) -> int:
    """Return 1 if i, at a speed v, m/s, is well before or behind a moving vehicle.

    `moved` is the predicted displacement of j along the path relative to i, m.
    """
    base = p.entity_const[i]
    front = front_of(p, i)
    before = front - p.const[base + slot.E_LENGTH] - st.far[j] - moved
    behind = st.near[j] + moved - front
    if before >= PAST + BEHIND_TIME * max(st.along[j] - v, 0.0):
        return 1
    return 1 if behind >= max(PAST, BEHIND_TIME * v) and st.along[j] >= v else 0


@compiled
def half_with_clearance(p: Program, i: int) -> float:
    """Return half the width of i, m, with the distance that its driver keeps on both sides."""
    return 0.5 * p.const[p.entity_const[i] + slot.E_WIDTH] + CLEARANCE


@compiled
def is_beside(low: float, high: float, rear: float, nose: float, half: float) -> int:
    """Return 1 if a box from offset `low` to `high` has no lateral overlap with the ego, whose ends are at two offsets.

    `half` is half the ego's width, m, with its clearance.
    """
    return 1 if low >= max(rear, nose) + half or high <= min(rear, nose) - half else 0


@compiled
def nose_offset(off: float, slope: float, front: float) -> float:
    """Return the offset of the ego's nose, m, from that of its rear axle and the slope of its path there."""
    return off + front * ratio(slope, safe_sqrt(1.0 + slope * slope), 0.0)


@compiled
def moving_over(begin: float, target: float, out: float, gone: float) -> tuple[float, float]:
    """Return (offset, slope) after `gone` metres of a move from one offset to another over a distance, all in m."""
    share = clip(ratio(gone, out, 1.0), 0.0, 1.0)
    off = begin + 0.5 * (1.0 - cos(pi * share)) * (target - begin)
    return off, 0.5 * pi * sin(pi * share) * ratio(target - begin, out, 0.0)


@compiled
def coming_back(target: float, over: float, gone: float) -> tuple[float, float]:
    """Return (offset, slope) after `gone` metres of the move back from an offset over a distance, all in m."""
    share = clip(ratio(gone, over, 1.0), 0.0, 1.0)
    off = 0.5 * (1.0 + cos(pi * share)) * target
    return off, -0.5 * pi * sin(pi * share) * ratio(target, over, 0.0)


@compiled
def is_oncoming(st: State, i: int, j: int) -> int:
    """Return 1 if j comes towards i on the path."""
    return 1 if j != i and st.on_way[j] == 1 and st.along[j] <= ONCOMING else 0


@compiled
def has_gone_by(p: Program, st: State, i: int, j: int, moved: float) -> int:
    """Return 1 if j is behind i, after it has moved forward by `moved` relative to i, m."""
    return 1 if st.far[j] + moved < front_of(p, i) - p.const[p.entity_const[i] + slot.E_LENGTH] else 0


@compiled
def is_approaching(p: Program, st: State, i: int, j: int) -> int:
    """Return 1 if an oncoming vehicle on the path has not passed i yet.

    One that has passed never `comes_near` again, because it moves on and i does not drive backwards.
    """
    if is_oncoming(st, i, j) == 0:
        return 0
    return 0 if has_gone_by(p, st, i, j, 0.0) == 1 and st.v[i] >= 0.0 else 1


@compiled
def any_approaching(p: Program, st: State, i: int) -> int:
    """Return 1 if anything on the path approaches i."""
    for j in range(p.entity_count[0]):
        if is_approaching(p, st, i, j) == 1:
            return 1
    return 0


@compiled
def earliest_near(p: Program, st: State, i: int, fastest: float, spare: float) -> float:
    """Return a time, s, before which no oncoming vehicle `comes_near` if i drives no faster than `fastest`, m/s."""
    front = front_of(p, i)
    earliest = op.FAR
    for j in range(p.entity_count[0]):
        if is_approaching(p, st, i, j) == 1:
            meeting = (st.near[j] - front) / max(fastest - st.along[j], -ONCOMING)
            earliest = min(earliest, meeting - spare)
    return earliest - op.TOLERANCE


@compiled
def comes_near(
    p: Program, st: State, i: int, j: int, time: float, gone: float, v: float, spare: float, known: int
) -> int:
    """Return 1 if an oncoming vehicle has not passed and is nearer to i than a time to collision of `spare`, s.

    That is after a time, s, in which i drives `gone` metres and reaches the speed v, m/s. With `known` 1 only a vehicle
    counts that the driver has had the time to react to.
    """
    if is_oncoming(st, i, j) == 0:
        return 0
    moved = st.along[j] * time - gone
    if has_gone_by(p, st, i, j, moved) == 1 or (known == 1 and reacts_to(p, st, j) == 0):
        return 0
    gap = max(st.near[j] + moved - front_of(p, i), 0.0)
    return 1 if gap < spare * (v - st.along[j]) else 0


@compiled
def any_comes_near(p: Program, st: State, i: int, time: float, gone: float, v: float, spare: float, known: int) -> int:
    """Return 1 if an oncoming vehicle `comes_near`."""
    for j in range(p.entity_count[0]):
        if comes_near(p, st, i, j, time, gone, v, spare, known) == 1:
            return 1
    return 0


@compiled
def has_passed(p: Program, st: State, i: int, around: int, time: float, gone: float, v: float) -> int:
    """Return 1 if i is clear of the moving vehicle that it passes, or passes only standing objects.

    That is after a time, s, in which i drives `gone` metres and reaches the speed v, m/s.
    """
    return 1 if around < 0 else is_clear_of(p, st, i, around, v, st.along[around] * time - gone)


@compiled
def meets_any(
    p: Program,
    st: State,
    i: int,
    time: float,
    gone: float,
    v: float,
    spare: float,
    known: int,
    rear: float,
    nose: float,
) -> int:
    """Return 1 if an oncoming vehicle `comes_near` and overlaps i, whose rear and nose are at two offsets, m."""
    half = half_with_clearance(p, i)
    for j in range(p.entity_count[0]):
        near = comes_near(p, st, i, j, time, gone, v, spare, known) == 1
        if near and is_beside(st.low[j], st.high[j], rear, nose, half) == 0:
            return 1
    return 0


@compiled
def meets_oncoming(
    p: Program,
    st: State,
    i: int,
    target: float,
    out: float,
    until: float,
    around: int,
    braking: float,
    spare: float,
    known: int,
    low: float,
    high: float,
) -> int:
    """Return 1 if i meets an oncoming vehicle before it is back at the centre of its lane.

    Args:
        p: The program.
        st: The state, after a look ahead.
        i: The ego.
        target: Offset at which it passes, m.
        out: Distance over which it moves there, along a cosine, m.
        until: Distance that it drives until it begins to come back, m; with `around`, the least.
        around: The moving vehicle that it passes, or behind which it comes back; NONE for standing objects.
        braking: Deceleration while it moves over, m/s2; 0 if it accelerates as on a free road.
        spare: Time to collision that is to be kept, s.
        known: 1 if only those vehicles count that the driver has had the time to react to.
        low: Right border of the lane of oncoming traffic that is entered, m to the left of the path lane's centre. A
            vehicle is presumed there beyond the driver's sight.
        high: Its left border; not more than `low` if no such lane is entered.
    """
    if high <= low and any_approaching(p, st, i) == 0:
        return 0
    front = front_of(p, i)
    usual = max(st.target_speed[0], 1.0)
    begin = st.path_off[0]
    off = begin
    v = st.v[i]
    gone = 0.0
    back_from = op.FAR
    back_over = 1.0
    strongest, hardest, least = pull_limits(p, i)
    earliest = earliest_near(p, st, i, max(v, usual) + strongest * HORIZON_STEP, spare)
    for k in range(PASSING_STEPS):
        time = (k + 1) * HORIZON_STEP
        slows = gone < out and braking > 0.0
        a = -braking if slows else clip(strongest * free_pull(v, usual, least), -hardest, strongest)
        faster = max(v + a * HORIZON_STEP, 0.0)
        before = gone
        gone += 0.5 * (v + faster) * HORIZON_STEP
        v = faster
        if back_from >= op.FAR and gone >= until and has_passed(p, st, i, around, time, gone, v) == 1:
            if k > 0:
                off, slope = moving_over(begin, target, out, before)
            back_from = gone
            back_over = shift_distance(v, off, RETURN_ACCELERATION)
        if back_from < op.FAR and ratio(gone - back_from, back_over, 1.0) >= 1.0:
            return 0
        entered = high > low and PASSING_SIGHT - usual * time - gone < spare * (v + usual)
        near = time >= earliest and any_comes_near(p, st, i, time, gone, v, spare, known) == 1
        if not entered and not near:
            continue  # nothing is near enough to be met
        if back_from < op.FAR:
            off, slope = coming_back(target, back_over, gone - back_from)
        else:
            off, slope = moving_over(begin, target, out, gone)
        nose = nose_offset(off, slope, front)
        if entered and is_beside(low, high, off, nose, half_with_clearance(p, i)) == 0:
            return 1
        if near and meets_any(p, st, i, time, gone, v, spare, known, off, nose) == 1:
            return 1
    return 1 if high > low else 0
