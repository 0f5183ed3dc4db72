"""The blueprint library: everything that clients can spawn, with the attributes of CARLA's own library.

Names, attributes and defaults are those of CARLA's documentation of the blueprint library (0.9.15 and 0.9.16:
"Blueprint library", "Vehicle catalogue", "Pedestrian catalogue"). Boxes and their source stand in `library/catalogs`;
boxes of walkers are those that Scenic's blueprint table lists for CARLA 0.9.16. Recommended colours are a palette of
our own: the vehicles' own ones are part of CARLA's binary assets.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.perception.labels import Tag
from scenario_compiler.resources import library_folder
from scenario_compiler.source.catalogs import load_catalogs
from scenario_compiler.vocabulary.entities import Vehicle

KINDS = ("bool", "int", "float", "str", "colour")
"""Types of attributes; their numbers on the wire are their indices, plus one from 0.9.16 on."""

COLOURS = ("180,44,44", "38,38,38", "205,205,205", "40,60,150", "60,60,60", "40,120,60", "190,140,30")

PERSON = (0.375, 0.375, 1.86)
CHILD = (0.5, 0.5, 1.1)
YOUTH = (0.375, 0.375, 1.3)
"""Length, width and height of a walker's box, m."""

CHILDREN = frozenset((9, 10, 11, 48, 49))
YOUTHS = frozenset((12, 13, 14))
WALKERS = {"0.9.15": 51, "0.9.16": 52}
"""Number of pedestrians by version."""


STANDING = (
    *("atm", "bench01", "bench02", "bench03", "busstop", "busstoplb", "calibrator", "chainbarrier", "chainbarrierend"),
    *("fountain", "mailbox", "maptable", "platformgarbage01", "slide", "streetfountain", "streetsign", "streetsign01"),
    *("streetsign04", "swing", "trashcan02", "trashcan04", "trashcan05", "vendingmachine"),
    *(f"plantpot0{number}" for number in range(1, 9)),
)
PROP_TAGS = {
    **dict.fromkeys(STANDING, Tag.STATIC),
    **dict.fromkeys(("dirtdebris01", "dirtdebris02", "dirtdebris03"), Tag.OTHER),
    "kiosk_01": Tag.BUILDING,
}
"""Semantic tags of props: CARLA takes them from the folder of a prop's mesh, which its `Default.Package.json` names.
All others lie in `Dynamic`; `busstoplb` is no part of the file that was at hand, and taken as `busstop`.
"""


@dataclass(frozen=True)
class Attribute:
    """An attribute of a blueprint: name, type of `KINDS`, default, recommended values, and whether it can be changed.

    If no values are recommended, clients get the default as the only one, because they read the first.
    """

    name: str
    kind: str
    value: str
    recommended: tuple[str, ...] = ()
    modifiable: bool = True


@dataclass(frozen=True)
class Blueprint:
    """A blueprint: a kind of actor that clients can spawn.

    Attributes:
        name: Its id.
        tags: Its tags.
        attributes: Its attributes.
        vehicle: Box and axles of a vehicle, walker or prop; None for other blueprints.
        since: The first version of CARLA that has it.
        defaults: The defaults of the attributes, by name; made from them.
    """

    name: str
    tags: str
    attributes: tuple[Attribute, ...] = ()
    vehicle: Vehicle | None = None
    since: str = "0.9.15"
    defaults: dict[str, str] = field(default_factory=dict, compare=False)

    def __post_init__(self) -> None:
        self.defaults.update({one.name: one.value for one in self.attributes})

    @property
    def kind(self) -> str:
        """The first word of its id."""
        return self.name.partition(".")[0]


@dataclass(frozen=True)
class Looks:
    """The data of a vehicle in CARLA's vehicle catalogue, without its box."""

    generation: int = 1
    base: str = "car"
    special: str = ""
    lights: bool = False
    doors: bool = False


