"""The motion of entities: scripted along a lane, as a bicycle with throttle, steering and brake, or set from outside.

Scripted motion is esmini's: (road, lane, s, offset) is stored, and x, y and heading are evaluated from it. s changes by
v dt / (1 - curvature t), with curvature and t at the start of the step; exactly where two pieces of the reference line
meet, the curvature is that of the piece from which the entity comes. At the end of a road the entity stops exactly
there; it keeps its speed for the step that no longer moves it, and has speed 0 after that. If only its lane ends or
narrows to nothing, it continues at the centre of a lane that does not. The bicycle is the usual kinematic model about
the rear axle, without side slip.
"""

from __future__ import annotations

from math import atan2, cos, pi, sin, sqrt, tan, tau

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.log import fault
from scenario_compiler.engine.columns.numbers import LARGEST, clip
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.beside import settle_in_lane
from scenario_compiler.engine.motion.following import follow_leader
from scenario_compiler.engine.motion.path import locate_ego, locate_free
from scenario_compiler.engine.motion.routes import leave_guide, next_turn
from scenario_compiler.engine.motion.surroundings import grip
from scenario_compiler.engine.motion.watching import WATCH_MOTION, WATCH_STILL, measure_motion, watch_entity
from scenario_compiler.marker import compiled
from scenario_compiler.roads.geometry import piece_curvature, road_pose, wrap_heading
from scenario_compiler.roads.lane_end import STEP_BEYOND, lane_after_end
from scenario_compiler.roads.lanes import (
    BORDER_TOLERANCE,
    lane_at,
    lane_centre,
    lane_direction,
    lane_exists,
    row_place,
    row_width,
)
from scenario_compiler.roads.tables import RoadTables
from scenario_compiler.roads.travel import advance, stretch_at
from scenario_compiler.vocabulary.horizon import TYRES_HOLD

NO_WIDTH = 1.0e-6
"""Width below which a lane does not exist, m (esmini 3.6)."""

PITCH_TIME = 0.2
"""Time constant of the body's pitch, s: a quarter of the period of a 1.25 Hz spring."""


@compiled
def look_here(n: RoadTables, st: State, i: int) -> None:
    """Find the lane's row and the road's piece at an entity on a road, and the range of s in which both are valid.

    The result is kept, because it holds for many steps. Without such a lane it holds only at this place.
    """
    road = st.road[i]
    lane = st.kept_lane[i]
    s = st.s[i]
    if s >= st.here_from[i] and s < st.here_to[i] and st.here_road[i] == road and st.here_lane[i] == lane:
        return
    row, piece, begin, end = stretch_at(n, road, lane, s)
    st.here_road[i] = road
    st.here_lane[i] = lane
    st.here_from[i] = begin
    st.here_to[i] = end
    st.here_row[i] = row
    st.here_piece[i] = piece


@compiled
def glide(n: RoadTables, p: Program, st: State, i: int, distance: float) -> None:
    """Move a scripted entity a signed distance forwards along its lane, m; off every road, straight on.

    Off every road the pose is written at once; on a road `place_scripted` evaluates it.
    """
    road = st.road[i]
    if road < 0:
        st.x[i] += distance * cos(st.h[i])
        st.y[i] += distance * sin(st.h[i])
        return
    look_here(n, st, i)
    s = st.s[i]
    piece = st.here_piece[i]
    if s == n.piece_s[piece] and st.facing[i] * distance > 0.0 and piece > n.road_piece[road]:
        piece = piece - 1
    stretch = 1.0 - piece_curvature(n, piece, s) * st.t[i]
    if stretch < 0.1:
        stretch = 0.1
    to_s = s + st.facing[i] * distance / stretch
    if to_s >= st.here_from[i] and to_s < st.here_to[i]:
        st.s[i] = to_s
    else:
        glide_beyond(n, p, st, i, st.facing[i] * distance / stretch)
        look_here(n, st, i)
    row = st.here_row[i]
    if row >= 0 and n.lane_steady[row] == 0 and st.kept_lane[i] != 0 and row_width(n, row, st.s[i]) < NO_WIDTH:
        leave_vanished_lane(n, st, i)


@compiled
def drift_angle(st: State, i: int, left: float, ahead: float) -> float:
    """Return the angle to its lane, rad, of an entity that moves `left` and `ahead` (not negative) in the same time.

    It moves along its heading: backwards it turns to the other side (esmini 3.6).
    """
    angle = atan2(left, ahead)
    return angle if st.v[i] >= 0.0 else -angle


