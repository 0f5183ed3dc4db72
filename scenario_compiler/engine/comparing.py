"""Comparison of a measured value with a limit, with the tolerance of esmini 3.6."""

from __future__ import annotations

from scenario_compiler.engine.faults import fault
from scenario_compiler.engine.opcodes import (
    FAULT_UNKNOWN_RULE,
    RULE_EQUAL,
    RULE_GREATER,
    RULE_GREATER_OR_EQUAL,
    RULE_LESS,
    RULE_LESS_OR_EQUAL,
    RULE_NOT_EQUAL,
    TOLERANCE,
)
from scenario_compiler.engine.state import State
from scenario_compiler.marker import compiled


@compiled
def compare(st: State, rule: int, value: float, limit: float) -> int:
    """Return 1 where the value stands to the limit as the rule says."""
    if rule == RULE_LESS:
        return 1 if value < limit - TOLERANCE else 0
    if rule == RULE_LESS_OR_EQUAL:
        return 1 if value <= limit + TOLERANCE else 0
    if rule == RULE_GREATER:
        return 1 if value > limit + TOLERANCE else 0
    if rule == RULE_GREATER_OR_EQUAL:
        return 1 if value >= limit - TOLERANCE else 0
    near = 1 if abs(value - limit) <= TOLERANCE else 0
    if rule == RULE_EQUAL:
        return near
    if rule == RULE_NOT_EQUAL:
        return 1 - near
    fault(st, FAULT_UNKNOWN_RULE, rule)
    return 0