LOOKS = {
    "vehicle.audi.tt": Looks(lights=True),
    "vehicle.audi.etron": Looks(lights=True, special="electric"),
    "vehicle.chevrolet.impala": Looks(lights=True),
    "vehicle.carlamotors.carlacola": Looks(base="truck", lights=True),
    "vehicle.carlamotors.european_hgv": Looks(2, "truck"),
    "vehicle.carlamotors.firetruck": Looks(2, "truck", "emergency", lights=True, doors=True),
    "vehicle.dodge.charger_2020": Looks(2, lights=True, doors=True),
    "vehicle.dodge.charger_police": Looks(special="emergency", lights=True),
    "vehicle.dodge.charger_police_2020": Looks(2, special="emergency", lights=True, doors=True),
    "vehicle.ford.ambulance": Looks(2, "van", "emergency", lights=True, doors=True),
    "vehicle.ford.crown": Looks(2, special="taxi", lights=True, doors=True),
    "vehicle.ford.mustang": Looks(lights=True),
    "vehicle.lincoln.mkz_2017": Looks(lights=True),
    "vehicle.lincoln.mkz_2020": Looks(2, lights=True, doors=True),
    "vehicle.mercedes.coupe_2020": Looks(2, lights=True, doors=True),
    "vehicle.mercedes.sprinter": Looks(2, "van", lights=True, doors=True),
    "vehicle.micro.microlino": Looks(special="electric"),
    "vehicle.mini.cooper_s_2021": Looks(2, lights=True, doors=True),
    "vehicle.mitsubishi.fusorosa": Looks(2, "bus", lights=True, doors=True),
    "vehicle.nissan.patrol_2021": Looks(2, lights=True, doors=True),
    "vehicle.tesla.cybertruck": Looks(base="truck", special="electric", lights=True),
    "vehicle.tesla.model3": Looks(2, special="electric", lights=True, doors=True),
    "vehicle.volkswagen.t2": Looks(base="van", lights=True),
    "vehicle.volkswagen.t2_2021": Looks(2, "van", lights=True, doors=True),
}
"""By id; a vehicle that is not here is a car, motorcycle or bicycle of the first generation without lights."""

TWO_WHEELS = {"bicycle": "bicycle", "motorbike": "motorcycle"}


def _number(name: str, value: str, *recommended: str) -> Attribute:
    return Attribute(name, "int" if value.lstrip("-").isdigit() else "float", value, recommended or (value,))


def _numbers(text: str) -> tuple[Attribute, ...]:
    return tuple(_number(*one.split("=")) for one in text.split())


def _role(value: str) -> Attribute:
    return Attribute("role_name", "str", value, (value,))


