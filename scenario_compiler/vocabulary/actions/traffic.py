"""Actions on background traffic: swarms around an entity, sources, sinks, and their end."""

from typing import Literal

from scenario_compiler.vocabulary.positions import Position
from scenario_compiler.vocabulary.word import Number, Word, attribute, child


class TrafficKind(Word):
    """A part of traffic that is of one category."""

    word: Literal["kind"] = "kind"

    category: Literal["car", "van", "truck", "bus", "motorbike", "bicycle"] = attribute(
        "Category of these vehicles: models of the catalog, drawn alike often."
    )
    weight: float = attribute("How often they are drawn, beside the weights of the others.", default=1.0, minimum=0)


class SpeedRange(Word):
    """Speeds that are drawn evenly."""

    word: Literal["speeds"] = "speeds"

    low: float = attribute("Least speed, m/s.", quantity="speed", minimum=0)
    high: float = attribute("Greatest speed, m/s.", quantity="speed", minimum=0)


class TrafficSwarmAction(Word):
    """Keep vehicles in an ellipse around an entity: who leaves it comes back at its rim, on the way into it.

    A vehicle appears only where a lane is free for it. The action goes on until it is stopped; the vehicles stay.
    """

    word: Literal["traffic_swarm"] = "traffic_swarm"

    traffic: str = attribute("Name, for <stop_traffic>.", default="")
    entity: str = attribute("Id of the entity in the middle.", names="entity")
    vehicles: int = attribute("Number of vehicles.", minimum=0, maximum=500)
    inner_radius: Number = attribute(
        "No vehicle appears nearer to the entity than this, m.", default=0.0, quantity="length", minimum=0
    )
    semi_major: Number = attribute(
        "Half of the ellipse's extent along the entity, m.", quantity="length", minimum=0, exclusive=True
    )
    semi_minor: Number = attribute(
        "Half of the ellipse's extent across the entity, m.", quantity="length", minimum=0, exclusive=True
    )
    offset: Number = attribute(
        "How far the middle of the ellipse is ahead of the entity, m.", default=0.0, quantity="length"
    )
    speed: Number | None = attribute(
        "Speed of the vehicles, m/s, which they aim for too; by the speed limits when left out.",
        default=None,
        quantity="speed",
        minimum=0,
    )
    same: float = attribute("Weight of vehicles that drive in the entity's direction.", default=1.0, minimum=0)
    opposite: float = attribute("Weight of vehicles that drive against it.", default=1.0, minimum=0)
    speeds: SpeedRange | None = child("Speeds that are drawn, in place of one for all.", default=None)
    kinds: tuple[TrafficKind, ...] = child("What the vehicles are; cars when left out.", default=())


class TrafficSourceAction(Word):
    """Let vehicles appear around a place, one after the other, where a lane is free for them.

    At most 100 are there at once: one that has left the map, or was taken by a sink, appears anew.
    """

    word: Literal["traffic_source"] = "traffic_source"

    traffic: str = attribute("Name, for <stop_traffic>.", default="")
    rate: float = attribute("Number of vehicles in a second.", minimum=0, exclusive=True, maximum=10)
    radius: Number = attribute("How far from the place they may appear, m.", default=0.0, quantity="length", minimum=0)
    speed: Number | None = attribute(
        "Speed of the vehicles, m/s, which they aim for too; by the speed limits when left out.",
        default=None,
        quantity="speed",
        minimum=0,
    )
    kinds: tuple[TrafficKind, ...] = child("What the vehicles are; cars when left out.", default=())
    position: Position = child("Where they appear: in this lane, and in those that go around it.")


class TrafficSinkAction(Word):
    """Let vehicles of background traffic disappear that come near a place."""

    word: Literal["traffic_sink"] = "traffic_sink"

    traffic: str = attribute("Name, for <stop_traffic>.", default="")
    radius: Number = attribute("How near they come, m.", quantity="length", minimum=0)
    rate: Number | None = attribute(
        "Greatest number of vehicles in a second; all of them when left out.", default=None, minimum=0, exclusive=True
    )
    position: Position = child("The place.")


class StopTrafficAction(Word):
    """End actions on traffic, whose vehicles drive on, or take background traffic of the scenario away."""

    word: Literal["stop_traffic"] = "stop_traffic"

    traffic: str = attribute(
        "Name of the actions, or id of the traffic; all of it when left out.", default="", names="traffic"
    )


KeepsVehicles = TrafficSwarmAction | TrafficSourceAction
"""Actions that have vehicles of their own."""