@compiled
def leave_vanished_lane(n: RoadTables, st: State, i: int) -> None:
    """Put an entity whose lane has narrowed to nothing on the centre of the next lane that has width.

    This is the nearest one towards the road's reference line, or else the nearest one away from it. Without either, the
    entity keeps its lane.
    """
    row = st.here_row[i]
    section = n.lane_section[row]
    inwards = 1 if st.kept_lane[i] > 0 else -1
    found = row + inwards
    while n.lane_id[found] != 0 and row_width(n, found, st.s[i]) < NO_WIDTH:
        found = found + inwards
    if n.lane_id[found] == 0:
        found = row - inwards
        while found >= n.section_lane[section] and found < n.section_lane[section + 1]:
            if row_width(n, found, st.s[i]) >= NO_WIDTH:
                break
            found = found - inwards
        if found < n.section_lane[section] or found >= n.section_lane[section + 1]:
            return
    st.kept_lane[i] = n.lane_id[found]
    st.kept_off[i] = 0.0
    look_here(n, st, i)


@compiled
def glide_beyond(n: RoadTables, p: Program, st: State, i: int, along: float) -> None:
    """Move a scripted entity a distance along s that leaves the known range of its lane's row or its road's piece.

    The centre lane continues to the end of its road. Where a lane ends, the entity continues on the centre of the
    nearest lane that does not. While an action moves it aside, that is the lane nearest to the one that ends, and the
    entity keeps its place across the road. A lane also ends where it is reversed from there on.
    """
    road = st.road[i]
    lane = st.kept_lane[i]
    s = st.s[i]
    direction = lane_direction(n, road, lane, s)
    ahead = direction * along
    sense = st.facing[i] * direction
    if lane == 0:
        to_road, to_lane = road, lane
        to_s = clip(s + along, 0.0, n.road_length[road])
        rest = abs(s + along - to_s)
    else:
        to_road, to_lane, to_s, rest = advance(n, road, lane, s, ahead, next_turn(n, p, st, i, road))
    beyond = lane_direction(n, to_road, to_lane, to_s)
    turned = 1 if to_road == road and to_lane == lane and beyond != direction else 0
    if rest > op.TOLERANCE or turned == 1 or (to_lane != 0 and lane_exists(n, to_road, to_lane, to_s) == 0):
        forward = 1 if ahead > 0.0 else -1
        aside = 0.0 if st.lateral[i] >= 0 else st.kept_off[i]
        heads = forward * (direction if turned == 1 else beyond)
        beside, from_s = lane_after_end(n, to_road, to_lane, to_s, aside, heads)
        if beside != 0:
            st.kept_off[i] = 0.0
            if st.lateral[i] >= 0 and to_road == road:
                centre, _ = lane_centre(n, road, beside, from_s)
                st.kept_off[i] = st.t[i] - centre
            turn = next_turn(n, p, st, i, to_road)
            to_road, to_lane, to_s, rest = advance(n, to_road, beside, from_s, forward * rest, turn)
        elif turned == 1:
            to_s = to_s - heads * STEP_BEYOND
    if rest > op.TOLERANCE and to_road == road and abs(to_s - s) <= op.TOLERANCE:
        st.ended[i] = 1
    if to_road != road or to_lane != lane:
        facing = sense * lane_direction(n, to_road, to_lane, to_s)
        if facing != st.facing[i]:
            st.kept_off[i] = -st.kept_off[i]
        st.facing[i] = facing
        st.road[i] = to_road
        st.kept_lane[i] = to_lane
        leave_guide(p, st, i)
    st.s[i] = to_s


@compiled
def place_scripted(n: RoadTables, st: State, i: int) -> None:
    """Evaluate the pose of a scripted entity on a road, and the lane that contains its reference point."""
    if st.road[i] < 0:
        return
    look_here(n, st, i)
    place_here(n, st, i)


