"""Transitions: their shapes, and what limits their rate or duration."""

from typing import Literal

from scenario_compiler.vocabulary.word import Number, Word, attribute

Shape = Literal["linear", "cubic", "sinusoidal", "step"]
"""Shape of a transition from its start value to its target: ASAM's DynamicsShape."""

OVER_TIME = "Duration of the change, s; with 0 it is immediate."
INSTEAD = "A rate or a distance instead of the duration."
"""Descriptions of the parts of a transition that words of actions have."""


class AtRate(Word):
    """The transition has a given rate."""

    word: Literal["at_rate"] = "at_rate"

    value: Number = attribute(
        "Greatest rate, m/s2 for a speed, m/s for an offset; the sign is ignored. With 0 the transition is immediate."
    )


class OverDistance(Word):
    """The transition takes a given distance."""

    word: Literal["over_distance"] = "over_distance"

    value: Number = attribute("Distance, m; with 0 the transition is immediate.", quantity="length", minimum=0)


class Limits(Word):
    """Limits of a motion: ASAM's DynamicConstraints. Limits that are left out are those of the vehicle."""

    word: Literal["limits"] = "limits"

    acceleration: Number | None = attribute(
        "Greatest acceleration, m/s2.", default=None, quantity="acceleration", minimum=0
    )
    acceleration_rate: Number | None = attribute(
        "Greatest increase of the acceleration, m/s3.", default=None, minimum=0
    )
    deceleration: Number | None = attribute(
        "Greatest deceleration, m/s2.", default=None, quantity="acceleration", minimum=0
    )
    deceleration_rate: Number | None = attribute(
        "Greatest increase of the deceleration, m/s3.", default=None, minimum=0
    )
    speed: Number | None = attribute("Greatest speed, m/s.", default=None, quantity="speed", minimum=0)
