"""Actions on an entity's speed: to an absolute target, or to one relative to another entity's speed.

The speed is taken at the progress after the step, so it changes in the first step already. A relative target is
evaluated again in every step. A change by a rate keeps its rate while the target moves, so its duration is computed
again for the whole change ("rate: change per second", ASAM OpenSCENARIO, DynamicsDimension); a target that has been
reached is then followed exactly. A change that exceeds the entity's limits takes longer; accelerations that still
exceed them are limited. After esmini 3.6.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.numbers import clip, ratio
from scenario_compiler.engine.columns.program import ENTITY, Program
from scenario_compiler.engine.columns.rows import SHAPES, ActionRow, ProgramDraft, dynamics_of, flags_of
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.shapes import shape_peak, shape_value, transition_span
from scenario_compiler.engine.moves.entry import HOLDS_SPEED, RELATIVE_THROUGHOUT, Entry
from scenario_compiler.forms.declaration import index
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables

if TYPE_CHECKING:
    from scenario_compiler.vocabulary.actions import RelativeSpeedAction, SpeedAction

AUTOMATION_LEAD = 2.0
"""Prediction time with which an acceleration of the ego is turned into a target speed of the automation, s; chosen."""


@compiled
def set_speed(p: Program, st: State, i: int, speed: float) -> None:
    """Set a scripted entity's speed, or the speed that the ego's automation aims for."""
    if p.entity_motion[i] == op.MOTION_SCRIPTED:
        st.v[i] = speed
    elif i == p.ego[0]:
        st.target_speed[0] = max(speed, 0.0)


@compiled
def push_speed(p: Program, st: State, i: int, acceleration: float, most: float, dt: float) -> None:
    """Let an entity accelerate for a step, within a speed; for the ego, set the target speed accordingly."""
    if p.entity_motion[i] == op.MOTION_SCRIPTED:
        set_speed(p, st, i, clip(st.v[i] + acceleration * dt, -most, most))
        return
    limit = greatest_rate(p, i, acceleration)
    set_speed(p, st, i, clip(st.v[i] + clip(acceleration, -limit, limit) * AUTOMATION_LEAD, -most, most))


@compiled
def speed_before(p: Program, st: State, i: int) -> float:
    """Return the speed that `set_speed` would change, m/s."""
    if p.entity_motion[i] != op.MOTION_SCRIPTED and i == p.ego[0]:
        return st.target_speed[0]
    return st.v[i]


@compiled
def greatest_rate(p: Program, i: int, change: float) -> float:
    """Return the greatest acceleration of an entity, or its greatest deceleration if the change is negative, m/s2."""
    return max(p.const[p.entity_const[i] + (slot.E_MAX_ACCELERATION if change > 0.0 else slot.E_MAX_DECELERATION)], 0.0)


@compiled
def related_speed(speed: float, mode: int, value: float) -> float:
    """Return a speed plus a value, or multiplied by it."""
    if mode == op.MODE_FACTOR:
        return speed * value
    return speed + value


@compiled
def wanted_speed(p: Program, st: State, k: int) -> float:
    """Return the present target of a change of speed, within the entity's greatest speed, m/s.

    A target relative to the entity itself is relative to its speed at the start.
    """
    i = p.action_entity[k]
    value = p.const[p.action_const[k] + slot.A_TARGET]
    other = p.action_other[k]
    if other >= 0:
        value = related_speed(st.action_from[k] if other == i else st.v[other], p.action_mode[k], value)
    most = p.const[p.entity_const[i] + slot.E_MAX_SPEED]
    return clip(value, -most, most)


@compiled
def time_over_distance(begin: float, target: float, distance: float) -> float:
    """Return the time of a change of speed over a distance, s; 0 if the entity would not move at all.

    Without a change of sign, the mean speed is the mean of both; otherwise the distances on both sides of 0 are added.
    """
    if begin * target < 0.0:
        both = abs(begin) + abs(target)
        return 2.0 * distance * both / max(begin * begin + target * target, 1.0e-9)
    mean = 0.5 * abs(begin + target)
    return distance / mean if mean > 1.0e-9 else 0.0


@compiled
def start_speed(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Prepare a change of speed; if its peak exceeds the entity's limits, it takes longer, unless it is a step."""
    del n
    i = p.action_entity[k]
    begin = speed_before(p, st, i)
    st.action_from[k] = begin
    target = wanted_speed(p, st, k)
    change = target - begin
    span = transition_span(
        p.action_shape[k], p.action_dimension[k], p.const[p.action_const[k] + slot.A_DYNAMICS], change
    )
    if p.action_dimension[k] == op.DIMENSION_DISTANCE and span > 0.0:
        span = time_over_distance(begin, target, span) if abs(change) > op.TOLERANCE else 0.0
    st.action_a[k] = 1.0
    if span > 0.0:
        limit = greatest_rate(p, i, change)
        least = shape_peak(p.action_shape[k]) * ratio(abs(change), limit, 0.0)
        st.action_a[k] = max(ratio(least, span, 1.0), 1.0)
        span = span * st.action_a[k]
    else:
        set_speed(p, st, i, target)
    st.action_change[k] = change
    st.action_span[k] = span
    st.longitudinal[i] = k


