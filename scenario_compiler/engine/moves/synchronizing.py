"""Arriving at a position at the same time as another entity, the master, arrives at its own position.

The speed is computed again in each step from the remaining distances up to the tolerances. With a final speed, two
phases of constant acceleration satisfy distance, time and speed; whether the entity accelerates or decelerates first is
decided once. Near the second phase the speed changes linearly to the end. The last stretch may be driven at the final
speed; its distance and time are subtracted first. While the master stands, the entity stops and waits. Without a final
speed, the speed changes linearly to whatever it is on arrival. After esmini 3.6, except that a master may also arrive
in reverse, for which esmini waits as if it stood.
"""

from __future__ import annotations

from math import cos
from typing import TYPE_CHECKING

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.numbers import length_of, ratio, safe_sqrt
from scenario_compiler.engine.columns.program import ENTITY, POSITION, Program
from scenario_compiler.engine.columns.rows import ActionRow, ProgramDraft
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.distances import distance_to, place_now
from scenario_compiler.engine.motion.tracks import nearest_on_track, track_followed
from scenario_compiler.engine.moves.entry import HOLDS_SPEED, RELATIVE_THROUGHOUT, Entry
from scenario_compiler.engine.moves.speeds import push_speed, related_speed, set_speed
from scenario_compiler.forms.declaration import index
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables

if TYPE_CHECKING:
    from scenario_compiler.vocabulary.actions import FinalSpeed, SynchronizeAction

ALONG_ROAD = 4 * op.FRAME_ROAD + op.MEASURE_ALONG
"""Mode of `distance_to` for distances along the roads."""

PHASE_UNDECIDED = 0
PHASE_RUSH = 1
PHASE_LINGER = 2
PHASE_LINE = 3
PHASE_BRAKE = 4
PHASE_WAIT = 5
PHASE_REST = 6
PHASE_STEADY = 7
"""Phases of an arrival at a final speed: undecided; first faster, or first slower, than a linear change of speed;
linear change of speed to the end; hard braking because the distance is too short; standing until the master moves;
standing until a linear change of speed from rest arrives in time; at the final speed.
"""

HARD_BRAKING = 8.0
"""Deceleration if the distance to stop is too short, m/s2 (esmini 3.6)."""

ON_THE_LINE = 0.1
"""Difference to the speed of a linear change at which the entity switches to it, m/s (esmini 3.6)."""

NEARLY = 0.001
"""Distance, m, and time, s, below which a linear change of speed is no longer computed (esmini 3.6)."""

FOREVER = 1.0e10
"""Time until a master that stands arrives, s (esmini 3.6)."""


@compiled
def on_own_path(p: Program, st: State, i: int) -> int:
    """Return 1 if an entity moves along points of its own, not along the road."""
    k = st.lateral[i]
    if k < 0 or k >= p.action_count[0]:
        return 0
    return 1 if p.action_flags[k] & op.FLAG_OWN_PATH != 0 else 0


@compiled
def way_to(n: RoadTables, p: Program, st: State, i: int, k: int) -> float:
    """Return the distance from an entity to a position, m: along its trajectory or the roads, else straight."""
    on_track = track_followed(p, st, i)
    found, x, y, _, road, _, _ = place_now(n, p, st, k, i)
    if on_track < 0 and on_own_path(p, st, i) == 0 and st.road[i] >= 0 and road >= 0:
        along = distance_to(n, p, st, i, k, ALONG_ROAD, 0)
        if abs(along) < op.FAR:
            return abs(along)
    if found == 0:
        return op.FAR
    if on_track >= 0:
        return max(nearest_on_track(p, st, p.action_other[on_track], x, y) - st.action_a[on_track], 0.0)
    return length_of(x - st.x[i], y - st.y[i])


@compiled
def final_speed(p: Program, st: State, k: int) -> float:
    """Return the present value of the final speed, m/s."""
    value = p.const[p.action_const[k] + slot.A_TARGET]
    if p.action_mode[k] == op.FINAL_ABSOLUTE:
        return value
    mode = op.MODE_DELTA if p.action_mode[k] == op.FINAL_DELTA else op.MODE_FACTOR
    return related_speed(st.v[p.action_lanes[k]], mode, value)


