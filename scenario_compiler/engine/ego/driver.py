"""The driver who has taken over: keeps the lane by preview, brakes before a blocked path, evades or merges.

Awareness is 0.5 at first and rises by 0.1 a second, as in SUMO's ToC device: until then the steering is slower and
less steady. Braking is that of the careful and competent driver of UN R157 (annex, table 1): up to 0.774 g, with a
jerk of 12.65 m/s3.
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.log import log_event
from scenario_compiler.engine.columns.numbers import clip, safe_sqrt
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.seeds import run_seed
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.sensor import gap_between, gap_is_free, look_ahead
from scenario_compiler.engine.motion.beside import neighbour_lane
from scenario_compiler.engine.motion.following import idm_acceleration, leader_gap
from scenario_compiler.engine.motion.path import path_ahead
from scenario_compiler.engine.motion.steering import (
    come_to_rest,
    command_acceleration,
    command_angle,
    plan_shift,
    pursuit_angle,
    shift_distance,
)
from scenario_compiler.marker import compiled
from scenario_compiler.randomness import random_unit
from scenario_compiler.roads.lane_types import is_drivable
from scenario_compiler.roads.lanes import lane_direction, lane_type, lane_width
from scenario_compiler.roads.tables import RoadTables

SIGHT = 150.0
"""How far a driver looks ahead, m."""

VIEW = 3.490658503988659
"""Full angle that a driver looks over, rad: 200 degrees, the human field of view with both eyes."""

AWARENESS_AT_FIRST = 0.5
AWARENESS_RATE = 0.1
"""Awareness after the answer and its rise per second (SUMO's ToC device: initialAwareness, recoveryRate)."""

HARDEST_BRAKE = 7.59
BRAKE_JERK = 12.65
"""Deceleration, m/s2, and jerk, m/s3, of the careful and competent driver."""

LATE_BRAKE = 2.5
"""Deceleration needed to stop in time at which a driver gives up smooth braking, m/s2."""

STANDOFF = 5.0
"""Distance that a driver who stops keeps to what blocks the path beyond the standstill gap, m: room to pull out
later.
"""

PULL_OUT_ACCELERATION = 1.0
"""Acceleration that a driver counts on when judging how long the way past takes, m/s2."""

CLEARANCE = 0.3
"""Distance that a driver keeps to both sides when passing, m."""

EVADE_ACCELERATION = 3.0
"""Greatest lateral acceleration of a planned evasion, m/s2."""

STEER_ACCELERATION = 6.0
"""Bound of the lateral acceleration that a driver steers for, m/s2."""

MEETING_TIME = 1.5
"""Time to spare before an oncoming vehicle is met, s."""

ONCOMING = -0.5
"""Speed along the way below which a vehicle is oncoming, m/s."""

SWAY = 0.012
"""Greatest error of the front wheels' angle with no awareness at all, rad."""

SWAY_INTERVAL = 0.5
"""Time from one drawn steering error to the next, s; linear between."""

HAND_RATE = 0.6
"""Greatest rate of the front wheels' angle that an aware driver asks for, rad/s."""


@compiled
def awareness(st: State) -> float:
    """Return the driver's awareness, 0 to 1."""
    return clip(AWARENESS_AT_FIRST + AWARENESS_RATE * (st.clock[0] - st.manual_since[0]), 0.0, 1.0)


@compiled
def steering_sway(st: State) -> float:
    """Return the error of the steering, rad: drawn every SWAY_INTERVAL, linear between, less with awareness."""
    place = clip((st.clock[0] - st.manual_since[0]) / SWAY_INTERVAL, 0.0, 1.0e6)
    k = int(place)
    share = place - k
    seed = run_seed(st, -1)
    before = random_unit(seed, op.STREAM_STEERING, st.requests[0], k)
    after = random_unit(seed, op.STREAM_STEERING, st.requests[0], k + 1)
    drawn = 2.0 * (before + share * (after - before)) - 1.0
    return SWAY * (1.0 - awareness(st)) * drawn


@compiled
def steer_by_hand(n: RoadTables, p: Program, st: State, i: int) -> None:
    """Steer for the path with the driver's sway and no faster than the hands turn."""
    wanted = pursuit_angle(n, p, st, i, STEER_ACCELERATION) + steering_sway(st)
    limit = p.const[p.entity_const[i] + slot.E_MAX_STEER]
    before = st.command_steer[i] * limit
    swing = HAND_RATE * awareness(st) * p.const[slot.K_STEP] * p.control_every[0]
    command_angle(p, st, i, before + clip(wanted - before, -swing, swing))


@compiled
def passing_distance(st: State, i: int, size: float) -> float:
    """Return how far the ego, `size` long, goes until it is past what blocks the path and back in its corridor."""
    return st.blocked_far[0] + size + 0.5 * shift_distance(st.v[i], 3.0, EVADE_ACCELERATION)


@compiled
def passing_time(st: State, i: int, distance: float) -> float:
    """Return the time for a distance, speeding up gently from the present speed."""
    v = st.v[i]
    return (safe_sqrt(v * v + 2.0 * PULL_OUT_ACCELERATION * distance) - v) / PULL_OUT_ACCELERATION


@compiled
def meets_oncoming(p: Program, st: State, i: int, centre: float) -> int:
    """Return 1 where a vehicle comes towards the corridor about `centre` and would be met before the ego is past."""
    base = p.entity_const[i]
    size = p.const[base + slot.E_LENGTH]
    front = p.const[base + slot.E_CENTER] + 0.5 * size
    half = 0.5 * p.const[base + slot.E_WIDTH] + CLEARANCE
    distance = passing_distance(st, i, size)
    time = passing_time(st, i, distance) + MEETING_TIME
    for j in range(p.entity_count[0]):
        if j == i or st.seen[j] == 0 or st.on_way[j] == 0 or st.along[j] > ONCOMING or st.far[j] < front:
            continue
        beside = st.low[j] >= centre + half or st.high[j] <= centre - half
        if not beside and max(st.near[j] - front, 0.0) < distance - st.along[j] * time:
            return 1
    return 0


@compiled
def beside_width(n: RoadTables, road: int, lane: int, s: float, side: int) -> float:
    """Return the width of the lane on a side of the path's lane where motor traffic may drive, else 0."""
    beside = neighbour_lane(n, road, lane, s, side, lane_direction(n, road, lane))
    if beside == 0 or is_drivable(lane_type(n, road, beside, s)) == 0:
        return 0.0
    return lane_width(n, road, beside, s)


@compiled
def same_direction(n: RoadTables, road: int, lane: int, s: float, side: int) -> int:
    """Return 1 where the lane on a side goes in the same direction."""
    beside = neighbour_lane(n, road, lane, s, side, lane_direction(n, road, lane))
    return 1 if beside != 0 and lane_direction(n, road, beside) == lane_direction(n, road, lane) else 0


@compiled
def corridor_safe(n: RoadTables, p: Program, st: State, i: int, centre: float, side: int) -> int:
    """Return 1 where the corridor about `centre` is free for as long as the ego needs it.

    Oncoming vehicles are looked at everywhere; a lane of the same direction beside must have a free gap.
    """
    if meets_oncoming(p, st, i, centre) == 1:
        return 0
    if side == 0 or same_direction(n, st.path_road[0], st.path_lane[0], st.path_s[0], side) == 0:
        return 1
    beside = neighbour_lane(
        n, st.path_road[0], st.path_lane[0], st.path_s[0], side, lane_direction(n, st.path_road[0], st.path_lane[0])
    )
    free = gap_is_free(n, p, st, i, st.path_road[0], beside, st.path_s[0])
    look_ahead(n, p, st, i, SIGHT, VIEW)
    return free


@compiled
def find_corridor(n: RoadTables, p: Program, st: State, i: int, blocker: int) -> tuple[int, float]:
    """Return (found, centre) of a corridor past what blocks the path, relative to the path lane's centre.

    First within the own lane, then with the lane beside on the left and on the right. It must be wide enough, near
    enough for a planned evasion before the block, and safe.
    """
    base = p.entity_const[i]
    size = p.const[base + slot.E_LENGTH]
    front = p.const[base + slot.E_CENTER] + 0.5 * size
    need = p.const[base + slot.E_WIDTH] + 2.0 * CLEARANCE
    distance = st.blocked_distance[0]
    road, lane, _, s, _ = path_ahead(n, p, st, distance + front)
    for choice in range(3):
        side = 0 if choice == 0 else 3 - 2 * choice
        left = st.border_left[blocker]
        right = st.border_right[blocker]
        if side != 0:
            wide = beside_width(n, road, lane, s, side)
            if wide <= 0.0:
                continue
            left += wide if side > 0 else 0.0
            right -= wide if side < 0 else 0.0
        found, centre, _ = gap_between(p, st, blocker, front, size, right, left, need, 0.0)
        if found == 0:
            continue
        if shift_distance(st.v[i], centre - st.path_off[0], EVADE_ACCELERATION) > distance - 1.0:
            continue
        if corridor_safe(n, p, st, i, centre, side) == 1:
            return 1, centre
    return 0, 0.0


@compiled
def evade(p: Program, st: State, i: int, centre: float) -> None:
    """Plan the move to a corridor, and how far it is kept."""
    base = p.entity_const[i]
    room = st.blocked_distance[0] - 1.0
    plan_shift(st, i, centre, min(room, shift_distance(st.v[i], centre - st.path_off[0], 1.5)))
    st.evade_until[0] = st.odometer[i] + st.blocked_far[0] + p.const[base + slot.E_LENGTH] + 2.0
    st.evade_commit[0] = 0.5 * (st.shift_begin[0] + st.shift_end[0])
    st.manoeuvre[0] = op.MANOEUVRE_EVADE
    log_event(st, op.EVENT_EVADE, centre)


@compiled
def choose_manoeuvre(n: RoadTables, p: Program, st: State, i: int, blocker: int) -> None:
    """Decide between going on, braking, evading and coming back."""
    before = st.manoeuvre[0]
    if before == op.MANOEUVRE_EVADE:
        if st.odometer[i] >= st.evade_until[0]:
            plan_shift(st, i, 0.0, shift_distance(st.v[i], st.path_off[0], 1.5))
            st.manoeuvre[0] = op.MANOEUVRE_KEEP
            return
        early = st.odometer[i] < st.evade_commit[0] and blocker >= 0
        if early and meets_oncoming(p, st, i, st.shift_to[0]) == 1:
            plan_shift(st, i, 0.0, shift_distance(st.v[i], st.path_off[0], 1.5))
            st.manoeuvre[0] = op.MANOEUVRE_BRAKE
        return
    if blocker < 0:
        st.manoeuvre[0] = op.MANOEUVRE_MERGE if st.merging[0] == 1 else op.MANOEUVRE_KEEP
        return
    found, centre = find_corridor(n, p, st, i, blocker)
    if found == 1:
        evade(p, st, i, centre)
        return
    st.manoeuvre[0] = op.MANOEUVRE_BRAKE
    if before != op.MANOEUVRE_BRAKE:
        log_event(st, op.EVENT_BRAKE, st.blocked_distance[0])


@compiled
def stop_within(p: Program, st: State, i: int, distance: float, standoff: float) -> float:
    """Return the acceleration that stops the ego before something a distance ahead: smoothly while there is time."""
    v = st.v[i]
    smooth = idm_acceleration(p, i, v, max(st.target_speed[0], 1.0), max(distance - standoff, 0.1), 0.0)
    needed = 0.5 * v * v / max(distance - 1.0, 0.1)
    if needed >= LATE_BRAKE:
        smooth = min(smooth, -needed)
    return smooth


@compiled
def press_pedals(p: Program, st: State, i: int) -> None:
    """Follow the leader in the corridor, stop before a block or the lane's end, with limited jerk.

    While evading, oncoming vehicles are not followed: the driver has judged that there is time, and drives on.
    """
    corridor = 0.0
    slowest = -op.FAR
    if st.manoeuvre[0] == op.MANOEUVRE_EVADE:
        corridor = st.shift_to[0]
        slowest = ONCOMING
    gap, lead = leader_gap(p, st, i, corridor, 1, slowest)
    wanted = idm_acceleration(p, i, st.v[i], st.target_speed[0], gap, lead)
    if st.manoeuvre[0] == op.MANOEUVRE_BRAKE and st.blocked_distance[0] < op.FAR:
        wanted = min(wanted, stop_within(p, st, i, st.blocked_distance[0], STANDOFF))
    if st.lane_end_distance[0] < op.FAR and st.merging[0] == 0:
        wanted = min(wanted, stop_within(p, st, i, st.lane_end_distance[0], 0.0))
    if st.red_line[0] < op.FAR:
        base = p.entity_const[i]
        front = p.const[base + slot.E_CENTER] + 0.5 * p.const[base + slot.E_LENGTH]
        wanted = min(wanted, stop_within(p, st, i, st.red_line[0] - front, 0.0))
    step = BRAKE_JERK * p.const[slot.K_STEP] * p.control_every[0]
    wanted = clip(wanted, max(-HARDEST_BRAKE, st.pedal[0] - step), st.pedal[0] + step)
    command_acceleration(p, st, i, come_to_rest(st.v[i], wanted))


@compiled
def drive_by_hand(n: RoadTables, p: Program, st: State, i: int, blocker: int) -> None:
    """Do what the driver does at a control step."""
    choose_manoeuvre(n, p, st, i, blocker)
    press_pedals(p, st, i)
    steer_by_hand(n, p, st, i)
