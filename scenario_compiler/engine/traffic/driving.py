"""Background traffic: vehicles that keep their lanes, follow, change lanes, turn and yield, and pedestrians.

Vehicles without a start position belong to an action (`swarms`, `sources`), which lets them appear; they disappear when
they leave the map. Following is the intelligent driver model (see `following`). Lane changing is after MOBIL (Kesting,
Treiber and Helbing 2007, Transportation Research Record 1999, 86-94), with two differences (`change_gain`). At a
junction a vehicle claims its connecting road. It gets the road if no crossing one is claimed or driven on, first come,
first served; otherwise it waits at the line. Turns are drawn with the counter hash from the seed, the vehicle and the
number of its turns so far.
"""

from __future__ import annotations

from math import atan, cos, pi, sin

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.numbers import clip, length_of, safe_sqrt
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.seeds import run_seed
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.ahead import walk
from scenario_compiler.engine.motion.beside import neighbour_lane
from scenario_compiler.engine.motion.entities import glide, place_scripted
from scenario_compiler.engine.motion.following import idm_acceleration
from scenario_compiler.engine.motion.path import STEP_OVER
from scenario_compiler.engine.motion.places import clear_place
from scenario_compiler.engine.motion.signals_ahead import red_ahead
from scenario_compiler.engine.traffic.junctions import distance_to_line, drop_claim, wait_at_red
from scenario_compiler.engine.traffic.neighbours import follower_on_way, leader_on_way, list_by_road
from scenario_compiler.marker import compiled
from scenario_compiler.randomness import random_hash
from scenario_compiler.roads.geometry import road_curvature
from scenario_compiler.roads.lane_types import is_drivable
from scenario_compiler.roads.lanes import (
    lane_centre,
    lane_direction,
    lane_pose,
    lane_row_in,
    lane_type,
    lane_width,
    section_at,
)
from scenario_compiler.roads.tables import AT_END, AT_START, RoadTables
from scenario_compiler.roads.travel import advance, distance_to_lane_end

LOOK_AHEAD = 120.0
"""Distance up to which a driver considers vehicles, bends and the end of the lane ahead, m."""

LOOK_BEHIND = 60.0
"""Distance up to which a driver considers vehicles behind before a lane change, m."""

THINK_TIME = 0.5
THINK_SHIFT = 0.05
"""Time between two decisions of a driver on speed, lane and turn, s, and by how much later than the vehicle with the
index before each vehicle decides, so that not all decide in the same frame; chosen. Both are rounded to whole steps.
"""

UNLIMITED = 36.0
"""Desired speed without a speed limit, m/s: the 130 km/h recommended in Germany."""

UNSIGNED = 13.9
"""Desired speed where the map states no limit, m/s: 50 km/h."""

LATERAL = 2.0
"""Greatest lateral acceleration in bends, m/s2: comfortable, as curve speeds of passenger cars are chosen."""

BEND_STEP = 8.0
"""Distance between the points at which the curvature ahead is sampled, m."""

THRESHOLD = 0.1
SAFE = 4.0
POLITENESS = 0.2
"""Parameters of MOBIL: gain in acceleration that justifies a change, m/s2; greatest deceleration that it may cause the
vehicle behind, m/s2; weight of the loss of the vehicle behind. The first two are those of Kesting et al. 2007, table 1.
"""

CHANGE_TIME = 3.0
"""Duration of a lane change, s."""

CHANGE_PAUSE = 6.0
"""Least time between the starts of two lane changes, s."""

NARROWEST_LANE = 2.5
"""Least width of a lane that a vehicle changes to, m."""

RETURN_ATTEMPTS = 5
"""Number of places that are tried in a frame for a vehicle that has left the map."""

OUT_OF_SIGHT = 120.0
"""Least distance from the ego at which a vehicle that has left the map may return, m."""

WALK_ASIDE = 0.5
"""Offset of pedestrians to the right of their sidewalk's centre, m."""


@compiled
def legal_speed(n: RoadTables, road: int, lane: int, s: float) -> float:
    """Return the speed limit of a lane, or of the road, m/s; UNSIGNED if there is none, and at most UNLIMITED."""
    speed = -1.0
    row = lane_row_in(n, section_at(n, road, s), lane)
    if row >= 0:
        for k in range(n.lane_speed[row], n.lane_speed[row + 1]):
            if n.speed_s[k] <= s:
                speed = n.speed_max[k]
    if speed < 0.0:
        for k in range(n.road_type[road], n.road_type[road + 1]):
            if n.type_s[k] <= s:
                speed = n.type_speed[k]
    if speed < 0.0:
        return UNSIGNED
    return min(speed, UNLIMITED)


