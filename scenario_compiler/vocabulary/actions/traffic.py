"""Actions on background traffic: swarms around an entity, sources, sinks, and their end."""

from typing import Literal

from scenario_compiler.vocabulary.positions import Position
from scenario_compiler.vocabulary.word import Number, Word, attribute, child


class TrafficKind(Word):
    """The vehicles of one category in traffic."""

    word: Literal["kind"] = "kind"

    category: Literal["car", "van", "truck", "bus", "motorbike", "bicycle"] = attribute(
        "Category of the vehicles. Its catalog models are drawn with equal probability."
    )
    weight: float = attribute("Weight of the category relative to the others.", default=1.0, minimum=0)


class SpeedRange(Word):
    """A uniform distribution of speeds."""

    word: Literal["speeds"] = "speeds"

    low: float = attribute("Least speed, m/s.", quantity="speed", minimum=0)
    high: float = attribute("Greatest speed, m/s.", quantity="speed", minimum=0)


class TrafficSwarmAction(Word):
    """Keep vehicles in an ellipse around an entity: a vehicle that leaves it re-enters at its edge.

    A vehicle appears only where a lane is free. The action continues until it is stopped; its vehicles remain.
    """

    word: Literal["traffic_swarm"] = "traffic_swarm"

    traffic: str = attribute("Name, for <stop_traffic>.", default="", defines="traffic")
    entity: str = attribute("Id of the entity at the centre.", names="entity")
    vehicles: int = attribute("Number of vehicles.", minimum=0, maximum=500)
    inner_radius: Number = attribute(
        "Least distance to the entity at which a vehicle appears, m.", default=0.0, quantity="length", minimum=0
    )
    semi_major: Number = attribute(
        "Semi-axis of the ellipse along the entity, m.", quantity="length", minimum=0, exclusive=True
    )
    semi_minor: Number = attribute(
        "Semi-axis of the ellipse across the entity, m.", quantity="length", minimum=0, exclusive=True
    )
    offset: Number = attribute(
        "Distance of the ellipse's centre ahead of the entity, m.", default=0.0, quantity="length"
    )
    speed: Number | None = attribute(
        "Initial and desired speed of the vehicles, m/s; derived from the speed limits if left out.",
        default=None,
        quantity="speed",
        minimum=0,
    )
    same: float = attribute("Weight of vehicles that drive in the entity's direction.", default=1.0, minimum=0)
    opposite: float = attribute("Weight of oncoming vehicles.", default=1.0, minimum=0)
    speeds: SpeedRange | None = child("Distribution of the speeds, instead of one speed for all.", default=None)
    kinds: tuple[TrafficKind, ...] = child("Types of the vehicles; cars if left out.", default=())


class TrafficSourceAction(Word):
    """Let vehicles appear around a position, one after the other, where a lane is free.

    At most 100 exist at once. A vehicle that leaves the map or is removed by a sink appears again.
    """

    word: Literal["traffic_source"] = "traffic_source"

    traffic: str = attribute("Name, for <stop_traffic>.", default="", defines="traffic")
    rate: float = attribute("Vehicles per second.", minimum=0, exclusive=True, maximum=10)
    radius: Number = attribute(
        "Greatest distance from the position at which they appear, m.", default=0.0, quantity="length", minimum=0
    )
    speed: Number | None = attribute(
        "Initial and desired speed of the vehicles, m/s; derived from the speed limits if left out.",
        default=None,
        quantity="speed",
        minimum=0,
    )
    kinds: tuple[TrafficKind, ...] = child("Types of the vehicles; cars if left out.", default=())
    position: Position = child("Position: they appear in this lane and in the lanes around it.")


class TrafficSinkAction(Word):
    """Remove vehicles of background traffic near a position."""

    word: Literal["traffic_sink"] = "traffic_sink"

    traffic: str = attribute("Name, for <stop_traffic>.", default="", defines="traffic")
    radius: Number = attribute("Distance at which vehicles are removed, m.", quantity="length", minimum=0)
    rate: Number | None = attribute(
        "Greatest number of vehicles per second; no limit if left out.", default=None, minimum=0, exclusive=True
    )
    position: Position = child("The place.")


class StopTrafficAction(Word):
    """End actions on traffic, whose vehicles drive on, or remove background traffic of the scenario."""

    word: Literal["stop_traffic"] = "stop_traffic"

    traffic: str = attribute(
        "Name of the actions, or id of the traffic; all traffic if left out.", default="", names="traffic"
    )


KeepsVehicles = TrafficSwarmAction | TrafficSourceAction
"""Actions that bring vehicles of their own."""
