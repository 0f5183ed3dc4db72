"""The extent of an entity before and behind its reference point, the middle of the rear axle."""

from __future__ import annotations

from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.marker import compiled


@compiled
def front_of(p: Program, i: int) -> float:
    """Return the distance from the reference point forwards to the front of the box, m."""
    return p.const[p.entity_const[i] + slot.E_CENTER] + 0.5 * p.const[p.entity_const[i] + slot.E_LENGTH]


@compiled
def rear_of(p: Program, i: int) -> float:
    """Return the distance from the reference point backwards to the rear of the box, m."""
    return 0.5 * p.const[p.entity_const[i] + slot.E_LENGTH] - p.const[p.entity_const[i] + slot.E_CENTER]
