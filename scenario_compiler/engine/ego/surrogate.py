"""Surrogate perception: estimates the output of camera and lane detector from what the engine knows.

A network with one hidden layer takes the features of one side (`view`) and returns two numbers: the logit of the
detector's confidence in that boundary, and how far that side shifts the followed path from the lane's centre. The error
that remains belongs to the location and not to the run, because a camera that drives the same road twice sees the same.
It is therefore modelled as noise that depends only on the road, the lane, the side and the position along the road, and
is linear between cells.

The coefficients stand in the program's numbers from `surrogate_const` on, in this order:

    VIEW_SIZE           least value of each feature in the runs of the fit
    VIEW_SIZE           greatest value; features are clipped to this range, and a value outside of it is counted
    VIEW_SIZE + 1 rows  weights of each feature, and last the bias, for the HIDDEN units and the two outputs
    HIDDEN rows         weights of each unit (x / (1 + |x|)) for the two outputs
    4                   size and cell length, m, of the logit's noise; the same for the path, m

The automation then drives as the controller `lane_detection` does, along the path that the surrogate reports.
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.log import log_event
from scenario_compiler.engine.columns.numbers import clip, logistic, safe_sqrt
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.columns.view import (
    HIDDEN,
    OUTPUTS,
    S_BESIDE,
    S_BROKEN,
    S_COVERED,
    S_VOTES,
    SIDE_SIZE,
    UNITS,
    V_BOTH,
    V_CONTRAST,
    V_SPEED,
    VIEW_SIZE,
)
from scenario_compiler.engine.ego.bends import speed_for_bends
from scenario_compiler.engine.ego.failures import health_of_camera
from scenario_compiler.engine.ego.objects_ahead import gap_to_keep
from scenario_compiler.engine.ego.view import keep_view, look_at_view, view_stays
from scenario_compiler.engine.motion.steering import aim, path_point
from scenario_compiler.marker import compiled
from scenario_compiler.randomness import random_hash
from scenario_compiler.roads.tables import RoadTables
from scenario_compiler.vocabulary.lane_keeping import TRUSTED

FIRST_AT = 2 * VIEW_SIZE
SECOND_AT = FIRST_AT + (VIEW_SIZE + 1) * UNITS
NOISE_AT = SECOND_AT + HIDDEN * OUTPUTS
"""Positions of the coefficients, from `surrogate_const` on."""

N_CONFIDENCE = 0
N_CONFIDENCE_CELL = 1
N_PATH = 2
N_PATH_CELL = 3

COEFFICIENTS = NOISE_AT + 4
"""Number of coefficients of surrogate perception."""

TOO_SMALL = 0.004
"""Change of a feature that is not worth taking up, as a share of its domain."""

PATH_SIDE = 2
"""Random stream of the path's noise; those of the left and right boundary are 0 and 1."""

FARTHEST_OFF = 3.0
"""Greatest distance between the lane's centre and the followed path, m."""

BRAKE_SHARE = 0.25
"""Brake command per unit of negative throttle, as in `lane_detection`."""

BYTES_MEAN = 510.0
BYTES_DEVIATION = 147.8
"""Mean and standard deviation of the sum of four uniformly distributed bytes."""

BY_HAND_EVERY = 5
BEFORE_HAND_BACK = 4.0
"""While the driver drives, only every fifth image is looked at, until so long before the driver may hand back, s."""

NO_BOUND = 1000.0
"""Lateral acceleration that no vehicle reaches, m/s2: `lane_detection` steers without a bound."""


@compiled
def draw_at(road: int, lane: int, side: int, cell: int) -> float:
    """Return the random number of a cell: approximately normal, from the sum of four bytes of a hash."""
    bits = random_hash(road, op.STREAM_SURROGATE + 16 * side, lane & 0xFFFF, cell)
    total = (bits & 255) + ((bits >> 8) & 255) + ((bits >> 16) & 255) + ((bits >> 24) & 255)
    return (total - BYTES_MEAN) / BYTES_DEVIATION