@compiled
def wished_speed(n: RoadTables, p: Program, st: State, i: int) -> float:
    """Return the desired speed of a driver, m/s: the driver's share of the speed limit, reduced before bends.

    A bend at the distance d allows the present speed sqrt(v_bend^2 + 2 b d). The way must have been walked before.
    """
    base = p.entity_const[i]
    legal = legal_speed(n, st.road[i], st.lane[i], st.s[i])
    wish = min(legal * p.const[base + slot.E_SHARE], p.const[base + slot.E_DESIRED_SPEED])
    ahead = 0.0
    for w in range(st.way_count[0]):
        road = st.way_road[w]
        room = n.road_length[road] - st.way_s[w] if st.way_sign[w] > 0 else st.way_s[w]
        while ahead < st.way_from[w] + room and ahead < 0.5 * LOOK_AHEAD:
            s = clip(st.way_s[w] + st.way_sign[w] * (ahead - st.way_from[w]), 0.0, n.road_length[road])
            bend = abs(road_curvature(n, road, s))
            if bend > 1.0e-4:
                allowed = safe_sqrt(LATERAL / bend + 2.0 * p.const[base + slot.E_DECELERATION] * ahead)
                wish = min(wish, allowed)
            ahead = ahead + BEND_STEP
    return wish


@compiled
def choose_turn(n: RoadTables, p: Program, st: State, i: int) -> None:
    """Draw the road that a vehicle takes at the end of its own, if several follow its lane."""
    road = st.road[i]
    st.turn_from[i] = road
    st.turn_to[i] = op.NONE
    st.asked[i] = op.NONE
    if st.entered[i] == 0:
        st.claim[i] = op.NONE
    direction = lane_direction(n, road, st.kept_lane[i], st.s[i])
    rest = n.road_length[road] - st.s[i] if direction > 0 else st.s[i]
    last, lane, _, left = advance(n, road, st.kept_lane[i], st.s[i], max(rest - STEP_OVER, 0.0), op.NONE)
    if left > 0.0 or last != road:
        return
    section = n.road_section[road]
    end = AT_START
    if direction > 0:
        section = n.road_section[road + 1] - 1
        end = AT_END
    row = lane_row_in(n, section, lane)
    if row < 0:
        return
    first = n.lane_link[2 * row + end]
    count = n.lane_link[2 * row + end + 1] - first
    if count <= 0:
        return
    bits = random_hash(run_seed(st, p.entity_seed[i]), op.STREAM_TURN, i, st.turns[i])
    chosen = n.link_lane[first + bits % max(count, 1)]
    st.turn_to[i] = n.section_road[n.lane_section[chosen]]
    st.turns[i] += 1


@compiled
def acceleration_behind(p: Program, i: int, v: float, wish: float, gap: float, lead: float) -> float:
    """Return a driver's acceleration behind a vehicle, m/s2; a gap below 0.1 m counts as 0.1 m."""
    if gap < 0.1:
        return idm_acceleration(p, i, v, wish, 0.1, lead)
    return idm_acceleration(p, i, v, wish, gap, lead)


@compiled
def look(n: RoadTables, st: State, i: int, lane: int, along: int, horizon: float) -> None:
    """Walk the way of a vehicle in a lane of its road, ahead (1) with its turn or backwards (-1)."""
    st.along_way[0] = along
    walk(n, st, st.road[i], lane, st.s[i], along, horizon, st.turn_to[i] if along > 0 else op.NONE)


