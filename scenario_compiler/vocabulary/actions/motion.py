"""Actions on an entity's position and route."""

from typing import Literal

from scenario_compiler.vocabulary.positions import Position, RouteWord, Trajectory
from scenario_compiler.vocabulary.word import Number, Word, attribute, child


class TeleportAction(Word):
    """Move the entity to a position at once."""

    word: Literal["teleport"] = "teleport"

    position: Position = child("Target position.")


class AssignRouteAction(Word):
    """Assign a route to the entity, which it follows at junctions from now on.

    The automated vehicle does not: its route is the one to its <destination>.
    """

    word: Literal["assign_route"] = "assign_route"

    route: RouteWord = child("The route.")


class AcquirePositionAction(Word):
    """Give the entity a route to a position.

    The automated vehicle does not follow it: its route is the one to its <destination>.
    """

    word: Literal["acquire_position"] = "acquire_position"

    position: Position = child("Destination.")


class RandomRouteAction(Word):
    """Let the entity turn at random at junctions from now on.

    The automated vehicle does not: its route is the one to its <destination>.
    """

    word: Literal["random_route"] = "random_route"


class TrajectoryTiming(Word):
    """Timing of the trajectory: how its times are shifted and scaled."""

    word: Literal["timing"] = "timing"

    domain: Literal["absolute", "relative"] = attribute(
        "`absolute`: the times are simulation times. `relative`: the action starts at the trajectory's first time, or "
        "at the time of the place `begin`."
    )
    scale: Number = attribute("Factor by which the times are multiplied.", default=1.0)
    offset: Number = attribute("Time added to them, s.", default=0.0, quantity="time")


class FollowTrajectoryAction(Word):
    """Follow a trajectory, at its times or at the entity's own speed.

    The automated vehicle does not: it steers itself.
    """

    word: Literal["follow_trajectory"] = "follow_trajectory"

    following: Literal["position", "follow"] = attribute(
        "Whether the entity follows the trajectory exactly, or steers along it.", default="position"
    )
    begin: Number = attribute(
        "Distance from the trajectory's start at which the entity starts, m.", default=0.0, quantity="length"
    )
    timing: TrajectoryTiming | None = child(
        "Use of the trajectory's times. If left out, they are ignored.", default=None
    )
    trajectory: Trajectory = child("The trajectory.")


class FinalSpeed(Word):
    """A speed to be reached on arrival."""

    word: Literal["final_speed"] = "final_speed"

    value: Number = attribute(
        "Speed, m/s. With `relative_to`, the difference to that entity's speed, or the factor by which it is "
        "multiplied."
    )
    relative_to: str = attribute("Id of the entity to which the speed is relative.", default="", names="entity")
    kind: Literal["delta", "factor"] = attribute("Meaning of the value: a difference or a factor.", default="delta")
    steady_time: Number | None = attribute(
        "Time for which the last stretch is driven at this speed, s.", default=None, quantity="time", minimum=0
    )
    steady_distance: Number | None = attribute(
        "Length of the last stretch, which is driven at this speed, m.", default=None, quantity="length", minimum=0
    )


class MasterPosition(Word):
    """Destination of the other entity."""

    word: Literal["master_position"] = "master_position"

    position: Position = child("The position.")


class SynchronizeAction(Word):
    """Adapt the speed so that the entity arrives at its destination when another entity arrives at its own."""

    word: Literal["synchronize"] = "synchronize"

    master: str = attribute("Id of the other entity.", names="entity")
    tolerance: Number = attribute(
        "Distance to the destination that counts as arrived, m.", default=0.0, quantity="length"
    )
    master_tolerance: Number = attribute("The same distance for the other entity, m.", default=0.0, quantity="length")
    final_speed: FinalSpeed | None = child("Speed on arrival.", default=None)
    master_position: MasterPosition = child("Destination of the other entity.")
    position: Position = child("Destination of the entity.")


class VisibilityAction(Word):
    """Show or hide the entity."""

    word: Literal["visibility"] = "visibility"

    graphics: bool = attribute("Whether the entity appears in images.")
    sensors: bool = attribute("Whether sensors detect the entity.")
    traffic: bool = attribute("Whether other traffic reacts to the entity.")


class ConnectTrailerAction(Word):
    """Connect a trailer, which the entity tows from now on. A trailer at another place is put behind it at once."""

    word: Literal["connect_trailer"] = "connect_trailer"

    trailer: str = attribute("Id of the trailer.", names="entity")


class DisconnectTrailerAction(Word):
    """Disconnect the trailer, which stays where it is."""

    word: Literal["disconnect_trailer"] = "disconnect_trailer"
