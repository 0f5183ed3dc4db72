"""Actions on an entity's speed."""

from __future__ import annotations

from typing import Literal

from scenario_compiler.vocabulary.word import Number, Word, attribute

Shape = Literal["linear", "cubic", "sinusoidal", "step"]
"""How a value goes from its start to its target: ASAM's dynamicsShape."""


class SpeedAction(Word):
    """Change the speed to a target."""

    word: Literal["speed"] = "speed"

    to: Number = attribute("Speed to reach, m/s.", quantity="speed")
    over_time: Number = attribute(
        "Duration of the change, s; 0 changes at once.", default=0.0, quantity="time", minimum=0
    )
    shape: Shape = attribute("How the speed goes from its present value to the target.", default="linear")
