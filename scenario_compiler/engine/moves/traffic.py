"""Actions on background traffic: swarms, sources, sinks, and stopping them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.program import ENTITY, POSITION, Program
from scenario_compiler.engine.columns.rows import ActionRow, ProgramDraft
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.moves.entry import Entry
from scenario_compiler.engine.traffic.sources import emit_due, take_due
from scenario_compiler.engine.traffic.swarms import keep_swarm
from scenario_compiler.forms.declaration import Allowed, Of, index
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables

if TYPE_CHECKING:
    from scenario_compiler.vocabulary.actions import (
        StopTrafficAction,
        TrafficSinkAction,
        TrafficSourceAction,
        TrafficSwarmAction,
    )

VEHICLES = Allowed(Of("entity", lambda p: p.entity_count[0] + 1))
"""Index of the first entity of an action on traffic, or a number of entities."""


@compiled
def start_keeping(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Begin a swarm, source or sink, which has its first effect in its next step."""
    del n, p
    st.action_a[k] = 0.0
    st.action_b[k] = 0.0
    st.action_keeps_traffic[k] = 1


@compiled
def step_swarm(n: RoadTables, p: Program, st: State, k: int, dt: float) -> int:
    """Update a swarm; return 1 if it has been stopped."""
    del dt
    if st.action_b[k] == op.ACTION_ENDS:
        return 1
    keep_swarm(n, p, st, k)
    return 0


@compiled
def step_source(n: RoadTables, p: Program, st: State, k: int, dt: float) -> int:
    """Let vehicles appear at a source when they are due; return 1 if it has been stopped."""
    del dt
    if st.action_b[k] == op.ACTION_ENDS:
        return 1
    emit_due(n, p, st, k)
    return 0


@compiled
def step_sink(n: RoadTables, p: Program, st: State, k: int, dt: float) -> int:
    """Let vehicles disappear at a sink when they are due; return 1 if it has been stopped."""
    del dt
    if st.action_b[k] == op.ACTION_ENDS:
        return 1
    take_due(n, p, st, k)
    return 0


@compiled
def start_stop_traffic(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Remove background traffic: `action_lanes` entities from index `action_other`; end the actions of that name.

    `action_mode` is the index of the name, 0 for all.
    """
    del n
    for i in range(max(p.action_other[k], 0), p.action_other[k] + p.action_lanes[k]):
        kind = p.entity_motion[i]
        if p.entity_position[i] >= 0 and kind in (op.MOTION_TRAFFIC, op.MOTION_WALKER):
            st.present[i] = 0
    for other in range(p.action_count[0]):
        named = p.action_mode[k] == 0 or p.action_mode[k] == p.action_mode[other]
        if st.action_keeps_traffic[other] == 1 and named:
            st.action_b[other] = op.ACTION_ENDS


def swarm_row(draft: ProgramDraft, word: TrafficSwarmAction, actor: int) -> ActionRow:
    """Return the row of a swarm."""
    del actor
    first, count = draft.vehicles_of(word)
    return ActionRow(
        (word.inner_radius, word.semi_major, word.semi_minor, word.offset, word.same, word.opposite),
        other=first,
        lanes=count,
        mode=draft.traffic_number(word.traffic),
        flags=draft.entities[word.entity],
        position=draft.random_position(),
    )


def source_row(draft: ProgramDraft, word: TrafficSourceAction, actor: int) -> ActionRow:
    """Return the row of a source."""
    del actor
    first, count = draft.vehicles_of(word)
    return ActionRow(
        (word.radius, word.rate),
        other=first,
        lanes=count,
        mode=draft.traffic_number(word.traffic),
        position=draft.position(word.position),
    )


def sink_row(draft: ProgramDraft, word: TrafficSinkAction, actor: int) -> ActionRow:
    """Return the row of a sink."""
    del actor
    return ActionRow(
        (word.radius, 0.0 if word.rate is None else word.rate),
        mode=draft.traffic_number(word.traffic),
        position=draft.position(word.position),
    )


def stop_traffic_row(draft: ProgramDraft, word: StopTrafficAction, actor: int) -> ActionRow:
    """Return the row of an action that stops traffic.

    The entities of one background traffic are adjacent in the plan, and their ids begin with the traffic's name.
    """
    del actor
    of = [
        k
        for k, entity in enumerate(draft.plan.entities)
        if entity.kind in ("traffic", "walker")
        and entity.start is not None
        and (not word.traffic or entity.id.startswith(f"{word.traffic}."))
    ]
    return ActionRow(
        other=of[0] if of else 0,
        lanes=of[-1] - of[0] + 1 if of else 0,
        mode=draft.traffic_number(word.traffic),
    )


TRAFFIC_SWARM = Entry(
    ("traffic_swarm",),
    swarm_row,
    start_keeping,
    step_swarm,
    whose="run",
    refers={"position": index(POSITION), "flags": index(ENTITY), "other": VEHICLES, "lanes": VEHICLES},
)
TRAFFIC_SOURCE = Entry(
    ("traffic_source",),
    source_row,
    start_keeping,
    step_source,
    whose="run",
    refers={"position": index(POSITION), "other": VEHICLES, "lanes": VEHICLES},
)
TRAFFIC_SINK = Entry(
    ("traffic_sink",), sink_row, start_keeping, step_sink, whose="run", refers={"position": index(POSITION)}
)
STOP_TRAFFIC = Entry(
    ("stop_traffic",), stop_traffic_row, start_stop_traffic, whose="run", refers={"other": VEHICLES, "lanes": VEHICLES}
)
