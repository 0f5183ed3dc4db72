"""The actors of a world that clients share: vehicles, walkers, props, sensors, lights, signs."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from scenario_compiler.carla_server.blueprints import PROP_TAGS, Blueprint
from scenario_compiler.carla_server.signs import Sign
from scenario_compiler.carla_server.traffic_lights import GREEN, Light
from scenario_compiler.frames import CarlaTransform
from scenario_compiler.perception.labels import Tag
from scenario_compiler.vocabulary.entities import Vehicle
from scenario_compiler.worlds.resistance import Resistance, resistance

MASS = 1000.0
"""CARLA's public default of a vehicle's mass, kg; those of single vehicles are binary assets."""

WALKER_MASS = 80.0

MAX_STEER = 70.0
"""Greatest angle of the front wheels, degrees: CARLA's public default."""

TRUE = ("true", "yes", "on")
NOT_ZERO = re.compile(r"\s*[+-]?0*[1-9]")

BRIGHTEST = 255
CHANNEL = re.compile(r"\s*([+-]?\d{1,9})")
"""A channel of a colour, as clients read it from a text (`ActorAttributeValueAccess::As<sensor::data::Color>`)."""

TAGS = {
    "car": Tag.CAR,
    "van": Tag.TRUCK,
    "truck": Tag.TRUCK,
    "bus": Tag.BUS,
    "motorbike": Tag.MOTORCYCLE,
    "bicycle": Tag.BICYCLE,
    "pedestrian": Tag.PEDESTRIAN,
}


@dataclass(eq=False)
class Actor:
    """An actor.

    Attributes:
        id: Its number.
        blueprint: Its blueprint.
        attributes: Its attributes, as texts.
        description: Its description as it came, for the wire.
        transform: Where it is, CARLA's axes; of a body, where it was when it was last asked for.
        parent: Actor that it is attached to, 0 for none.
        relative: Its transform relative to that.
        row: Its row in the snapshot, -1 for none.
        children: Ids of the actors that are attached to it.
    """

    id: int
    blueprint: Blueprint
    attributes: dict[str, str]
    description: list[Any]
    transform: CarlaTransform
    parent: int = 0
    relative: CarlaTransform | None = None
    row: int = -1
    children: list[int] = field(default_factory=list)

    @property
    def stream(self) -> int:
        """Number of its stream, 0 for none."""
        return 0

    @property
    def box(self) -> tuple[float, float, float]:
        """Half extents of its box, m."""
        return (0.0, 0.0, 0.0)

    @property
    def tag(self) -> Tag:
        """Its semantic tag."""
        return Tag.UNLABELED

    def says(self, name: str) -> bool:
        """Return an attribute that is true or false, as CARLA's server reads its text.

        "true", "yes" and "on" are true in upper and lower case, and so is a text that begins with an integer other than
        0; every other text is false. CARLA's clients send "true" and "false" only (`ActorAttribute::Set`).
        Source: `UActorBlueprintFunctionLibrary::ActorAttributeToBool` in CARLA, `FToBoolHelper::FromCStringWide` in
        the Unreal Engine.
        """
        text = self.attributes[name]
        return text.lower() in TRUE or NOT_ZERO.match(text) is not None


@dataclass(eq=False)
class Body(Actor):
    """An actor that has a box and an index in the engine: a vehicle, a walker or a prop.

    Attributes:
        place: Its index in the engine.
        shape: Its box and axles.
        simulates: Whether physics moves it; it never moves a prop.
        collides: Whether it can collide with others.
        weighs: Whether gravity pulls it; without gravity, its tires transmit no force.
        mass: kg.
        spawned: Where it was spawned, CARLA's axes.
    """

    place: int = -1
    shape: Vehicle = field(default_factory=lambda: Vehicle(name="", length=1, width=1, height=1, wheelbase=1, center=0))
    simulates: bool = False
    collides: bool = True
    weighs: bool = True
    mass: float = MASS
    spawned: CarlaTransform = field(default_factory=lambda: CarlaTransform(0.0, 0.0, 0.0, 0.0, 0.0, 0.0))

    @property
    def box(self) -> tuple[float, float, float]:
        """Half extents of its box, m."""
        return (0.5 * self.shape.length, 0.5 * self.shape.width, 0.5 * self.shape.height)

    @property
    def tag(self) -> Tag:
        """Its semantic tag; in pictures, riders have their own."""
        return TAGS.get(self.shape.category) or PROP_TAGS.get(self.blueprint.name.rpartition(".")[2], Tag.DYNAMIC)

    @property
    def up(self) -> float:
        """Height of its origin over the ground, m."""
        return 0.0


