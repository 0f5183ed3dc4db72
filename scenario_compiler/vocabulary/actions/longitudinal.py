"""Actions on an entity's speed, and on its distance to another entity along the road."""

from typing import Literal

from scenario_compiler.vocabulary.actions.dynamics import INSTEAD, OVER_TIME, AtRate, Limits, OverDistance, Shape
from scenario_compiler.vocabulary.conditions.measuring import OwnSystem
from scenario_compiler.vocabulary.word import Number, Word, attribute, child

_SHAPE = "Shape of the change from the present speed to the target."

Displacement = Literal["any", "trailingReferencedEntity", "leadingReferencedEntity"]
"""Side of the other entity on which a distance is kept: ASAM's longitudinal displacement."""


class SpeedAction(Word):
    """Change the speed to a target.

    A change that exceeds the vehicle's `max_acceleration` or `max_deceleration` takes longer, unless it is immediate;
    a target above its `max_speed` is that speed. For the automated vehicle, the target is the speed that the automation
    aims for.
    """

    word: Literal["speed"] = "speed"

    to: Number = attribute("Target speed, m/s.", quantity="speed")
    over_time: Number = attribute(OVER_TIME, default=0.0, quantity="time", minimum=0)
    shape: Shape = attribute(_SHAPE, default="linear")
    dynamics: AtRate | OverDistance | None = child(INSTEAD, default=None)


class RelativeSpeedAction(Word):
    """Change the speed to a target relative to another entity's speed, within the limits of the vehicle."""

    word: Literal["relative_speed"] = "relative_speed"

    to: str = attribute("Id of the other entity.", names="entity")
    value: Number = attribute(
        "Difference to the other entity's speed, m/s, or factor by which that speed is multiplied."
    )
    kind: Literal["delta", "factor"] = attribute("Meaning of the value: a difference or a factor.", default="delta")
    continuous: bool = attribute("Whether the speed stays relative to the other entity's afterwards.", default=False)
    over_time: Number = attribute(OVER_TIME, default=0.0, quantity="time", minimum=0)
    shape: Shape = attribute(_SHAPE, default="linear")
    dynamics: AtRate | OverDistance | None = child(INSTEAD, default=None)


class SpeedEntry(Word):
    """An entry of a speed profile."""

    word: Literal["entry"] = "entry"

    speed: Number = attribute("Target speed, m/s.", quantity="speed")
    time: Number | None = attribute(
        "Time since the previous entry, s; the shortest time that the limits allow if left out.",
        default=None,
        quantity="time",
        minimum=0,
    )


class SpeedProfileAction(Word):
    """Drive a sequence of speeds."""

    word: Literal["speed_profile"] = "speed_profile"

    to: str = attribute("Id of the entity to whose speed the values refer.", default="", names="entity")
    following: Literal["position", "follow"] = attribute(
        "Whether the speeds are followed exactly, or smoothly within the limits.", default="position"
    )
    limits: Limits | None = child("Limits of the changes.", default=None)
    entries: tuple[SpeedEntry, ...] = child("The speeds, in order.")


class LongitudinalDistanceAction(Word):
    """Reach or keep a distance or a time gap to another entity along the road."""

    word: Literal["keep_distance"] = "keep_distance"

    to: str = attribute("Id of the other entity.", names="entity")
    distance: Number | None = attribute(
        "Distance, m; the present one if neither distance nor time gap is given. A negative one is on the other side.",
        default=None,
        quantity="length",
    )
    time_gap: Number | None = attribute("Time gap, s, instead of a distance.", default=None, quantity="time")
    freespace: bool = attribute("Whether the distance is measured between the bounding boxes.", default=False)
    continuous: bool = attribute("Whether the distance is kept afterwards.", default=False)
    coordinates: OwnSystem = attribute("Coordinate system of the measurement.", default="road")
    displacement: Displacement = attribute(
        "Side of the other entity; trailing means behind it.", default="trailingReferencedEntity"
    )
    limits: Limits | None = child("Limits of the motion. Without them the entity is moved there at once.", default=None)
