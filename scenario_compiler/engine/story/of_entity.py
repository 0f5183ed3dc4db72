"""Conditions on an entity, evaluated on the states before the step.

As in esmini 3.6, an undefined quantity (the time gap to an entity behind, the time to a collision that does not occur)
fulfils no condition, and a place that no road leads to is far away.
"""

from __future__ import annotations

from math import cos, pi, sin
from typing import TYPE_CHECKING

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.numbers import angle_between, length_of, safe_sqrt
from scenario_compiler.engine.columns.program import ENTITY, POSITION, SET, Program
from scenario_compiler.engine.columns.rows import FRAMES, ConditionRow, ProgramDraft
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.closing import approach_speed
from scenario_compiler.engine.motion.collision import in_contact
from scenario_compiler.engine.motion.distances import distance_between, distance_to, place_now
from scenario_compiler.engine.motion.on_tracks import point_at
from scenario_compiler.engine.motion.tracks import track_followed, track_height, track_pose
from scenario_compiler.engine.motion.watching import (
    WATCH_ACCELERATION,
    WATCH_AT_END,
    WATCH_MOTION,
    WATCH_OFF_ROAD,
    WATCH_STILL,
)
from scenario_compiler.engine.story.clearance import is_member
from scenario_compiler.engine.story.entry import RULES, Condition, compared, other_is_gone, time_compared
from scenario_compiler.forms.declaration import index
from scenario_compiler.marker import compiled
from scenario_compiler.roads.lanes import lane_direction, lane_pose
from scenario_compiler.roads.tables import RoadTables

if TYPE_CHECKING:
    from scenario_compiler.vocabulary.conditions import (
        AccelerationCondition,
        AngleCondition,
        CollisionCondition,
        DistanceCondition,
        EndOfRoadCondition,
        OffroadCondition,
        PositionDistanceCondition,
        ReachPositionCondition,
        RelativeAngleCondition,
        RelativeSpeedCondition,
        SpeedCondition,
        StandstillCondition,
        TimeHeadwayCondition,
        TimeToCollisionCondition,
        TraveledDistanceCondition,
    )

    Gap = TimeHeadwayCondition | DistanceCondition | TimeToCollisionCondition | PositionDistanceCondition

MEASURES = {
    "euclidianDistance": op.MEASURE_STRAIGHT,
    "longitudinal": op.MEASURE_ALONG,
    "lateral": op.MEASURE_ACROSS,
}
PARTS = {
    "total": op.PART_TOTAL,
    "longitudinal": op.PART_ALONG,
    "lateral": op.PART_ACROSS,
    "vertical": op.PART_UP,
}
ANGLES = {"heading": op.ANGLE_HEADING, "pitch": op.ANGLE_PITCH, "roll": op.ANGLE_ROLL}
KINDS = {
    "": op.KIND_ANY,
    "vehicle": op.KIND_VEHICLE,
    "pedestrian": op.KIND_PEDESTRIAN,
    "miscellaneous": op.KIND_THING,
}
"""Codes of the kinds of distances, components of a motion, angles, and kinds of entities."""


@compiled
def headway(n: RoadTables, p: Program, st: State, c: int, i: int) -> float:
    """Return the time gap to the other entity ahead, s; -1 if it is behind, or if i stands or drives backwards."""
    gap = distance_between(n, p, st, i, p.condition_other[c], p.condition_mode[c], p.condition_flags[c] & 1)
    if gap < 0.0 or st.v[i] < op.TOLERANCE:
        return -1.0
    return min(gap / st.v[i], op.FAR)