@compiled
def place_here(n: RoadTables, st: State, i: int) -> None:
    """Evaluate the pose as `place_scripted` does, on the known row and piece."""
    road = st.road[i]
    s = st.s[i]
    lane = st.kept_lane[i]
    off = st.kept_off[i]
    row = st.here_row[i]
    x, y, z, h, pitch, roll, t = row_place(n, road, row, st.here_piece[i], s, off)
    st.x[i] = x
    st.y[i] = y
    st.z[i] = z
    if st.facing[i] < 0:
        h = h + pi
        pitch = -pitch
        roll = -roll
    h = h + st.turn[i]
    st.h[i] = h if h > 0.0 and h < tau else wrap_heading(h)
    st.pitch[i] = pitch
    st.roll[i] = roll
    st.t[i] = t
    if off != 0.0 and (row < 0 or abs(off) >= 0.5 * row_width(n, row, s) - BORDER_TOLERANCE):
        inside = lane_at(n, road, s, t)
        if inside not in (0, lane):
            lane = inside
            centre, _ = lane_centre(n, road, lane, s)
            off = t - centre
    st.lane[i] = lane
    st.off[i] = off
    if st.lateral[i] < 0:
        settle_in_lane(st, i)


@compiled
def move_scripted(n: RoadTables, p: Program, st: State, i: int, dt: float) -> None:
    """Move a scripted entity by its speed, unless an action has moved it; it stops at the end of its road.

    Off every road it goes straight on, but stays at the end of a finished trajectory (esmini 3.6).
    """
    if st.follows[i] == 1 and st.longitudinal[i] < 0 and st.road[i] >= 0:
        follow_leader(n, p, st, i, dt)
    if st.moved[i] == 1 or abs(st.v[i]) <= op.TOLERANCE:
        return
    if st.road[i] < 0 and st.ended[i] == 1:
        st.v[i] = 0.0
        return
    stood = st.ended[i]
    st.ended[i] = 0
    glide(n, p, st, i, st.v[i] * dt)
    if st.road[i] >= 0:
        place_here(n, st, i)
    if stood == 1 and st.ended[i] == 1:
        st.v[i] = 0.0


@compiled
def next_speed(p: Program, st: State, i: int, gain: float, loss: float, dt: float) -> float:
    """Return the speed after a step of a vehicle that is driven by commands, m/s.

    `gain` accelerates it in the direction of its gear; `loss` slows it down to a stop but not beyond, both in m/s2.
    """
    v = st.v[i]
    most = p.const[p.entity_const[i] + slot.E_MAX_SPEED]
    if st.command_reverse[i] == 0 and v >= 0.0:
        return clip(v + (gain - loss) * dt, 0.0, most)
    pushed = v + gain * dt
    if st.command_reverse[i] == 1:
        pushed = v - gain * dt
    if pushed > 0.0:
        pushed = max(pushed - loss * dt, 0.0)
    else:
        pushed = min(pushed + loss * dt, 0.0)
    return clip(pushed, -most, most)


@compiled
def steering_tangent(st: State, i: int) -> float:
    """Return the tangent of the front wheels' angle; in most steps the wheels keep their angle."""
    angle = st.steer[i]
    if angle != st.tangent_of[i]:
        st.tangent_of[i] = angle
        st.steer_tangent[i] = tan(angle)
    return st.steer_tangent[i]


@compiled
def move_bicycle(p: Program, st: State, i: int, dt: float) -> None:
    """Move a vehicle by its commands. Brakes stop it exactly; only the reverse gear drives it backwards.

    It turns no more tightly than its tyres hold, however far the wheels are turned, and a pedal has no more effect than
    they hold. Without a turn, cosine and sine of
    its heading are those of its box.
    """
    base = p.entity_const[i]
    st.throttle[i] = clip(st.command_throttle[i], 0.0, 1.0)
    st.brake[i] = clip(st.command_brake[i], 0.0, 1.0)
    fastest = p.const[base + slot.E_MAX_ACCELERATION]
    hardest = p.const[base + slot.E_MAX_DECELERATION]
    gain = min(st.throttle[i] * fastest, grip(st, fastest))
    loss = min(st.brake[i] * hardest, grip(st, hardest)) + st.drag[i] * (1.0 - st.throttle[i])
    speed = next_speed(p, st, i, gain, loss, dt)
    wanted = clip(st.command_steer[i], -1.0, 1.0) * p.const[base + slot.E_MAX_STEER]
    st.steer[i] = st.steer[i] + clip(wanted - st.steer[i], -st.steer_rate[i] * dt, st.steer_rate[i] * dt)
    st.v[i] = speed
    if speed == 0.0:
        st.h[i] = wrap_heading(st.h[i])
        return
    tangent = steering_tangent(st, i)
    rate = speed * tangent / max(p.const[base + slot.E_WHEELBASE], 0.1)
    held = grip(st, TYRES_HOLD)
    if abs(rate * speed) > held:
        rate = clip(rate, -held / abs(speed), held / abs(speed))
    swing = rate * dt
    middle = st.h[i] + 0.5 * swing
    c = st.box_cos[i]
    s = st.box_sin[i]
    if middle != st.box_h[i]:
        c = cos(middle)
        s = sin(middle)
    st.x[i] += speed * dt * c
    st.y[i] += speed * dt * s
    st.h[i] = wrap_heading(st.h[i] + swing)


