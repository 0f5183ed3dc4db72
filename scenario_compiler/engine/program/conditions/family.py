"""The type of a family's table, and the codes of comparisons."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from scenario_compiler.engine import opcodes as op
from scenario_compiler.engine.program.draft import ConditionRow, Draft
from scenario_compiler.vocabulary.conditions.measuring import Rule
from scenario_compiler.vocabulary.word import Word

Family = dict[type[Word], Callable[[Draft, Any], ConditionRow]]
"""By the type of a condition: from the draft and the word to the condition's row."""

RULES: dict[Rule, int] = {
    "lessThan": op.RULE_LESS,
    "lessOrEqual": op.RULE_LESS_OR_EQUAL,
    "greaterThan": op.RULE_GREATER,
    "greaterOrEqual": op.RULE_GREATER_OR_EQUAL,
    "equalTo": op.RULE_EQUAL,
    "notEqualTo": op.RULE_NOT_EQUAL,
}
