"""Reaching and keeping a distance or a time gap to another entity along the road.

Without limits the entity is put at the distance and takes the other's speed; with limits a critically damped spring
moves it there. The distance is measured along the roads, the centre line of the entity's lane, the trajectory that it
follows or its own axis, between the reference points or the boxes. After esmini 3.6, except that the distance does not
depend on which of the two entities an action moves first in a step.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.numbers import angle_between
from scenario_compiler.engine.columns.program import ENTITY, Program
from scenario_compiler.engine.columns.rows import FRAMES, ActionRow, ProgramDraft, flags_of, limits_of
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.distances import (
    along_axis,
    along_roads,
    gap_beyond,
    half_extent,
    own_reach,
    reach_there,
    track_distance_between,
    turned_against,
    way_in_lane,
)
from scenario_compiler.engine.motion.entities import glide, place_scripted
from scenario_compiler.engine.motion.spring import spring_acceleration
from scenario_compiler.engine.motion.tracks import track_followed
from scenario_compiler.engine.moves.entry import HOLDS_SPEED, RELATIVE_THROUGHOUT, Entry
from scenario_compiler.engine.moves.speeds import push_speed, set_speed
from scenario_compiler.engine.moves.trajectories import keeps_times, move_on_track
from scenario_compiler.forms.declaration import index
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables

if TYPE_CHECKING:
    from scenario_compiler.vocabulary.actions import LongitudinalDistanceAction

NEAR_ENOUGH = 0.1
"""Error at which a distance counts as reached, m (esmini 3.6)."""


@compiled
def limit_or(p: Program, k: int, place: int, otherwise: float) -> float:
    """Return a limit of an action, or another value if the action has none (negative)."""
    value = p.const[p.action_const[k] + place]
    return value if value >= 0.0 else otherwise


@compiled
def limit_of_vehicle(p: Program, k: int, place: int, of_vehicle: int) -> float:
    """Return the vehicle's own limit, or the action's if that is less."""
    own = max(p.const[p.entity_const[p.action_entity[k]] + of_vehicle], 0.0)
    return min(limit_or(p, k, place, own), own)


@compiled
def ahead_between(n: RoadTables, p: Program, st: State, k: int) -> tuple[float, float]:
    """Return (distance to the other entity ahead, part of it that the boxes cover), m; FAR if no road leads there.

    With `freespace` it is measured between the centres of the boxes, otherwise between the reference points.
    """
    i = p.action_entity[k]
    j = p.action_other[k]
    freespace = p.action_flags[k] & op.FLAG_FREESPACE
    if p.action_mode[k] == op.FRAME_ENTITY:
        axis = st.h[i]
        if freespace == 0:
            return along_axis(axis, st.x[j] - st.x[i], st.y[j] - st.y[i], op.MEASURE_ALONG), 0.0
        reach = half_extent(p, i, 0.0) + half_extent(p, j, angle_between(st.h[j], axis))
        ahead = along_axis(axis, st.middle_x[j] - st.middle_x[i], st.middle_y[j] - st.middle_y[i], op.MEASURE_ALONG)
        return ahead, reach
    follows = track_followed(p, st, i)
    if p.action_mode[k] == op.FRAME_TRAJECTORY and follows >= 0:
        return track_distance_between(p, st, i, j, follows, op.MEASURE_ALONG, freespace)
    frame = p.action_mode[k]
    ahead, left, direction = along_roads(n, st, i, st.road[j], st.s[j], st.t[j], st.x[j], st.y[j])
    if frame == op.FRAME_LANE and ahead < op.FAR:
        ahead = way_in_lane(n, st, i, st.road[j], ahead)
    if ahead >= op.FAR or freespace == 0:
        return ahead, 0.0
    turned = turned_against(n, st.road[i], st.s[i], st.facing[i], st.h[i])
    own, own_reached = own_reach(n, p, st, i, turned, frame, op.MEASURE_ALONG)
    other, other_reached = reach_there(n, p, st, i, j, st.road[j], st.s[j], left, direction, frame, op.MEASURE_ALONG)
    return ahead + other - own, own_reached + other_reached


@compiled
def start_keep_distance(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Determine side and distance; the present ones if the action leaves them open."""
    st.longitudinal[p.action_entity[k]] = k
    flags = p.action_flags[k]
    ahead, reach = ahead_between(n, p, st, k)
    side = 1.0
    if flags & op.FLAG_AHEAD != 0 or (flags & op.FLAG_BEHIND == 0 and ahead < 0.0):
        side = -1.0
    st.action_a[k] = side
    st.action_b[k] = p.const[p.action_const[k] + slot.A_TARGET]
    if flags & op.FLAG_PRESENT != 0 and ahead < op.FAR:
        st.action_b[k] = side * gap_beyond(ahead, reach)
    st.action_change[k] = 0.0


