"""Positions on roads: in lanes, beside reference lines, at spawn points, at random, or relative to an entity."""

from typing import Literal

from scenario_compiler.vocabulary.word import Number, Word, attribute, child

Surface = Literal["driving", "biking", "shoulder", "sidewalk"]
"""Kinds of lanes. `driving` includes every lane that motor traffic may use."""


class LanePositionWord(Word):
    """A point in a lane, facing the lane's direction of travel."""

    word: Literal["lane"] = "lane"

    road: str = attribute("Id of the road in the map.", names="road")
    lane: int = attribute("Id of the lane: negative to the right of the reference line, positive to the left.")
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
    heading: Number | None = attribute(
        "Heading in the world, degrees, instead of `turn`.", default=None, quantity="angle"
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
    heading: Number | None = attribute(
        "Heading in the world, degrees, instead of `turn`.", default=None, quantity="angle"
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
    """A spawn point by its name: one of the scenario's own or, if there is none, one of the map's."""

    word: Literal["spawn_point"] = "spawn_point"

    name: str = attribute(
        "Name of the spawn point in the scenario's <spawn_points> or in the map's map.toml.", names="spawn_point"
    )


class NumberedSpawnPoint(Word):
    """A spawn point by its index in the scenario's own list, or in the map's list if the scenario has none."""

    word: Literal["numbered_spawn_point"] = "numbered_spawn_point"

    index: int = attribute("Index in the list, counted from 0.", minimum=0)


class RandomSpawnPoint(Word):
    """A spawn point drawn at random from the scenario's list, or from the map's list if the scenario has none.

    Without a seed, a spawn point that would put the entity into the box of an entity placed before is drawn again.
    """

    word: Literal["random_spawn_point"] = "random_spawn_point"

    seed: int | None = attribute(
        "Seed of the draw. With a seed the spawn point is always the same; without one, each run and each variant of "
        "a sweep has its own.",
        default=None,
        minimum=0,
    )


class RelativeLanePosition(Word):
    """A point ahead of or behind an entity, along the lanes on which it travels.

    In a path or a condition it is measured from the entity's start, in an action that places another one from where the
    entity is then.
    """

    word: Literal["ahead_of"] = "ahead_of"

    entity: str = attribute("Id of the entity to which the position is relative.", names="entity")
    distance: Number = attribute(
        "Distance ahead along the entity's lane, m; negative values are behind.", quantity="length"
    )
    lanes: int = attribute(
        "Lanes to the left of the entity's lane in its direction of travel; negative values are to the right.",
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


class BesidePosition(Word):
    """A point beside an entity, and ahead of it if required, measured from the entity's own position in its lane.

    In a path or a condition it is measured from the entity's start, in an action that places another one from where the
    entity is then.
    """

    word: Literal["beside"] = "beside"

    entity: str = attribute("Id of the entity to which the position is relative.", names="entity")
    distance: Number = attribute(
        "Distance across the lane, m, positive to the left in the lane's direction of travel.", quantity="length"
    )
    ahead: Number = attribute(
        "Distance ahead along the entity's lane, m; negative values are behind.", default=0.0, quantity="length"
    )
    turn: Number = attribute(
        "Heading relative to the lane's direction of travel, degrees, positive counter-clockwise.",
        default=0.0,
        quantity="angle",
    )


class RandomPosition(Word):
    """A place drawn at random, uniformly over the permitted lanes, at a distance from entities placed before.

    Entities with fixed start positions are placed first. Those with random positions follow in the order of the file.
    No entity is placed inside the box of another one, whatever the value of `clear`. Objects `beside` the entity count
    as part of it.
    """

    word: Literal["random"] = "random"

    on: Surface = attribute("Kind of the lanes.", default="driving")
    roads: tuple[str, ...] = attribute(
        "Ids of the roads; all roads outside junctions if left out.", default=(), names="road", separated=True
    )
    lane: int | None = attribute("Id of the lane on these roads; any lane if left out.", default=None)
    s_from: float = attribute("Least distance along the road, m.", default=0.0, quantity="length", minimum=0)
    s_to: float | None = attribute(
        "Greatest distance along the road, m; the road's end if left out.", default=None, quantity="length", minimum=0
    )
    clear: Number = attribute(
        "Least distance to the reference point of any entity placed before, m.",
        default=15.0,
        quantity="length",
        minimum=0,
    )
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
    seed: int | None = attribute(
        "Seed of the draw. With a seed the place is always the same; without one, each run and each variant of a "
        "sweep has its own.",
        default=None,
        minimum=0,
    )


class AnyOfPosition(Word):
    """One of several places in lanes, drawn at random: the bound form of a random spawn point."""

    word: Literal["any_of"] = "any_of"

    clear: Number = attribute(
        "Least distance to the reference point of any entity placed before, m.",
        default=0.0,
        quantity="length",
        minimum=0,
    )
    places: tuple[LanePositionWord, ...] = child("The places.")