TICK = _number("sensor_tick", "0.0")
IMAGE = (_role("front"), *_numbers("fov=90.0 image_size_x=800 image_size_y=600"), TICK)
LENS = _numbers(
    "lens_circle_falloff=5.0 lens_circle_multiplier=0.0 lens_k=-1.0 lens_kcube=0.0 lens_x_size=0.08 lens_y_size=0.08"
)
PICTURE = (
    Attribute("enable_postprocess_effects", "bool", "true"),
    Attribute("exposure_mode", "str", "histogram", ("histogram", "manual")),
    *_numbers(
        "bloom_intensity=0.675 fstop=1.4 iso=100.0 gamma=2.2 lens_flare_intensity=0.1 shutter_speed=200.0 "
        "min_fstop=1.2 blade_count=5 exposure_compensation=0.0 exposure_min_bright=10.0 exposure_max_bright=12.0 "
        "exposure_speed_up=3.0 exposure_speed_down=1.0 calibration_constant=16.0 focal_distance=1000.0 blur_amount=1.0 "
        "blur_radius=0.0 motion_blur_intensity=0.45 motion_blur_max_distortion=0.35 "
        "motion_blur_min_object_screen_size=0.1 slope=0.88 toe=0.55 shoulder=0.26 black_clip=0.0 white_clip=0.04 "
        "temp=6500.0 tint=0.0 chromatic_aberration_intensity=0.0 chromatic_aberration_offset=0.0"
    ),
)
EVENTS = _numbers(
    "positive_threshold=0.3 negative_threshold=0.3 sigma_positive_threshold=0 sigma_negative_threshold=0 "
    "refractory_period_ns=0 log_eps=0.001"
)
LASER = _numbers(
    "channels=32 range=10.0 points_per_second=56000 rotation_frequency=10.0 upper_fov=10.0 lower_fov=-30.0 "
    "horizontal_fov=360.0"
)
RETURNS = _numbers(
    "atmosphere_attenuation_rate=0.004 noise_seed=0 dropoff_general_rate=0.45 dropoff_intensity_limit=0.8 "
    "dropoff_zero_intensity=0.4 noise_stddev=0.0"
)
IMU = _numbers(
    "noise_accel_stddev_x=0.0 noise_accel_stddev_y=0.0 noise_accel_stddev_z=0.0 noise_gyro_stddev_x=0.0 "
    "noise_gyro_stddev_y=0.0 noise_gyro_stddev_z=0.0 noise_gyro_bias_x=0.0 noise_gyro_bias_y=0.0 noise_gyro_bias_z=0.0 "
    "noise_seed=0"
)
GNSS = _numbers(
    "noise_alt_bias=0.0 noise_alt_stddev=0.0 noise_lat_bias=0.0 noise_lat_stddev=0.0 noise_lon_bias=0.0 "
    "noise_lon_stddev=0.0 noise_seed=0"
)
SENSORS = (
    Blueprint("sensor.camera.rgb", "sensor,camera,rgb", (*IMAGE, *LENS, *PICTURE)),
    Blueprint("sensor.camera.depth", "sensor,camera,depth", (*IMAGE, *LENS)),
    Blueprint("sensor.camera.semantic_segmentation", "sensor,camera,semantic_segmentation", (*IMAGE, *LENS)),
    Blueprint("sensor.camera.instance_segmentation", "sensor,camera,instance_segmentation", (*IMAGE, *LENS)),
    Blueprint("sensor.camera.normals", "sensor,camera,normals", (*IMAGE, *LENS)),
    Blueprint("sensor.camera.optical_flow", "sensor,camera,optical_flow", (*IMAGE, *LENS)),
    Blueprint("sensor.camera.dvs", "sensor,camera,dvs", (*IMAGE, *LENS, *EVENTS, Attribute("use_log", "bool", "true"))),
    Blueprint(
        "sensor.camera.cosmos_visualization", "sensor,camera,cosmos_visualization", (*IMAGE, *LENS), since="0.9.16"
    ),
    Blueprint("sensor.lidar.ray_cast", "sensor,lidar,ray_cast", (_role("front"), TICK, *LASER, *RETURNS)),
    Blueprint("sensor.lidar.ray_cast_semantic", "sensor,lidar,ray_cast_semantic", (_role("front"), TICK, *LASER)),
    Blueprint(
        "sensor.other.radar",
        "sensor,other,radar",
        (
            _role("front"),
            TICK,
            *_numbers("horizontal_fov=30.0 vertical_fov=30.0 range=100.0 points_per_second=1500 noise_seed=0"),
        ),
    ),
    Blueprint("sensor.other.imu", "sensor,other,imu", (_role("front"), TICK, *IMU)),
    Blueprint("sensor.other.gnss", "sensor,other,gnss", (_role("front"), TICK, *GNSS)),
    Blueprint("sensor.other.collision", "sensor,other,collision", (_role("front"),)),
    Blueprint("sensor.other.lane_invasion", "sensor,other,lane_invasion", (_role("front"),)),
    Blueprint(
        "sensor.other.obstacle",
        "sensor,other,obstacle",
        (
            _role("front"),
            TICK,
            *_numbers("distance=5.0 hit_radius=0.5"),
            Attribute("only_dynamics", "bool", "false"),
            Attribute("debug_linetrace", "bool", "true"),
        ),
    ),
    Blueprint("sensor.other.rss", "sensor,other,rss", (_role("front"),)),
    Blueprint("sensor.other.v2x", "sensor,other,v2x", (_role("front"), TICK), since="0.9.16"),
    Blueprint("sensor.other.v2x_custom", "sensor,other,v2x_custom", (_role("front"), TICK), since="0.9.16"),
)

OTHERS = (
    Blueprint("controller.ai.walker", "controller,ai,walker", (_role("front"),)),
    Blueprint(
        "static.trigger.friction",
        "static,trigger,friction",
        (_role("front"), *_numbers("friction=3.5 extent_x=1.0 extent_y=1.0 extent_z=1.0")),
    ),
    Blueprint("util.actor.empty", "util,actor,empty", (_role("empty"),)),
    Blueprint(
        "static.prop.mesh",
        "static,prop,mesh",
        (_role("front"), Attribute("mesh_path", "str", ""), Attribute("mass", "float", ""), *_numbers("scale=1.0")),
    ),
)