@compiled
def span_to_moving_target(p: Program, st: State, k: int) -> float:
    """Return the duration of a change to a speed that has moved, s: that of the whole change if a rate is given.

    A duration that was extended because of the entity's limits is extended by the same factor (esmini 3.6).
    """
    if p.action_dimension[k] != op.DIMENSION_RATE:
        return st.action_span[k]
    rate = p.const[p.action_const[k] + slot.A_DYNAMICS]
    return st.action_a[k] * transition_span(p.action_shape[k], op.DIMENSION_RATE, rate, st.action_change[k])


@compiled
def step_speed(n: RoadTables, p: Program, st: State, k: int, dt: float) -> int:
    """Set the speed of a change after dt; return 1 in the step that reaches the target.

    A step that the entity's limits reduce counts with the share that they allow.
    """
    del n
    i = p.action_entity[k]
    continuous = p.action_flags[k] & op.FLAG_CONTINUOUS
    if p.action_other[k] >= 0:
        st.action_change[k] = wanted_speed(p, st, k) - st.action_from[k]
        if st.action_progress[k] < st.action_span[k] - op.TOLERANCE:
            st.action_span[k] = span_to_moving_target(p, st, k)
    elif st.action_span[k] <= 0.0:
        return 1
    span = st.action_span[k]
    before = speed_before(p, st, i)
    progress = min(st.action_progress[k] + dt, span)
    share = 1.0
    if progress < span - op.TOLERANCE:
        share = shape_value(st, p.action_shape[k], progress / max(span, op.TOLERANCE))
    asked = st.action_from[k] + st.action_change[k] * share - before
    limit = greatest_rate(p, i, asked) * dt
    done = clip(asked, -limit, limit)
    if abs(asked - done) <= op.TOLERANCE:
        st.action_progress[k] = progress
        set_speed(p, st, i, st.action_from[k] + st.action_change[k] * share)
        return 1 if progress >= span - op.TOLERANCE and continuous == 0 else 0
    if st.action_progress[k] < span - op.TOLERANCE:
        progress = st.action_progress[k] + dt * ratio(done, asked, 1.0)
    st.action_progress[k] = progress
    set_speed(p, st, i, before + done)
    return 0


def speed_row(draft: ProgramDraft, word: SpeedAction, actor: int) -> ActionRow:
    """Return the row of a change to a speed."""
    del draft, actor
    value, dimension = dynamics_of(word.over_time, word.dynamics)
    return ActionRow((word.to, value), shape=SHAPES[word.shape], dimension=dimension)


def relative_speed_row(draft: ProgramDraft, word: RelativeSpeedAction, actor: int) -> ActionRow:
    """Return the row of a change to a speed relative to another entity's."""
    del actor
    value, dimension = dynamics_of(word.over_time, word.dynamics)
    return ActionRow(
        (word.value, value),
        shape=SHAPES[word.shape],
        dimension=dimension,
        other=draft.entities[word.to],
        mode=op.MODE_DELTA if word.kind == "delta" else op.MODE_FACTOR,
        flags=flags_of((op.FLAG_CONTINUOUS, word.continuous)),
    )


SPEED = Entry(("speed",), speed_row, start_speed, step_speed, holds=HOLDS_SPEED)
RELATIVE_SPEED = Entry(
    ("relative_speed",),
    relative_speed_row,
    start_speed,
    step_speed,
    holds=HOLDS_SPEED,
    relative=RELATIVE_THROUGHOUT,
    refers={"other": index(ENTITY)},
)
