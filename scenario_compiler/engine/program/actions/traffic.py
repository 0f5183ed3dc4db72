"""Actions on traffic: swarms, sources, sinks, and their end."""

from __future__ import annotations

from scenario_compiler.engine import opcodes as op
from scenario_compiler.engine.program.actions.family import Family
from scenario_compiler.engine.program.draft import ActionRow, Draft
from scenario_compiler.engine.program.positions import add_position
from scenario_compiler.plan.keeping import group_name
from scenario_compiler.plan.model import Plan
from scenario_compiler.vocabulary.actions import (
    KeepsVehicles,
    StopTrafficAction,
    TrafficSinkAction,
    TrafficSourceAction,
    TrafficSwarmAction,
)
from scenario_compiler.vocabulary.positions import RandomPosition
from scenario_compiler.vocabulary.traversal import walk


def _swarm(draft: Draft, word: TrafficSwarmAction, actor: int) -> ActionRow:
    del actor
    first, count = _vehicles(draft, word)
    return ActionRow(
        op.ACTION_TRAFFIC_SWARM,
        (word.inner_radius, word.semi_major, word.semi_minor, word.offset, word.same, word.opposite),
        other=first,
        lanes=count,
        mode=_number(draft.plan, word.traffic),
        flags=draft.entities[word.entity],
        position=add_position(draft, RandomPosition(), "traffic"),
    )


def _source(draft: Draft, word: TrafficSourceAction, actor: int) -> ActionRow:
    del actor
    first, count = _vehicles(draft, word)
    return ActionRow(
        op.ACTION_TRAFFIC_SOURCE,
        (word.radius, word.rate),
        other=first,
        lanes=count,
        mode=_number(draft.plan, word.traffic),
        position=add_position(draft, word.position),
    )


def _sink(draft: Draft, word: TrafficSinkAction, actor: int) -> ActionRow:
    del actor
    return ActionRow(
        op.ACTION_TRAFFIC_SINK,
        (word.radius, 0.0 if word.rate is None else word.rate),
        mode=_number(draft.plan, word.traffic),
        position=add_position(draft, word.position),
    )


def _stop(draft: Draft, word: StopTrafficAction, actor: int) -> ActionRow:
    """Entities of one background traffic stand side by side in the plan, and their ids begin with the traffic's."""
    del actor
    of = [
        k
        for k, entity in enumerate(draft.plan.entities)
        if entity.kind in ("traffic", "walker")
        and entity.start is not None
        and (not word.traffic or entity.id.startswith(f"{word.traffic}."))
    ]
    return ActionRow(
        op.ACTION_STOP_TRAFFIC,
        other=of[0] if of else 0,
        lanes=of[-1] - of[0] + 1 if of else 0,
        mode=_number(draft.plan, word.traffic),
    )


def _number(plan: Plan, name: str) -> int:
    """Return the number of a name among those of actions on traffic, from 1; 0 for no name."""
    kinds = (TrafficSwarmAction, TrafficSourceAction, TrafficSinkAction, StopTrafficAction)
    names = {word.traffic for word in walk(plan.storyboard) if isinstance(word, kinds)}
    return sorted({"", *names}).index(name)


def _vehicles(draft: Draft, word: KeepsVehicles) -> tuple[int, int]:
    """Return the first of an action's entities and their number; actions are added in the plan's order."""
    group = group_name(word, draft.traffic)
    kept = [(k, one.id) for k, one in enumerate(draft.plan.entities) if one.kind == "traffic" and one.start is None]
    of = [k for k, name in kept if name.rpartition(".")[0] == group]
    return (of[0], len(of)) if of else (0, 0)


ACTIONS: Family = {
    TrafficSwarmAction: _swarm,
    TrafficSourceAction: _source,
    TrafficSinkAction: _sink,
    StopTrafficAction: _stop,
}
