"""Moves to an offset from the lane's centre: over a time, or as fast as a lateral acceleration allows.

A move over a time works like a lane change. A move limited by its acceleration takes its position from the progress
before the step, so it begins one step late; its heading follows from the lateral rate over the speed, and it does not
change the motion ahead. Its offset is measured along the t axis of the road. After esmini 3.6.
"""

from __future__ import annotations

from math import atan, pi
from typing import TYPE_CHECKING

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.log import fault
from scenario_compiler.engine.columns.numbers import is_number, safe_sqrt
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.rows import SHAPES, ActionRow, ProgramDraft, flags_of
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.beside import settle_in_lane
from scenario_compiler.engine.motion.entities import place_scripted
from scenario_compiler.engine.motion.shapes import shape_slope, shape_value, transition_span
from scenario_compiler.engine.motion.steering import plan_shift, shift_distance
from scenario_compiler.engine.moves.entry import HOLDS_LANE, RELATIVE_AT_START, Entry
from scenario_compiler.engine.moves.lane_changes import OFFSET_ACCELERATION, step_lane_change
from scenario_compiler.marker import compiled
from scenario_compiler.roads.lanes import lane_centre
from scenario_compiler.roads.tables import RoadTables

if TYPE_CHECKING:
    from scenario_compiler.vocabulary.actions import LaneOffsetAction, LimitedLaneOffsetAction

USUAL_ACCELERATION = 0.5
"""Lateral acceleration of a move without a given one, m/s2 (esmini 3.6)."""


