"""Conditions on an entity: `entity` is the triggering one; inside `<when>` it defaults to the actor that holds it."""

from __future__ import annotations

from typing import Literal

from scenario_compiler.vocabulary.positions import Position
from scenario_compiler.vocabulary.word import Number, Word, attribute, child

Rule = Literal["lessThan", "lessOrEqual", "greaterThan", "greaterOrEqual", "equalTo", "notEqualTo"]
"""How a measured value is compared, in ASAM's words."""

_ENTITY = "Id of the triggering entity; the actor that holds the <when> when left out."


class TimeHeadwayCondition(Word):
    """The time gap to another entity ahead: distance along the road over the triggering entity's speed."""

    word: Literal["time_gap"] = "time_gap"

    entity: str = attribute(_ENTITY, default="", names="entity")
    to: str = attribute("Id of the entity that the gap is measured to.", names="entity")
    below: Number = attribute("True when the gap is less, s.", quantity="time", minimum=0)


class DistanceCondition(Word):
    """The straight distance between the reference points of two entities."""

    word: Literal["distance"] = "distance"

    entity: str = attribute(_ENTITY, default="", names="entity")
    to: str = attribute("Id of the entity that the distance is measured to.", names="entity")
    below: Number = attribute("True when the distance is less, m.", quantity="length", minimum=0)


class TimeToCollisionCondition(Word):
    """The time until the triggering entity would reach the other at their present speeds."""

    word: Literal["time_to_collision"] = "time_to_collision"

    entity: str = attribute(_ENTITY, default="", names="entity")
    to: str = attribute("Id of the entity that would be hit.", names="entity")
    below: Number = attribute("True when the time is less, s.", quantity="time", minimum=0)


class SpeedCondition(Word):
    """The speed of an entity against a value."""

    word: Literal["speed"] = "speed"

    entity: str = attribute(_ENTITY, default="", names="entity")
    rule: Rule = attribute("How the speed is compared with the value.")
    value: Number = attribute("Speed to compare with, m/s.", quantity="speed")


class StandstillCondition(Word):
    """An entity has stood for some time."""

    word: Literal["standstill"] = "standstill"

    entity: str = attribute(_ENTITY, default="", names="entity")
    duration: Number = attribute("How long it must have stood, s.", default=0.0, quantity="time", minimum=0)


class ReachPositionCondition(Word):
    """An entity is near a position."""

    word: Literal["reached"] = "reached"

    entity: str = attribute(_ENTITY, default="", names="entity")
    tolerance: Number = attribute(
        "Distance that counts as reached, m.", default=2.0, quantity="length", minimum=0, exclusive=True
    )
    position: Position = child("The position to reach.")


class TraveledDistanceCondition(Word):
    """An entity has covered a distance since the start."""

    word: Literal["traveled"] = "traveled"

    entity: str = attribute(_ENTITY, default="", names="entity")
    distance: Number = attribute("Distance covered, m.", quantity="length", minimum=0)
