"""Positions relative to an entity's present position, and points of the world off the roads.

The names and meanings are those of ASAM OpenSCENARIO (Position and its kinds). `turn` is the heading relative to the
direction that the position itself defines (of the lane, the road or the entity). `heading`, if given, is absolute and
replaces it.
"""

from typing import Literal

from scenario_compiler.vocabulary.word import Number, Word, attribute

_ENTITY = "Id of the entity to which the position is relative."
_HEADING = "Heading in the world, degrees, instead of `turn`."


class FreePosition(Word):
    """A point of the world, on or off the roads, in OpenDRIVE's axes."""

    word: Literal["free"] = "free"

    x: Number = attribute("x, m.", quantity="length")
    y: Number = attribute("y, m.", quantity="length")
    z: Number | None = attribute("z, m; the road's surface if left out.", default=None, quantity="length")
    heading: Number | None = attribute(
        "Heading, degrees counter-clockwise from the x axis. If left out, it is 0, or the trajectory's own heading on "
        "a trajectory.",
        default=None,
        quantity="angle",
    )


class GeoPosition(Word):
    """A point by latitude and longitude, on maps that specify their projection."""

    word: Literal["geographic"] = "geographic"

    latitude: float = attribute("Latitude (WGS 84), degrees.", minimum=-90, maximum=90)
    longitude: float = attribute("Longitude (WGS 84), degrees.", minimum=-180, maximum=180)
    turn: Number = attribute(
        "Heading relative to the direction of s of the road there (off the roads, to the x axis), degrees.",
        default=0.0,
        quantity="angle",
    )
    heading: Number | None = attribute(_HEADING, default=None, quantity="angle")


class LanesAwayPosition(Word):
    """A point in a lane counted from an entity's lane: ASAM's RelativeLanePosition.

    Along the road, ahead and left refer to the direction of s, and the distance is that of the reference line. Along
    the lane, they refer to the lane's direction of travel, and the distance is that of the lane's centre line.
    """

    word: Literal["relative_lane"] = "relative_lane"

    entity: str = attribute(_ENTITY, names="entity")
    lanes: int = attribute(
        "Number of lanes from the entity's lane, positive to the left (the centre lane is not counted).", default=0
    )
    distance: Number = attribute("Distance ahead, m.", quantity="length")
    along: Literal["road", "lane"] = attribute(
        "Whether the distance follows the road's reference line, in the direction of s, or the centre line of the "
        "entity's lane, in its direction of travel; left is relative to that direction.",
        default="road",
    )
    offset: Number = attribute(
        "Distance from the lane's centre, m, positive to the left.", default=0.0, quantity="length"
    )
    turn: Number = attribute(
        "Heading relative to the direction of s or of travel, degrees, positive counter-clockwise.",
        default=0.0,
        quantity="angle",
    )
    heading: Number | None = attribute(_HEADING, default=None, quantity="angle")


class RelativeRoadPosition(Word):
    """A point on an entity's road, by distances along and across the road's reference line."""

    word: Literal["relative_road"] = "relative_road"

    entity: str = attribute(_ENTITY, names="entity")
    ds: Number = attribute("Distance along the road, m.", quantity="length")
    dt: Number = attribute(
        "Distance across the road, m, positive to the left in the direction of s.", quantity="length"
    )
    turn: Number = attribute("Heading relative to the road's, degrees.", default=0.0, quantity="angle")
    heading: Number | None = attribute(_HEADING, default=None, quantity="angle")


class RelativeObjectPosition(Word):
    """A point in an entity's own axes: ahead of it and to its left."""

    word: Literal["relative_object"] = "relative_object"

    entity: str = attribute(_ENTITY, names="entity")
    dx: Number = attribute("Distance ahead, m.", quantity="length")
    dy: Number = attribute("Distance to the left, m.", quantity="length")
    dz: Number = attribute("Distance above, m.", default=0.0, quantity="length")
    turn: Number = attribute("Heading relative to the entity's, degrees.", default=0.0, quantity="angle")
    heading: Number | None = attribute(_HEADING, default=None, quantity="angle")


class RelativeWorldPosition(Word):
    """A point at a distance from an entity along the world's axes."""

    word: Literal["relative_world"] = "relative_world"

    entity: str = attribute(_ENTITY, names="entity")
    dx: Number = attribute("Distance along x, m.", quantity="length")
    dy: Number = attribute("Distance along y, m.", quantity="length")
    dz: Number = attribute("Distance along z, m.", default=0.0, quantity="length")
    turn: Number = attribute("Heading relative to the entity's, degrees.", default=0.0, quantity="angle")
    heading: Number | None = attribute(_HEADING, default=None, quantity="angle")
