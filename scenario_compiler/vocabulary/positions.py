"""Positions: where an entity stands or a condition looks, as the author writes them and as the plan binds them.

After lowering only `LanePosition` and `RelativeLanePosition` are left: world positions and spawn points are bound to a
road, a lane, s and an offset.
"""

from __future__ import annotations

from typing import Literal

from scenario_compiler.vocabulary.word import Number, Word, attribute


class LanePosition(Word):
    """A point in a lane of a road, facing the lane's direction of travel."""

    word: Literal["lane"] = "lane"

    road: str = attribute("Id of the road in the map.", names="road")
    lane: int = attribute("Id of the lane: negative right of the reference line, positive left of it.")
    s: Number = attribute("Distance along the road's reference line, m.", quantity="length", minimum=0)
    offset: Number = attribute(
        "Distance from the lane's centre, m, positive to the left in the direction of s.",
        default=0.0,
        quantity="length",
    )
    turn: Number = attribute(
        "Heading relative to the lane's direction of travel, degrees, positive counter-clockwise.",
        default=0.0,
        quantity="angle",
    )


class RoadPosition(Word):
    """A point beside a road's reference line, facing along s."""

    word: Literal["road"] = "road"

    road: str = attribute("Id of the road in the map.", names="road")
    s: Number = attribute("Distance along the road's reference line, m.", quantity="length", minimum=0)
    t: Number = attribute("Distance from the reference line, m, positive to the left.", quantity="length")
    turn: Number = attribute(
        "Heading relative to the direction of s, degrees, positive counter-clockwise.",
        default=0.0,
        quantity="angle",
    )


class WorldPosition(Word):
    """A point of the world, bound to the nearest lane that contains it."""

    word: Literal["world"] = "world"

    frame: Literal["opendrive", "carla"] = attribute(
        "Axes of x, y and yaw: OpenDRIVE's (y to the left of x, yaw counter-clockwise) or CARLA's (y to the right, yaw "
        "clockwise, the point is the centre of the vehicle's box).",
        default="opendrive",
    )
    x: Number = attribute("x, m.", quantity="length")
    y: Number = attribute("y, m.", quantity="length")
    yaw: Number = attribute("Heading in the frame, degrees.", default=0.0, quantity="angle")


class SpawnPoint(Word):
    """A spawn point that the map names."""

    word: Literal["spawn_point"] = "spawn_point"

    name: str = attribute("Name of the spawn point in the map's map.toml.", names="spawn_point")


class RelativeLanePosition(Word):
    """A point ahead of (or behind) an entity along the lanes it travels on."""

    word: Literal["ahead_of"] = "ahead_of"

    entity: str = attribute("Id of the entity that the position is relative to.", names="entity")
    distance: Number = attribute("Distance ahead along the entity's lane, m; negative is behind.", quantity="length")
    lanes: int = attribute(
        "Lanes to the left of the entity's lane in its direction of travel; negative is to the right.",
        default=0,
    )
    offset: Number = attribute(
        "Distance from the lane's centre, m, positive to the left in the entity's direction of travel.",
        default=0.0,
        quantity="length",
    )
    turn: Number = attribute(
        "Heading relative to the lane's direction of travel, degrees, positive counter-clockwise.",
        default=0.0,
        quantity="angle",
    )


Position = LanePosition | RoadPosition | WorldPosition | SpawnPoint | RelativeLanePosition
BoundPosition = LanePosition | RelativeLanePosition