@compiled
def shift_ahead(n: RoadTables, p: Program, st: State, i: int, distance: float) -> None:
    """Move a scripted entity a signed distance forwards at once, along its trajectory without times or its lane."""
    follows = track_followed(p, st, i)
    if follows < 0:
        glide(n, p, st, i, distance)
        place_scripted(n, st, i)
    elif keeps_times(p, st, follows) == 0:
        move_on_track(n, p, st, follows, distance)


@compiled
def step_keep_distance(n: RoadTables, p: Program, st: State, k: int, dt: float) -> int:
    """Advance towards the distance; return 1 if the step begins near enough to one that need not be kept.

    If an action has already moved one of the two entities in this step, the other one has yet to move as far.
    """
    i = p.action_entity[k]
    j = p.action_other[k]
    if j < 0 or (p.entity_motion[i] != op.MOTION_SCRIPTED and i != p.ego[0]):
        return 1
    ahead, reach = ahead_between(n, p, st, k)
    if ahead >= op.FAR:
        return 0
    flags = p.action_flags[k]
    wanted = st.action_b[k]
    if flags & op.FLAG_TIME_GAP != 0:
        wanted = wanted * abs(st.v[j])
    ahead = ahead + (st.moved[i] - st.moved[j]) * st.v[j] * dt
    error = gap_beyond(ahead, reach) - st.action_a[k] * wanted
    done = 1 if flags & op.FLAG_CONTINUOUS == 0 and abs(error) < NEAR_ENOUGH else 0
    if flags & op.FLAG_LIMITED != 0:
        drive_to_distance(p, st, k, error, dt)
    else:
        if p.entity_motion[i] == op.MOTION_SCRIPTED:
            shift_ahead(n, p, st, i, error)
        set_speed(p, st, i, st.v[j])
    return done


@compiled
def within_jerk(p: Program, k: int, before: float, wanted: float, dt: float) -> float:
    """Return the acceleration nearest to the wanted one that the action's limits of jerk allow in a step, m/s2.

    The limits apply while the acceleration or deceleration grows; releasing throttle or brake is not limited (esmini
    3.6).
    """
    if wanted < 0.0:
        return max(wanted, before - limit_or(p, k, slot.A_DECELERATION_RATE, op.FAR) * dt)
    return min(wanted, before + limit_or(p, k, slot.A_ACCELERATION_RATE, op.FAR) * dt)


@compiled
def drive_to_distance(p: Program, st: State, k: int, error: float, dt: float) -> None:
    """Change the speed for one step by the spring within the limits."""
    i = p.action_entity[k]
    most = limit_of_vehicle(p, k, slot.A_ACCELERATION, slot.E_MAX_ACCELERATION)
    least = limit_of_vehicle(p, k, slot.A_DECELERATION, slot.E_MAX_DECELERATION)
    stiff = most if error < 0.0 else least
    acceleration = spring_acceleration(error, st.v[i] - st.v[p.action_other[k]], stiff, most, least)
    acceleration = within_jerk(p, k, st.action_change[k], acceleration, dt)
    st.action_change[k] = acceleration
    fastest = limit_of_vehicle(p, k, slot.A_MOST_SPEED, slot.E_MAX_SPEED)
    push_speed(p, st, i, acceleration, fastest, dt)


def keep_distance_row(draft: ProgramDraft, word: LongitudinalDistanceAction, actor: int) -> ActionRow:
    """Return the row of a longitudinal distance."""
    del actor
    given = word.time_gap if word.time_gap is not None else word.distance
    return ActionRow(
        (0.0 if given is None else given, 0.0, *limits_of(word.limits)),
        other=draft.entities[word.to],
        mode=FRAMES[word.coordinates],
        flags=flags_of(
            (op.FLAG_CONTINUOUS, word.continuous),
            (op.FLAG_FREESPACE, word.freespace),
            (op.FLAG_TIME_GAP, word.time_gap is not None),
            (op.FLAG_PRESENT, given is None),
            (op.FLAG_LIMITED, word.limits is not None),
            (op.FLAG_BEHIND, word.displacement == "trailingReferencedEntity"),
            (op.FLAG_AHEAD, word.displacement == "leadingReferencedEntity"),
        ),
    )


KEEP_DISTANCE = Entry(
    ("keep_distance",),
    keep_distance_row,
    start_keep_distance,
    step_keep_distance,
    holds=HOLDS_SPEED,
    relative=RELATIVE_THROUGHOUT,
    refers={"other": index(ENTITY)},
)
