"""The attributes of actors, as a client's description has them."""

from __future__ import annotations

import pytest

from scenario_compiler.carla_server.actors import Actor, Car
from scenario_compiler.carla_server.blueprints import KINDS, first_kind, library
from scenario_compiler.carla_server.call_error import CallError
from scenario_compiler.carla_server.spawning import check_attributes, new_actor
from scenario_compiler.cli.carla import VERSIONS
from scenario_compiler.frames import CarlaTransform

VERSION = "0.9.16"
BOOL = 1
"""The number of the type "bool" on the wire."""

HERE = CarlaTransform(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def actor(blueprint: str, **attributes: str) -> Actor:
    return new_actor(VERSION, [1, blueprint, [[name, BOOL, text] for name, text in attributes.items()]], HERE)


@pytest.mark.parametrize(
    "text",
    ["true", "True", "TRUE", "yes", "On", "1", "-1", " 2", "3 m", "007", pytest.param("9" * 5000, id="many digits")],
)
def test_a_text_is_true_as_in_the_unreal_engine(text: str) -> None:
    assert actor("sensor.other.obstacle", only_dynamics=text).says("only_dynamics")


@pytest.mark.parametrize(
    "text",
    [
        "false",
        "False",
        "no",
        "off",
        "0",
        "00",
        "-0.5",
        pytest.param("0" * 5000, id="many zeros"),
        "",
        "maybe",
        "truee",
        " true",
        "t",
        "+",
    ],
)
def test_every_other_text_is_false(text: str) -> None:
    assert not actor("sensor.camera.dvs", use_log=text).says("use_log")


def test_without_a_text_of_the_client_the_blueprints_default_holds() -> None:
    assert actor("sensor.camera.dvs").says("use_log")
    assert not actor("sensor.other.obstacle").says("only_dynamics")


@pytest.mark.parametrize(("text", "sticky"), [("true", True), ("False", False), ("off", False), ("1", True)])
def test_a_control_is_sticky_where_the_attribute_is_true(text: str, sticky: bool) -> None:
    car = actor("vehicle.audi.tt", sticky_control=text)
    assert isinstance(car, Car)
    assert car.sticky is sticky


def test_each_default_is_true_or_false() -> None:
    defaults = {
        one.value for blueprint in library(VERSION).values() for one in blueprint.attributes if one.kind == "bool"
    }
    assert defaults == {"true", "false"}


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize(
    ("kind", "text"),
    [
        *(("colour", text) for text in ("red", "", "300,0,0", "1,2", "1,2,3,", "1,x,3", "9" * 5000)),
        *(("bool", text) for text in ("1", "", "maybe")),
    ],
)
def test_a_text_that_no_client_can_read_is_refused(version: str, kind: str, text: str) -> None:
    """A client asks for the attributes of all actors: one that it cannot read hides them all from everybody."""
    description = [1, "vehicle.audi.tt", [["mine", first_kind(version) + KINDS.index(kind), text]]]
    with pytest.raises(CallError, match="'mine'"):
        check_attributes(version, description)


@pytest.mark.parametrize("version", VERSIONS)
def test_what_clients_can_read_passes(version: str) -> None:
    read = [("colour", "255, 0,7"), ("bool", "True"), ("int", "abc"), ("float", ""), ("str", "red")]
    number = {kind: first_kind(version) + place for place, kind in enumerate(KINDS)}
    check_attributes(version, [1, "vehicle.audi.tt", [["mine", number[kind], text] for kind, text in read]])
    for wrong in (first_kind(version) - 1, first_kind(version) + len(KINDS)):
        with pytest.raises(CallError, match="type"):
            check_attributes(version, [1, "vehicle.audi.tt", [["mine", wrong, ""]]])


@pytest.mark.parametrize(
    ("blueprint", "attributes"),
    [
        ("sensor.camera.rgb", {"image_size_x": "100000"}),
        ("sensor.camera.depth", {"image_size_y": "0"}),
        ("sensor.camera.dvs", {"image_size_x": "30000", "image_size_y": "30000"}),
        ("sensor.camera.rgb", {"fov": "175"}),
        ("sensor.lidar.ray_cast", {"range": "-10"}),
        ("sensor.lidar.ray_cast_semantic", {"points_per_second": "-1e30"}),
        ("sensor.lidar.ray_cast", {"channels": "2000"}),
        ("sensor.other.radar", {"points_per_second": "1e9"}),
        ("sensor.other.radar", {"range": "-100"}),
        ("sensor.other.imu", {"noise_accel_stddev_x": "1e308"}),
    ],
)
def test_a_number_with_which_a_sensor_cannot_measure_is_refused(blueprint: str, attributes: dict[str, str]) -> None:
    with pytest.raises(CallError, match=r"unable to spawn actor: (its attribute '|an image has at most )"):
        actor(blueprint, **attributes)


def test_the_greatest_numbers_of_sensors_can_be_spawned() -> None:
    actor("sensor.camera.rgb", image_size_x="32766", image_size_y="512", fov="170")
    actor("sensor.lidar.ray_cast", channels="1024", points_per_second="1e7", range="0")
