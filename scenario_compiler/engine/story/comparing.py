"""Comparison of a measured value with a limit, with the tolerance of esmini 3.6."""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.log import fault
from scenario_compiler.engine.columns.state import State
from scenario_compiler.marker import compiled


@compiled
def compare(st: State, rule: int, value: float, limit: float) -> int:
    """Return 1 if value and limit satisfy the rule, with the tolerance TOLERANCE."""
    if rule == op.RULE_LESS:
        return 1 if value < limit - op.TOLERANCE else 0
    if rule == op.RULE_LESS_OR_EQUAL:
        return 1 if value <= limit + op.TOLERANCE else 0
    if rule == op.RULE_GREATER:
        return 1 if value > limit + op.TOLERANCE else 0
    if rule == op.RULE_GREATER_OR_EQUAL:
        return 1 if value >= limit - op.TOLERANCE else 0
    near = 1 if abs(value - limit) <= op.TOLERANCE else 0
    if rule == op.RULE_EQUAL:
        return near
    if rule == op.RULE_NOT_EQUAL:
        return 1 - near
    fault(st, op.FAULT_UNKNOWN_RULE, rule)
    return 0
