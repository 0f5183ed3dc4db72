"""A series of speeds: each entry is reached after its time, or as soon as the limits allow.

The whole series is planned when the action begins (`speed_plans`) and then follows the clock, so entries relative to
another entity use the speed that it has when the action begins.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.rows import ActionRow, ProgramDraft, Slot, flags_of, limits_of
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.moves.entry import HOLDS_SPEED, RELATIVE_AT_START, Entry
from scenario_compiler.engine.moves.speed_plans import pieces_needed, plan_speeds
from scenario_compiler.engine.moves.speeds import set_speed, speed_before
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables

if TYPE_CHECKING:
    from scenario_compiler.vocabulary.actions import SpeedProfileAction


@compiled
def start_profile(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Plan the whole profile from the present speed and acceleration."""
    del n
    i = p.action_entity[k]
    st.longitudinal[i] = k
    plan_speeds(p, st, k, speed_before(p, st, i), st.a[i])


@compiled
def step_profile(n: RoadTables, p: Program, st: State, k: int, dt: float) -> int:
    """Set the planned speed for the time after dt; return 1 in the step that reaches the last speed."""
    del n
    time = st.clock[0] + dt
    at = st.action_phase[k]
    while st.piece_time[at + 1] < op.FAR and st.piece_time[at + 1] <= time + op.TOLERANCE:
        at = at + 1
    st.action_phase[k] = at
    since = time - st.piece_time[at]
    speed = st.piece_speed[at] + (st.piece_slope[at] + 0.5 * st.piece_jerk[at] * since) * since
    set_speed(p, st, p.action_entity[k], speed)
    return 1 if st.piece_time[at + 1] >= op.FAR else 0


def speed_profile_row(draft: ProgramDraft, word: SpeedProfileAction, actor: int) -> ActionRow:
    """Return the row of a speed profile."""
    del actor
    entries: list[Slot] = []
    for entry in word.entries:
        entries += [entry.speed, -1.0 if entry.time is None else entry.time]
    return ActionRow(
        (0.0, 0.0, *limits_of(word.limits), *entries),
        lanes=len(word.entries),
        other=draft.entities[word.to] if word.to else op.NONE,
        flags=flags_of((op.FLAG_SMOOTH, word.following == "follow")),
        pieces=pieces_needed(len(word.entries)),
    )


SPEED_PROFILE = Entry(
    ("speed_profile",), speed_profile_row, start_profile, step_profile, holds=HOLDS_SPEED, relative=RELATIVE_AT_START
)
