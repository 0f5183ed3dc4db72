"""How values change: shapes, and what a change is bounded or timed by."""

from typing import Literal

from scenario_compiler.vocabulary.word import Number, Word, attribute

Shape = Literal["linear", "cubic", "sinusoidal", "step"]
"""How a value goes from its start to its target: ASAM's DynamicsShape."""


class AtRate(Word):
    """The change goes at a rate."""

    word: Literal["at_rate"] = "at_rate"

    value: Number = attribute("Greatest rate of the change, m/s2 for a speed, m/s for an offset; its sign is ignored.")


class OverDistance(Word):
    """The change takes a distance."""

    word: Literal["over_distance"] = "over_distance"

    value: Number = attribute("Distance, m.", quantity="length", minimum=0)


class Limits(Word):
    """Limits of a motion: ASAM's DynamicConstraints. What is left out is the vehicle's own."""

    word: Literal["limits"] = "limits"

    acceleration: Number | None = attribute(
        "Greatest acceleration, m/s2.", default=None, quantity="acceleration", minimum=0
    )
    acceleration_rate: Number | None = attribute("Greatest rise of the acceleration, m/s3.", default=None, minimum=0)
    deceleration: Number | None = attribute(
        "Greatest deceleration, m/s2.", default=None, quantity="acceleration", minimum=0
    )
    deceleration_rate: Number | None = attribute("Greatest rise of the deceleration, m/s3.", default=None, minimum=0)
    speed: Number | None = attribute("Greatest speed, m/s.", default=None, quantity="speed", minimum=0)
