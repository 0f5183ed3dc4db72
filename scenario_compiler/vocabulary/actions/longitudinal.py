"""Actions on an entity's speed, and on its distance to another along the road."""

from typing import Literal

from scenario_compiler.vocabulary.actions.dynamics import AtRate, Limits, OverDistance, Shape
from scenario_compiler.vocabulary.conditions.measuring import CoordinateSystem
from scenario_compiler.vocabulary.word import Number, Word, attribute, child

_OVER_TIME = "Duration of the change, s; 0 changes at once."
_SHAPE = "How the speed goes from its present value to the target."
_INSTEAD = "A rate or a distance in place of the duration."

Displacement = Literal["any", "trailingReferencedEntity", "leadingReferencedEntity"]
"""On which side of the other entity a distance is kept: ASAM's longitudinal displacement."""


class SpeedAction(Word):
    """Change the speed to a target."""

    word: Literal["speed"] = "speed"

    to: Number = attribute("Speed to reach, m/s.", quantity="speed")
    over_time: Number = attribute(_OVER_TIME, default=0.0, quantity="time", minimum=0)
    shape: Shape = attribute(_SHAPE, default="linear")
    dynamics: AtRate | OverDistance | None = child(_INSTEAD, default=None)


class RelativeSpeedAction(Word):
    """Change the speed to a target that depends on another entity's."""

    word: Literal["relative_speed"] = "relative_speed"

    to: str = attribute("Id of the other entity.", names="entity")
    value: Number = attribute("What is added to the other's speed, m/s, or what it is multiplied by.")
    kind: Literal["delta", "factor"] = attribute("Whether the value is added or multiplied by.", default="delta")
    continuous: bool = attribute("Whether the speed is kept relative to the other's from then on.", default=False)
    over_time: Number = attribute(_OVER_TIME, default=0.0, quantity="time", minimum=0)
    shape: Shape = attribute(_SHAPE, default="linear")
    dynamics: AtRate | OverDistance | None = child(_INSTEAD, default=None)


class SpeedEntry(Word):
    """A speed of a profile."""

    word: Literal["entry"] = "entry"

    speed: Number = attribute("Speed to reach, m/s.", quantity="speed")
    time: Number | None = attribute(
        "How long after the entry before, s; as soon as the limits allow when left out.",
        default=None,
        quantity="time",
        minimum=0,
    )


class SpeedProfileAction(Word):
    """Go through a series of speeds."""

    word: Literal["speed_profile"] = "speed_profile"

    to: str = attribute("Id of the entity that the speeds are relative to.", default="", names="entity")
    following: Literal["position", "follow"] = attribute(
        "Whether the speeds are met exactly, or smoothly within the limits.", default="position"
    )
    limits: Limits | None = child("Limits of the changes.", default=None)
    entries: tuple[SpeedEntry, ...] = child("The speeds, in order.")


class LongitudinalDistanceAction(Word):
    """Reach, or keep, a distance or a time gap to another entity along the road."""

    word: Literal["keep_distance"] = "keep_distance"

    to: str = attribute("Id of the other entity.", names="entity")
    distance: Number | None = attribute(
        "The distance, m; the present one when neither is given.", default=None, quantity="length"
    )
    time_gap: Number | None = attribute("The time gap, s, in place of a distance.", default=None, quantity="time")
    freespace: bool = attribute("Whether it is measured between the boxes.", default=False)
    continuous: bool = attribute("Whether it is kept from then on.", default=False)
    coordinates: CoordinateSystem = attribute("In which system it is measured.", default="road")
    displacement: Displacement = attribute(
        "On which side of the other entity; trailing is behind it.", default="trailingReferencedEntity"
    )
    limits: Limits | None = child("Limits of the motion; without them the entity is put there at once.", default=None)
