"""Actions on where an entity is and which way it goes."""

from typing import Literal

from scenario_compiler.vocabulary.positions import Position, RouteWord, Trajectory
from scenario_compiler.vocabulary.word import Number, Word, attribute, child


class TeleportAction(Word):
    """Put the entity somewhere at once."""

    word: Literal["teleport"] = "teleport"

    position: Position = child("Where to.")


class AssignRouteAction(Word):
    """Give the entity a route, which it takes at junctions from now on."""

    word: Literal["assign_route"] = "assign_route"

    route: RouteWord = child("The route.")


class AcquirePositionAction(Word):
    """Give the entity the way to a position as its route."""

    word: Literal["acquire_position"] = "acquire_position"

    position: Position = child("Where it is to go.")


class RandomRouteAction(Word):
    """Let the entity turn at random at junctions from now on."""

    word: Literal["random_route"] = "random_route"


class TrajectoryTiming(Word):
    """The trajectory's times count: they are shifted and stretched by these."""

    word: Literal["timing"] = "timing"

    domain: Literal["absolute", "relative"] = attribute(
        "Whether they are simulation times, or count from when the action starts."
    )
    scale: Number = attribute("Factor that the times are multiplied by.", default=1.0)
    offset: Number = attribute("What is added to them, s.", default=0.0, quantity="time")


class FollowTrajectoryAction(Word):
    """Move along a trajectory, by its times or at the entity's own speed."""

    word: Literal["follow_trajectory"] = "follow_trajectory"

    following: Literal["position", "follow"] = attribute(
        "Whether the entity is on the trajectory exactly, or steers along it.", default="position"
    )
    begin: Number = attribute("Distance from the trajectory's begin to start at, m.", default=0.0, quantity="length")
    timing: TrajectoryTiming | None = child("How the trajectory's times count; not at all when left out.", default=None)
    trajectory: Trajectory = child("The trajectory.")


class FinalSpeed(Word):
    """A speed that is to be reached on arrival."""

    word: Literal["final_speed"] = "final_speed"

    value: Number = attribute("The speed, m/s; with `relative_to` what is added to or multiplied with that entity's.")
    relative_to: str = attribute("Id of the entity that it is relative to.", default="", names="entity")
    kind: Literal["delta", "factor"] = attribute("Whether the value is added or multiplied by.", default="delta")
    steady_time: Number | None = attribute(
        "The last stretch is driven at this speed for this time, s.", default=None, quantity="time", minimum=0
    )
    steady_distance: Number | None = attribute(
        "The last stretch is driven at this speed over this distance, m.", default=None, quantity="length", minimum=0
    )


class MasterPosition(Word):
    """Where the other entity is going."""

    word: Literal["master_position"] = "master_position"

    position: Position = child("The position.")


class SynchronizeAction(Word):
    """Choose the speed so that the entity reaches its position when another reaches its own."""

    word: Literal["synchronize"] = "synchronize"

    master: str = attribute("Id of the other entity.", names="entity")
    tolerance: Number = attribute("Distance from the position that counts as there, m.", default=0.0, quantity="length")
    master_tolerance: Number = attribute("The same for the other entity, m.", default=0.0, quantity="length")
    final_speed: FinalSpeed | None = child("Speed on arrival.", default=None)
    master_position: MasterPosition = child("Where the other entity is going.")
    position: Position = child("Where the entity is going.")


class VisibilityAction(Word):
    """Show or hide the entity."""

    word: Literal["visibility"] = "visibility"

    graphics: bool = attribute("Whether pictures show it.")
    sensors: bool = attribute("Whether sensors see it.")
    traffic: bool = attribute("Whether the other traffic minds it.")


class ConnectTrailerAction(Word):
    """Connect a trailer, which follows the entity from now on."""

    word: Literal["connect_trailer"] = "connect_trailer"

    trailer: str = attribute("Id of the trailer.", names="entity")


class DisconnectTrailerAction(Word):
    """Let go of the trailer, which stays where it is."""

    word: Literal["disconnect_trailer"] = "disconnect_trailer"
