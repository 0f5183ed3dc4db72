"""The type of a family's table, and the codes of transition shapes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from scenario_compiler.engine import opcodes as op
from scenario_compiler.engine.program.draft import ActionRow, Draft
from scenario_compiler.vocabulary.actions.dynamics import Shape
from scenario_compiler.vocabulary.word import Word

Family = dict[type[Word], Callable[[Draft, Any, int], ActionRow]]
"""By the type of an action: from the draft, the word and the number of the entity that does it to the action's row."""

SHAPES: dict[Shape, int] = {
    "linear": op.SHAPE_LINEAR,
    "sinusoidal": op.SHAPE_SINUSOIDAL,
    "cubic": op.SHAPE_CUBIC,
    "step": op.SHAPE_STEP,
}