@compiled
def change_gain(n: RoadTables, p: Program, st: State, i: int, lane: int, present: float) -> float:
    """Return the gain of a change to a neighbouring lane, m/s2; -FAR if it is not safe.

    MOBIL adds to the vehicle's own gain those of the followers in the new and in the old lane, times the politeness.
    Here the old follower does not count, and the new one only if it loses.

    Args:
        n: The roads.
        p: The program.
        st: The state; its way is overwritten.
        i: The vehicle.
        lane: The neighbouring lane.
        present: The vehicle's acceleration without a change, m/s2.
    """
    look(n, st, i, lane, 1, LOOK_AHEAD)
    gap, lead = leader_on_way(n, p, st, i)
    look(n, st, i, lane, -1, LOOK_BEHIND)
    behind, gap_behind = follower_on_way(n, p, st, i)
    if gap < p.const[p.entity_const[i] + slot.E_MINIMUM_GAP]:
        return -op.FAR
    own = acceleration_behind(p, i, st.v[i], st.wish[i], gap, lead)
    if own < -SAFE:
        return -op.FAR
    cost = 0.0
    if behind >= 0:
        if gap_behind < p.const[p.entity_const[behind] + slot.E_MINIMUM_GAP]:
            return -op.FAR
        wish = max(st.wish[behind], st.v[behind])
        then = acceleration_behind(p, behind, st.v[behind], wish, gap_behind, st.v[i])
        if then < -SAFE:
            return -op.FAR
        length = p.const[p.entity_const[i] + slot.E_LENGTH]
        now = idm_acceleration(p, behind, st.v[behind], wish, min(gap + gap_behind + length, op.FAR), lead)
        cost = min(then - now, 0.0)
    return own - present + POLITENESS * cost


@compiled
def lane_beside(n: RoadTables, st: State, i: int, side: int) -> int:
    """Return the lane to the left (1) or right (-1) that a vehicle may change to; 0 if there is none."""
    road = st.road[i]
    s = st.s[i]
    direction = lane_direction(n, road, st.kept_lane[i], st.s[i])
    lane = neighbour_lane(n, road, st.kept_lane[i], s, side, direction)
    if lane == 0 or lane_direction(n, road, lane, s) != direction:
        return 0
    if is_drivable(lane_type(n, road, lane, s)) == 0 or lane_width(n, road, lane, s) < NARROWEST_LANE:
        return 0
    return lane


@compiled
def consider_change(n: RoadTables, p: Program, st: State, i: int, present: float, goes_on: float) -> None:
    """Begin a lane change if it is worth it, or if the vehicle's own lane ends before the neighbouring one."""
    best = THRESHOLD
    target = 0
    for side in range(1, -2, -2):
        lane = lane_beside(n, st, i, side)
        if lane != 0:
            further = distance_to_lane_end(n, st.road[i], lane, st.s[i], LOOK_AHEAD, op.NONE)
            if further >= min(goes_on, LOOK_AHEAD) - 1.0:
                gain = change_gain(n, p, st, i, lane, present)
                if gain > -op.FAR and further > goes_on + 10.0:
                    gain = gain + 10.0
                if gain > best:
                    best = gain
                    target = lane
    if target != 0:
        begin_change(n, st, i, target)


@compiled
def begin_change(n: RoadTables, st: State, i: int, lane: int) -> None:
    """Let a vehicle follow another lane, with its present position as an offset."""
    st.kept_lane[i] = lane
    centre, _ = lane_centre(n, st.road[i], lane, st.s[i])
    st.change_from[i] = st.t[i] - centre
    st.change_at[i] = st.clock[0]
    st.kept_off[i] = st.change_from[i]
    st.lateral[i] = op.DRIVES_BY_RULES
    st.turn_from[i] = op.NONE


@compiled
def glide_over(st: State, i: int) -> None:
    """Advance a vehicle's lane change, which is a cosine over CHANGE_TIME; the heading follows it."""
    if st.lateral[i] != op.DRIVES_BY_RULES:
        return
    share = clip((st.clock[0] - st.change_at[i]) / CHANGE_TIME, 0.0, 1.0)
    before = st.kept_off[i]
    st.kept_off[i] = st.change_from[i] * 0.5 * (1.0 + cos(pi * share))
    rate = -st.change_from[i] * 0.5 * pi / CHANGE_TIME * sin(pi * share)
    st.turn[i] = st.facing[i] * atan(rate / max(st.v[i], 2.0)) if before != 0.0 else 0.0
    if share >= 1.0:
        st.kept_off[i] = 0.0
        st.turn[i] = 0.0
        st.lateral[i] = op.NONE


@compiled
def way_end(n: RoadTables, st: State) -> float:
    """Return the length of the walked way, m; it is less than the horizon if no road follows."""
    w = st.way_count[0] - 1
    rest = n.road_length[st.way_road[w]] - st.way_s[w] if st.way_sign[w] > 0 else st.way_s[w]
    return st.way_from[w] + rest


