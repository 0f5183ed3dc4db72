"""Conditions on an entity. `entity` triggers them; inside `<when>` it defaults to the actor that contains it."""

from typing import Literal

from scenario_compiler.vocabulary.conditions.measuring import (
    COORDINATES,
    DISTANCE,
    ENTITY,
    FREESPACE,
    RULE,
    CoordinateSystem,
    Direction,
    DistanceType,
    Rule,
)
from scenario_compiler.vocabulary.positions import Position
from scenario_compiler.vocabulary.word import Number, Word, attribute, child


class TimeHeadwayCondition(Word):
    """The time gap to an entity ahead: the distance divided by the triggering entity's speed."""

    word: Literal["time_gap"] = "time_gap"

    entity: str = attribute(ENTITY, default="", names="entity")
    to: str = attribute("Id of the entity ahead.", names="entity")
    below: Number = attribute("Limit, s: true when the gap is smaller.", quantity="time", minimum=0)
    rule: Rule = attribute(RULE, default="lessThan")
    freespace: bool = attribute(FREESPACE, default=False)
    coordinates: CoordinateSystem = attribute(COORDINATES, default="road")
    distance: DistanceType = attribute(DISTANCE, default="longitudinal")


class DistanceCondition(Word):
    """The distance between two entities; by default the straight distance between their reference points."""

    word: Literal["distance"] = "distance"

    entity: str = attribute(ENTITY, default="", names="entity")
    to: str = attribute("Id of the other entity.", names="entity")
    below: Number = attribute("Limit, m: true when the distance is smaller.", quantity="length", minimum=0)
    rule: Rule = attribute(RULE, default="lessThan")
    freespace: bool = attribute(FREESPACE, default=False)
    coordinates: CoordinateSystem = attribute(COORDINATES, default="entity")
    distance: DistanceType = attribute(DISTANCE, default="euclidianDistance")


class PositionDistanceCondition(Word):
    """The distance of an entity to a position."""

    word: Literal["distance_to_position"] = "distance_to_position"

    entity: str = attribute(ENTITY, default="", names="entity")
    below: Number = attribute("Limit, m: true when the distance is smaller.", quantity="length", minimum=0)
    rule: Rule = attribute(RULE, default="lessThan")
    freespace: bool = attribute(
        "Whether the distance is measured from the bounding box, not from the reference point.", default=False
    )
    coordinates: CoordinateSystem = attribute(COORDINATES, default="entity")
    distance: DistanceType = attribute(DISTANCE, default="euclidianDistance")
    position: Position = child("The position.")


class TimeToCollisionCondition(Word):
    """The time until the triggering entity would reach another entity, or a position, at their present speeds."""

    word: Literal["time_to_collision"] = "time_to_collision"

    entity: str = attribute(ENTITY, default="", names="entity")
    to: str = attribute("Id of the other entity; if left out, the position is used.", default="", names="entity")
    below: Number = attribute("Limit, s: true when the time is shorter.", quantity="time", minimum=0)
    rule: Rule = attribute(RULE, default="lessThan")
    freespace: bool = attribute(FREESPACE, default=False)
    coordinates: CoordinateSystem = attribute(COORDINATES, default="entity")
    distance: DistanceType = attribute(DISTANCE, default="euclidianDistance")
    position: Position | None = child("Position, if no other entity is named.", default=None)


class SpeedCondition(Word):
    """The speed of an entity, compared with a value."""

    word: Literal["speed"] = "speed"

    entity: str = attribute(ENTITY, default="", names="entity")
    rule: Rule = attribute("How the speed is compared with the value.")
    value: Number = attribute("Speed to compare with, m/s.", quantity="speed")
    direction: Direction = attribute("Component of the velocity.", default="total")


class RelativeSpeedCondition(Word):
    """The difference between the speeds of the triggering entity and another one."""

    word: Literal["relative_speed"] = "relative_speed"

    entity: str = attribute(ENTITY, default="", names="entity")
    to: str = attribute("Id of the other entity.", names="entity")
    rule: Rule = attribute("How the difference is compared with the value.")
    value: Number = attribute("Difference to compare with, m/s.", quantity="speed")
    direction: Direction = attribute("Component of the velocities.", default="total")


class AccelerationCondition(Word):
    """The acceleration of an entity, compared with a value."""

    word: Literal["acceleration"] = "acceleration"

    entity: str = attribute(ENTITY, default="", names="entity")
    rule: Rule = attribute("How the acceleration is compared with the value.")
    value: Number = attribute("Acceleration to compare with, m/s2.", quantity="acceleration")
    direction: Direction = attribute("Component of the acceleration.", default="total")