@compiled
def draw_cell(st: State, road: int, lane: int, side: int, number: int) -> None:
    """Draw the random numbers of a cell's beginning and end, unless they are known, also from a neighbouring cell."""
    apart = number - st.noise_cell[side]
    if st.noise_road[side] != road or st.noise_lane[side] != lane or apart * apart > 1:
        st.noise_here[side] = draw_at(road, lane, side, number)
        st.noise_there[side] = draw_at(road, lane, side, number + 1)
    elif apart == 1:
        st.noise_here[side] = st.noise_there[side]
        st.noise_there[side] = draw_at(road, lane, side, number + 1)
    elif apart == -1:
        st.noise_there[side] = st.noise_here[side]
        st.noise_here[side] = draw_at(road, lane, side, number)
    st.noise_road[side] = road
    st.noise_lane[side] = lane
    st.noise_cell[side] = number


@compiled
def noise_at(st: State, road: int, lane: int, side: int, s: float, cell: float) -> float:
    """Return the noise at s, with mean 0 and standard deviation 1, linear between cells of length `cell`, m."""
    place = s / max(cell, 0.1)
    number = int(clip(place, 0.0, 1.0e9))
    share = clip(place - number, 0.0, 1.0)
    draw_cell(st, road, lane, side, number)
    whole = safe_sqrt(share * share + (1.0 - share) * (1.0 - share))
    return ((1.0 - share) * st.noise_here[side] + share * st.noise_there[side]) / max(whole, 0.5)


@compiled
def note_differing(st: State, begin: int, end: int, count: int) -> int:
    """Append to `changed` the features from `begin` to `end` that differ from those taken up; return its new length."""
    for k in range(begin, end):
        st.changed[count] = k  # overwritten by the next feature unless this one differs
        count += 1 if st.view[k] != st.taken_up[k] else 0
    return count


@compiled
def find_differing(st: State) -> int:
    """Write to `changed`, in their order, the features that may have to be taken up, and return their number.

    Those that are known not to have been written since the last time are left out.
    """
    lasting = st.lasting_anew[0]
    count = 0
    for side in range(2):
        base = SIDE_SIZE * side
        sums = st.side_anew[side]
        count = note_differing(
            st, base if sums == 1 else base + S_BESIDE, base + (S_BROKEN if sums == 1 else S_VOTES), count
        )
        count = note_differing(st, base + (S_BROKEN if lasting == 1 else S_COVERED), base + SIDE_SIZE, count)
    count = note_differing(st, V_BOTH, V_SPEED if lasting == 1 else V_CONTRAST, count)
    return note_differing(st, V_SPEED, VIEW_SIZE, count)


@compiled
def take_up(p: Program, st: State) -> int:
    """Bring `unit` up to date with the view, held within the domain; return 1 where a feature was outside.

    Only features that have changed since they were last taken up cost anything, and small changes wait until they have
    added up: most features stay nearly as they are from look to look. While one is outside, all are looked at.
    """
    low = p.surrogate_const[0]
    outside = 0
    count = 0
    for place in range(find_differing(st)):
        k = st.changed[place]
        value = st.view[k]
        least = p.const[low + k]
        most = p.const[low + VIEW_SIZE + k]
        if value < least or value > most:
            value = clip(value, least, most)
            outside = 1
        change = value - st.taken_up[k]
        if abs(change) > TOO_SMALL * (most - least):
            st.taken_up[k] = value
            st.changed[count] = k
            st.change[count] = change
            count += 1
    st.side_anew[0] = outside
    st.side_anew[1] = outside
    st.lasting_anew[0] = outside
    first = 0
    while first + 4 <= count:
        add_four(p, st, first)
        first = first + 4
    while first < count:
        add_one(p, st, first)
        first = first + 1
    return outside


@compiled
def mirrored(feature: int) -> int:
    """Return the feature that the network takes on the right side in the place of a feature of the left side."""
    if feature < SIDE_SIZE:
        return feature + SIDE_SIZE
    return feature - SIDE_SIZE if feature < V_BOTH else feature


