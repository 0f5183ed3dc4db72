"""Triggers: condition groups, conditions with their edges and delays, and triggering entities."""

from __future__ import annotations

from typing import get_args

from scenario_compiler.expressions import Expression
from scenario_compiler.openscenario.conditions import read_condition
from scenario_compiler.openscenario.node import Node
from scenario_compiler.vocabulary.storyboard import ConditionGroup, Edge, Trigger, TriggerCondition

EDGES: tuple[Edge, ...] = get_args(Edge)

OLD_EDGES = {"any": "risingOrFalling"}
"""Names of edges in drafts before 1.0."""


def read_start_trigger(node: Node, tag: str = "StartTrigger") -> Trigger | None:
    """Return a start trigger; None, which means at once, if there is none or it has no group."""
    trigger = node.child(tag)
    read = None if trigger is None else read_trigger(trigger)
    written = [] if trigger is None else trigger.children("ConditionGroup")
    return read if written else None


def read_stop_trigger(node: Node) -> Trigger | None:
    """Return a stop trigger; None, which means never, if there is none or it has no group."""
    return read_start_trigger(node, "StopTrigger")


def read_trigger(node: Node) -> Trigger:
    """Return a trigger without the groups that contain an unreadable condition, because they never become true."""
    groups = [_group(one) for one in node.children("ConditionGroup")]
    return Trigger.model_construct(groups=tuple(one for one in groups if one is not None)).written_at(node.origin)


def _group(node: Node) -> ConditionGroup | None:
    read = [_condition(one) for one in node.children("Condition")]
    conditions = tuple(one for one in read if one is not None)
    if len(conditions) < len(read):
        return None
    return ConditionGroup.model_construct(conditions=conditions).written_at(node.origin)


def _condition(node: Node) -> TriggerCondition | None:
    name = node.text("name", "")
    by_entity, by_value = node.child("ByEntityCondition"), node.child("ByValueCondition")
    entities: tuple[str, ...] = ()
    every = False
    inner: Node | None = None
    if by_entity is not None:
        triggering = by_entity.required("TriggeringEntities")
        if triggering is not None:
            every = triggering.choice("triggeringEntitiesRule", ("any", "all"), "any") == "all"
            entities = _entities(triggering)
        around = by_entity.required("EntityCondition")
        inner = None if around is None else around.first()
    elif by_value is not None:
        inner = by_value.first()
    else:
        node.required("ByEntityCondition", "ByValueCondition")
    condition = None if inner is None else read_condition(inner)
    edge, delay = _edge(node), _delay(node)
    if condition is None or (by_entity is not None and not entities):
        return None
    return TriggerCondition.model_construct(
        name=name, condition=condition, entities=entities, every=every, edge=edge, delay=delay
    ).written_at(node.origin)


def _entities(triggering: Node) -> tuple[str, ...]:
    named = triggering.children("EntityRef", "Entity")
    return tuple(dict.fromkeys(entity for one in named for entity in one.entities("entityRef")))


def _edge(node: Node) -> Edge:
    text = str(node.element.get("conditionEdge", "")).strip()
    if text in OLD_EDGES:
        node.has("conditionEdge")
        return "risingOrFalling"
    return node.choice("conditionEdge", EDGES, "none")


def _delay(node: Node) -> float | Expression:
    delay = node.number("delay", 0.0)
    return max(0.0, delay) if isinstance(delay, float) else delay
