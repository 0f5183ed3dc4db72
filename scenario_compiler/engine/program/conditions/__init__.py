"""What a condition becomes: `CONDITIONS`, by the type of its word. One module a family of the standard."""

from __future__ import annotations

from scenario_compiler.engine import opcodes as op
from scenario_compiler.engine.program.conditions import by_entity, by_value
from scenario_compiler.engine.program.conditions.family import Family
from scenario_compiler.engine.program.draft import Draft
from scenario_compiler.vocabulary.storyboard import Edge, Trigger, TriggerCondition

CONDITIONS: Family = {**by_entity.CONDITIONS, **by_value.CONDITIONS}
"""By the type of a condition, its row."""

EDGES: dict[Edge, int] = {
    "none": op.EDGE_NONE,
    "rising": op.EDGE_RISING,
    "falling": op.EDGE_FALLING,
    "risingOrFalling": op.EDGE_BOTH,
}


def add_trigger(draft: Draft, trigger: Trigger | None, owner: int) -> int:
    """Append a trigger of an element (NONE: of the storyboard); return its row, NONE for no trigger or an empty one."""
    if trigger is None or not trigger.groups:
        return op.NONE
    p = draft.program
    for group in trigger.groups:
        for condition in group.conditions:
            add_condition(draft, condition, owner)
        p.group_first.append(p.condition_count[0])
    p.trigger_first.append(len(p.group_first) - 1)
    return len(p.trigger_first) - 2


def add_condition(draft: Draft, wrapped: TriggerCondition, owner: int) -> None:
    """Append a condition to the group under construction; its triggering entities are the trigger's, else its own.

    Raises:
        ValueError: CONDITIONS has no entry for the word.
    """
    word = wrapped.condition
    if type(word) not in CONDITIONS:
        raise ValueError(f"a program has no row for the condition <{word.tag()}>")
    row = CONDITIONS[type(word)](draft, word)
    own = (row.entity,) if row.entity else ()
    entities = [draft.entities[name] for name in wrapped.entities or own]
    draft.condition(row, entities, wrapped.every, EDGES[wrapped.edge], wrapped.delay, owner)