@compiled
def add_one(p: Program, st: State, at: int) -> None:
    """Add a changed feature to all units."""
    weights = p.surrogate_const[0] + FIRST_AT
    left = weights + UNITS * st.changed[at]
    right = weights + UNITS * mirrored(st.changed[at])
    change = st.change[at]
    for unit in range(UNITS):
        st.unit[unit] += p.const[left + unit] * change
        st.unit[UNITS + unit] += p.const[right + unit] * change


@compiled
def add_four(p: Program, st: State, at: int) -> None:
    """Add four changed features to all units, one after the other: a unit is read and written once."""
    weights = p.surrogate_const[0] + FIRST_AT
    a = st.change[at]
    b = st.change[at + 1]
    c = st.change[at + 2]
    d = st.change[at + 3]
    for side in range(2):
        first = st.changed[at]
        second = st.changed[at + 1]
        third = st.changed[at + 2]
        fourth = st.changed[at + 3]
        if side == 1:
            first = mirrored(first)
            second = mirrored(second)
            third = mirrored(third)
            fourth = mirrored(fourth)
        of_a = weights + UNITS * first
        of_b = weights + UNITS * second
        of_c = weights + UNITS * third
        of_d = weights + UNITS * fourth
        base = UNITS * side
        for unit in range(UNITS):
            value = st.unit[base + unit] + p.const[of_a + unit] * a
            value = value + p.const[of_b + unit] * b
            value = value + p.const[of_c + unit] * c
            st.unit[base + unit] = value + p.const[of_d + unit] * d


@compiled
def outputs_of(p: Program, st: State, side: int) -> tuple[float, float]:
    """Return the outputs of the network for a side: the logit of the confidence, and how far it draws the path."""
    bias = p.surrogate_const[0] + FIRST_AT + VIEW_SIZE * UNITS
    second = p.surrogate_const[0] + SECOND_AT
    logit = st.unit[UNITS * side + HIDDEN] + p.const[bias + HIDDEN]
    drawn = st.unit[UNITS * side + HIDDEN + 1] + p.const[bias + HIDDEN + 1]
    for unit in range(HIDDEN):
        value = st.unit[UNITS * side + unit] + p.const[bias + unit]
        st.answer[unit] = value / (1.0 + abs(value))
    for unit in range(HIDDEN):
        logit += p.const[second + OUTPUTS * unit] * st.answer[unit]
        drawn += p.const[second + OUTPUTS * unit + 1] * st.answer[unit]
    return logit, drawn


@compiled
def judge_view(n: RoadTables, p: Program, st: State) -> None:
    """Work out the network for both sides of the view that has just been written.

    The first time that it leaves the domain while the automation drives is logged.
    """
    keep_view(n, p, st)
    outside = take_up(p, st)
    automated = st.takeover_state[0] in (op.TAKEOVER_AUTOMATED, op.TAKEOVER_WARNING) and st.crashed[0] == 0
    if outside == 1 and automated and st.time_outside_domain[0] < 0.0:
        st.time_outside_domain[0] = st.clock[0]
        log_event(st, op.EVENT_OUTSIDE_DOMAIN, 0.0)
    left, left_drawn = outputs_of(p, st, 0)
    right, right_drawn = outputs_of(p, st, 1)
    st.seen_logit[0] = left
    st.seen_logit[1] = right
    st.seen_drawn[0] = left_drawn - right_drawn


@compiled
def skips_image(p: Program, st: State) -> int:
    """Return 1 if this image is not looked at, because the driver drives and will not soon hand back.

    The confidence is only recorded then, and stays as it was at the last look.
    """
    if st.takeover_state[0] != op.TAKEOVER_MANUAL:
        return 0
    wait = p.const[slot.K_HAND_BACK_AFTER]
    if wait > 0.0 and st.clock[0] - st.manual_since[0] > wait - BEFORE_HAND_BACK:
        return 0
    return 1 if (st.frame[0] - 1) % (BY_HAND_EVERY * max(p.image_every[0], 1)) != 0 else 0


