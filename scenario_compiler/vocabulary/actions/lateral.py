"""Actions across the lanes."""

from typing import Literal

from scenario_compiler.vocabulary.actions.dynamics import AtRate, Limits, OverDistance, Shape
from scenario_compiler.vocabulary.conditions.measuring import CoordinateSystem
from scenario_compiler.vocabulary.word import Number, Word, attribute, child

_SHAPE = "How the offset goes from one lane to the other."
_INSTEAD = "A rate or a distance in place of the duration."
_OFFSET = "Distance from the new lane's centre at the end, m, along the road's t axis: positive to the left of s."


class LaneChangeAction(Word):
    """Move to a neighbouring lane, counted from the lane that the entity, or another one, is in."""

    word: Literal["lane_change"] = "lane_change"

    by: int = attribute(
        "Number of lanes, positive to the left in the direction of travel of the entity counted from, negative to the "
        "right."
    )
    over_time: Number = attribute("Duration of the change, s.", default=0.0, quantity="time", minimum=0)
    shape: Shape = attribute(_SHAPE, default="sinusoidal")
    of: str = attribute("Id of the entity counted from; the entity itself when left out.", default="", names="entity")
    offset: Number = attribute(_OFFSET, default=0.0, quantity="length")
    dynamics: AtRate | OverDistance | None = child(_INSTEAD, default=None)


class LaneChangeToAction(Word):
    """Move to the lane of an id, on the road that the entity is on."""

    word: Literal["lane_change_to"] = "lane_change_to"

    lane: int = attribute("Id of the lane.")
    over_time: Number = attribute("Duration of the change, s.", default=0.0, quantity="time", minimum=0)
    shape: Shape = attribute(_SHAPE, default="sinusoidal")
    offset: Number = attribute(_OFFSET, default=0.0, quantity="length")
    dynamics: AtRate | OverDistance | None = child(_INSTEAD, default=None)


class LaneOffsetAction(Word):
    """Move sideways within the lane, or out of it: to an offset from the lane's centre."""

    word: Literal["lane_offset"] = "lane_offset"

    to: Number = attribute(
        "Distance from the lane's centre, m, positive to the left in the entity's direction of travel.",
        quantity="length",
    )
    over_time: Number = attribute("Duration of the move, s.", quantity="time", minimum=0)
    shape: Shape = attribute("How the offset goes from its present value to the target.", default="sinusoidal")


class LimitedLaneOffsetAction(Word):
    """Move to an offset as fast as a lateral acceleration lets it: ASAM's LaneOffsetAction."""

    word: Literal["limited_lane_offset"] = "limited_lane_offset"

    to: Number = attribute(
        "Distance from the lane's centre, or from where the other entity is, m, along the t axis: positive to the "
        "left of s.",
        quantity="length",
    )
    of: str = attribute("Id of the entity whose offset is counted from.", default="", names="entity")
    acceleration: Number | None = attribute(
        "Greatest lateral acceleration, m/s2.", default=None, quantity="acceleration", minimum=0
    )
    shape: Shape = attribute("How the offset goes from its present value to the target.", default="sinusoidal")
    continuous: bool = attribute("Whether the offset is kept from then on.", default=False)


class LateralDistanceAction(Word):
    """Reach, or keep, a distance to another entity across the road."""

    word: Literal["keep_lateral_distance"] = "keep_lateral_distance"

    to: str = attribute("Id of the other entity.", names="entity")
    distance: Number | None = attribute(
        "The distance, m; the present one when left out.", default=None, quantity="length"
    )
    freespace: bool = attribute("Whether it is measured between the boxes.", default=False)
    continuous: bool = attribute("Whether it is kept from then on.", default=False)
    coordinates: CoordinateSystem = attribute("In which system it is measured.", default="lane")
    displacement: Literal["any", "leftToReferencedEntity", "rightToReferencedEntity"] = attribute(
        "On which side of the other entity.", default="any"
    )
    limits: Limits | None = child("Limits of the motion; without them the entity is put there at once.", default=None)
