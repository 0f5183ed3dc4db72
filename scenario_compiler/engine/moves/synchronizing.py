"""Arriving at a position when another entity, the master, arrives at its own.

The speed is solved for anew in each step from the ways that remain up to the tolerances. With a speed on arrival the
acceleration is that of the smoothest motion that ends at the position, at that speed, at that time (of least squared
acceleration; a straight line of speed where one does); without one it is twice what the mean speed asks for. The
entity waits rather than goes back, and waits while the master stands. Where the last stretch is driven at the final
speed, the speed before it goes in a straight line down or up to it, from the first step on (esmini 3.6).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.numbers import length_of
from scenario_compiler.engine.columns.program import ENTITY, POSITION, Program
from scenario_compiler.engine.columns.rows import ActionRow, ProgramDraft
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.distances import distance_to, place_now
from scenario_compiler.engine.moves.entry import HOLDS_SPEED, Entry
from scenario_compiler.engine.moves.speeds import push_speed, related_speed, set_speed
from scenario_compiler.forms.declaration import index
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables

if TYPE_CHECKING:
    from scenario_compiler.vocabulary.actions import FinalSpeed, SynchronizeAction

ALONG_ROAD = 4 * op.FRAME_ROAD + op.MEASURE_ALONG
"""Along the roads, as `distance_to` takes it."""


@compiled
def on_own_path(p: Program, st: State, i: int) -> int:
    """Return 1 where an entity moves along points of its own, not along the road."""
    k = st.lateral[i]
    if k < 0 or k >= p.action_count[0]:
        return 0
    return 1 if p.action_flags[k] & op.FLAG_OWN_PATH != 0 else 0


@compiled
def way_to(n: RoadTables, p: Program, st: State, i: int, k: int) -> float:
    """Return how far an entity is from a position: along the roads, or straight where it goes its own way."""
    if on_own_path(p, st, i) == 0:
        along = distance_to(n, p, st, i, k, ALONG_ROAD, 0)
        if abs(along) < op.FAR:
            return abs(along)
    found, x, y, _, _, _ = place_now(n, p, st, k, i)
    if found == 0:
        return op.FAR
    return length_of(x - st.x[i], y - st.y[i])


@compiled
def final_speed(p: Program, st: State, k: int) -> float:
    """Return the speed on arrival as it is now."""
    value = p.const[p.action_const[k] + slot.A_TARGET]
    if p.action_mode[k] == op.FINAL_ABSOLUTE:
        return value
    mode = op.MODE_DELTA if p.action_mode[k] == op.FINAL_DELTA else op.MODE_FACTOR
    return related_speed(st.v[p.action_lanes[k]], mode, value)


@compiled
def start_synchronize(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Begin with no distances known."""
    del n
    st.longitudinal[p.action_entity[k]] = k
    st.action_a[k] = op.FAR
    st.action_b[k] = op.FAR


@compiled
def acceleration_to_meet(p: Program, st: State, k: int, way: float, time: float, dt: float) -> float:
    """Return the acceleration for a step with a way and a time left."""
    v = st.v[p.action_entity[k]]
    if p.action_mode[k] == op.FINAL_NONE:
        return 2.0 * (way / time - v) / time
    last = final_speed(p, st, k)
    steady = p.const[p.action_const[k] + slot.A_STEADY_TIME]
    stretch = p.const[p.action_const[k] + slot.A_STEADY_DISTANCE]
    if steady > 0.0:
        time = time - steady
        way = way - last * steady
    elif stretch > 0.0 and last > op.TOLERANCE:
        time = time - stretch / last
        way = way - stretch
    if time <= dt or way <= 0.0:
        return (last - v) / dt
    if steady > 0.0 or stretch > 0.0:
        return (2.0 * way / time - last - v) / dt
    return (6.0 * way / time - 4.0 * v - 2.0 * last) / time


@compiled
def step_synchronize(n: RoadTables, p: Program, st: State, k: int, dt: float) -> int:
    """Choose the speed for one step; return 1 on arrival of either, or where one goes away from its position."""
    i = p.action_entity[k]
    master = p.action_other[k]
    if master < 0 or (p.entity_motion[i] != op.MOTION_SCRIPTED and i != p.ego[0]):
        return 1
    if dt <= 0.0:
        return 0
    base = p.action_const[k]
    way = way_to(n, p, st, i, p.action_position[k])
    way = way - p.const[base + slot.A_TOLERANCE]
    masters = way_to(n, p, st, master, p.point_position[p.action_point[k]])
    masters = masters - p.const[base + slot.A_MASTER_TOLERANCE]
    speed = abs(st.v[master])
    there = way <= op.TOLERANCE or masters <= op.TOLERANCE
    passed = way > st.action_a[k] + op.TOLERANCE or masters > st.action_b[k] + op.TOLERANCE
    st.action_a[k] = way
    st.action_b[k] = masters
    if there or passed or masters < speed * dt:
        if p.action_mode[k] != op.FINAL_NONE:
            set_speed(p, st, i, final_speed(p, st, k))
        return 1
    if speed < op.TOLERANCE:
        set_speed(p, st, i, 0.0)
        return 0
    fastest = max(p.const[p.entity_const[i] + slot.E_MAX_SPEED], 0.0)
    acceleration = acceleration_to_meet(p, st, k, way, masters / speed, dt)
    push_speed(p, st, i, max(acceleration, -max(st.v[i], 0.0) / dt), fastest, dt)
    return 0


def synchronize_row(draft: ProgramDraft, word: SynchronizeAction, actor: int) -> ActionRow:
    """Return the row of an arrival at the time of another entity's."""
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
    refers={"other": index(ENTITY), "position": index(POSITION)},
)
