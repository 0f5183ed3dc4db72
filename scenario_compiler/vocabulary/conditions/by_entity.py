"""Conditions on an entity: `entity` is the triggering one; inside `<when>` it defaults to the actor that holds it."""

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
    """The time gap to another entity ahead: distance over the triggering entity's speed."""

    word: Literal["time_gap"] = "time_gap"

    entity: str = attribute(ENTITY, default="", names="entity")
    to: str = attribute("Id of the entity that the gap is measured to.", names="entity")
    below: Number = attribute("The limit: true when the gap is less, s.", quantity="time", minimum=0)
    rule: Rule = attribute(RULE, default="lessThan")
    freespace: bool = attribute(FREESPACE, default=False)
    coordinates: CoordinateSystem = attribute(COORDINATES, default="road")
    distance: DistanceType = attribute(DISTANCE, default="longitudinal")


class DistanceCondition(Word):
    """The distance between two entities: straight between their reference points, if nothing else is said."""

    word: Literal["distance"] = "distance"

    entity: str = attribute(ENTITY, default="", names="entity")
    to: str = attribute("Id of the entity that the distance is measured to.", names="entity")
    below: Number = attribute("The limit: true when the distance is less, m.", quantity="length", minimum=0)
    rule: Rule = attribute(RULE, default="lessThan")
    freespace: bool = attribute(FREESPACE, default=False)
    coordinates: CoordinateSystem = attribute(COORDINATES, default="entity")
    distance: DistanceType = attribute(DISTANCE, default="euclidianDistance")


class PositionDistanceCondition(Word):
    """The distance of an entity to a position."""

    word: Literal["distance_to_position"] = "distance_to_position"

    entity: str = attribute(ENTITY, default="", names="entity")
    below: Number = attribute("The limit: true when the distance is less, m.", quantity="length", minimum=0)
    rule: Rule = attribute(RULE, default="lessThan")
    freespace: bool = attribute("Whether it is measured from the box, not the reference point.", default=False)
    coordinates: CoordinateSystem = attribute(COORDINATES, default="entity")
    distance: DistanceType = attribute(DISTANCE, default="euclidianDistance")
    position: Position = child("The position.")


class TimeToCollisionCondition(Word):
    """The time until the triggering entity would reach the other, or a position, at their present speeds."""

    word: Literal["time_to_collision"] = "time_to_collision"

    entity: str = attribute(ENTITY, default="", names="entity")
    to: str = attribute("Id of the entity that would be hit; a position when left out.", default="", names="entity")
    below: Number = attribute("The limit: true when the time is less, s.", quantity="time", minimum=0)
    rule: Rule = attribute(RULE, default="lessThan")
    freespace: bool = attribute(FREESPACE, default=False)
    coordinates: CoordinateSystem = attribute(COORDINATES, default="entity")
    distance: DistanceType = attribute(DISTANCE, default="euclidianDistance")
    position: Position | None = child("The position, where no other entity is named.", default=None)


class SpeedCondition(Word):
    """The speed of an entity against a value."""

    word: Literal["speed"] = "speed"

    entity: str = attribute(ENTITY, default="", names="entity")
    rule: Rule = attribute("How the speed is compared with the value.")
    value: Number = attribute("Speed to compare with, m/s.", quantity="speed")
    direction: Direction = attribute("Which part of the velocity is meant.", default="total")


class RelativeSpeedCondition(Word):
    """How much faster the triggering entity is than another, by their speeds."""

    word: Literal["relative_speed"] = "relative_speed"

    entity: str = attribute(ENTITY, default="", names="entity")
    to: str = attribute("Id of the other entity.", names="entity")
    rule: Rule = attribute("How the difference is compared with the value.")
    value: Number = attribute("Difference to compare with, m/s.", quantity="speed")
    direction: Direction = attribute("Which part of the velocities is meant.", default="total")


class AccelerationCondition(Word):
    """The acceleration of an entity against a value."""

    word: Literal["acceleration"] = "acceleration"

    entity: str = attribute(ENTITY, default="", names="entity")
    rule: Rule = attribute("How the acceleration is compared with the value.")
    value: Number = attribute("Acceleration to compare with, m/s2.", quantity="acceleration")
    direction: Direction = attribute("Which part of the acceleration is meant.", default="total")


class StandstillCondition(Word):
    """An entity has stood for some time."""

    word: Literal["standstill"] = "standstill"

    entity: str = attribute(ENTITY, default="", names="entity")
    duration: Number = attribute("How long it must have stood, s.", default=0.0, quantity="time", minimum=0)


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
    """An entity touches another."""

    word: Literal["collision"] = "collision"

    entity: str = attribute(ENTITY, default="", names="entity")
    with_entity: str = attribute("Id of the other entity; any when left out.", name="with", default="", names="entity")
    with_type: Literal["", "vehicle", "pedestrian", "miscellaneous"] = attribute(
        "Which kind of entity the other is; any when left out.", default=""
    )


class OffroadCondition(Word):
    """An entity has been off every road for some time."""

    word: Literal["off_road"] = "off_road"

    entity: str = attribute(ENTITY, default="", names="entity")
    duration: Number = attribute("For how long, s.", default=0.0, quantity="time", minimum=0)


class EndOfRoadCondition(Word):
    """An entity has stood at the end of its road for some time."""

    word: Literal["end_of_road"] = "end_of_road"

    entity: str = attribute(ENTITY, default="", names="entity")
    duration: Number = attribute("For how long, s.", default=0.0, quantity="time", minimum=0)


class RelativeLaneRange(Word):
    """Lanes that are looked at, counted from the entity's own."""

    word: Literal["lanes"] = "lanes"

    least: int | None = attribute("The first of them; no limit when left out.", name="from", default=None)
    greatest: int | None = attribute("The last of them; no limit when left out.", name="to", default=None)


class RelativeClearanceCondition(Word):
    """No other entity is within a range ahead and behind, on certain lanes."""

    word: Literal["clearance"] = "clearance"

    entity: str = attribute(ENTITY, default="", names="entity")
    forward: Number = attribute("Range ahead, m.", default=0.0, quantity="length", minimum=0)
    backward: Number = attribute("Range behind, m.", default=0.0, quantity="length", minimum=0)
    opposite_lanes: bool = attribute("Whether lanes of the other direction count.", default=False)
    freespace: bool = attribute(FREESPACE, default=False)
    of: tuple[str, ...] = attribute(
        "Ids of the entities looked for; any when left out.", default=(), names="entity", separated=True
    )
    lanes: tuple[RelativeLaneRange, ...] = child("The lanes; any when left out.", default=())


class AngleCondition(Word):
    """The heading of an entity against an angle."""

    word: Literal["angle"] = "angle"

    entity: str = attribute(ENTITY, default="", names="entity")
    kind: Literal["heading", "pitch", "roll"] = attribute("Which angle.", default="heading")
    value: Number = attribute("The angle, degrees.", quantity="angle")
    tolerance: Number = attribute("Difference that counts as equal, degrees.", quantity="angle", minimum=0)
    coordinates: CoordinateSystem = attribute("In which system it is measured.", default="world")


class RelativeAngleCondition(Word):
    """The heading of an entity relative to another's, against an angle."""

    word: Literal["relative_angle"] = "relative_angle"

    entity: str = attribute(ENTITY, default="", names="entity")
    to: str = attribute("Id of the other entity.", names="entity")
    kind: Literal["heading", "pitch", "roll"] = attribute("Which angle.", default="heading")
    value: Number = attribute("The angle, degrees.", quantity="angle")
    tolerance: Number = attribute("Difference that counts as equal, degrees.", quantity="angle", minimum=0)
