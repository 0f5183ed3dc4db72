"""Following a trajectory: at the entity's own speed, or by the trajectory's times. After esmini 3.6.

Without timing, the distance along it grows by speed times step. An entity that drives backwards at the start faces
against the trajectory, so that it still moves along it; if the vertices have headings, these determine its direction of
motion. The part of the last step beyond the end goes straight on. With timing, the position is that of the time after
the step, and the speed is the distance over the step. A trajectory ends at its end, or at its last time; a closed one
without timing continues at its beginning. With timing it controls the speed too, so it ends a running change of speed,
and a later one ends it ("conflicting actions", ASAM OpenSCENARIO).

An entity that is elsewhere leaps to its trajectory: to the distance `begin`, or to the present time. The leap counts
neither for the odometer nor for the speed.
"""

from __future__ import annotations

from math import cos, pi
from typing import TYPE_CHECKING

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.numbers import ratio
from scenario_compiler.engine.columns.program import TRACK, Program
from scenario_compiler.engine.columns.rows import ActionRow, ProgramDraft, flags_of
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.free import place_free
from scenario_compiler.engine.motion.laying import lay_track, pace_vertices
from scenario_compiler.engine.motion.tracks import (
    beside_track,
    distance_at_time,
    time_at_distance,
    track_height,
    track_is_timed,
    track_length,
    track_pose,
)
from scenario_compiler.engine.moves.entry import HOLDS_LANE, Entry
from scenario_compiler.forms.declaration import index
from scenario_compiler.marker import compiled
from scenario_compiler.roads.geometry import wrap_heading
from scenario_compiler.roads.tables import RoadTables

if TYPE_CHECKING:
    from scenario_compiler.vocabulary.actions import FollowTrajectoryAction


@compiled
def keeps_times(p: Program, st: State, k: int) -> int:
    """Return 1 if an action follows its trajectory by times."""
    return 1 if p.action_mode[k] != op.TIMING_NONE and track_is_timed(p, st, p.action_other[k]) == 1 else 0


@compiled
def heads_itself(p: Program, track: int) -> int:
    """Return 1 if a trajectory's vertices have given headings."""
    return 1 if p.track_kind[track] != op.TRACK_CLOTHOIDS and p.vertex_heading[p.track_vertex[track]] == 1 else 0


@compiled
def put_on_track(n: RoadTables, p: Program, st: State, k: int, s: float, beyond: float) -> int:
    """Put an entity at a distance along its trajectory, or straight on beyond its end.

    Its height is that of the trajectory if given, otherwise that of the road surface. Returns 1 if the entity faces in
    the trajectory's direction, else -1.
    """
    i = p.action_entity[k]
    smooth = 1 if p.action_flags[k] & op.FOLLOW_SMOOTHLY != 0 else 0
    x, y, h, along = track_pose(p, st, p.action_other[k], s, smooth)
    h = h + st.action_from[k]
    x, y = beside_track(x, y, along, beyond, 0.0)
    st.action_a[k] = s
    st.x[i] = x
    st.y[i] = y
    st.h[i] = wrap_heading(h)
    place_free(n, st, i)
    sense = 1 if cos(h - along) >= 0.0 else -1
    if p.track_raised[p.action_other[k]] == 1:
        z, pitch = track_height(p, st, p.action_other[k], s)
        st.z[i] = z
        st.pitch[i] = sense * pitch
        st.roll[i] = 0.0
    return sense


@compiled
def time_on_track(p: Program, st: State, k: int, clock: float) -> float:
    """Return the time on a trajectory at a time of the run; relative timing counts from the start of the action.

    "The time that would be taken to reach this point is deducted from all calculated waypoint time values"
    (initialDistanceOffset, ASAM OpenSCENARIO): `action_span` stores it.
    """
    base = p.action_const[k]
    scale = p.const[base + slot.J_SCALE]
    time = st.action_b[k]
    if p.action_mode[k] == op.TIMING_ABSOLUTE:
        time = ratio(clock, scale, clock) + st.action_span[k]
    return time - ratio(p.const[base + slot.J_OFFSET], scale, 0.0)


