"""The type of a family's table, the codes of what actions share, and the numbers of dynamics and limits."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from scenario_compiler.engine import opcodes as op
from scenario_compiler.engine.program.draft import ActionRow, Draft, Slot
from scenario_compiler.vocabulary.actions.dynamics import AtRate, Limits, OverDistance, Shape
from scenario_compiler.vocabulary.word import Word

Family = dict[type[Word], Callable[[Draft, Any, int], ActionRow]]
"""By the type of an action: from the draft, the word and the number of the entity that does it to the action's row."""

SHAPES: dict[Shape, int] = {
    "linear": op.SHAPE_LINEAR,
    "sinusoidal": op.SHAPE_SINUSOIDAL,
    "cubic": op.SHAPE_CUBIC,
    "step": op.SHAPE_STEP,
}


def dynamics_of(over_time: Slot, instead: AtRate | OverDistance | None) -> tuple[Slot, int]:
    """Return the number of a change's dynamics and its DIMENSION_... code."""
    if instead is None:
        return over_time, op.DIMENSION_TIME
    return instead.value, op.DIMENSION_RATE if isinstance(instead, AtRate) else op.DIMENSION_DISTANCE


def limits_of(limits: Limits | None) -> tuple[Slot, ...]:
    """Return the numbers of a motion's limits, in the order of `slots`, negative for those left out."""
    if limits is None:
        return (-1.0,) * 5
    given = (limits.acceleration, limits.acceleration_rate, limits.deceleration, limits.deceleration_rate, limits.speed)
    return tuple(-1.0 if limit is None else limit for limit in given)


def flags_of(*flags: tuple[int, bool]) -> int:
    """Return the flags that are set, as bits."""
    return sum(flag for flag, on in flags if on)
