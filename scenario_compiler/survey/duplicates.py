"""Near-duplicates: scenarios whose plans differ only in numbers, and these numbers."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from typing import Any

from scenario_compiler.expressions import Expression
from scenario_compiler.plan.model import Plan
from scenario_compiler.records import Record

UNSAID = ("name", "summary", "classifications", "origins", "derived", "digest", "parameters")
"""Parts of a plan that do not affect what happens."""

Numbers = Mapping[str, float]
"""Numbers of a plan by their paths in it."""


def likeness(plan: Plan) -> tuple[str, Numbers]:
    """Return a digest of a plan without its numbers, and the numbers by their paths.

    The names of entities do not count, only their positions in the plan. A number that depends on parameters counts as
    its expression.
    """
    ids = {entity.id: f"#{number}" for number, entity in enumerate(plan.entities)}
    content = {name: value for name, value in vars(plan).items() if name not in UNSAID}
    content["map"] = plan.map.sha256
    numbers: dict[str, float] = {}
    words: list[str] = []
    for where, value in _leaves(content, ""):
        if isinstance(value, float | int) and not isinstance(value, bool):
            numbers[where] = float(value)
            words.append(where)
        else:
            words.append(f"{where}={json.dumps(ids.get(value, value) if isinstance(value, str) else value)}")
    return hashlib.sha256("\n".join(words).encode()).hexdigest(), numbers


def differences(some: Mapping[str, Numbers]) -> dict[str, dict[str, float]]:
    """Return the numbers that differ between similar plans: by path, the value in each plan by the plan's name."""
    places = dict.fromkeys(where for numbers in some.values() for where in numbers)
    values = {where: {name: numbers[where] for name, numbers in some.items() if where in numbers} for where in places}
    return {where: found for where, found in values.items() if len(set(found.values())) > 1}


def _leaves(value: Any, where: str) -> Iterator[tuple[str, Any]]:
    """Yield the path and the value of every value that contains no others."""
    if isinstance(value, Expression):
        yield where, value.text
    elif isinstance(value, Record):
        yield from _leaves(vars(value), where)
    elif isinstance(value, Mapping):
        for key, inner in value.items():
            yield from _leaves(inner, f"{where}/{key}" if where else str(key))
    elif isinstance(value, tuple | list):
        for number, inner in enumerate(value):
            yield from _leaves(inner, f"{where}/{number}")
    else:
        yield where, value
