"""Criteria by which a run is judged."""

from collections.abc import Iterable
from typing import Literal

from scenario_compiler.vocabulary.driver import ReferenceName
from scenario_compiler.vocabulary.horizon import HORIZON
from scenario_compiler.vocabulary.takeover import RequestCause
from scenario_compiler.vocabulary.word import Number, Word, attribute


class NoCollision(Word):
    """The ego vehicle touches no other entity, and the world's own physics, if it has any, reports no collision."""

    word: Literal["no_collision"] = "no_collision"


class StayOnRoad(Word):
    """The ego vehicle's reference point stays on the road: on lanes for motor traffic, shoulders and parking lanes.

    This criterion always applies to an automated vehicle, even if it is not written, unless `required` is false. Where
    the vehicle goes after its first collision does not count.
    """

    word: Literal["stay_on_road"] = "stay_on_road"

    required: bool = attribute("false: the ego vehicle may leave the road.", default=True)


class ReachDestination(Word):
    """The ego vehicle reaches its destination without a collision on the way."""

    word: Literal["reach_destination"] = "reach_destination"


class MinimumTimeToCollision(Word):
    """The ego vehicle's time to collision never falls below a value."""

    word: Literal["minimum_time_to_collision"] = "minimum_time_to_collision"

    at_least: Number = attribute("Least time to collision, s.", quantity="time", minimum=0, maximum=HORIZON)


class TakeoverWithin(Word):
    """The driver responds to the first request in time, and before a collision.

    A run without a request meets it, as does one that ends without a collision before the time is over.
    """

    word: Literal["takeover_within"] = "takeover_within"

    time: Number = attribute("Longest time from the request to the response, s.", quantity="time", minimum=0)


class Requested(Word):
    """The automation asks the driver to take over."""

    word: Literal["requested"] = "requested"

    cause: RequestCause | None = attribute("Cause of the first request; any cause if left out.", default=None)


class NoMinimumRisk(Word):
    """No minimum-risk manoeuvre becomes necessary."""

    word: Literal["no_minimum_risk"] = "no_minimum_risk"


class MakesProgress(Word):
    """The automated vehicle never stands still without a reason for the time that the cause `no_progress` allows (5 s).

    Reasons are a moving leader or a queue behind one, a red signal, a stop ordered by an action, and a minimum-risk
    stop.
    """

    word: Literal["makes_progress"] = "makes_progress"


class NoObstruction(Word):
    """The automated vehicle never stops in a driving lane unless something ahead holds it.

    An object, the end of the lane or a red signal at most 30 m ahead holds it. Only stops by a minimum-risk manoeuvre
    or by the driver count as obstructing a lane.
    """

    word: Literal["no_obstruction"] = "no_obstruction"


class MaximumLateralOffset(Word):
    """The ego vehicle's reference point stays near the middle of the lane in which it is, up to its first collision.

    Off every lane this does not hold. After a lane change the middle is that of the new lane, whereas the measure of
    the same name is about the lane in which the vehicle was at the request.
    """

    word: Literal["maximum_lateral_offset"] = "maximum_lateral_offset"

    at_most: Number = attribute(
        "Greatest distance from the middle of the present lane, m.", quantity="length", minimum=0
    )


class NoAvoidableCollision(Word):
    """The ego vehicle has no collision that a reference driver in its place from the start would have avoided."""

    word: Literal["no_avoidable_collision"] = "no_avoidable_collision"

    by: ReferenceName = attribute("The reference driver.", default="careful_and_competent")


Criterion = (
    NoCollision
    | StayOnRoad
    | ReachDestination
    | MinimumTimeToCollision
    | TakeoverWithin
    | Requested
    | NoMinimumRisk
    | MakesProgress
    | NoObstruction
    | MaximumLateralOffset
    | NoAvoidableCollision
)


def references_in(criteria: Iterable[Criterion]) -> tuple[ReferenceName, ...]:
    """Return the reference drivers that the criteria name, each once, in order."""
    return tuple(dict.fromkeys(one.by for one in criteria if isinstance(one, NoAvoidableCollision)))