@compiled
def start_synchronize(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Begin the action without known distances, and fix the length of the last stretch at the final speed."""
    del n
    st.longitudinal[p.action_entity[k]] = k
    st.action_a[k] = op.FAR
    st.action_b[k] = op.FAR
    st.action_phase[k] = PHASE_UNDECIDED
    base = p.action_const[k]
    st.action_from[k] = max(p.const[base + slot.A_STEADY_DISTANCE], 0.0)
    if p.const[base + slot.A_STEADY_TIME] > 0.0:
        st.action_from[k] = p.const[base + slot.A_STEADY_TIME] * final_speed(p, st, k)


@compiled
def speed_ahead(st: State, i: int) -> float:
    """Return the speed of an entity along its road, m/s, without its lateral motion."""
    if st.road[i] < 0:
        return st.v[i]
    return st.v[i] * abs(cos(st.turn[i]))


@compiled
def bend(st: State, k: int, v: float, last: float, way: float, time: float, dt: float) -> float:
    """Return the acceleration, m/s2, in the first of two phases of constant acceleration; set the next phase.

    With the mean m = way / time, the speeds v now and w at the end, and an acceleration a, then -a, distance and speeds
    give the peak u = m +- r with r^2 = ((m - v)^2 + (m - w)^2) / 2, and a = (2 u - v - w) / time: plus if m is above
    the mean of v and w, minus if it is below. If u would be negative, the entity brakes to a stop within the share v^2
    / (v^2 + w^2) of the distance; it brakes with HARD_BRAKING if this is more than half of it.
    """
    time = max(time, op.TOLERANCE)
    mean = way / time
    over = mean - 0.5 * (v + last)
    spread = safe_sqrt(0.5 * ((mean - v) * (mean - v) + (mean - last) * (mean - last)))
    acceleration = 0.0
    peak = mean
    if over > 0.0:
        peak = mean + spread
        acceleration = 2.0 * (over + spread) / time
    elif over < 0.0:
        peak = mean - spread
        acceleration = 2.0 * (over - spread) / time
    rushes = 1 if st.action_phase[k] == PHASE_RUSH else 0
    if (rushes == 1 and acceleration < 0.0) or (rushes == 0 and acceleration > 0.0):
        st.action_phase[k] = PHASE_LINE
        return 0.0
    if peak >= 0.0:
        return acceleration
    squares = v * v + last * last
    acceleration = -0.5 * ratio(squares, way, 0.0)
    if v * v > 0.5 * squares:
        acceleration = -HARD_BRAKING
        st.action_phase[k] = PHASE_BRAKE
    if v + acceleration * dt < 0.0:
        st.action_phase[k] = PHASE_REST
    return acceleration


@compiled
def meet_at_speed(p: Program, st: State, k: int, last: float, way: float, time: float, dt: float) -> None:
    """Choose the speed for a step towards a position that is to be reached at a final speed, by phases (esmini 3.6)."""
    i = p.action_entity[k]
    v = st.v[i]
    least = max(last, op.TOLERANCE)
    phase = st.action_phase[k]
    if st.action_from[k] > 0.0 and phase != PHASE_STEADY:
        if way - st.action_from[k] < op.TOLERANCE or time - st.action_from[k] / least < op.TOLERANCE:
            phase = PHASE_STEADY
        else:
            way = way - st.action_from[k]
            time = time - st.action_from[k] / least
    if phase == PHASE_WAIT and time < FOREVER:
        phase = PHASE_UNDECIDED
    if phase == PHASE_REST and time < 2.0 * way / least:
        phase = PHASE_LINE
    if phase in (PHASE_RUSH, PHASE_LINGER) and time < FOREVER and abs(v - 2.0 * way / time + last) < ON_THE_LINE:
        st.action_phase[k] = PHASE_LINE
        return
    if phase == PHASE_UNDECIDED:
        phase = PHASE_RUSH if 0.5 * (v + last) < way / time else PHASE_LINGER
    st.action_phase[k] = phase
    if phase == PHASE_STEADY:
        set_speed(p, st, i, last)
    elif phase == PHASE_REST:
        set_speed(p, st, i, 0.0)
    elif phase == PHASE_LINE:
        near = way < NEARLY or time < NEARLY or time >= FOREVER
        set_speed(p, st, i, 0.0 if near else max(2.0 * way / time - max(last, 0.0), 0.0))
    elif phase == PHASE_BRAKE:
        if v - HARD_BRAKING * dt < 0.0:
            st.action_phase[k] = PHASE_WAIT
        slow_down(p, st, i, -HARD_BRAKING, dt)
    elif phase != PHASE_WAIT:
        slow_down(p, st, i, bend(st, k, speed_ahead(st, i), last, way, time, dt), dt)


@compiled
def slow_down(p: Program, st: State, i: int, acceleration: float, dt: float) -> None:
    """Let an entity accelerate or brake for a step, at most to a stop."""
    if dt > 0.0:
        fastest = max(p.const[p.entity_const[i] + slot.E_MAX_SPEED], 0.0)
        push_speed(p, st, i, max(acceleration, -max(st.v[i], 0.0) / dt), fastest, dt)


@compiled
def step_synchronize(n: RoadTables, p: Program, st: State, k: int, dt: float) -> int:
    """Choose the speed for one step; return 1 if either entity has arrived, or moves away from its position.

    Without a final speed, the acceleration is twice the one that the mean speed requires; it is almost 0 while the
    master stands.
    """
    i = p.action_entity[k]
    master = p.action_other[k]
    if master < 0 or (p.entity_motion[i] != op.MOTION_SCRIPTED and i != p.ego[0]):
        return 1
    base = p.action_const[k]
    way = way_to(n, p, st, i, p.action_position[k])
    masters = way_to(n, p, st, master, p.point_position[p.action_point[k]])
    there = way < p.const[base + slot.A_TOLERANCE] + op.TOLERANCE
    master_there = masters < p.const[base + slot.A_MASTER_TOLERANCE] + op.TOLERANCE
    passed = way > st.action_a[k] + op.TOLERANCE or masters > st.action_b[k] + op.TOLERANCE
    st.action_a[k] = way
    st.action_b[k] = masters
    way = max(way - p.const[base + slot.A_TOLERANCE], op.TOLERANCE)
    masters = max(masters - p.const[base + slot.A_MASTER_TOLERANCE], op.TOLERANCE)
    speed = abs(speed_ahead(st, master))
    time = FOREVER
    if speed > op.TOLERANCE:
        time = masters / speed
    if there or master_there or passed or time < dt:
        if p.action_mode[k] != op.FINAL_NONE:
            set_speed(p, st, i, final_speed(p, st, k))
        return 1
    if p.action_mode[k] == op.FINAL_NONE:
        slow_down(p, st, i, 2.0 * (way / time - st.v[i]) / time, dt)
    else:
        meet_at_speed(p, st, k, final_speed(p, st, k), way, time, dt)
    return 0


def synchronize_row(draft: ProgramDraft, word: SynchronizeAction, actor: int) -> ActionRow:
    """Return the row of a synchronized arrival."""
    del actor
    p = draft.program
    final = word.final_speed
    point = len(p.point_position)
    p.point_position.append(draft.position(word.master_position.position))
    p.point_const.append(draft.block(-1.0))
    return ActionRow(
        (
            0.0 if final is None else final.value,
            0.0,
            word.tolerance,
            word.master_tolerance,
            -1.0 if final is None or final.steady_time is None else final.steady_time,
            -1.0 if final is None or final.steady_distance is None else final.steady_distance,
        ),
        lanes=draft.entities[final.relative_to] if final is not None and final.relative_to else 0,
        other=draft.entities[word.master],
        mode=_final_mode(final),
        position=draft.position(word.position),
        point=point,
        points=1,
    )


def _final_mode(final: FinalSpeed | None) -> int:
    if final is None:
        return op.FINAL_NONE
    if not final.relative_to:
        return op.FINAL_ABSOLUTE
    return op.FINAL_DELTA if final.kind == "delta" else op.FINAL_FACTOR


SYNCHRONIZE = Entry(
    ("synchronize",),
    synchronize_row,
    start_synchronize,
    step_synchronize,
    holds=HOLDS_SPEED,
    relative=RELATIVE_THROUGHOUT,
    refers={"other": index(ENTITY), "position": index(POSITION)},
)