@compiled
def time_to_collision(n: RoadTables, p: Program, st: State, c: int, i: int) -> float:
    """Return the distance to the other entity or the position divided by the closing speed, s; -1 if undefined.

    It is undefined if they do not approach each other, and if no road leads there.
    """
    other = p.condition_other[c]
    mode = p.condition_mode[c]
    freespace = p.condition_flags[c] & 1
    if other >= 0:
        gap = distance_between(n, p, st, i, other, mode, freespace)
        road, s, t = st.road[other], st.s[other], st.t[other]
        x, y, z = st.x[other], st.y[other], st.z[other]
    else:
        position = p.condition_position[c]
        gap = distance_to(n, p, st, i, position, mode, freespace)
        _, x, y, z, road, s, t = place_now(n, p, st, position, i)
    if abs(gap) < op.TOLERANCE or abs(gap) >= op.FAR:
        return -1.0
    closing = approach_speed(n, p, st, i, other, road, s, t, x, y, z, mode, gap)
    return min(abs(gap) / closing, op.FAR) if closing >= op.TOLERANCE else -1.0


@compiled
def part_of(st: State, i: int, x: float, y: float, z: float, part: int) -> float:
    """Return a component of a world vector in an entity's own axes, or the vector's length."""
    if part == op.PART_ALONG:
        return x * cos(st.h[i]) + y * sin(st.h[i])
    if part == op.PART_ACROSS:
        return y * cos(st.h[i]) - x * sin(st.h[i])
    if part == op.PART_TOTAL:
        return safe_sqrt(x * x + y * y + z * z)
    return z


@compiled
def relative_speed(st: State, i: int, j: int, part: int) -> float:
    """Return the speed of i minus that of j, or a component of the relative velocity in i's axes, m/s."""
    if part == op.PART_TOTAL:
        return st.v[i] - st.v[j]
    x = st.velocity_x[i] - st.velocity_x[j]
    y = st.velocity_y[i] - st.velocity_y[j]
    return part_of(st, i, x, y, st.velocity_z[i] - st.velocity_z[j], part)


@compiled
def own_angle(st: State, i: int, kind: int) -> float:
    """Return an entity's heading, pitch or roll in the world, rad."""
    if kind == op.ANGLE_HEADING:
        return st.h[i]
    return st.pitch[i] if kind == op.ANGLE_PITCH else st.roll[i]


@compiled
def angle_of(n: RoadTables, st: State, i: int, kind: int, frame: int) -> float:
    """Return an entity's angle in the world, or relative to the road (along s) or the lane (as travelled), rad.

    In the entity's own axes every angle is 0 (AngleCondition, ASAM OpenSCENARIO 1.3).
    """
    if frame == op.FRAME_ENTITY:
        return 0.0
    angle = own_angle(st, i, kind)
    if frame == op.FRAME_WORLD or st.road[i] < 0:
        return angle
    _, _, _, h, pitch, roll = lane_pose(n, st.road[i], st.lane[i], st.s[i], st.off[i])
    sense = 1.0
    if frame != op.FRAME_ROAD and lane_direction(n, st.road[i], st.lane[i], st.s[i]) < 0:
        h = h + pi
        sense = -1.0
    if kind == op.ANGLE_HEADING:
        return angle - h
    return angle - sense * (pitch if kind == op.ANGLE_PITCH else roll)


@compiled
def speed_holds(n: RoadTables, p: Program, st: State, c: int, i: int) -> int:
    """Return 1 if the speed, or a component of it, satisfies the condition."""
    del n
    part = p.condition_mode[c]
    if part == op.PART_TOTAL:
        return compared(p, st, c, st.v[i])
    return compared(p, st, c, part_of(st, i, st.velocity_x[i], st.velocity_y[i], st.velocity_z[i], part))


@compiled
def acceleration_holds(n: RoadTables, p: Program, st: State, c: int, i: int) -> int:
    """Return 1 if the acceleration, or a component of it, satisfies the condition."""
    del n
    part = p.condition_mode[c]
    return compared(p, st, c, part_of(st, i, st.acceleration_x[i], st.acceleration_y[i], st.acceleration_z[i], part))


@compiled
def traveled_distance_holds(n: RoadTables, p: Program, st: State, c: int, i: int) -> int:
    """Return 1 if the travelled distance satisfies the condition."""
    del n
    return compared(p, st, c, st.odometer[i])