@dataclass(eq=False)
class Car(Body):
    """A vehicle.

    Attributes:
        simulates: Whether physics moves it; if not, it stays where a client puts it.
        control: Throttle (0 to 1), steer (-1 to 1, positive to the right), brake (0 to 1), hand brake, reverse, manual
            gear shift, gear: as a client gave them last.
        ackermann: Target of the Ackermann controller, or None: steering angle, rad, positive to the right, and its
            rate, rad/s; speed, m/s; acceleration, m/s2; jerk, m/s3.
        tuning: Settings of that controller: proportional, integral and derivative gains for the speed, then for the
            acceleration.
        physics: The physics control that a client gave, in the order and units of the wire (radii and places of wheels
            in cm), or None.
        lights: Bits of its lights, as CARLA counts them.
        doors: Doors that are open, by CARLA's numbers.
        turned: Angles to which a client has turned wheels, degrees, by the number of the wheel.
        constant: Speed that it keeps, m/s, or None.
        pushed: Change of speed by impulses, which the next step applies, m/s.
        gear: The gear it is in.
        light: The traffic light that it stands before, or None.
        shown: The state that the last stop or yield sign has shown to it: RED or GREEN.
        friction: Friction that a trigger gives its tires while it is in it, or None.
        slowing: The resistances that slow it down while it rolls.
    """

    simulates: bool = True
    control: list[Any] = field(default_factory=lambda: [0.0, 0.0, 0.0, False, False, False, 0])
    ackermann: list[float] | None = None
    tuning: list[float] = field(default_factory=lambda: [0.15, 0.0, 0.25, 0.01, 0.0, 0.01])
    physics: list[Any] | None = None
    lights: int = 0
    doors: set[int] = field(default_factory=set)
    turned: dict[int, float] = field(default_factory=dict)
    constant: float | None = None
    pushed: float = 0.0
    gear: int = 1
    light: Light | None = None
    shown: int = GREEN
    friction: float | None = None
    slowing: Resistance = field(init=False)

    def __post_init__(self) -> None:
        self.weigh_up()

    def weigh_up(self) -> None:
        """Compute its resistances from its physics control, which has radii in cm."""
        control = self.physics_control()
        wheels = [(wheel[1], wheel[3] / 100.0) for wheel in control[15]]
        self.slowing = resistance(wheels, control[12], self.shape.width * self.shape.height, self.mass)

    @property
    def sticky(self) -> bool:
        """Whether a control holds until the next one."""
        return self.says("sticky_control")

    @property
    def two_wheeled(self) -> bool:
        """Whether it has two wheels."""
        return self.attributes.get("number_of_wheels") == "2" or self.shape.category in ("bicycle", "motorbike")

    @property
    def steers(self) -> float:
        """Greatest angle of its front wheels, degrees."""
        if self.physics is None:
            return MAX_STEER
        return float(max((wheel[2] for wheel in self.physics[15]), default=MAX_STEER))

    @property
    def grip(self) -> float:
        """The share of the wheels' forces that the tires transmit to the road: 1 unless their friction is below 1."""
        if not self.weighs:
            return 0.0
        if self.friction is not None:
            return min(max(self.friction, 0.0), 1.0)
        if self.physics is None:
            return 1.0
        return float(min([1.0, *(max(wheel[0], 0.0) for wheel in self.physics[15])]))

    def physics_control(self) -> list[Any]:
        """Return its physics control: a client's, or CARLA's public defaults; its wheels are where they are now."""
        given = self._default_physics() if self.physics is None else self.physics
        wheels = [[*wheel[:9], place] for wheel, place in zip(given[15], self._wheel_places(), strict=True)]
        return [*given[:15], wheels, *given[16:]]

    def _default_physics(self) -> list[Any]:
        wheels = []
        for front in (True, True, False, False):  # two-wheelers have four in CARLA's physics too
            steered, held = (MAX_STEER, 0.0) if front else (0.0, 3000.0)
            wheels.append([3.5, 0.25, steered, 30.0, 1500.0, held, 2.0, 17.0, 1000.0])
        return [
            *([[0.0, 500.0], [5000.0, 500.0]], 5000.0, 1.0, 0.15, 2.0, 0.35, True, 0.5, 10.0, 4.0),
            *([[5.0, 0.5, 0.65]], self.mass, 0.3, [0.0, 0.0, 0.0], [[0.0, 1.0], [120.0, 1.0]], wheels, False),
        ]

    def _wheel_places(self) -> list[list[float]]:
        """Return the places of its wheels, front left first, CARLA's axes, cm."""
        length, width = 0.5 * self.shape.wheelbase, 0.4 * self.shape.width
        x, y, z, _, yaw, _ = self.transform
        ahead = (math.cos(math.radians(yaw)), math.sin(math.radians(yaw)))
        return [
            [
                100.0 * (x + along * length * ahead[0] - across * width * ahead[1]),
                100.0 * (y + along * length * ahead[1] + across * width * ahead[0]),
                100.0 * (z + 0.3),
            ]
            for along, across in ((1, -1), (1, 1), (-1, -1), (-1, 1))
        ]


