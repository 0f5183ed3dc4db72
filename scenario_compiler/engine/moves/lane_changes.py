"""Lane changes: to a neighbouring lane, counted from the entity's own or another one's, or to the lane of an id.

The entity follows its new lane from the beginning, offset by the gap to it. Offsets of a running change are relative to
the entity's forward direction, so that a road with the opposite direction of s does not mirror them. By time or rate,
the speed is that along the path: the lateral motion reduces the motion ahead. The position follows from the progress
after the step, the heading from the slope before it. After esmini 3.6.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.log import fault, log_event
from scenario_compiler.engine.columns.numbers import is_number, safe_sqrt
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.rows import SHAPES, ActionRow, ProgramDraft, dynamics_of
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.beside import count_lanes, own_lane, settle_in_lane
from scenario_compiler.engine.motion.entities import drift_angle, glide, place_scripted
from scenario_compiler.engine.motion.path import measure_path, set_path
from scenario_compiler.engine.motion.shapes import shape_slope, shape_value, transition_span
from scenario_compiler.engine.motion.steering import plan_shift, shift_distance
from scenario_compiler.engine.moves.entry import HOLDS_LANE, RELATIVE_AT_START, Entry
from scenario_compiler.marker import compiled
from scenario_compiler.roads.lanes import lane_centre, lane_exists
from scenario_compiler.roads.tables import RoadTables

if TYPE_CHECKING:
    from scenario_compiler.vocabulary.actions import LaneChangeAction, LaneChangeToAction

LANES_AWAY = 0
LANE_BY_ID = 1
"""Whether a change counts lanes, or gives the lane by its id."""

OFFSET_ACCELERATION = 1.0
"""Greatest lateral acceleration with which the automation moves the ego to an offset, m/s2."""

CHANGE_ACCELERATION = 3.0
"""Greatest lateral acceleration with which the automation changes lanes in a given time, m/s2; chosen."""


@compiled
def lane_aimed_at(n: RoadTables, p: Program, st: State, k: int) -> int:
    """Return the target lane of a change, on the road of its entity; 0 if there is none.

    Lanes are counted to the left, as seen in the forward direction, from the lane of the entity itself or of another
    one.
    """
    i = p.action_entity[k]
    target = p.action_lanes[k]
    if p.action_mode[k] == LANES_AWAY:
        of = p.action_other[k]
        if of < 0:
            of = i
        if st.road[of] < 0:
            return 0
        lane, _ = own_lane(p, st, of)
        target = count_lanes(lane, p.action_lanes[k], st.facing[of])
    return target if lane_exists(n, st.road[i], target, st.s[i]) == 1 else 0


@compiled
def start_lane_change(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Fix the target lane and let the entity follow it, offset by the present gap, with its heading along the lane.

    For the ego, the target becomes the lane of its path, and the automation steers there over the time or distance that
    is given; if none is, as soon as it can. If the target does not exist, the change is 0, which is logged.
    """
    i = p.action_entity[k]
    road = st.road[i]
    st.action_from[k] = 0.0
    st.action_change[k] = 0.0
    st.action_span[k] = 0.0
    st.lateral[i] = k
    if road < 0:
        log_event(st, op.EVENT_NO_LANE, 1.0 * i)
        return
    offset = p.const[p.action_const[k] + slot.A_TARGET]
    if is_number(offset) == 0:
        fault(st, op.FAULT_NOT_FINITE, i)
        return
    target = lane_aimed_at(n, p, st, k)
    if target == 0:
        log_event(st, op.EVENT_NO_LANE, 1.0 * i)
    if p.entity_motion[i] != op.MOTION_SCRIPTED:
        if i == p.ego[0] and target != 0:
            set_path(n, st, road, target, st.s[i])
            plan_change(n, p, st, k, offset)
        return
    settle_in_lane(st, i)
    if target == 0:
        st.action_from[k] = st.facing[i] * st.kept_off[i]
        return
    centre, _ = lane_centre(n, road, target, st.s[i])
    gap = st.t[i] - centre
    st.kept_lane[i] = target
    st.kept_off[i] = gap
    st.changing[i] = 1 if st.guide[i] < 0 else 0
    st.turn[i] = 0.0
    st.action_from[k] = st.facing[i] * gap
    st.action_change[k] = st.facing[i] * (offset - gap)
    value = p.const[p.action_const[k] + slot.A_DYNAMICS]
    st.action_span[k] = transition_span(p.action_shape[k], p.action_dimension[k], value, offset - gap)


@compiled
def plan_change(n: RoadTables, p: Program, st: State, k: int, offset: float) -> None:
    """Plan the ego's way into its new lane, which is its path already; `action_span` is the odometer at its end, m."""
    i = p.action_entity[k]
    measure_path(n, st, i)
    left = st.facing[i] * offset
    change = left - st.path_off[0]
    span = transition_span(
        p.action_shape[k], p.action_dimension[k], p.const[p.action_const[k] + slot.A_DYNAMICS], change
    )
    if span > 0.0:
        distance = span if p.action_dimension[k] == op.DIMENSION_DISTANCE else st.v[i] * span
        plan_shift(st, i, left, max(distance, shift_distance(st.v[i], change, CHANGE_ACCELERATION)))
        st.action_span[k] = st.shift_end[0]
    elif offset != 0.0:
        plan_shift(st, i, left, shift_distance(st.v[i], offset, OFFSET_ACCELERATION))


