"""Entities: the ego vehicle, static and dynamic actors, and the vehicles they are."""

from __future__ import annotations

from typing import Literal

from scenario_compiler.vocabulary.positions import Position
from scenario_compiler.vocabulary.sensors import Camera
from scenario_compiler.vocabulary.storyboard import When
from scenario_compiler.vocabulary.word import ENTITY_ID, Number, Word, attribute, child

Category = Literal[
    "car", "van", "truck", "bus", "motorbike", "bicycle", "pedestrian", "cone", "barrier", "sign", "prop"
]  # fmt: skip
"""What an entity is: how it is drawn, and what background traffic is made of."""


class Vehicle(Word):
    """A kind of vehicle, person or thing: the catalog's entry.

    The reference point is on the ground: a vehicle's rear axle, anything else's middle.
    """

    word: Literal["vehicle"] = "vehicle"

    name: str = attribute("CARLA blueprint id.")
    category: Category = attribute("What it is.", default="car")
    summary: str = attribute("What it is.", default="")
    source: str = attribute("Where the numbers come from.", default="")
    length: float = attribute("Length of the box, m.", quantity="length", minimum=0, exclusive=True)
    width: float = attribute("Width of the box, m.", quantity="length", minimum=0, exclusive=True)
    height: float = attribute("Height of the box, m.", quantity="length", minimum=0, exclusive=True)
    wheelbase: float = attribute("Distance between the axles, m.", quantity="length", minimum=0, exclusive=True)
    center: float = attribute("Distance from the rear axle forward to the box's centre, m.", quantity="length")
    max_steer: float = attribute("Greatest angle of the front wheels, degrees.", default=40.0, minimum=1, maximum=90)
    max_acceleration: float = attribute(
        "Acceleration at full throttle, m/s2.", default=3.5, quantity="acceleration", minimum=0
    )
    max_deceleration: float = attribute(
        "Deceleration at full brake, m/s2.", default=8.0, quantity="acceleration", minimum=0
    )
    max_speed: float = attribute("Top speed, m/s.", default=60.0, quantity="speed", minimum=0)


class Property(Word):
    """A parameter of a controller."""

    word: Literal["property"] = "property"

    name: str = attribute("Name of the controller's parameter.")
    value: str = attribute("Its value.")


class Controller(Word):
    """What drives the ego vehicle between control steps."""

    word: Literal["controller"] = "controller"

    model: str = attribute(
        "Name of a controller, or `package.module:Class` of your own.",
        default="lane_detection",
        names="controller",
    )
    properties: tuple[Property, ...] = child("Its parameters.", default=())


class Ego(Word):
    """The automated vehicle."""

    word: Literal["ego"] = "ego"

    id: str = attribute("Id of the entity.", default="ego", pattern=ENTITY_ID)
    model: str = attribute("Vehicle of the vehicle catalog.", default="vehicle.audi.tt", names="vehicle")
    speed: Number = attribute("Speed at the start, m/s.", default=0.0, quantity="speed", minimum=0)
    desired_speed: Number | None = attribute(
        "Speed that the automation aims for, m/s; the speed at the start when left out.",
        default=None,
        quantity="speed",
        minimum=0,
        exclusive=True,
    )
    start: Position = child("Where it starts.", wrapper="start")
    destination: Position | None = child("Where the run ends.", default=None, wrapper="destination")
    camera: Camera = child("Its forward camera.", default_factory=Camera)
    controller: Controller = child("What drives it.", default_factory=Controller)
    whens: tuple[When, ...] = child("What happens to it.", default=())


class Static(Word):
    """An actor that stands still."""

    word: Literal["static"] = "static"

    id: str = attribute("Id of the entity.", pattern=ENTITY_ID)
    model: str = attribute("Vehicle of the vehicle catalog.", default="vehicle.audi.tt", names="vehicle")
    at: Position = child("Where it stands.", wrapper="at")


class Follow(Word):
    """Car following by the intelligent driver model (Treiber, Hennecke and Helbing 2000)."""

    word: Literal["follow"] = "follow"

    time_gap: Number = attribute("Desired time gap, s.", default=1.5, quantity="time", minimum=0.1)
    minimum_gap: Number = attribute("Gap at standstill, m.", default=2.0, quantity="length", minimum=0.1)
    acceleration: Number = attribute("Greatest acceleration, m/s2.", default=1.5, quantity="acceleration", minimum=0.1)
    deceleration: Number = attribute(
        "Comfortable deceleration, m/s2.", default=2.0, quantity="acceleration", minimum=0.1
    )


class Dynamic(Word):
    """An actor that moves along its lane."""

    word: Literal["dynamic"] = "dynamic"

    id: str = attribute("Id of the entity.", pattern=ENTITY_ID)
    model: str = attribute("Vehicle of the vehicle catalog.", default="vehicle.tesla.model3", names="vehicle")
    speed: Number = attribute("Speed at the start, m/s.", default=0.0, quantity="speed", minimum=0)
    start: Position = child("Where it starts.", wrapper="start")
    follow: Follow | None = child("Follow the vehicle ahead in place of a constant speed.", default=None)
    whens: tuple[When, ...] = child("What it does, and when.", default=())


Actor = Static | Dynamic
