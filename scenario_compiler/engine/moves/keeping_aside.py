"""Reaching and keeping a lateral distance to another entity.

Sides are relative to the other entity's forward direction. Without limits the entity is put at the distance. With a
limit of speed it moves there at that speed; with a limit of acceleration a critically damped spring moves it. The
lateral motion reduces the motion ahead. The action has an effect from the step after its start (esmini 3.6).
"""

from __future__ import annotations

from math import cos, sin
from typing import TYPE_CHECKING

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.numbers import angle_between, clip, safe_sqrt
from scenario_compiler.engine.columns.program import ENTITY, Program
from scenario_compiler.engine.columns.rows import FRAMES, ActionRow, ProgramDraft, flags_of, limits_of
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.distances import along_axis, along_roads, turned_against
from scenario_compiler.engine.motion.entities import drift_angle, glide, place_scripted
from scenario_compiler.engine.motion.spring import spring_acceleration
from scenario_compiler.engine.motion.steering import plan_shift, shift_distance
from scenario_compiler.engine.motion.watching import WATCH_MOTION
from scenario_compiler.engine.moves.entry import HOLDS_LANE, RELATIVE_THROUGHOUT, Entry
from scenario_compiler.engine.moves.keeping_distance import limit_or, within_jerk
from scenario_compiler.forms.declaration import index
from scenario_compiler.marker import compiled
from scenario_compiler.roads.geometry import wrap_heading
from scenario_compiler.roads.lanes import lane_centre
from scenario_compiler.roads.tables import RoadTables

if TYPE_CHECKING:
    from scenario_compiler.vocabulary.actions import LateralDistanceAction

NEAR_ASIDE = 0.01
"""Error at which a lateral distance counts as reached, m (esmini 3.6)."""


@compiled
def left_between(n: RoadTables, p: Program, st: State, k: int) -> tuple[float, float]:
    """Return (distance of the other entity to the left, m; 1 if it faces in the same direction, else -1).

    The distance is FAR if no road leads there. Left is relative to the entity's motion along its road, or to its own
    axes.
    """
    i = p.action_entity[k]
    j = p.action_other[k]
    if p.action_mode[k] == op.FRAME_ENTITY:
        axis = st.h[i] - st.turn[i] if st.road[i] >= 0 else st.h[j]
        left = along_axis(axis, st.x[j] - st.x[i], st.y[j] - st.y[i], op.MEASURE_ACROSS)
        return left, 1.0 if cos(angle_between(st.h[j], axis)) >= 0.0 else -1.0
    ahead, left, direction = along_roads(n, st, i, st.road[j], st.s[j], st.t[j], st.x[j], st.y[j])
    if ahead >= op.FAR:
        return op.FAR, 1.0
    return left, 1.0 if cos(turned_against(n, st.road[j], st.s[j], direction, st.h[j])) >= 0.0 else -1.0


@compiled
def widths_between(p: Program, k: int) -> float:
    """Return the part of the distance between reference points that the boxes cover, m."""
    if p.action_flags[k] & op.FLAG_FREESPACE == 0:
        return 0.0
    own = p.const[p.entity_const[p.action_entity[k]] + slot.E_WIDTH]
    return 0.5 * (own + p.const[p.entity_const[p.action_other[k]] + slot.E_WIDTH])