@compiled
def lane_goes_on(n: RoadTables, st: State, i: int) -> float:
    """Return how far the vehicle's lane continues, m, at most LOOK_AHEAD; the end of the map does not end it."""
    rest = distance_to_lane_end(n, st.road[i], st.kept_lane[i], st.s[i], LOOK_AHEAD, st.turn_to[i])
    if rest > way_end(n, st) - 1.0:
        return LOOK_AHEAD
    return rest


@compiled
def think(n: RoadTables, p: Program, st: State, i: int, gap: float, lead: float) -> None:
    """Decide on the desired speed and on a lane change; needs the way ahead, and overwrites it."""
    st.wish[i] = max(wished_speed(n, p, st, i), 0.5)
    st.lane_rest[i] = lane_goes_on(n, st, i)
    room = st.way_from[1] if st.way_count[0] > 1 else LOOK_AHEAD
    junction_ahead = st.way_count[0] > 1 and n.road_junction[st.way_road[1]] >= 0
    near = junction_ahead and room < CHANGE_TIME * st.v[i] + 25.0
    in_junction = n.road_junction[st.road[i]] >= 0
    waited = st.clock[0] - st.change_at[i] >= CHANGE_PAUSE and st.lateral[i] < 0 and st.claim[i] < 0
    if waited and not near and not in_junction and st.v[i] > 2.0:
        present = idm_acceleration(p, i, st.v[i], st.wish[i], gap, lead)
        consider_change(n, p, st, i, present, st.lane_rest[i])


@compiled
def thinks_now(p: Program, st: State, i: int) -> int:
    """Return 1 if a vehicle decides on speed, lane and turn in this frame."""
    step = max(p.const[slot.K_STEP], op.TOLERANCE)
    every = max(int(clip(THINK_TIME / step + 0.5, 1.0, 1.0e6)), 1)
    shift = int(clip(THINK_SHIFT / step + 0.5, 0.0, 1.0e6))
    return 1 if (st.frame[0] + i * shift) % every == 0 else 0


@compiled
def pull(n: RoadTables, p: Program, st: State, i: int, dt: float) -> float:
    """Return a vehicle's acceleration with its leader, the line at which it waits and the end of its lane, m/s2."""
    look(n, st, i, st.kept_lane[i], 1, LOOK_AHEAD)
    gap, lead = leader_on_way(n, p, st, i)
    red = red_ahead(n, p, st, i) if p.head_count[0] > 0 else op.FAR
    if red < op.FAR:
        line = wait_at_red(p, st, i, red)
    else:
        line = distance_to_line(n, p, st, i, gap, lead)
    if thinks_now(p, st, i) == 1 or st.wish[i] < 0.0:
        think(n, p, st, i, gap, lead)
    st.lane_rest[i] -= st.v[i] * dt
    base = p.entity_const[i]
    wanted = acceleration_behind(p, i, st.v[i], st.wish[i], gap, lead)
    if line < op.FAR:
        wanted = min(wanted, acceleration_behind(p, i, st.v[i], st.wish[i], line, 0.0))
    if st.lane_rest[i] < LOOK_AHEAD - 20.0:
        end = st.lane_rest[i] - p.const[base + slot.E_CENTER] - 0.5 * p.const[base + slot.E_LENGTH]
        wanted = min(wanted, acceleration_behind(p, i, st.v[i], st.wish[i], end, 0.0))
    return wanted


@compiled
def come_back(n: RoadTables, p: Program, st: State, i: int) -> None:
    """Put a vehicle that has left the map at another random place if one is free and out of the ego's sight."""
    st.v[i] = 0.0
    k = p.entity_position[i]
    first = op.PLACE_ATTEMPTS + RETURN_ATTEMPTS * (st.frame[0] & 65535)
    road, lane, s, _, direction = clear_place(n, p, st, k, p.entity_count[0], first, RETURN_ATTEMPTS)
    if road < 0:
        return
    x, y, _, _, _, _ = lane_pose(n, road, lane, s, 0.0)
    ego = p.ego[0]
    if ego >= 0 and length_of(x - st.x[ego], y - st.y[ego]) < OUT_OF_SIGHT:
        return
    st.road[i] = road
    st.s[i] = s
    st.kept_lane[i] = lane
    st.facing[i] = direction
    prepare_driver(n, p, st, i)
    place_scripted(n, st, i)
    st.last_x[i] = st.x[i]
    st.last_y[i] = st.y[i]
    st.last_v[i] = st.v[i]
    list_by_road(p, st)