@compiled
def surrogate_confidence(n: RoadTables, p: Program, st: State) -> None:
    """Write the confidence of both sides, the sensor's health and the error of the followed path."""
    health = health_of_camera(p, st)
    st.health[0] = health
    if skips_image(p, st) == 1:
        return
    if view_stays(n, p, st) == 0:
        st.view_row[0] = op.NONE
        if look_at_view(n, p, st) == 0:
            st.conf_left[0] = 0.0
            st.conf_right[0] = 0.0
            return
        judge_view(n, p, st)
    noise = p.surrogate_const[0] + NOISE_AT
    road = st.path_road[0]
    lane = st.path_lane[0]
    s = st.path_s[0]
    cell = p.const[noise + N_CONFIDENCE_CELL]
    size = p.const[noise + N_CONFIDENCE]
    of_left = noise_at(st, road, lane, 0, s, cell)
    of_right = noise_at(st, road, lane, 1, s, cell)
    left = logistic(st.seen_logit[0] + size * of_left)
    right = logistic(st.seen_logit[1] + size * of_right)
    if max(left, right) >= TRUSTED:
        of_path = noise_at(st, road, lane, PATH_SIDE, s, p.const[noise + N_PATH_CELL])
        drawn = st.seen_drawn[0] + p.const[noise + N_PATH] * of_path
        st.path_error[0] = clip(drawn, -FARTHEST_OFF, FARTHEST_OFF)
    st.conf_left[0] = health * left
    st.conf_right[0] = health * right


@compiled
def seen_angle(n: RoadTables, p: Program, st: State, i: int) -> float:
    """Return the angle of the front wheels that follows the path seen by the surrogate, rad."""
    if st.path_road[0] < 0:
        return 0.0
    reach = clip(
        p.const[slot.K_LOOK_AHEAD_TIME] * st.v[i],
        p.const[slot.K_LOOK_AHEAD_LEAST],
        p.const[slot.K_LOOK_AHEAD_MOST],
    )
    x, y = path_point(n, p, st, i, reach, reach, st.path_error[0])
    dx = x - st.x[i]
    dy = y - st.y[i]
    c = st.box_cos[i]
    w = st.box_sin[i]
    return aim(p, st, i, dx * c + dy * w, dy * c - dx * w, NO_BOUND)


@compiled
def drive_as_seen(n: RoadTables, p: Program, st: State, i: int) -> None:
    """Command throttle and brake as `lane_detection` does, for the desired speed or the gap to what is ahead."""
    base = p.entity_const[i]
    v = st.v[i]
    in_bends = speed_for_bends(n, p, st, i, p.const[slot.K_LATERAL], p.const[slot.K_DECELERATION])
    desired = min(st.target_speed[0], in_bends)
    missing = p.const[slot.K_SPEED_GAIN] * (desired - v)
    st.command_throttle[i] = clip(missing, 0.0, 1.0)
    st.command_brake[i] = clip(-BRAKE_SHARE * missing, 0.0, 1.0)
    gap, lead = gap_to_keep(p, st, i)
    if gap >= op.FAR:
        return
    a = p.const[slot.K_ACCELERATION]
    b = p.const[slot.K_DECELERATION]
    closing = v * (v - lead) / max(2.0 * safe_sqrt(a * b), 0.1)
    wanted = p.const[slot.K_MINIMUM_GAP] + max(0.0, v * p.const[slot.K_TIME_GAP] + closing)
    free = v / max(desired, 0.1)
    near = wanted / max(gap, 0.1)
    followed = a * (1.0 - min(free * free * free * free, 2.0) - near * near)
    if followed >= 0.0:
        most = max(p.const[base + slot.E_MAX_ACCELERATION], 0.1)
        st.command_throttle[i] = min(st.command_throttle[i], followed / most)
    else:
        most = max(p.const[base + slot.E_MAX_DECELERATION], 0.1)
        st.command_throttle[i] = 0.0
        st.command_brake[i] = max(st.command_brake[i], min(-followed / most, 1.0))