@compiled
def standstill_holds(n: RoadTables, p: Program, st: State, c: int, i: int) -> int:
    """Return 1 if the duration of standing satisfies the condition."""
    del n
    return time_compared(p, st, c, st.still[i])


@compiled
def end_of_road_holds(n: RoadTables, p: Program, st: State, c: int, i: int) -> int:
    """Return 1 if the duration at the end of a road satisfies the condition."""
    del n
    return time_compared(p, st, c, st.at_end[i])


@compiled
def off_road_holds(n: RoadTables, p: Program, st: State, c: int, i: int) -> int:
    """Return 1 if the duration off every lane satisfies the condition."""
    del n
    return time_compared(p, st, c, st.off_road[i])


@compiled
def time_headway_holds(n: RoadTables, p: Program, st: State, c: int, i: int) -> int:
    """Return 1 if the time gap satisfies the condition."""
    if other_is_gone(p, st, c) == 1:
        return 0
    return time_compared(p, st, c, headway(n, p, st, c, i))


@compiled
def time_to_collision_holds(n: RoadTables, p: Program, st: State, c: int, i: int) -> int:
    """Return 1 if the time to collision satisfies the condition."""
    if other_is_gone(p, st, c) == 1:
        return 0
    return time_compared(p, st, c, time_to_collision(n, p, st, c, i))


@compiled
def distance_holds(n: RoadTables, p: Program, st: State, c: int, i: int) -> int:
    """Return 1 if the distance to another entity satisfies the condition; it is FAR if no road leads there."""
    if other_is_gone(p, st, c) == 1:
        return 0
    freespace = p.condition_flags[c] & 1
    gap = distance_between(n, p, st, i, p.condition_other[c], p.condition_mode[c], freespace)
    return compared(p, st, c, abs(gap))


@compiled
def position_distance_holds(n: RoadTables, p: Program, st: State, c: int, i: int) -> int:
    """Return 1 if the distance to a position satisfies the condition; it is FAR if no road leads there."""
    gap = distance_to(n, p, st, i, p.condition_position[c], p.condition_mode[c], p.condition_flags[c] & 1)
    return compared(p, st, c, abs(gap))


@compiled
def relative_speed_holds(n: RoadTables, p: Program, st: State, c: int, i: int) -> int:
    """Return 1 if the speed relative to another entity satisfies the condition."""
    del n
    if other_is_gone(p, st, c) == 1:
        return 0
    return compared(p, st, c, relative_speed(st, i, p.condition_other[c], p.condition_mode[c]))


@compiled
def reach_position_holds(n: RoadTables, p: Program, st: State, c: int, i: int) -> int:
    """Return 1 if the distance to a point satisfies the condition; it is FAR if the point lies nowhere."""
    found, x, y = point_at(n, p, st, p.condition_position[c], i)
    if found == 0:
        return compared(p, st, c, op.FAR)
    return compared(p, st, c, length_of(st.x[i] - x, st.y[i] - y))


@compiled
def collision_holds(n: RoadTables, p: Program, st: State, c: int, i: int) -> int:
    """Return 1 if i touches one of the given entities of the given kind; an entity does not touch itself."""
    del n
    others = p.condition_other[c]
    kind = p.condition_mode[c]
    for j in range(p.entity_count[0]):
        if j == i or is_member(p, others, j) == 0:
            continue
        if (kind == op.KIND_ANY or p.entity_type[j] == kind) and in_contact(p, st, i, j) == 1:
            return 1
    return 0


@compiled
def angle_compares(p: Program, c: int, angle: float) -> int:
    """Return 1 if an angle equals that of the condition within its tolerance."""
    base = p.condition_const[c]
    away = abs(angle_between(angle, p.const[base + slot.C_VALUE]))
    return 1 if away <= p.const[base + slot.C_TOLERANCE] + op.TOLERANCE else 0


