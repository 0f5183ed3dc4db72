"""Entities: the ego vehicle, static and dynamic actors, groups of them, traffic, and their vehicle models."""

from typing import Literal

from scenario_compiler.vocabulary.actions.path import Path
from scenario_compiler.vocabulary.positions import Position
from scenario_compiler.vocabulary.sensors import Camera, ForwardSensor, Odometry
from scenario_compiler.vocabulary.storyboard import When
from scenario_compiler.vocabulary.word import ENTITY_ID, Number, Word, attribute, child

Category = Literal[
    "car", "van", "truck", "bus", "motorbike", "bicycle", "pedestrian", "cone", "barrier", "sign", "prop"
]  # fmt: skip
"""Category of an entity: decides how it is drawn and which models background traffic draws."""

THINGS: tuple[Category, ...] = ("cone", "barrier", "sign", "prop")
"""The categories of objects, which are neither vehicles nor pedestrians."""


class Vehicle(Word):
    """A vehicle, pedestrian or object model: an entry of the catalog.

    The reference point is on the ground: under the rear axle of a vehicle, under the middle of anything else.
    """

    word: Literal["vehicle"] = "vehicle"

    name: str = attribute("CARLA blueprint id.", defines="vehicle")
    category: Category = attribute("Category of the model.", default="car")
    summary: str = attribute("Short description.", default="")
    source: str = attribute("Source of the numbers.", default="")
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
    pitch_gradient: float = attribute(
        "How far the body pitches when the vehicle brakes or accelerates, degrees per m/s2. On springs with a ride "
        "frequency f, a centre of gravity at height h and a wheelbase b, it is h / (pi f b)**2 rad, reduced by "
        "anti-dive. For 0.55 m, 1.2 Hz and 2.65 m this is 0.32 degrees; the default is two thirds of that.",
        default=0.2,
        minimum=0,
        maximum=2,
    )
    hitch: float | None = attribute(
        "Distance from the rear axle forward to the hitch for a trailer, m; usually negative. The rear "
        "end of the box if left out.",
        default=None,
        quantity="length",
    )
    coupler: float | None = attribute(
        "Distance from the rear axle forward to the point at which this trailer is coupled to the towing vehicle, m. "
        "The front end of the box if left out.",
        default=None,
        quantity="length",
    )


class Property(Word):
    """A parameter of a controller."""

    word: Literal["property"] = "property"

    name: str = attribute("Name of the controller's parameter.")
    value: str = attribute("Its value.")


class Detector(Word):
    """The detector that finds the lane in the camera's image for the controller `lane_detection`."""

    word: Literal["detector"] = "detector"

    model: str = attribute(
        "Name of a lane detector, or your own as `package.module:Class` or `file.py:Class`.",
        default="classical",
        names="detector",
    )


class Controller(Word):
    """The controller that drives the ego vehicle between control steps."""

    word: Literal["controller"] = "controller"

    model: str = attribute(
        "Name of a controller, or your own as `package.module:Class` or `file.py:Class`.",
        default="lane_detection",
        names="controller",
    )
    properties: tuple[Property, ...] = child("Its parameters.", default=())
    detector: Detector | None = child(
        "The lane detector, for `lane_detection` and controllers derived from it; the classical detector if left out.",
        default=None,
    )


class Ego(Word):
    """The automated vehicle."""

    word: Literal["ego"] = "ego"

    id: str = attribute("Id of the entity.", default="ego", defines="entity", pattern=ENTITY_ID)
    model: str = attribute("Model from the vehicle catalog.", default="vehicle.audi.tt", names="vehicle")
    speed: Number = attribute("Speed at the start, m/s.", default=0.0, quantity="speed", minimum=0)
    desired_speed: Number | None = attribute(
        "Speed that the automation aims for, m/s; the speed at the start if left out.",
        default=None,
        quantity="speed",
        minimum=0,
        exclusive=True,
    )
    start: Position = child("Start position.", wrapper="start")
    destination: Position | None = child("Destination: the run ends here.", default=None, wrapper="destination")
    camera: Camera = child("The forward camera.", default_factory=Camera.model_construct)
    forward_sensor: ForwardSensor = child(
        "The sensor that detects objects ahead.", default_factory=ForwardSensor.model_construct
    )
    odometry: Odometry = child(
        "Errors of the vehicle's own motion estimate while it does not see its lane.",
        default_factory=Odometry.model_construct,
    )
    controller: Controller = child("The controller that drives it.", default_factory=Controller.model_construct)
    whens: tuple[When, ...] = child("Events of the vehicle.", default=())