@compiled
def start_lane_offset(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Prepare a move to an offset from the lane's centre; the ego's automation plans it and steers by itself."""
    del n
    i = p.action_entity[k]
    base = p.action_const[k]
    left = p.const[base + slot.A_TARGET]
    st.action_from[k] = 0.0
    st.action_change[k] = 0.0
    st.action_span[k] = 0.0
    st.lateral[i] = k
    if st.road[i] < 0:
        return
    if p.entity_motion[i] != op.MOTION_SCRIPTED:
        if i == p.ego[0]:
            least = shift_distance(st.v[i], left - st.path_off[0], OFFSET_ACCELERATION)
            plan_shift(st, i, left, max(least, st.v[i] * p.const[base + slot.A_DYNAMICS]))
        return
    settle_in_lane(st, i)
    st.turn[i] = 0.0
    st.action_from[k] = st.facing[i] * st.kept_off[i]
    st.action_change[k] = left - st.action_from[k]
    value = p.const[base + slot.A_DYNAMICS]
    st.action_span[k] = transition_span(p.action_shape[k], p.action_dimension[k], value, st.action_change[k])


@compiled
def offset_aimed_at(n: RoadTables, p: Program, st: State, k: int) -> float:
    """Return the target offset from the lane's centre, along the t axis, m.

    An offset relative to another entity is measured to that entity's left, from its position, or, if it is on another
    road, from its offset in its lane.
    """
    i = p.action_entity[k]
    target = p.const[p.action_const[k] + slot.A_TARGET]
    of = p.action_other[k]
    if of < 0 or st.road[of] < 0:
        return target
    left = st.facing[of] * target
    if st.road[of] != st.road[i]:
        return left + st.off[of]
    centre, _ = lane_centre(n, st.road[i], st.kept_lane[i], st.s[i])
    return left + st.t[of] - centre


@compiled
def limited_span(shape: int, change: float, acceleration: float) -> float:
    """Return the duration of a move with a greatest lateral acceleration, s; a linear one lasts as long as a cubic."""
    if shape == op.SHAPE_STEP:
        return 0.0
    most = max(acceleration if acceleration > op.TOLERANCE else USUAL_ACCELERATION, op.TOLERANCE)
    if shape == op.SHAPE_SINUSOIDAL:
        return pi * safe_sqrt(abs(change) / (2.0 * most))
    return safe_sqrt(6.0 * abs(change) / most)


@compiled
def start_limited_offset(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Prepare a move limited by its lateral acceleration; the ego's automation plans it and steers by itself."""
    i = p.action_entity[k]
    acceleration = p.const[p.action_const[k] + slot.A_DYNAMICS]
    st.action_from[k] = 0.0
    st.action_change[k] = 0.0
    st.action_span[k] = 0.0
    st.lateral[i] = k
    if st.road[i] < 0:
        return
    if is_number(p.const[p.action_const[k] + slot.A_TARGET]) == 0:
        fault(st, op.FAULT_NOT_FINITE, i)
        return
    if p.entity_motion[i] != op.MOTION_SCRIPTED:
        if i == p.ego[0]:
            left = st.facing[i] * offset_aimed_at(n, p, st, k)
            most = acceleration if acceleration > op.TOLERANCE else USUAL_ACCELERATION
            plan_shift(st, i, left, shift_distance(st.v[i], left - st.path_off[0], most))
        return
    settle_in_lane(st, i)
    st.action_from[k] = st.facing[i] * st.kept_off[i]
    st.action_change[k] = st.facing[i] * offset_aimed_at(n, p, st, k) - st.action_from[k]
    st.action_span[k] = limited_span(p.action_shape[k], st.action_change[k], acceleration)


@compiled
def step_limited_offset(n: RoadTables, p: Program, st: State, k: int, dt: float) -> int:
    """Advance a move limited by its lateral acceleration; return 1 if it is complete; a continuous one never is.

    A continuous offset from an entity ends when that is absent. An absolute offset stays on the side that it had at the
    start, also on a road with the opposite direction of s.
    """
    i = p.action_entity[k]
    if p.entity_motion[i] != op.MOTION_SCRIPTED or st.road[i] < 0:
        return 1
    span = st.action_span[k]
    progress = st.action_progress[k]
    continuous = 1 if p.action_flags[k] & op.FLAG_CONTINUOUS else 0
    if progress >= span - op.TOLERANCE:
        st.turn[i] = 0.0
        left = st.action_from[k] + st.action_change[k]
        of = p.action_other[k]
        if continuous == 1 and of >= 0 and of != i:
            if st.present[of] == 0:
                return 1
            left = st.facing[i] * offset_aimed_at(n, p, st, k)
        st.kept_off[i] = st.facing[i] * left
        place_scripted(n, st, i)
        return 1 - continuous
    long = max(span, op.TOLERANCE)
    share = progress / long
    rate = st.action_change[k] * shape_slope(p.action_shape[k], share) / long
    st.turn[i] = atan(rate / st.v[i]) if abs(st.v[i]) > op.TOLERANCE else 0.0
    done = shape_value(st, p.action_shape[k], share)
    left = st.action_from[k] + st.action_change[k] * done
    st.kept_off[i] = st.facing[i] * left
    st.action_progress[k] = progress + dt
    place_scripted(n, st, i)
    return 0


def lane_offset_row(draft: ProgramDraft, word: LaneOffsetAction, actor: int) -> ActionRow:
    """Return the row of a move to an offset over a time."""
    del draft, actor
    return ActionRow((word.to, word.over_time), shape=SHAPES[word.shape])


def limited_lane_offset_row(draft: ProgramDraft, word: LimitedLaneOffsetAction, actor: int) -> ActionRow:
    """Return the row of a move to an offset within a lateral acceleration."""
    del actor
    return ActionRow(
        (word.to, -1.0 if word.acceleration is None else word.acceleration),
        shape=SHAPES[word.shape],
        other=draft.entities[word.of] if word.of else op.NONE,
        flags=flags_of((op.FLAG_CONTINUOUS, word.continuous)),
    )


LANE_OFFSET = Entry(("lane_offset",), lane_offset_row, start_lane_offset, step_lane_change, holds=HOLDS_LANE)
LIMITED_LANE_OFFSET = Entry(
    ("limited_lane_offset",),
    limited_lane_offset_row,
    start_limited_offset,
    step_limited_offset,
    holds=HOLDS_LANE,
    relative=RELATIVE_AT_START,
)