@compiled
def angle_on_track(p: Program, st: State, i: int, k: int, kind: int) -> float:
    """Return an entity's heading or pitch relative to the trajectory on which action k leads it, or its roll, rad."""
    track = p.action_other[k]
    if kind == op.ANGLE_HEADING:
        _, _, _, along = track_pose(p, st, track, st.action_a[k], 0)
        return st.h[i] - along
    angle = own_angle(st, i, kind)
    if kind == op.ANGLE_PITCH:
        _, pitch = track_height(p, st, track, st.action_a[k])
        angle = angle - pitch
    return angle


@compiled
def angle_holds(n: RoadTables, p: Program, st: State, c: int, i: int) -> int:
    """Return 1 if an angle of the entity satisfies the condition; relative to a trajectory only on one."""
    kind = p.condition_mode[c] % 4
    frame = p.condition_mode[c] // 4
    if frame != op.FRAME_TRAJECTORY:
        return angle_compares(p, c, angle_of(n, st, i, kind, frame))
    k = track_followed(p, st, i)
    return angle_compares(p, c, angle_on_track(p, st, i, k, kind)) if k >= 0 else 0


@compiled
def relative_angle_holds(n: RoadTables, p: Program, st: State, c: int, i: int) -> int:
    """Return 1 if the angle to another entity satisfies the condition."""
    del n
    if other_is_gone(p, st, c) == 1:
        return 0
    other = p.condition_other[c]
    kind = p.condition_mode[c]
    return angle_compares(p, c, own_angle(st, other, kind) - own_angle(st, i, kind))


def _gap(word: Gap, other: int, position: int) -> ConditionRow:
    return ConditionRow(
        RULES[word.rule],
        word.below,
        word.entity,
        other=other,
        mode=4 * FRAMES[word.coordinates] + MEASURES[word.distance],
        flags=1 if word.freespace else 0,
        position=position,
    )


def gap_row(draft: ProgramDraft, word: TimeHeadwayCondition | DistanceCondition) -> ConditionRow:
    """Return the row of a condition on the time gap or the distance to another entity."""
    return _gap(word, draft.entities[word.to], op.NONE)


def position_distance_row(draft: ProgramDraft, word: PositionDistanceCondition) -> ConditionRow:
    """Return the row of a condition on the distance to a position."""
    return _gap(word, op.NONE, draft.position(word.position))


def time_to_collision_row(draft: ProgramDraft, word: TimeToCollisionCondition) -> ConditionRow:
    """Return the row of a condition on the time to collision.

    Raises:
        ValueError: Neither an entity nor a position is given.
    """
    draft.program.watches[0] |= WATCH_MOTION
    if word.to:
        return _gap(word, draft.entities[word.to], op.NONE)
    if word.position is None:
        raise ValueError("a time to collision is to an entity or a position")
    return _gap(word, op.NONE, draft.position(word.position))


def _part(draft: ProgramDraft, direction: str) -> int:
    """Return the code of a component of a motion, and have it measured."""
    if direction != "total":
        draft.program.watches[0] |= WATCH_MOTION
    return PARTS[direction]


def speed_row(draft: ProgramDraft, word: SpeedCondition) -> ConditionRow:
    """Return the row of a condition on the speed."""
    return ConditionRow(RULES[word.rule], word.value, word.entity, mode=_part(draft, word.direction))


def relative_speed_row(draft: ProgramDraft, word: RelativeSpeedCondition) -> ConditionRow:
    """Return the row of a condition on the speed relative to another entity."""
    part, other = _part(draft, word.direction), draft.entities[word.to]
    return ConditionRow(RULES[word.rule], word.value, word.entity, other=other, mode=part)


def acceleration_row(draft: ProgramDraft, word: AccelerationCondition) -> ConditionRow:
    """Return the row of a condition on the acceleration."""
    draft.program.watches[0] |= WATCH_MOTION | WATCH_ACCELERATION
    return ConditionRow(RULES[word.rule], word.value, word.entity, mode=PARTS[word.direction])