class StandstillCondition(Word):
    """An entity has been standing for some time."""

    word: Literal["standstill"] = "standstill"

    entity: str = attribute(ENTITY, default="", names="entity")
    duration: Number = attribute("Least duration of the standstill, s.", default=0.0, quantity="time", minimum=0)


class ReachPositionCondition(Word):
    """An entity is near a position."""

    word: Literal["reached"] = "reached"

    entity: str = attribute(ENTITY, default="", names="entity")
    tolerance: Number = attribute(
        "Distance that counts as reached, m.", default=2.0, quantity="length", minimum=0, exclusive=True
    )
    position: Position = child("The position to reach.")


class TraveledDistanceCondition(Word):
    """An entity has covered a distance since the start."""

    word: Literal["traveled"] = "traveled"

    entity: str = attribute(ENTITY, default="", names="entity")
    distance: Number = attribute("Distance covered, m.", quantity="length", minimum=0)


class CollisionCondition(Word):
    """An entity touches another one."""

    word: Literal["collision"] = "collision"

    entity: str = attribute(ENTITY, default="", names="entity")
    with_entities: tuple[str, ...] = attribute(
        "Ids of the other entities, of which one is enough; any entity if left out.",
        name="with",
        default=(),
        names="entity",
        separated=True,
    )
    with_type: Literal["", "vehicle", "pedestrian", "miscellaneous"] = attribute(
        "Type of the other entity; any type if left out.", default=""
    )


class OffroadCondition(Word):
    """An entity has been off every road for some time."""

    word: Literal["off_road"] = "off_road"

    entity: str = attribute(ENTITY, default="", names="entity")
    duration: Number = attribute("Least duration, s.", default=0.0, quantity="time", minimum=0)


class EndOfRoadCondition(Word):
    """An entity has been standing at the end of its road for some time."""

    word: Literal["end_of_road"] = "end_of_road"

    entity: str = attribute(ENTITY, default="", names="entity")
    duration: Number = attribute("Least duration, s.", default=0.0, quantity="time", minimum=0)


class RelativeLaneRange(Word):
    """A range of lanes, counted from the entity's own lane."""

    word: Literal["lanes"] = "lanes"

    least: int | None = attribute("First lane; no limit if left out.", name="from", default=None)
    greatest: int | None = attribute("Last lane; no limit if left out.", name="to", default=None)


class RelativeClearanceCondition(Word):
    """No other entity is within a range ahead and behind on certain lanes."""

    word: Literal["clearance"] = "clearance"

    entity: str = attribute(ENTITY, default="", names="entity")
    forward: Number = attribute("Range ahead of the reference point, m.", default=0.0, quantity="length", minimum=0)
    backward: Number = attribute("Range behind the reference point, m.", default=0.0, quantity="length", minimum=0)
    opposite_lanes: bool = attribute("Whether lanes of the opposite direction count.", default=False)
    freespace: bool = attribute(
        "Whether the other entities' whole boxes count, also in the lanes into which they reach, instead of their "
        "reference points.",
        default=False,
    )
    of: tuple[str, ...] = attribute(
        "Ids of the other entities; any entity if left out.", default=(), names="entity", separated=True
    )
    lanes: tuple[RelativeLaneRange, ...] = child("Lanes; any lane if left out.", default=())


class AngleCondition(Word):
    """An entity's heading, pitch or roll, compared with an angle."""

    word: Literal["angle"] = "angle"

    entity: str = attribute(ENTITY, default="", names="entity")
    kind: Literal["heading", "pitch", "roll"] = attribute("Angle that is compared.", default="heading")
    value: Number = attribute("Angle to compare with, degrees.", quantity="angle")
    tolerance: Number = attribute("Tolerance for equality, degrees.", quantity="angle", minimum=0)
    coordinates: CoordinateSystem = attribute("Coordinate system of the measurement.", default="world")


class RelativeAngleCondition(Word):
    """An entity's heading, pitch or roll relative to another entity's, compared with an angle."""

    word: Literal["relative_angle"] = "relative_angle"

    entity: str = attribute(ENTITY, default="", names="entity")
    to: str = attribute("Id of the other entity.", names="entity")
    kind: Literal["heading", "pitch", "roll"] = attribute("Angle that is compared.", default="heading")
    value: Number = attribute("Angle to compare with, degrees.", quantity="angle")
    tolerance: Number = attribute("Tolerance for equality, degrees.", quantity="angle", minimum=0)