@compiled
def settle(n: RoadTables, st: State, i: int) -> None:
    """Put an entity on the road surface below it, without the pitch of its body on the springs."""
    st.pitch[i] -= st.body_pitch[i]
    road = st.road[i]
    if road < 0:
        return
    if n.road_flat[road] == 1:
        st.z[i] = 0.0
        st.pitch[i] = 0.0
        st.roll[i] = 0.0
        return
    _, _, z, h, pitch, roll = road_pose(n, road, st.s[i], st.t[i])
    forward = cos(st.h[i] - h)
    side = sin(st.h[i] - h)
    st.z[i] = z
    st.pitch[i] = pitch * forward - roll * side
    st.roll[i] = roll * forward + pitch * side


@compiled
def pitch_body(p: Program, st: State, i: int, dt: float) -> None:
    """Let the ego's body pitch with its acceleration, as a first-order lag (implicit Euler)."""
    held = -p.const[p.entity_const[i] + slot.E_PITCH_GRADIENT] * st.a[i]
    st.body_pitch[i] += (held - st.body_pitch[i]) * dt / (PITCH_TIME + dt)
    st.pitch[i] += st.body_pitch[i]


@compiled
def move_entities(n: RoadTables, p: Program, st: State, dt: float) -> None:
    """Move every present entity that the engine moves, except traffic; posed entities have been moved from outside."""
    for i in range(p.entity_count[0]):
        if st.present[i] == 0 or st.towed_by[i] >= 0:
            continue
        kind = p.entity_motion[i]
        if kind == op.MOTION_SCRIPTED:
            move_scripted(n, p, st, i, dt)
        elif kind == op.MOTION_BICYCLE:
            move_bicycle(p, st, i, dt)
        elif kind not in (op.MOTION_STATIC, op.MOTION_POSED, op.MOTION_TRAFFIC, op.MOTION_WALKER):
            fault(st, op.FAULT_UNKNOWN_MOTION, i)


@compiled
def take_stock(n: RoadTables, p: Program, st: State, dt: float) -> None:
    """After all have moved, update road positions, odometers, accelerations and watched quantities.

    A value that became NaN or infinite is a fault of the run.
    """
    watches = p.watches[0]
    for i in range(p.entity_count[0]):
        x = st.x[i]
        y = st.y[i]
        v = st.v[i]
        total = x + y + st.h[i] + v + st.steer[i]
        if not (total > -LARGEST and total < LARGEST):
            fault(st, op.FAULT_NOT_FINITE, i)
            return
        kind = p.entity_motion[i]
        if kind >= op.MOTION_BICYCLE and kind <= op.MOTION_POSED and st.present[i] == 1:
            if i == p.ego[0]:
                locate_ego(n, p, st, i)
            else:
                locate_free(n, st, i)
            if kind == op.MOTION_BICYCLE:
                settle(n, st, i)
        if dt > 0.0:
            dx = x - st.last_x[i]
            dy = y - st.last_y[i]
            st.odometer[i] += sqrt(dx * dx + dy * dy)
            st.a[i] = (v - st.last_v[i]) / dt
        else:
            st.a[i] = 0.0
        if kind == op.MOTION_BICYCLE and st.present[i] == 1:
            pitch_body(p, st, i, dt)
        st.last_x[i] = x
        st.last_y[i] = y
        st.last_v[i] = v
        st.moved[i] = 0
        if watches != 0 and st.present[i] == 1:
            if watches & WATCH_MOTION != 0:
                measure_motion(st, i, watches, dt)
            if watches >= WATCH_STILL:
                watch_entity(n, st, i, watches, dt)