def reach_position_row(draft: ProgramDraft, word: ReachPositionCondition) -> ConditionRow:
    """Return the row of a condition on reaching a position."""
    return ConditionRow(value=word.tolerance, entity=word.entity, position=draft.position(word.position))


def traveled_distance_row(draft: ProgramDraft, word: TraveledDistanceCondition) -> ConditionRow:
    """Return the row of a condition on the travelled distance."""
    del draft
    return ConditionRow(op.RULE_GREATER_OR_EQUAL, word.distance, word.entity)


def standstill_row(draft: ProgramDraft, word: StandstillCondition) -> ConditionRow:
    """Return the row of a condition on the duration of standing."""
    draft.program.watches[0] |= WATCH_STILL
    return ConditionRow(op.RULE_GREATER, word.duration, word.entity)


def off_road_row(draft: ProgramDraft, word: OffroadCondition) -> ConditionRow:
    """Return the row of a condition on the duration off every lane."""
    draft.program.watches[0] |= WATCH_OFF_ROAD
    return ConditionRow(op.RULE_GREATER_OR_EQUAL, word.duration, word.entity)


def end_of_road_row(draft: ProgramDraft, word: EndOfRoadCondition) -> ConditionRow:
    """Return the row of a condition on the duration at the end of a road."""
    draft.program.watches[0] |= WATCH_AT_END
    return ConditionRow(op.RULE_GREATER_OR_EQUAL, word.duration, word.entity)


def collision_row(draft: ProgramDraft, word: CollisionCondition) -> ConditionRow:
    """Return the row of a condition on a collision; `other` is the set of the other entities."""
    others = draft.members(draft.entities[one] for one in word.with_entities)
    return ConditionRow(entity=word.entity, other=others, mode=KINDS[word.with_type])


def angle_row(draft: ProgramDraft, word: AngleCondition) -> ConditionRow:
    """Return the row of a condition on an angle."""
    del draft
    mode = 4 * FRAMES[word.coordinates] + ANGLES[word.kind]
    return ConditionRow(value=word.value, entity=word.entity, mode=mode, const=(word.tolerance,))


def relative_angle_row(draft: ProgramDraft, word: RelativeAngleCondition) -> ConditionRow:
    """Return the row of a condition on the angle to another entity."""
    return ConditionRow(
        value=word.value,
        entity=word.entity,
        other=draft.entities[word.to],
        mode=ANGLES[word.kind],
        const=(word.tolerance,),
    )


BETWEEN = {"other": index(ENTITY)}
AT = {"position": index(POSITION)}

SPEED = Condition(("speed",), speed_row, speed_holds)
ACCELERATION = Condition(("acceleration",), acceleration_row, acceleration_holds)
TRAVELED_DISTANCE = Condition(("traveled",), traveled_distance_row, traveled_distance_holds)
STANDSTILL = Condition(("standstill",), standstill_row, standstill_holds)
END_OF_ROAD = Condition(("end_of_road",), end_of_road_row, end_of_road_holds)
OFF_ROAD = Condition(("off_road",), off_road_row, off_road_holds)
TIME_HEADWAY = Condition(("time_gap",), gap_row, time_headway_holds, refers=BETWEEN)
TIME_TO_COLLISION = Condition(("time_to_collision",), time_to_collision_row, time_to_collision_holds)
DISTANCE = Condition(("distance",), gap_row, distance_holds, refers=BETWEEN)
POSITION_DISTANCE = Condition(("distance_to_position",), position_distance_row, position_distance_holds, refers=AT)
RELATIVE_SPEED = Condition(("relative_speed",), relative_speed_row, relative_speed_holds, refers=BETWEEN)
REACH_POSITION = Condition(("reached",), reach_position_row, reach_position_holds, refers=AT)
COLLISION = Condition(("collision",), collision_row, collision_holds, refers={"other": index(SET)})
ANGLE = Condition(("angle",), angle_row, angle_holds)
RELATIVE_ANGLE = Condition(("relative_angle",), relative_angle_row, relative_angle_holds, refers=BETWEEN)