@compiled
def shift_to(n: RoadTables, st: State, k: int, i: int, progress: float, left: float) -> int:
    """Write the progress and offset of a lane change; return 1 if it is complete, with the heading along the lane."""
    st.action_progress[k] = progress
    done = 0
    if progress >= st.action_span[k] - op.TOLERANCE:
        left = st.action_from[k] + st.action_change[k]
        st.turn[i] = 0.0
        done = 1
    st.kept_off[i] = st.facing[i] * left
    centre, _ = lane_centre(n, st.road[i], st.kept_lane[i], st.s[i])
    st.t[i] = centre + st.kept_off[i]
    return done


@compiled
def lane_change_by_distance(n: RoadTables, p: Program, st: State, k: int, i: int, dt: float) -> int:
    """Move an entity in a lane change whose progress is the distance ahead; return 1 if it is complete."""
    span = max(st.action_span[k], op.TOLERANCE)
    progress = st.action_progress[k]
    slope = st.action_change[k] * shape_slope(p.action_shape[k], progress / span) / span
    ahead = st.v[i] * dt / safe_sqrt(1.0 + slope * slope)
    st.turn[i] = drift_angle(st, i, slope, 1.0)
    progress = min(progress + abs(ahead), span)
    share = shape_value(st, p.action_shape[k], progress / span)
    left = st.action_from[k] + st.action_change[k] * share
    done = shift_to(n, st, k, i, progress, left)
    glide(n, p, st, i, ahead)
    return done


@compiled
def lane_change_by_time(n: RoadTables, p: Program, st: State, k: int, i: int, dt: float) -> int:
    """Move an entity in a lane change whose progress is time; return 1 if it is complete.

    If the change requires more lateral motion than the entity moves in the step, the entity moves straight sideways as
    far as it can, with the share completed as for a linear shape. The offset changes first: on a curve, s moves by the
    new one.
    """
    span = max(st.action_span[k], op.TOLERANCE)
    progress = st.action_progress[k]
    change = st.action_change[k]
    side = dt * abs(change) * shape_slope(p.action_shape[k], progress / span) / span
    path = abs(st.v[i]) * dt
    left = side if change > 0.0 else -side
    if side > path:
        st.turn[i] = drift_angle(st, i, left, 0.0)
        progress = min(progress + span * path / max(abs(change), op.TOLERANCE), span)
        return shift_to(n, st, k, i, progress, st.action_from[k] + change * progress / span)
    ahead = safe_sqrt(path * path - side * side)
    st.turn[i] = drift_angle(st, i, left, ahead)
    progress = min(progress + dt, span)
    share = shape_value(st, p.action_shape[k], progress / span)
    done = shift_to(n, st, k, i, progress, st.action_from[k] + change * share)
    glide(n, p, st, i, ahead if st.v[i] > 0.0 else -ahead)
    return done


@compiled
def step_lane_change(n: RoadTables, p: Program, st: State, k: int, dt: float) -> int:
    """Advance a lane change or a move to an offset over a time; return 1 if it is complete.

    A standing entity waits, unless it is put there at once. Every change moves its entity ahead too, by the speed that
    the actions before it in the file set. The ego's is complete where its planned way ends, or at once if it has none.
    """
    i = p.action_entity[k]
    if p.entity_motion[i] != op.MOTION_SCRIPTED:
        return 1 if st.odometer[i] >= st.action_span[k] else 0
    if st.road[i] < 0:
        return 1
    if st.action_span[k] <= 0.0:
        shift_to(n, st, k, i, 0.0, 0.0)
        if abs(st.v[i]) >= op.TOLERANCE and dt > 0.0:
            glide(n, p, st, i, st.v[i] * dt)
            st.moved[i] = 1
        place_scripted(n, st, i)
        return 1
    if abs(st.v[i]) < op.TOLERANCE or dt <= 0.0:
        return 0
    if p.action_dimension[k] == op.DIMENSION_DISTANCE:
        done = lane_change_by_distance(n, p, st, k, i, dt)
    else:
        done = lane_change_by_time(n, p, st, k, i, dt)
    st.moved[i] = 1
    place_scripted(n, st, i)
    if st.ended[i] == 1:
        return 1
    return done


def lane_change_row(draft: ProgramDraft, word: LaneChangeAction, actor: int) -> ActionRow:
    """Return the row of a change by a number of lanes."""
    del actor
    value, dimension = dynamics_of(word.over_time, word.dynamics)
    return ActionRow(
        (word.offset, value),
        shape=SHAPES[word.shape],
        dimension=dimension,
        lanes=word.by,
        other=draft.entities[word.of] if word.of else op.NONE,
        mode=LANES_AWAY,
    )


def lane_change_to_row(draft: ProgramDraft, word: LaneChangeToAction, actor: int) -> ActionRow:
    """Return the row of a change to a lane given by its id."""
    del draft, actor
    value, dimension = dynamics_of(word.over_time, word.dynamics)
    shape = SHAPES[word.shape]
    return ActionRow((word.offset, value), shape=shape, dimension=dimension, lanes=word.lane, mode=LANE_BY_ID)


LANE_CHANGE = Entry(
    ("lane_change",), lane_change_row, start_lane_change, step_lane_change, holds=HOLDS_LANE, relative=RELATIVE_AT_START
)
LANE_CHANGE_TO = Entry(("lane_change_to",), lane_change_to_row, start_lane_change, step_lane_change, holds=HOLDS_LANE)
