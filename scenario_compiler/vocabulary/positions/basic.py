"""Positions on the map's roads: in lanes, beside reference lines, at spawn points, at random, ahead of an entity."""

from typing import Literal

from scenario_compiler.vocabulary.word import Number, Word, attribute, child

Surface = Literal["driving", "biking", "shoulder", "sidewalk"]
"""Kinds of lanes that things stand on; `driving` is every lane that motor traffic may use."""


class LanePositionWord(Word):
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
    heading: Number | None = attribute(
        "Heading in the world, degrees, in place of `turn`.", default=None, quantity="angle"
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
        "Heading in the world, degrees, in place of `turn`.", default=None, quantity="angle"
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
    """A spawn point by its name: one of the scenario's own, else one that the map names."""

    word: Literal["spawn_point"] = "spawn_point"

    name: str = attribute(
        "Name of the spawn point in the scenario's <spawn_points> or in the map's map.toml.", names="spawn_point"
    )


class NumberedSpawnPoint(Word):
    """A spawn point by its place in the scenario's own list, or in the map's where the scenario has none."""

    word: Literal["numbered_spawn_point"] = "numbered_spawn_point"

    index: int = attribute("Its place in the list, counted from 0.", minimum=0)


class RandomSpawnPoint(Word):
    """One of the spawn points of the scenario, or of the map where the scenario has none, drawn at random.

    Without a seed it is a free one: where it would stand in the box of an entity placed before, it is drawn again.
    """

    word: Literal["random_spawn_point"] = "random_spawn_point"

    seed: int | None = attribute(
        "Seed of the draw: the same one always. Left out, each run and each variant of a sweep has its own.",
        default=None,
        minimum=0,
    )


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


class BesidePosition(Word):
    """A point beside (and ahead of) an entity, measured from where the entity itself stands in its lane."""

    word: Literal["beside"] = "beside"

    entity: str = attribute("Id of the entity that the position is relative to.", names="entity")
    distance: Number = attribute(
        "Distance across the lane, m, positive to the left in the lane's direction of travel.", quantity="length"
    )
    ahead: Number = attribute(
        "Distance ahead along the entity's lane, m; negative is behind.", default=0.0, quantity="length"
    )
    turn: Number = attribute(
        "Heading relative to the lane's direction of travel, degrees, positive counter-clockwise.",
        default=0.0,
        quantity="angle",
    )


class RandomPosition(Word):
    """A place drawn at random, evenly over the lanes that are left to choose from, clear of entities placed before.

    Entities with fixed starts are placed first, those at random after them in the order of the file. None stands in
    another's box, whatever `clear` says; things `beside` the entity count as part of it.
    """

    word: Literal["random"] = "random"

    on: Surface = attribute("Kind of the lanes.", default="driving")
    roads: tuple[str, ...] = attribute(
        "Ids of the roads; all roads outside of junctions when left out.", default=(), names="road", separated=True
    )
    lane: int | None = attribute("Id of the lane on these roads; any when left out.", default=None)
    s_from: float = attribute("Least distance along the road, m.", default=0.0, quantity="length", minimum=0)
    s_to: float | None = attribute(
        "Greatest distance along the road, m; the road's end when left out.", default=None, quantity="length", minimum=0
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
        "Seed of the draw: the same place always. Left out, each run and each variant of a sweep has its own.",
        default=None,
        minimum=0,
    )


class AnyOfPosition(Word):
    """One of several places in lanes, drawn at random: what a random spawn point is bound to."""

    word: Literal["any_of"] = "any_of"

    clear: Number = attribute(
        "Least distance to the reference point of any entity placed before, m.",
        default=0.0,
        quantity="length",
        minimum=0,
    )
    places: tuple[LanePositionWord, ...] = child("The places.")