class Static(Word):
    """An actor that stands still."""

    word: Literal["static"] = "static"

    id: str = attribute("Id of the entity.", defines="entity", pattern=ENTITY_ID)
    model: str = attribute("Model from the vehicle catalog.", default="vehicle.audi.tt", names="vehicle")
    at: Position = child("Position.", wrapper="at")


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
    """An actor that moves: along its lane, through junctions to its destination, or on a path of its own."""

    word: Literal["dynamic"] = "dynamic"

    id: str = attribute("Id of the entity.", defines="entity", pattern=ENTITY_ID)
    model: str = attribute("Model from the vehicle catalog.", default="vehicle.tesla.model3", names="vehicle")
    speed: Number = attribute("Speed at the start, m/s.", default=0.0, quantity="speed", minimum=0)
    start: Position | None = child(
        "Start position. If left out, the actor is absent until <add_entity> places it.",
        default=None,
        wrapper="start",
    )
    destination: Position | None = child(
        "Destination: the actor turns towards it at junctions and drives on beyond it.",
        default=None,
        wrapper="destination",
    )
    follow: Follow | None = child("Follows the vehicle ahead instead of keeping a constant speed.", default=None)
    path: Path | None = child("Path on which it moves from the start.", default=None)
    whens: tuple[When, ...] = child("Actions of the actor, with their conditions.", default=())


class Row(Word):
    """Objects in a row along a lane: cones, barriers, parked cars. A member's id is the row's id and a number."""

    word: Literal["row"] = "row"

    id: str = attribute("Id of the row. Its members are <id>.1, <id>.2 and so on.", defines="entity", pattern=ENTITY_ID)
    model: str = attribute(
        "Model of the members, from the vehicle catalog.", default="static.prop.constructioncone", names="vehicle"
    )
    count: int = attribute("Number of members.", minimum=1, maximum=200)
    spacing: float = attribute("Distance between two members along the lane, m.", default=5.0, quantity="length")
    across: float = attribute(
        "Lateral distance from the first member to the last, m, positive to the left in the direction of travel.",
        default=0.0,
        quantity="length",
    )
    at: Position = child("Position of the first member.", wrapper="at")


class WorkZone(Word):
    """Road works: a sign, a taper of cones, barriers at its end, and cones along the closed stretch.

    The taper runs across the lane. The members' ids are <id>.sign, <id>.taper.1, ..., <id>.barrier.1, ...,
    <id>.cones.1, ...
    """

    word: Literal["work_zone"] = "work_zone"

    id: str = attribute("Id of the work zone.", defines="entity", pattern=ENTITY_ID)
    length: float = attribute(
        "Length of the closed stretch behind the taper, m.", default=30.0, quantity="length", minimum=0, maximum=1000
    )
    taper: float = attribute("Length of the taper, m.", default=20.0, quantity="length", minimum=5, maximum=300)
    across: float = attribute(
        "Lateral extent of the works from the first cone, m, positive to the left in the direction of travel.",
        default=3.2,
        quantity="length",
    )
    spacing: float = attribute(
        "Greatest distance between two cones, m.", default=5.0, quantity="length", minimum=1, maximum=50
    )
    sign_before: float = attribute(
        "Distance of the sign before the first cone, m; 0 means no sign.",
        default=30.0,
        quantity="length",
        minimum=0,
        maximum=300,
    )
    line: bool = attribute(
        "Whether a temporary yellow line runs along the cones of the closed stretch, on the open side.",
        default=False,
    )
    at: Position = child("Position of the first cone, at the lane's edge.", wrapper="at")


class Traffic(Word):
    """Background traffic: vehicles that follow, change lanes, turn at junctions and yield, and pedestrians.

    Pedestrians walk on the sidewalks. Start positions are drawn at random from the run's seed, so each run and each
    variant of a sweep has its own. A vehicle that leaves the map returns at another random place.
    """

    word: Literal["traffic"] = "traffic"

    id: str = attribute(
        "Id of the traffic. Its entities are <id>.1, <id>.2 and so on.",
        default="traffic",
        defines="traffic",
        pattern=ENTITY_ID,
    )
    vehicles: int = attribute("Number of vehicles.", default=0, minimum=0, maximum=500)
    pedestrians: int = attribute("Number of pedestrians on the sidewalks.", default=0, minimum=0, maximum=500)
    density: float = attribute(
        "Vehicles per kilometre of driving lane, in addition to `vehicles`.", default=0.0, minimum=0, maximum=100
    )
    types: tuple[str, ...] = attribute(
        "Categories (car, van, truck, bus, motorbike, bicycle) or catalog models of the vehicles, drawn with equal "
        "probability.",
        default=("car",),
        separated=True,
    )
    pedestrian_types: tuple[str, ...] = attribute(
        "Types of the pedestrians: the category pedestrian, or models of the catalog.",
        default=("pedestrian",),
        separated=True,
    )
    roads: tuple[str, ...] = attribute(
        "Ids of the roads on which they start; all roads outside junctions if left out.",
        default=(),
        names="road",
        separated=True,
    )
    clear: float = attribute(
        "Least distance at the start, m, between two of them and to the other entities.",
        default=20.0,
        quantity="length",
        minimum=8,
        maximum=500,
    )
    slowest: float = attribute(
        "Speed that the slowest driver aims for, as a share of the speed limit.",
        default=0.85,
        quantity="fraction",
        minimum=0.1,
        maximum=2,
    )
    fastest: float = attribute(
        "Speed that the fastest driver aims for, as a share of the speed limit.",
        default=1.1,
        quantity="fraction",
        minimum=0.1,
        maximum=2,
    )
    seed: int | None = attribute(
        "Seed for models, starts and turns. With a seed the traffic is always the same; without one, each run and "
        "each variant of a sweep has its own starts and turns.",
        default=None,
        minimum=0,
    )


Actor = Static | Dynamic