@dataclass(eq=False)
class Walker(Body):
    """A person on foot.

    Attributes:
        mass: kg.
        simulates: Whether physics moves it; if not, it stays where a client puts it.
        control: Direction (x, y, z in CARLA's axes), speed, m/s, and whether it jumps: as a client gave them last.
        bones: Transforms of bones that a client gave, by their names.
    """

    mass: float = WALKER_MASS
    simulates: bool = True
    control: list[Any] = field(default_factory=lambda: [[1.0, 0.0, 0.0], 0.0, False])
    bones: dict[str, Any] = field(default_factory=dict)

    @property
    def up(self) -> float:
        """Height of its origin over the ground, m: the middle of its box."""
        return 0.5 * self.shape.height


@dataclass(eq=False)
class Sensor(Actor):
    """A sensor; its stream's number is its own.

    Attributes:
        due: The time of its next measurement, s.
        measured: How often it has measured.
        unseen: Ids of the actors that a lidar does not see.
    """

    due: float = -math.inf
    measured: int = 0
    unseen: frozenset[int] = frozenset()

    @property
    def stream(self) -> int:
        """Number of its stream."""
        return self.id

    def number(self, name: str) -> float:
        """Return an attribute as a number, or its default if it is not a number."""
        for text in (self.attributes.get(name), self.blueprint.defaults.get(name)):
            try:
                value = float(text or "")
            except ValueError:
                continue
            if math.isfinite(value):
                return value
        return 0.0


@dataclass(eq=False, kw_only=True)
class LightActor(Actor):
    """A traffic light's actor."""

    light: Light


@dataclass(eq=False, kw_only=True)
class SignActor(Actor):
    """A sign's actor."""

    sign: Sign


def channels_of(text: str) -> tuple[int, int, int] | None:
    """Return red, green and blue of the text of a colour as clients read it, None if they cannot read it."""
    found = [CHANNEL.match(part) for part in text.split(",")]
    values = [int(one.group(1)) for one in found if one is not None]
    if len(found) != 3 or len(values) != 3 or max(values) > BRIGHTEST:
        return None
    red, green, blue = (value & BRIGHTEST for value in values)
    return red, green, blue


def transform_of(wire: Sequence[Sequence[float]]) -> CarlaTransform:
    """Return a transform in the layout of the wire: [[x, y, z], [pitch, yaw, roll]]."""
    (x, y, z), (pitch, yaw, roll) = wire
    return CarlaTransform(float(x), float(y), float(z), float(pitch), float(yaw), float(roll))


def on_wire(transform: CarlaTransform) -> list[list[float]]:
    """Return a transform in the layout of the wire."""
    return [list(transform[:3]), list(transform[3:])]