@compiled
def start_trajectory(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Compute the trajectory and put the entity on it; a standing entity takes the trajectory's first speed."""
    i = p.action_entity[k]
    if p.entity_motion[i] != op.MOTION_SCRIPTED:
        return
    track = p.action_other[k]
    lay_track(n, p, st, track, i)
    timed = keeps_times(p, st, k)
    smooth = p.action_flags[k] & op.FOLLOW_SMOOTHLY != 0
    if timed == 1:
        pace_vertices(p, st, track, abs(st.v[i]), 1 if smooth else 0)
    begin = p.const[p.action_const[k] + slot.J_BEGIN]
    st.action_from[k] = pi if timed == 0 and heads_itself(p, track) == 0 and st.v[i] < 0.0 else 0.0
    st.action_b[k] = time_at_distance(p, st, track, begin)
    st.action_span[k] = st.action_b[k] - time_at_distance(p, st, track, 0.0)
    st.lateral[i] = k
    if p.action_flags[k] & op.FLAG_TIMED != 0:
        st.longitudinal[i] = k
    st.ended[i] = 0
    s = begin
    if timed == 1:
        s = max(distance_at_time(p, st, track, time_on_track(p, st, k, st.clock[0])), begin)
    sense = put_on_track(n, p, st, k, s, 0.0)
    st.last_x[i] = st.x[i]
    st.last_y[i] = st.y[i]
    st.action_change[k] = 1.0 * sense
    if timed == 1 and st.v[i] == 0.0 and p.track_kind[track] == op.TRACK_POLYLINE:
        st.v[i] = sense * st.track_v[p.track_vertex[track]]


@compiled
def step_by_time(n: RoadTables, p: Program, st: State, k: int, dt: float) -> int:
    """Move an entity to its trajectory's position at the time after dt; return 1 if the last time has been reached."""
    i = p.action_entity[k]
    track = p.action_other[k]
    st.action_b[k] += ratio(dt, p.const[p.action_const[k] + slot.J_SCALE], dt)
    time = time_on_track(p, st, k, st.clock[0] + dt)
    last = st.track_time[p.track_vertex[track + 1] - 1]
    before = st.action_a[k]
    s = max(distance_at_time(p, st, track, time), p.const[p.action_const[k] + slot.J_BEGIN])
    beyond = max(time - last, 0.0) * abs(st.v[i])
    sense = put_on_track(n, p, st, k, s, beyond)
    if dt > 0.0 and time < last + op.TOLERANCE:
        st.v[i] = sense * (s - before) / dt
    return 1 if time >= last - op.TOLERANCE else 0


@compiled
def move_on_track(n: RoadTables, p: Program, st: State, k: int, distance: float) -> int:
    """Move an entity a signed distance forwards along its trajectory; return 1 if it has reached an end of it.

    If the vertices have headings, the part of the distance beyond the end goes in the direction that the entity faces,
    even if it reverses.
    """
    track = p.action_other[k]
    length = track_length(p, st, track)
    sense = st.action_change[k]
    ds = sense * distance
    s = st.action_a[k] + ds
    if p.track_closed[track] == 1 and length > op.TOLERANCE:
        put_on_track(n, p, st, k, s % length, 0.0)
        return 0
    beyond = max(s - length, 0.0)
    if heads_itself(p, track) == 1:
        beyond = sense * beyond
    put_on_track(n, p, st, k, min(max(s, 0.0), length), beyond)
    return 1 if (ds > 0.0 and s > length - op.TOLERANCE) or (ds < 0.0 and s < op.TOLERANCE) else 0


@compiled
def step_trajectory(n: RoadTables, p: Program, st: State, k: int, dt: float) -> int:
    """Move an entity along its trajectory; return 1 if it has reached the end.

    Off every road it stays there.
    """
    i = p.action_entity[k]
    if p.entity_motion[i] != op.MOTION_SCRIPTED:
        return 1
    st.moved[i] = 1
    if keeps_times(p, st, k) == 1:
        done = step_by_time(n, p, st, k, dt)
    else:
        done = move_on_track(n, p, st, k, st.v[i] * dt)
    if done == 1 and st.road[i] < 0:
        st.ended[i] = 1
    return done


TIMINGS = {"absolute": op.TIMING_ABSOLUTE, "relative": op.TIMING_RELATIVE}
"""Codes of the reference of a trajectory's times."""


def follow_trajectory_row(draft: ProgramDraft, word: FollowTrajectoryAction, actor: int) -> ActionRow:
    """Return the row of a trajectory that is followed; without times it leaves the speed to other actions."""
    del actor
    timing = word.timing
    timed = timing is not None and all(time is not None for _, time in word.trajectory.times)
    scale, offset = (1.0, 0.0) if timing is None else (timing.scale, timing.offset)
    return ActionRow(
        (word.begin, offset, scale),
        other=draft.track(word.trajectory),
        mode=op.TIMING_NONE if timing is None else TIMINGS[timing.domain],
        flags=flags_of(
            (op.FLAG_OWN_PATH, True),
            (op.FLAG_ON_TRACK, True),
            (op.FLAG_TIMED, timed),
            (op.FOLLOW_SMOOTHLY, word.following == "follow"),
        ),
    )


FOLLOW_TRAJECTORY = Entry(
    ("follow_trajectory",),
    follow_trajectory_row,
    start_trajectory,
    step_trajectory,
    holds=HOLDS_LANE,
    refers={"other": index(TRACK)},
)
