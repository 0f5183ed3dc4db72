"""Describes why the engine stopped a run: the entity, the quantity, its value, and the time."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence

from scenario_compiler.diagnostics import Code
from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.numbers import LARGEST
from scenario_compiler.recording.names import FAULTS

BROKE_OFF = Code(
    "SC523",
    "run-broke-off",
    "The run could not go on and ended early. Either a position, heading or speed became infinite, NaN, or too large "
    "to compute with; or a place that is known only during the run lies on no lane. The message names the entity, the "
    "quantity and its value. The rows up to that time are kept.\n\n"
    "    'lead' has the speed inf m/s at 3.05 s\n\n"
    "Check the actions on that entity at that time: a speed, an acceleration or a position that depends on a "
    "parameter or on another entity.",
)

QUANTITIES = {
    "x": ("x", "m"),
    "y": ("y", "m"),
    "h": ("heading", "rad"),
    "v": ("speed", "m/s"),
    "steer": ("steering angle", "rad"),
}
"""Columns that the engine keeps finite, in the order in which they are checked, with the name of each quantity and its
unit.
"""

OF_ENTITIES = (op.FAULT_NOT_FINITE, op.FAULT_OFF_ROAD_START, op.FAULT_NO_ROOM)
"""Fault codes that concern an entity."""


def break_off_text(code: int, at: int, entities: Sequence[str], values: Mapping[str, float], t: float) -> str:
    """Return why the engine stopped a run; empty for a run that it did not stop.

    Args:
        code: The engine's fault code; 0 if there is none.
        at: Subject of the fault: for the codes OF_ENTITIES, the index of the entity.
        entities: The entities' ids.
        values: That entity's values of QUANTITIES at the end.
        t: Time of the end, s.
    """
    if code == 0:
        return ""
    what = FAULTS.get(code, f"fault {code} of the engine")
    if code not in OF_ENTITIES or not 0 <= at < len(entities):
        return f"{what}, at {t:.6g} s"
    for name, (quantity, unit) in QUANTITIES.items():
        value = values[name]
        if not math.isfinite(value) or abs(value) >= LARGEST:
            return f"'{entities[at]}' has the {quantity} {value:g} {unit} at {t:.6g} s"
    return f"'{entities[at]}' at {t:.6g} s: {what}"


def equal_reasons(reasons: Iterable[tuple[int, str]]) -> list[tuple[str, int, int]]:
    """Return the reasons for which variants have no result, the most frequent first.

    Reasons that differ only in their numbers count as one, because most variants have numbers of their own.

    Args:
        reasons: The variants' numbers, rising, with their reasons.

    Returns:
        For each kind of reason the text of its first variant, the number of variants, and the first variant.
    """
    found: dict[str, tuple[str, int, int]] = {}
    for variant, reason in reasons:
        kind = kind_of(reason)
        text, count, first = found.get(kind, (reason, 0, variant))
        found[kind] = (text, count + 1, first)
    return sorted(found.values(), key=lambda one: (-one[1], one[2]))


def kind_of(reason: str) -> str:
    """Return what a reason has in common with those that differ from it only in their numbers."""
    return _NUMBER.sub("0", reason)


_NUMBER = re.compile(r"(?<![\w.])-?\d+(\.\d+)?(e[+-]?\d+)?(?![\w.]*\w)", re.ASCII)
"""A number that is not a part of a name."""
