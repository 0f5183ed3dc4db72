"""Actions on an entity's lateral position."""

from typing import Literal

from scenario_compiler.vocabulary.actions.dynamics import INSTEAD, OVER_TIME, AtRate, Limits, OverDistance, Shape
from scenario_compiler.vocabulary.conditions.measuring import OwnSystem
from scenario_compiler.vocabulary.word import Number, Word, attribute, child

_SHAPE = "Shape of the lateral motion from one lane to the other."
_OFFSET = "Final distance from the new lane's centre, m, along the road's t axis: positive to the left of s."


class LaneChangeAction(Word):
    """Change to a neighbouring lane, counted from the lane of this entity or of another one.

    The speed is that along the path. An entity that is too slow for the duration takes longer, and a standing one
    waits. The automation of the automated vehicle steers to the lane by itself, with at most 3 m/s2 to the side.
    """

    word: Literal["lane_change"] = "lane_change"

    by: int = attribute(
        "Number of lanes, positive to the left and negative to the right, in the direction of travel of the entity "
        "from which lanes are counted."
    )
    over_time: Number = attribute(OVER_TIME, default=0.0, quantity="time", minimum=0)
    shape: Shape = attribute(_SHAPE, default="sinusoidal")
    of: str = attribute(
        "Id of the entity from whose lane the lanes are counted; the entity itself if left out.",
        default="",
        names="entity",
    )
    offset: Number = attribute(_OFFSET, default=0.0, quantity="length")
    dynamics: AtRate | OverDistance | None = child(INSTEAD, default=None)


class LaneChangeToAction(Word):
    """Change to the lane with a given id, on the road that the entity is on; otherwise like <lane_change>."""

    word: Literal["lane_change_to"] = "lane_change_to"

    lane: int = attribute("Id of the lane.")
    over_time: Number = attribute(OVER_TIME, default=0.0, quantity="time", minimum=0)
    shape: Shape = attribute(_SHAPE, default="sinusoidal")
    offset: Number = attribute(_OFFSET, default=0.0, quantity="length")
    dynamics: AtRate | OverDistance | None = child(INSTEAD, default=None)


class LaneOffsetAction(Word):
    """Move sideways to an offset from the lane's centre, within the lane or beyond it.

    An entity that is too slow for the duration takes longer, and a standing one waits. The automation of the automated
    vehicle steers there by itself, with at most 1 m/s2 to the side.
    """

    word: Literal["lane_offset"] = "lane_offset"

    to: Number = attribute(
        "Distance from the lane's centre, m, positive to the left in the entity's direction of travel.",
        quantity="length",
    )
    over_time: Number = attribute("Duration of the move, s; with 0 it is immediate.", quantity="time", minimum=0)
    shape: Shape = attribute("Shape of the motion from the present offset to the target.", default="sinusoidal")


class LimitedLaneOffsetAction(Word):
    """Move to an offset, limited by a lateral acceleration: ASAM's LaneOffsetAction."""

    word: Literal["limited_lane_offset"] = "limited_lane_offset"

    to: Number = attribute(
        "Distance from the lane's centre, m, along the t axis: positive to the left of s. With `of`, the distance from "
        "that entity, positive to its left.",
        quantity="length",
    )
    of: str = attribute("Id of the entity to whose position the offset refers.", default="", names="entity")
    acceleration: Number | None = attribute(
        "Greatest lateral acceleration, m/s2; 0.5 if left out or 0.", default=None, quantity="acceleration", minimum=0
    )
    shape: Shape = attribute("Shape of the motion from the present offset to the target.", default="sinusoidal")
    continuous: bool = attribute("Whether the offset is kept afterwards.", default=False)


class LateralDistanceAction(Word):
    """Reach or keep a lateral distance to another entity."""

    word: Literal["keep_lateral_distance"] = "keep_lateral_distance"

    to: str = attribute("Id of the other entity.", names="entity")
    distance: Number | None = attribute("Distance, m; the present one if left out.", default=None, quantity="length")
    freespace: bool = attribute("Whether the distance is measured between the bounding boxes.", default=False)
    continuous: bool = attribute("Whether the distance is kept afterwards.", default=False)
    coordinates: OwnSystem = attribute("Coordinate system of the measurement.", default="lane")
    displacement: Literal["any", "leftToReferencedEntity", "rightToReferencedEntity"] = attribute(
        "Side of the other entity.", default="any"
    )
    limits: Limits | None = child("Limits of the motion. Without them the entity is moved there at once.", default=None)
