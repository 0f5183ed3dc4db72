"""The simulated driver who has taken over: keeps the lane, brakes before a blocked path, evades or merges.

The driver acts on something new only after the perception and reaction times (`foresight`). Steering is never perfect:
the lateral position that the driver steers for wanders, at first more than after the driver has settled. Awareness is
0.5 at the response and rises by 0.1 per second, as in SUMO's ToC device; with less awareness the hands turn the
steering wheel more slowly. The jerk of braking is that of the careful and competent driver of UN R157 (annex, table 1).
"""

from __future__ import annotations

from math import cos, pi

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.extent import front_of
from scenario_compiler.engine.columns.log import log_event
from scenario_compiler.engine.columns.numbers import clip, length_of, ratio, safe_sqrt
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.seeds import run_seed
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.bends import DRIVER_BRAKING, DRIVER_LATERAL, acceleration_for_bends
from scenario_compiler.engine.ego.foresight import CALL, LIFT_OFF, ONCOMING, called_for, meets, reacts_to
from scenario_compiler.engine.ego.objects_ahead import row_gap
from scenario_compiler.engine.ego.passing import (
    CLEARANCE,
    GIVE_UP_TIME,
    MEETING_TIME,
    PASSING_SIGHT,
    RETURN_ACCELERATION,
    any_approaching,
    half_with_clearance,
    is_beside,
    is_clear_of,
    is_oncoming,
    meets_oncoming,
)
from scenario_compiler.engine.ego.reach import driver_sight
from scenario_compiler.engine.ego.sensor import (
    CROSSING,
    GAP_HORIZON,
    SLOW,
    gap_behind_free,
    gap_between,
    gap_is_free,
    lane_closes,
    look_ahead,
    obstructs,
)
from scenario_compiler.engine.motion.ahead import measure_on_way, walk
from scenario_compiler.engine.motion.beside import neighbour_lane
from scenario_compiler.engine.motion.following import idm_acceleration
from scenario_compiler.engine.motion.path import path_ahead, preferred_road
from scenario_compiler.engine.motion.steering import (
    SHIFT_PEAK,
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

VIEW = 3.490658503988659
"""Full horizontal angle that a driver sees, rad; chosen: 200 degrees, about the human field of view with both eyes."""

AWARENESS_AT_FIRST = 0.5
AWARENESS_RATE = 0.1
"""Awareness at the response, and its rise per second (SUMO's ToC device: initialAwareness, recoveryRate)."""

BRAKE_JERK = 12.65
"""Jerk of braking, m/s3: 0.774 g in 0.6 s, that of the careful and competent driver of UN R157."""

LATE_BRAKE = 2.5
"""Deceleration needed to stop in time above which a driver gives up smooth braking, m/s2; chosen."""

GAP_BRAKE = 3.5
"""Deceleration needed to stop in time up to which a driver waits for a gap in a neighbouring lane before braking, m/s2;
chosen from what is usually called comfortable.
"""

GAP_ROOM = 2.0
"""Distance before a block at which a driver who has waited for a gap wants to stop, m; chosen, as for the automation.
"""

LEADER_WAIT = 5.0
"""Time that a driver who can stop comfortably waits behind a leader that has stopped, before passing it, s; chosen."""

STANDOFF = 7.0
"""Distance to a block that a stopping driver keeps in addition to the standstill gap, m: room to pull out later;
chosen.
"""

STEER_ACCELERATION = 6.0
"""Greatest lateral acceleration that a driver steers for, m/s2; chosen."""

BOTH_SHARE = 0.5
"""Share of the hardest braking that a driver uses while steering at the same time; chosen."""

EVASION_SHARE = 0.6
"""Greatest share of the distance to a block over which an evasion is spread, unless that would be too sudden; chosen.
"""

WANDER_INTERVAL = 2.0
"""Time from one drawn lateral position to the next, s; a cosine connects them. Chosen."""

SQRT_12 = 3.4641016151377544
"""Width of a uniform distribution divided by its standard deviation."""

WANDER_GAIN = 1.22
"""Standard deviation of the drawn positions divided by that of the resulting lateral position.

Interpolation leaves 0.75 of the variance, and the preview smooths the rest. Measured: see tests/engine/test_driver.py.
"""

CONCENTRATION = 0.3
"""Share of the wandering that remains while the driver evades; chosen."""

HAND_RATE = 0.6
"""Greatest rate of the front wheels' angle that a fully aware driver applies, rad/s; chosen."""


@compiled
def look_with_eyes(n: RoadTables, p: Program, st: State, i: int) -> None:
    """Look ahead as far as the driver can see in the present weather."""
    reach = driver_sight(p, st)
    look_ahead(n, p, st, i, reach, VIEW)


@compiled
def look_far(n: RoadTables, p: Program, st: State, i: int) -> None:
    """Look ahead as far as the driver can see, but at least over PASSING_SIGHT, where oncoming traffic matters."""
    reach = max(PASSING_SIGHT, driver_sight(p, st))
    look_ahead(n, p, st, i, reach, VIEW)


@compiled
def awareness(st: State) -> float:
    """Return the driver's awareness, 0 to 1."""
    return clip(AWARENESS_AT_FIRST + AWARENESS_RATE * (st.clock[0] - st.manual_since[0]), 0.0, 1.0)


@compiled
def drawn_place(st: State, k: int) -> float:
    """Return the k-th drawn lateral position: uniformly distributed, with mean 0 and standard deviation 1."""
    return SQRT_12 * (random_unit(run_seed(st, -1), op.STREAM_WANDER, st.requests[0], k) - 0.5)


@compiled
def draw_places(st: State, k: int) -> None:
    """Keep the k-th drawn lateral position and the next one, between which the driver steers for a while."""
    if st.wander_at[0] == k and st.wander_request[0] == st.requests[0]:
        return
    st.wander_at[0] = k
    st.wander_request[0] = st.requests[0]
    st.wander_from[0] = drawn_place(st, k)
    st.wander_to[0] = drawn_place(st, k + 1)


@compiled
def wandering(p: Program, st: State) -> float:
    """Return how far to the left of the intended position the driver steers now, m."""
    driven = max(st.clock[0] - st.manual_since[0], 0.0)
    place = min(driven / WANDER_INTERVAL, 1.0e6)
    k = int(place)
    share = 0.5 * (1.0 - cos(pi * (place - k)))
    draw_places(st, k)
    before = st.wander_from[0]
    unsettled = clip(1.0 - ratio(driven, p.const[slot.K_SETTLED_AFTER], 1.0), 0.0, 1.0)
    settled = p.const[slot.K_SDLP]
    spread = settled + unsettled * (p.const[slot.K_SDLP_AT_FIRST] - settled)
    if st.manoeuvre[0] == op.MANOEUVRE_EVADE:
        spread = spread * CONCENTRATION
    return WANDER_GAIN * spread * (before + share * (st.wander_to[0] - before))


@compiled
def will_be_beside(p: Program, st: State, i: int, j: int) -> int:
    """Return 1 if an entity on the path is beside the ego now or within WANDER_INTERVAL at the present speeds."""
    front = front_of(p, i)
    rear = front - p.const[p.entity_const[i] + slot.E_LENGTH]
    if j == i or st.on_way[j] == 0 or st.far[j] < rear:
        return 0
    return 1 if st.near[j] - front <= max(st.v[i] - st.along[j], 0.0) * WANDER_INTERVAL else 0


@compiled
def kept_clear(p: Program, st: State, i: int, aside: float) -> float:
    """Return a place aside of the path's middle, m to the left, moved away from everything that stands or drives there.

    Between objects on both sides that leave less than the clearance, the driver steers for their middle.
    """
    half = half_with_clearance(p, i)
    least = -op.FAR
    greatest = op.FAR
    for j in range(p.entity_count[0]):
        if will_be_beside(p, st, i, j) == 0:
            continue
        if st.high[j] <= 0.0:
            least = max(least, st.high[j] + half)
        elif st.low[j] >= 0.0:
            greatest = min(greatest, st.low[j] - half)
    return clip(aside, least, greatest) if least <= greatest else 0.5 * (least + greatest)


@compiled
def steer_by_hand(n: RoadTables, p: Program, st: State, i: int) -> None:
    """Steer for the path plus the driver's wandering, no faster than the hands turn.

    An evasion is planned with a clearance. In the lane, the wandering keeps it from what is beside the car.
    """
    st.aside[0] = wandering(p, st)
    if st.manoeuvre[0] != op.MANOEUVRE_EVADE:
        st.aside[0] = kept_clear(p, st, i, st.aside[0])
    wanted = pursuit_angle(n, p, st, i, STEER_ACCELERATION)
    st.aside[0] = 0.0
    limit = p.const[p.entity_const[i] + slot.E_MAX_STEER]
    before = st.command_steer[i] * limit
    swing = HAND_RATE * awareness(st) * p.const[slot.K_STEP] * p.control_every[0]
    command_angle(p, st, i, before + clip(wanted - before, -swing, swing))


@compiled
def beside_width(n: RoadTables, road: int, lane: int, s: float, side: int) -> float:
    """Return the width of the neighbouring lane on a side (1 left, -1 right), m; 0 if motor traffic may not use it."""
    beside = neighbour_lane(n, road, lane, s, side, lane_direction(n, road, lane, s))
    if beside == 0 or is_drivable(lane_type(n, road, beside, s)) == 0:
        return 0.0
    return lane_width(n, road, beside, s)


@compiled
def same_direction(n: RoadTables, road: int, lane: int, s: float, side: int) -> int:
    """Return 1 if the neighbouring lane on a side has the same direction of travel."""
    beside = neighbour_lane(n, road, lane, s, side, lane_direction(n, road, lane, s))
    return 1 if beside != 0 and lane_direction(n, road, beside, s) == lane_direction(n, road, lane, s) else 0


@compiled
def gap_beside_free(n: RoadTables, p: Program, st: State, i: int, side: int) -> int:
    """Return 1 if the neighbouring lane on a side, of the same direction, has a free gap.

    If that lane carries traffic, the gap counts only after the driver has watched it for the time `K_LOOK_BESIDE`. The
    measurements of the path ahead are made again afterwards.
    """
    beside = neighbour_lane(n, st.path_road[0], st.path_lane[0], st.path_s[0], side, st.path_sense[0])
    free = gap_is_free(n, p, st, i, st.path_road[0], beside, st.path_s[0])
    look_far(n, p, st, i)
    if st.used_beside[0] == 0:
        return free
    if st.looks_beside[0] < 0.0:
        st.looks_beside[0] = st.clock[0]
    looked = st.clock[0] - st.looks_beside[0]
    return free if looked >= p.const[slot.K_LOOK_BESIDE] - op.TOLERANCE else 0


@compiled
def way_until(st: State, i: int, j: int, gap: float) -> float:
    """Return the distance that the ego drives at its present speed until it meets j, which is `gap` metres ahead, m."""
    towards = -st.along[j] if is_oncoming(st, i, j) == 1 else 0.0
    return gap * ratio(st.v[i], st.v[i] + towards, 1.0)


@compiled
def room_to_move(p: Program, st: State, i: int, blocker: int, centre: float) -> float:
    """Return the distance in which the ego must have moved over to a corridor past a block, m.

    It ends 1 m before the ego meets the first obstacle outside the corridor: the block, or an object less than a
    `row_gap` before it.
    """
    front = front_of(p, i)
    half = 0.5 * p.const[p.entity_const[i] + slot.E_WIDTH]
    begin = st.near[blocker] - row_gap(st, i)
    room = way_until(st, i, blocker, st.blocked_distance[0])
    for j in range(p.entity_count[0]):
        aside = is_beside(st.low[j], st.high[j], centre, st.path_off[0], half)
        if aside == 0 and obstructs(st, j, front) == 1 and st.far[j] >= begin:
            room = min(room, way_until(st, i, j, max(st.near[j] - front, 0.0)))
    return room - 1.0


@compiled
def evasion_over(p: Program, st: State, i: int, blocker: int, centre: float) -> float:
    """Return the distance over which the move to a corridor past a block is spread, m.

    The move ends well before the block. With little time it is faster, up to the driver's greatest lateral
    acceleration.
    """
    change = centre - st.path_off[0]
    room = room_to_move(p, st, i, blocker, centre)
    gentle = min(shift_distance(st.v[i], change, RETURN_ACCELERATION), EVASION_SHARE * room)
    return min(max(gentle, shift_distance(st.v[i], change, p.const[slot.K_DRIVER_LATERAL])), room)


@compiled
def meets_standing(p: Program, st: State, i: int, centre: float, out: float, begin: float) -> int:
    """Return 1 if a move to `centre` over the distance `out` hits an obstacle that ends nearer than `begin`, m."""
    front = front_of(p, i)
    base = p.entity_const[i]
    half = 0.5 * p.const[base + slot.E_WIDTH]
    for j in range(p.entity_count[0]):
        if obstructs(st, j, front) == 0 or st.far[j] >= begin:
            continue
        enters = clip(ratio(st.near[j] - front, out, 1.0), 0.0, 1.0)
        leaves = clip(ratio(st.far[j] - front + p.const[base + slot.E_LENGTH], out, 1.0), 0.0, 1.0)
        change = centre - st.path_off[0]
        first = st.path_off[0] + change * 0.5 * (1.0 - cos(pi * enters))
        last = st.path_off[0] + change * 0.5 * (1.0 - cos(pi * leaves))
        if is_beside(st.low[j], st.high[j], first, last, half) == 0:
            return 1
    return 0


@compiled
def evasion_length(p: Program, st: State, i: int) -> float:
    """Return the distance after which the block is behind the ego, m."""
    return st.blocked_far[0] + p.const[p.entity_const[i] + slot.E_LENGTH] + 2.0


@compiled
def lane_beside_begins(n: RoadTables, p: Program, st: State, side: int, against: int, out: float) -> int:
    """Return 1 if the neighbouring lane of a corridor is there already where the ego moves into it.

    It is looked for halfway and at the end of the move, `out` m ahead. Beside the block there may be a lane that begins
    behind a junction, where the ego would still drive on the pavement.
    """
    for k in range(2):
        road, lane, _, s, _ = path_ahead(n, p, st, 0.5 * (k + 1.0) * out)
        if beside_width(n, road, lane, s, side) <= 0.0 or same_direction(n, road, lane, s, side) == against:
            return 0
    return 1


@compiled
def corridor_beside(
    n: RoadTables, p: Program, st: State, i: int, blocker: int, road: int, lane: int, s: float, side: int, against: int
) -> tuple[int, float]:
    """Return (found, centre) of a corridor past the block that uses the neighbouring lane on a side.

    `side` is 0 for the ego's own lane alone. `against` is 1 if neighbouring lanes of oncoming traffic are looked for, 0
    for those of the same direction. `centre` is the offset from the path lane's centre, m, positive to the left: as
    little as is needed past something that stands, and the middle of the neighbouring lane past an oncoming vehicle.
    """
    base = p.entity_const[i]
    front = front_of(p, i)
    need = p.const[base + slot.E_WIDTH] + 2.0 * CLEARANCE
    left = st.border_left[blocker]
    right = st.border_right[blocker]
    low = 0.0
    high = 0.0
    if side != 0:
        wide = beside_width(n, road, lane, s, side)
        if wide <= 0.0 or same_direction(n, road, lane, s, side) == against:
            return 0, 0.0
        if against == 1:
            st.awaits_oncoming[0] = any_approaching(p, st, i)
        low = left if side > 0 else right - wide
        high = low + wide
        left = max(left, high)
        right = min(right, low)
    begin = st.near[blocker] - row_gap(st, i)
    end = front + st.blocked_far[0] + row_gap(st, i)
    wish = 0.5 * (low + high) if is_oncoming(st, i, blocker) == 1 else 0.0
    found, centre, _ = gap_between(p, st, begin, end, front, right, left, need, wish)
    if found == 0:
        return 0, 0.0
    fastest = shift_distance(st.v[i], centre - st.path_off[0], p.const[slot.K_DRIVER_LATERAL])
    if fastest > room_to_move(p, st, i, blocker, centre):
        return 0, 0.0
    if against == 0:
        high = low
    out = evasion_over(p, st, i, blocker, centre)
    if side != 0 and lane_beside_begins(n, p, st, side, against, out) == 0:
        return 0, 0.0
    if meets_standing(p, st, i, centre, out, begin) == 1:
        return 0, 0.0
    if meets_oncoming(p, st, i, centre, out, evasion_length(p, st, i), op.NONE, 0.0, MEETING_TIME, 0, low, high) == 1:
        st.awaits_oncoming[0] = any_approaching(p, st, i)
        return 0, 0.0
    if side != 0 and against == 0 and gap_beside_free(n, p, st, i, side) == 0:
        st.seeks_gap[0] = 1
        return 0, 0.0
    return 1, centre


@compiled
def find_corridor(n: RoadTables, p: Program, st: State, i: int, blocker: int) -> tuple[int, float]:
    """Return (found, centre) of a corridor past what blocks the path; the centre is an offset from the path lane's, m.

    The own lane is tried first, then the lanes of the same direction on the left and right, then those of oncoming
    traffic. A corridor must be wide enough, safe, and reachable by an evasion that ends before the block.
    """
    look_far(n, p, st, i)
    front = front_of(p, i)
    road, lane, _, s, _ = path_ahead(n, p, st, st.blocked_distance[0] + front)
    found = 0
    centre = 0.0
    for choice in range(5):
        if found == 0:
            side = 0 if choice == 0 else 3 - 2 * ((choice - 1) % 2 + 1)
            against = 1 if choice >= 3 else 0
            found, centre = corridor_beside(n, p, st, i, blocker, road, lane, s, side, against)
    look_with_eyes(n, p, st, i)
    return found, centre


@compiled
def evade(p: Program, st: State, i: int, blocker: int, centre: float) -> None:
    """Plan the move to a corridor past a block, and how long the ego stays in it."""
    plan_shift(st, i, centre, evasion_over(p, st, i, blocker, centre))
    st.evade_until[0] = st.odometer[i] + evasion_length(p, st, i)
    st.evade_commit[0] = 0.5 * (st.shift_begin[0] + st.shift_end[0])
    st.manoeuvre[0] = op.MANOEUVRE_EVADE
    st.looks_beside[0] = -1.0
    log_event(st, op.EVENT_EVADE, centre)


@compiled
def come_back(st: State, i: int, manoeuvre: int) -> None:
    """Plan the move back to the lane's centre."""
    plan_shift(st, i, 0.0, shift_distance(st.v[i], st.path_off[0], RETURN_ACCELERATION))
    st.evaded[0] = op.NONE
    st.manoeuvre[0] = manoeuvre


@compiled
def is_past(p: Program, st: State, i: int, j: int) -> int:
    """Return 1 if the ego may come back: the vehicle j has left the path, or the ego is clear of all vehicles."""
    if st.on_way[j] == 0:
        return 1
    if is_clear_of(p, st, i, j, st.v[i], 0.0) == 0:
        return 0
    over = shift_time(p, st, 0.0)
    return 1 if meets(p, st, i, 0.0, over, 0.0, BRAKE_JERK) >= op.FAR else 0


@compiled
def way_back_free(p: Program, st: State, i: int) -> int:
    """Return 1 if the move back to the lane's centre passes everything that stands at the driver's clearance."""
    base = p.entity_const[i]
    front = front_of(p, i)
    rear = front - p.const[base + slot.E_LENGTH]
    half = half_with_clearance(p, i)
    off = st.path_off[0]
    end = front + shift_distance(st.v[i], off, RETURN_ACCELERATION)
    for j in range(p.entity_count[0]):
        if j == i or st.on_way[j] == 0 or abs(st.along[j]) >= SLOW or st.near[j] > end or st.far[j] < rear:
            continue
        if is_beside(st.low[j], st.high[j], off, 0.0, half) == 0:
            return 0
    return 1


@compiled
def shift_time(p: Program, st: State, target: float) -> float:
    """Return the time of a move to an offset at the driver's greatest lateral acceleration, s."""
    return safe_sqrt(SHIFT_PEAK * abs(target - st.path_off[0]) / max(p.const[slot.K_DRIVER_LATERAL], 0.5))


@compiled
def moving_threat(p: Program, st: State, i: int) -> int:
    """Return the nearest moving entity that requires braking and that the driver reacts to, or NONE."""
    found = op.NONE
    for j in range(p.entity_count[0]):
        if st.along[j] < SLOW or reacts_to(p, st, j) == 0 or called_for(p, st, i, j, 0.0, SLOW) >= -CALL:
            continue
        if found < 0 or st.near[j] < st.near[found]:
            found = j
    return found


@compiled
def free_behind(n: RoadTables, p: Program, st: State, i: int, lane: int) -> int:
    """Return 1 if nobody in a neighbouring lane approaches too fast from behind; measures the path ahead again."""
    road = st.path_road[0]
    walk(n, st, road, lane, st.path_s[0], -1, GAP_HORIZON, preferred_road(p, st, road))
    for j in range(p.entity_count[0]):
        st.on_way[j] = 0
        if j != i and length_of(st.x[j] - st.x[i], st.y[j] - st.y[i]) < GAP_HORIZON:
            measure_on_way(n, p, st, j)
    free = gap_behind_free(p, st, i)
    look_with_eyes(n, p, st, i)
    return free


@compiled
def clear_offset(
    p: Program, st: State, i: int, threat: int, whole: float, low: float, high: float
) -> tuple[int, float, int]:
    """Return (found, offset, braking) of a move towards a neighbouring lane, `whole` metres away, that meets nothing.

    Oncoming traffic must not be met either, until the ego has passed `threat` and is back; less time to it suffices if
    `threat` comes towards the ego. The lane between the offsets `low` and `high` carries oncoming traffic. Half the
    distance is tried before the whole, and steering alone before steering with braking.
    """
    braking = BOTH_SHARE * p.const[slot.K_DRIVER_DECELERATION]
    spare = GIVE_UP_TIME if is_oncoming(st, i, threat) == 1 else MEETING_TIME
    for choice in range(4):
        target = whole if choice % 2 == 1 else 0.5 * whole
        both = 1 if choice >= 2 else 0
        if both == 0 and st.style[0] == op.STYLE_BOTH:
            continue
        if meets(p, st, i, target, shift_time(p, st, target), both * braking, BRAKE_JERK) < op.FAR:
            continue
        out = shift_distance(st.v[i], target - st.path_off[0], p.const[slot.K_DRIVER_LATERAL])
        if meets_oncoming(p, st, i, target, out, out, threat, both * braking, spare, 0, low, high) == 0:
            return 1, target, both
    return 0, 0.0, 0


@compiled
def way_out(n: RoadTables, p: Program, st: State, i: int, threat: int) -> tuple[int, float, int]:
    """Return (found, offset, braking) of an evasion of what braking alone in the own lane would hit, `threat` first."""
    if meets(p, st, i, 0.0, 1.0, p.const[slot.K_DRIVER_DECELERATION], BRAKE_JERK) >= op.FAR:
        return 0, 0.0, 0
    road = st.path_road[0]
    lane = st.path_lane[0]
    s = st.path_s[0]
    direction = st.path_sense[0]
    for side in range(1, -2, -2):
        wide = beside_width(n, road, lane, s, side)
        if wide <= 0.0:
            continue
        own = lane_width(n, road, lane, s)
        low = 0.5 * own if side > 0 else -0.5 * own - wide
        high = low
        beside = neighbour_lane(n, road, lane, s, side, direction)
        if lane_direction(n, road, beside, s) != direction:
            high = low + wide
        look_far(n, p, st, i)
        found, target, braking = clear_offset(p, st, i, threat, 0.5 * side * (own + wide), low, high)
        look_with_eyes(n, p, st, i)
        if found == 0:
            continue
        if high <= low and free_behind(n, p, st, i, beside) == 0:
            continue
        return 1, target, braking
    return 0, 0.0, 0


@compiled
def evade_moving(p: Program, st: State, i: int, j: int, target: float) -> None:
    """Plan the move to the neighbouring lane, around the moving entity j."""
    plan_shift(st, i, target, shift_distance(st.v[i], target - st.path_off[0], p.const[slot.K_DRIVER_LATERAL]))
    st.evaded[0] = j
    st.evade_commit[0] = 0.5 * (st.shift_begin[0] + st.shift_end[0])
    st.manoeuvre[0] = op.MANOEUVRE_EVADE
    log_event(st, op.EVENT_EVADE, target)


@compiled
def swerves(n: RoadTables, p: Program, st: State, i: int, threat: int) -> int:
    """Evade `threat`, which moves, if the driver steers and there is a way out; return 1 if the driver does."""
    if st.style[0] == op.STYLE_BRAKES or st.merging[0] == 1:
        return 0
    found, target, braking = way_out(n, p, st, i, threat)
    if found == 0:
        return 0
    if braking == 1:
        st.style[0] = op.STYLE_BOTH
    evade_moving(p, st, i, threat, target)
    return 1


@compiled
def evades_block(n: RoadTables, p: Program, st: State, i: int, blocker: int) -> int:
    """Evade what blocks the path, if the driver steers and there is a way; return 1 if the driver does.

    Nobody steers around what crosses the path.
    """
    if st.style[0] == op.STYLE_BRAKES or abs(st.across[blocker]) >= CROSSING:
        return 0
    found, centre = find_corridor(n, p, st, i, blocker)
    if found == 1:
        evade(p, st, i, blocker, centre)
        return 1
    return swerves(n, p, st, i, blocker) if is_oncoming(st, i, blocker) == 1 else 0


@compiled
def go_on_evading(n: RoadTables, p: Program, st: State, i: int, blocker: int) -> None:
    """Come back once the obstacle is past and the way back is free, or early if an oncoming vehicle would be met.

    The driver does not come back early into the way of an oncoming vehicle that is evaded, but looks for another way.
    """
    out = max(st.shift_end[0] - st.odometer[i], 0.1)
    early = st.odometer[i] < st.evade_commit[0]
    if st.evaded[0] >= 0:
        if is_past(p, st, i, st.evaded[0]) == 1:
            come_back(st, i, op.MANOEUVRE_KEEP)
        elif (
            early
            and is_oncoming(st, i, st.evaded[0]) == 0
            and meets_oncoming(p, st, i, st.shift_to[0], out, out, st.evaded[0], 0.0, GIVE_UP_TIME, 1, 0.0, 0.0) == 1
        ):
            come_back(st, i, op.MANOEUVRE_BRAKE)
        return
    rest = st.evade_until[0] - st.odometer[i]
    if rest <= 0.0:
        if way_back_free(p, st, i) == 1:
            come_back(st, i, op.MANOEUVRE_KEEP)
    elif (
        early
        and blocker >= 0
        and meets_oncoming(p, st, i, st.shift_to[0], out, rest, op.NONE, 0.0, GIVE_UP_TIME, 1, 0.0, 0.0) == 1
    ):
        if is_oncoming(st, i, blocker) == 0:
            come_back(st, i, op.MANOEUVRE_BRAKE)
        else:
            evades_block(n, p, st, i, blocker)


@compiled
def begin_braking(st: State, distance: float) -> None:
    """Switch to the manoeuvre "brake", and log it if it is new."""
    if st.manoeuvre[0] != op.MANOEUVRE_BRAKE:
        log_event(st, op.EVENT_BRAKE, distance)
    st.manoeuvre[0] = op.MANOEUVRE_BRAKE


@compiled
def waits_for_gap(st: State) -> int:
    """Return 1 if only other vehicles, oncoming or in the neighbouring lane, prevent an evasion."""
    return 1 if st.seeks_gap[0] == 1 or st.awaits_oncoming[0] == 1 else 0


@compiled
def waits_behind(st: State, i: int, blocker: int) -> int:
    """Return 1 if what blocks the path was followed until just now, and the ego can stop behind it comfortably.

    Such a leader is followed to its standstill like any other.
    """
    needed = 0.5 * st.v[i] * st.v[i] / max(st.blocked_distance[0] - GAP_ROOM, 0.1)
    return 1 if st.clock[0] - st.led_at[blocker] < LEADER_WAIT and needed <= GAP_BRAKE else 0


@compiled
def choose_manoeuvre(n: RoadTables, p: Program, st: State, i: int, blocker: int) -> None:
    """Decide whether to go on, brake, evade or come back."""
    st.seeks_gap[0] = 0
    st.awaits_oncoming[0] = 0
    if st.manoeuvre[0] == op.MANOEUVRE_EVADE:
        go_on_evading(n, p, st, i, blocker)
        return
    if blocker >= 0 and waits_behind(st, i, blocker) == 1:
        st.manoeuvre[0] = op.MANOEUVRE_KEEP
        return
    if blocker >= 0 and reacts_to(p, st, blocker) == 1:
        if evades_block(n, p, st, i, blocker) == 0:
            begin_braking(st, st.blocked_distance[0])
        return
    st.looks_beside[0] = -1.0
    threat = moving_threat(p, st, i)
    if threat >= 0:
        if swerves(n, p, st, i, threat) == 1:
            return
        front = front_of(p, i)
        begin_braking(st, st.near[threat] - front)
        return
    st.manoeuvre[0] = op.MANOEUVRE_MERGE if st.merging[0] == 1 else op.MANOEUVRE_KEEP


@compiled
def stop_within(p: Program, st: State, i: int, distance: float, standoff: float) -> float:
    """Return the acceleration that stops the ego before something `distance` ahead, smoothly if possible, m/s2."""
    v = st.v[i]
    smooth = idm_acceleration(p, i, v, max(st.target_speed[0], 1.0), max(distance - standoff, 0.1), 0.0)
    needed = 0.5 * v * v / max(distance - 1.0, 0.1)
    if needed >= LATE_BRAKE:
        smooth = min(smooth, -needed)
    return smooth


@compiled
def stop_before_block(p: Program, st: State, i: int) -> float:
    """Return the acceleration that stops the ego before what blocks its path, m/s2.

    A driver who looks for a gap in a neighbouring lane only lifts off the accelerator until harder braking is needed.
    """
    room = st.blocked_distance[0] - GAP_ROOM
    if st.seeks_gap[0] == 0 or room < 0.1:
        return stop_within(p, st, i, st.blocked_distance[0], STANDOFF)
    needed = 0.5 * st.v[i] * st.v[i] / max(room, 0.1)
    brakes = needed >= GAP_BRAKE or (st.pedal[0] < -CALL and needed >= 0.5 * GAP_BRAKE)
    return -needed if brakes else -LIFT_OFF


@compiled
def follow_all(p: Program, st: State, i: int, corridor: float, slowest: float) -> float:
    """Return the acceleration that everything ahead in a corridor allows, m/s2.

    The driver does not yet brake for something new, but only lifts off the accelerator.
    """
    wanted = idm_acceleration(p, i, st.v[i], st.target_speed[0], op.FAR, 0.0)
    front = front_of(p, i)
    for j in range(p.entity_count[0]):
        called = called_for(p, st, i, j, corridor, slowest)
        if called >= op.FAR or (st.seeks_gap[0] == 1 and st.ahead_is[j] == op.AHEAD_BLOCKING):
            continue
        closing = max(st.v[i] - st.along[j], 0.0)
        needed = 0.5 * closing * closing / max(st.near[j] - front - 1.0, 0.1)
        if needed >= LATE_BRAKE:
            called = min(called, -needed)
        if called < -CALL and reacts_to(p, st, j) == 0:
            called = -LIFT_OFF
        wanted = min(wanted, called)
    return wanted


@compiled
def press_pedals(n: RoadTables, p: Program, st: State, i: int) -> None:
    """Follow the leader in the corridor, slow down for bends, and stop before a block, a red signal or the lane's end.

    The jerk is limited.

    While evading, the driver does not slow down for oncoming vehicles: the evasion was only begun because there is
    time. The jerk begins at the acceleration that the automation leaves, as far as the driver wants it: a brake of the
    automation that the driver does not want ends with the response, and is no braking of the driver.
    """
    hardest = p.const[slot.K_DRIVER_DECELERATION]
    corridor = 0.0
    slowest = -op.FAR
    if st.manoeuvre[0] == op.MANOEUVRE_EVADE:
        corridor = st.shift_to[0]
        slowest = ONCOMING
    wanted = follow_all(p, st, i, corridor, slowest)
    if st.manoeuvre[0] == op.MANOEUVRE_EVADE and st.style[0] == op.STYLE_BOTH and st.odometer[i] < st.shift_end[0]:
        wanted = min(wanted, -BOTH_SHARE * hardest)
    if st.manoeuvre[0] == op.MANOEUVRE_BRAKE and st.blocked_distance[0] < op.FAR:
        wanted = min(wanted, stop_before_block(p, st, i))
    if lane_closes(st) < op.FAR and st.merging[0] == 0:
        wanted = min(wanted, stop_within(p, st, i, lane_closes(st), 0.0))
    if st.red_line[0] < op.FAR:
        front = front_of(p, i)
        wanted = min(wanted, stop_within(p, st, i, st.red_line[0] - front, 0.0))
    in_bends = acceleration_for_bends(n, p, st, i, DRIVER_LATERAL, DRIVER_BRAKING)
    wanted = min(wanted, in_bends)
    step = BRAKE_JERK * p.const[slot.K_STEP] * p.control_every[0]
    wanted = come_to_rest(st.v[i], wanted)
    before = st.pedal[0]
    if st.clock[0] <= st.manual_since[0]:
        before = clip(wanted, min(before, 0.0), max(before, 0.0))
    wanted = clip(wanted, max(-hardest, before - step), before + step)
    command_acceleration(p, st, i, wanted)


@compiled
def drive_by_hand(n: RoadTables, p: Program, st: State, i: int, blocker: int) -> None:
    """Drive the ego for one control step as the simulated driver."""
    choose_manoeuvre(n, p, st, i, blocker)
    press_pedals(n, p, st, i)
    steer_by_hand(n, p, st, i)