@compiled
def start_keep_aside(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Determine side and distance; the present ones if the action leaves them open."""
    st.lateral[p.action_entity[k]] = k
    flags = p.action_flags[k]
    left, same = left_between(n, p, st, k)
    side = 1.0
    if flags & op.FLAG_BEHIND != 0 or (flags & op.FLAG_AHEAD == 0 and same * left > 0.0):
        side = -1.0
    st.action_a[k] = side
    st.action_b[k] = p.const[p.action_const[k] + slot.A_TARGET]
    if flags & op.FLAG_PRESENT != 0 and left < op.FAR:
        st.action_b[k] = -side * same * left - widths_between(p, k)
    st.action_change[k] = 0.0
    st.action_span[k] = 0.0


@compiled
def shift_by(n: RoadTables, st: State, i: int, left: float) -> None:
    """Move a scripted entity to the left within its lane; its heading does not change."""
    centre, _ = lane_centre(n, st.road[i], st.kept_lane[i], st.s[i])
    st.kept_off[i] += st.facing[i] * left
    st.t[i] = centre + st.kept_off[i]


@compiled
def step_keep_aside(n: RoadTables, p: Program, st: State, k: int, dt: float) -> int:
    """Advance towards the distance; return 1 if it is reached and need not be kept."""
    i = p.action_entity[k]
    if p.action_other[k] < 0:
        return 1
    if st.action_progress[k] <= 0.0:
        st.action_progress[k] = 1.0
        return 0
    left, same = left_between(n, p, st, k)
    if left >= op.FAR:
        return 0
    error = left + same * st.action_a[k] * (st.action_b[k] + widths_between(p, k))
    flags = p.action_flags[k]
    if p.entity_motion[i] != op.MOTION_SCRIPTED:
        if i == p.ego[0]:
            aside = st.path_off[0] + error
            plan_shift(st, i, aside, shift_distance(st.v[i], error, 1.0))
        return 1
    if dt <= 0.0:
        return 0
    done = 1 if abs(error) < NEAR_ASIDE and flags & op.FLAG_CONTINUOUS == 0 else 0
    if st.road[i] < 0:
        steer_aside(p, st, k, error, dt)
    elif flags & op.FLAG_LIMITED != 0:
        drive_aside(n, p, st, k, error, dt)
    else:
        shift_by(n, st, i, error)
        st.turn[i] = drift_angle(st, i, error, abs(st.v[i]) * dt) if abs(error) > op.TOLERANCE else 0.0
        place_scripted(n, st, i)
    return done


@compiled
def steer_aside(p: Program, st: State, k: int, error: float, dt: float) -> None:
    """Turn an entity that is off every road towards the distance, within its acceleration."""
    i = p.action_entity[k]
    j = p.action_other[k]
    if abs(st.v[i]) < op.TOLERANCE:
        return
    most = limit_or(p, k, slot.A_ACCELERATION, p.const[p.entity_const[i] + slot.E_MAX_ACCELERATION])
    speed = st.v[i] * sin(angle_between(st.h[i], st.h[j])) - drift(st, j)
    turn = spring_acceleration(error, speed, most, most, most) * dt / st.v[i]
    st.h[i] = wrap_heading(st.h[i] + turn)


@compiled
def drift(st: State, j: int) -> float:
    """Return an entity's speed to the left of its own heading, from its motion in the last step, m/s."""
    return st.velocity_y[j] * cos(st.h[j]) - st.velocity_x[j] * sin(st.h[j])


@compiled
def drive_aside(n: RoadTables, p: Program, st: State, k: int, error: float, dt: float) -> None:
    """Move sideways for one step by the spring within the limits, and ahead by the rest of the distance driven.

    `action_change` stores the speed to the left between steps, `action_span` the acceleration.
    """
    i = p.action_entity[k]
    fastest = limit_or(p, k, slot.A_MOST_SPEED, op.FAR)
    most = limit_or(p, k, slot.A_ACCELERATION, p.const[p.action_const[k] + slot.A_DECELERATION])
    speed = error / max(dt, op.TOLERANCE)
    if most >= 0.0:
        vanishing = st.action_change[k] - drift(st, p.action_other[k])
        acceleration = spring_acceleration(error, vanishing, most, most, most)
        st.action_span[k] = within_jerk(p, k, st.action_span[k], acceleration, dt)
        speed = st.action_change[k] + st.action_span[k] * dt
    speed = clip(speed, -fastest, fastest)
    st.action_change[k] = speed
    path = abs(st.v[i]) * dt
    side = clip(speed * dt, -path, path)
    ahead = safe_sqrt(path * path - side * side)
    st.turn[i] = drift_angle(st, i, side, ahead) if abs(side) > op.TOLERANCE else 0.0
    shift_by(n, st, i, side)
    glide(n, p, st, i, ahead if st.v[i] > 0.0 else -ahead)
    st.moved[i] = 1
    place_scripted(n, st, i)


def keep_lateral_distance_row(draft: ProgramDraft, word: LateralDistanceAction, actor: int) -> ActionRow:
    """Return the row of a lateral distance."""
    del actor
    draft.program.watches[0] |= WATCH_MOTION
    return ActionRow(
        (0.0 if word.distance is None else word.distance, 0.0, *limits_of(word.limits)),
        other=draft.entities[word.to],
        mode=FRAMES[word.coordinates],
        flags=flags_of(
            (op.FLAG_CONTINUOUS, word.continuous),
            (op.FLAG_FREESPACE, word.freespace),
            (op.FLAG_PRESENT, word.distance is None),
            (op.FLAG_LIMITED, word.limits is not None),
            (op.FLAG_BEHIND, word.displacement == "rightToReferencedEntity"),
            (op.FLAG_AHEAD, word.displacement == "leftToReferencedEntity"),
        ),
    )


KEEP_LATERAL_DISTANCE = Entry(
    ("keep_lateral_distance",),
    keep_lateral_distance_row,
    start_keep_aside,
    step_keep_aside,
    holds=HOLDS_LANE,
    relative=RELATIVE_THROUGHOUT,
    refers={"other": index(ENTITY)},
)