def _vehicle(one: Vehicle) -> Blueprint:
    two = TWO_WHEELS.get(one.category, "")
    looks = LOOKS.get(one.name, Looks(base=two or "car"))
    fixed = {
        "object_type": ("str", ""),
        "base_type": ("str", looks.base),
        "special_type": ("str", looks.special),
        "number_of_wheels": ("int", "2" if two else "4"),
        "generation": ("int", str(looks.generation)),
        "has_dynamic_doors": ("bool", str(looks.doors).lower()),
        "has_lights": ("bool", str(looks.lights).lower()),
    }
    return Blueprint(
        one.name,
        ",".join(one.name.split(".")),
        (
            Attribute("color", "colour", COLOURS[0], COLOURS),
            Attribute("role_name", "str", "autopilot", ("autopilot", "scenario", "ego_vehicle")),
            Attribute("sticky_control", "bool", "true"),
            Attribute("terramechanics", "bool", "false"),
            *(Attribute(name, kind, value, (value,), False) for name, (kind, value) in fixed.items()),
        ),
        one,
    )


def _walker(number: int) -> Blueprint:
    length, width, height = CHILD if number in CHILDREN else YOUTH if number in YOUTHS else PERSON
    young = number in CHILDREN | YOUTHS
    name = f"walker.pedestrian.{number:04}"
    box = Vehicle(
        name=name, category="pedestrian", length=length, width=width, height=height, wheelbase=length, center=0.0
    )
    return Blueprint(
        name,
        ",".join(name.split(".")),
        (
            Attribute("role_name", "str", "pedestrian", ("pedestrian",)),
            Attribute("is_invincible", "bool", "true"),
            Attribute("speed", "float", "1.4", ("0.0", "1.1", "1.9") if young else ("0.0", "1.4", "2.8")),
            Attribute("gender", "str", "other", ("other",), False),
            Attribute("age", "str", "child" if young else "adult", ("child" if young else "adult",), False),
            Attribute("generation", "int", "1" if number <= 14 else "2", ("1" if number <= 14 else "2",), False),
            Attribute("can_use_wheelchair", "bool", "false", ("false",), False),
            Attribute("use_wheelchair", "bool", "false"),
        ),
        box,
        since="0.9.16" if number > WALKERS["0.9.15"] else "0.9.15",
    )


def _prop(one: Vehicle) -> Blueprint:
    size = "small" if one.length * one.width * one.height < 0.5 else "medium" if one.length < 2.0 else "big"
    return Blueprint(
        one.name,
        ",".join(one.name.split(".")),
        (Attribute("role_name", "str", "prop", ("prop",)), Attribute("size", "str", size, (size,), False)),
        one,
    )


@lru_cache(maxsize=2)
def library(version: str) -> dict[str, Blueprint]:
    """Return the blueprints of a version by id."""
    sink = Diagnostics()
    known = load_catalogs(library_folder() / "catalogs", sink).vehicles.values()
    found = [
        *(_vehicle(one) for one in known if one.name.startswith("vehicle.")),
        *(_walker(number + 1) for number in range(WALKERS["0.9.16"])),
        *(_prop(one) for one in known if one.name.startswith("static.")),
        *SENSORS,
        *OTHERS,
    ]
    return {one.name: one for one in found if one.since <= version}


def first_kind(version: str) -> int:
    """Return the number on the wire of the first of `KINDS`; the others follow it."""
    return 1 if version >= "0.9.16" else 0


def definitions(version: str) -> list[list[object]]:
    """Return the blueprints in the layout of the wire; a definition's number is its index, counted from 1."""
    first = first_kind(version)
    return [
        [
            number,
            one.name,
            one.tags,
            [
                [
                    attribute.name,
                    first + KINDS.index(attribute.kind),
                    attribute.value,
                    list(attribute.recommended or (attribute.value,)),
                    attribute.modifiable,
                    False,
                ]
                for attribute in one.attributes
            ],
        ]
        for number, one in enumerate(library(version).values(), 1)
    ]
