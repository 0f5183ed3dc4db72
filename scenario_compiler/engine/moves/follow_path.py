"""Motion along a path of points in the plane, at the entity's speed or by the points' times.

The entity's position on the road is looked up in each step for conditions and sensors; off all roads it has none.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.log import fault
from scenario_compiler.engine.columns.numbers import bearing, clip, length_of
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.rows import ActionRow, ProgramDraft
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.free import place_free
from scenario_compiler.engine.motion.on_tracks import point_at
from scenario_compiler.engine.moves.entry import HOLDS_LANE, Entry
from scenario_compiler.marker import compiled
from scenario_compiler.roads.geometry import wrap_heading
from scenario_compiler.roads.tables import RoadTables

if TYPE_CHECKING:
    from scenario_compiler.vocabulary.actions import FollowPathAction
    from scenario_compiler.vocabulary.actions.path import Path


@compiled
def path_goes_on(p: Program, st: State, k: int, i: int, progress: float) -> int:
    """Put the entity on its path after a distance or a time; return 1 if the path continues, 0 at its end.

    Legs without length, or without duration, are passed at once.
    """
    first = p.action_point[k]
    last = first + p.action_points[k]
    timed = 1 if p.const[p.point_const[first] + slot.G_TIME] >= 0.0 else 0
    x = st.action_x[k]
    y = st.action_y[k]
    begin = 0.0
    for q in range(first, last):
        at = p.point_position[q]
        dx = st.position_x[at] - x
        dy = st.position_y[at] - y
        far = length_of(dx, dy)
        end = begin + far
        if timed == 1:
            end = max(begin, p.const[p.point_const[q] + slot.G_TIME])
        span = end - begin
        if progress < end - op.TOLERANCE or q == last - 1:
            share = clip((progress - begin) / span, 0.0, 1.0) if span > op.TOLERANCE else 1.0
            st.x[i] = x + share * dx
            st.y[i] = y + share * dy
            if far > op.TOLERANCE:
                st.h[i] = wrap_heading(bearing(dx, dy))
            if timed == 1:
                st.v[i] = far / span if span > op.TOLERANCE else 0.0
            return 1 if progress < end - op.TOLERANCE else 0
        x = x + dx
        y = y + dy
        begin = end
    return 0


@compiled
def start_follow_path(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Begin a path at its entity's position; an entity that stood at the end of another path moves again.

    The points that `reset_positions` leaves open are where they are now.
    """
    i = p.action_entity[k]
    if p.entity_motion[i] != op.MOTION_SCRIPTED:
        return
    for q in range(p.action_point[k], p.action_point[k] + p.action_points[k]):
        at = p.point_position[q]
        found, x, y = point_at(n, p, st, at, i)
        if found == 0 or x >= op.FAR:
            fault(st, op.FAULT_OFF_ROAD_START, i)
        st.position_x[at] = x
        st.position_y[at] = y
    st.action_x[k] = st.x[i]
    st.action_y[k] = st.y[i]
    st.lateral[i] = k
    st.ended[i] = 0
    speed = p.const[p.action_const[k]]
    if speed >= 0.0:
        st.v[i] = speed


@compiled
def step_follow_path(n: RoadTables, p: Program, st: State, k: int, dt: float) -> int:
    """Move an entity along its path; return 1 if it has reached the end."""
    i = p.action_entity[k]
    if p.entity_motion[i] != op.MOTION_SCRIPTED or p.action_points[k] <= 0:
        return 1
    by_time = p.const[p.point_const[p.action_point[k]] + slot.G_TIME] >= 0.0
    st.action_progress[k] += dt if by_time else max(st.v[i], 0.0) * dt
    goes_on = path_goes_on(p, st, k, i, st.action_progress[k])
    place_free(n, st, i)
    st.moved[i] = 1
    if goes_on == 1:
        return 0
    if p.action_drives_on[k] == 1 and st.road[i] >= 0:
        st.turn[i] = 0.0
    else:
        st.v[i] = 0.0
        st.ended[i] = 1
    return 1


def follow_path_row(draft: ProgramDraft, word: FollowPathAction | Path, actor: int) -> ActionRow:
    """Return the row of a path of points."""
    del actor
    p = draft.program
    first = len(p.point_position)
    for point in word.points:
        p.point_position.append(draft.position(point.position))
        p.point_const.append(draft.block(-1.0 if point.time is None else point.time))
    speed = -1.0 if word.speed is None else word.speed
    drives_on = 1 if word.then == "drive" else 0
    count = len(word.points)
    return ActionRow((speed, 0.0), flags=op.FLAG_OWN_PATH, point=first, points=count, drives_on=drives_on)


FOLLOW_PATH = Entry(("follow_path", "path"), follow_path_row, start_follow_path, step_follow_path, holds=HOLDS_LANE)