@compiled
def forget_decisions(st: State, i: int) -> None:
    """Reset a traffic vehicle's claim, lane change, turn and desired speed."""
    st.kept_off[i] = 0.0
    st.turn[i] = 0.0
    st.lateral[i] = op.NONE
    st.turn_from[i] = op.NONE
    st.turn_to[i] = op.NONE
    st.wish[i] = -1.0
    st.lane_rest[i] = op.FAR
    st.claim[i] = op.NONE
    st.entered[i] = 0
    st.asked[i] = op.NONE
    st.change_at[i] = -CHANGE_PAUSE
    st.change_from[i] = 0.0


@compiled
def vanish(st: State, i: int) -> None:
    """Let a traffic vehicle disappear."""
    forget_decisions(st, i)
    st.present[i] = 0
    st.v[i] = 0.0
    st.a[i] = 0.0


@compiled
def prepare_driver(n: RoadTables, p: Program, st: State, i: int) -> None:
    """Put a traffic vehicle at the centre of its lane, without earlier decisions."""
    base = p.entity_const[i]
    st.ended[i] = 0
    forget_decisions(st, i)
    legal = legal_speed(n, st.road[i], st.kept_lane[i], st.s[i])
    st.v[i] = min(p.const[base + slot.E_SPEED], legal * p.const[base + slot.E_SHARE])


@compiled
def prepare_walker(n: RoadTables, p: Program, st: State, i: int) -> None:
    """Choose a pedestrian's direction, and put the pedestrian to the right of the sidewalk's centre."""
    bits = random_hash(run_seed(st, p.entity_seed[i]), op.STREAM_TURN, i, 0)
    st.facing[i] = 1 if bits % 2 == 0 else -1
    aside = min(WALK_ASIDE, 0.25 * lane_width(n, st.road[i], st.kept_lane[i], st.s[i]))
    st.kept_off[i] = -st.facing[i] * aside
    st.turn[i] = 0.0


@compiled
def prepare_traffic(n: RoadTables, p: Program, st: State) -> None:
    """Reset background traffic to t = 0, after all entities have been placed."""
    for i in range(p.entity_count[0]):
        kind = p.entity_motion[i]
        if kind == op.MOTION_TRAFFIC:
            forget_decisions(st, i)
        if st.road[i] < 0:
            continue
        if kind == op.MOTION_TRAFFIC:
            prepare_driver(n, p, st, i)
        elif kind == op.MOTION_WALKER:
            prepare_walker(n, p, st, i)
        if kind in (op.MOTION_TRAFFIC, op.MOTION_WALKER):
            place_scripted(n, st, i)
            st.last_x[i] = st.x[i]
            st.last_y[i] = st.y[i]
            st.last_v[i] = st.v[i]


@compiled
def move_driver(n: RoadTables, p: Program, st: State, i: int, dt: float) -> None:
    """Move a traffic vehicle by one step."""
    if st.ended[i] == 1:
        if p.entity_position[i] < 0:
            vanish(st, i)
        else:
            come_back(n, p, st, i)
        return
    drop_claim(n, p, st, i)
    if st.turn_from[i] != st.road[i]:
        choose_turn(n, p, st, i)
    wanted = pull(n, p, st, i, dt)
    st.v[i] = max(0.0, st.v[i] + dt * wanted)
    glide_over(st, i)
    road = st.road[i]
    glide(n, p, st, i, st.v[i] * dt)
    place_scripted(n, st, i)
    if st.road[i] != road:
        list_by_road(p, st)


@compiled
def move_walker(n: RoadTables, p: Program, st: State, i: int, dt: float) -> None:
    """Move a pedestrian by one step; at the end of the sidewalk the pedestrian turns round."""
    if st.ended[i] == 1:
        st.ended[i] = 0
        st.facing[i] = -st.facing[i]
        st.kept_off[i] = -st.kept_off[i]
    st.v[i] = p.const[p.entity_const[i] + slot.E_SPEED]
    glide(n, p, st, i, st.v[i] * dt)
    place_scripted(n, st, i)


@compiled
def move_traffic(n: RoadTables, p: Program, st: State, dt: float) -> None:
    """Move all background traffic, one after the other."""
    list_by_road(p, st)
    for i in range(p.entity_count[0]):
        if st.present[i] == 0:
            continue
        if p.entity_motion[i] == op.MOTION_TRAFFIC:
            move_driver(n, p, st, i, dt)
        elif p.entity_motion[i] == op.MOTION_WALKER:
            move_walker(n, p, st, i, dt)
