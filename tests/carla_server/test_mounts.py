"""Cameras that are mounted at the same place draw a scene once; each sends what it would send alone."""

from __future__ import annotations

from functools import partial

import pytest

from scenario_compiler.carla_server.actors import Car, Sensor
from scenario_compiler.carla_server.sensors.instrument import Instrument
from scenario_compiler.carla_server.sensors.kinds import INSTRUMENTS
from scenario_compiler.carla_server.spawning import new_actor, new_body
from scenario_compiler.carla_server.stage import Stage
from scenario_compiler.carla_server.towns import load_town
from scenario_compiler.frames import CarlaTransform
from scenario_compiler.vocabulary.weather import Weather
from tests.work import counted

RAIN = Weather(precipitation=80.0, cloudiness=80.0)
KINDS = ("rgb", "depth", "semantic_segmentation", "instance_segmentation", "normals", "optical_flow")
AHEAD = CarlaTransform(1.5, 0.0, 2.0, 0.0, 0.0, 0.0)
SIZE = [["image_size_x", 1, "160"], ["image_size_y", 1, "90"]]


class Mounted:
    """A car with cameras, and another car before it."""

    def __init__(self) -> None:
        self.stage = Stage(load_town("town_grid", ()), "0.9.16")
        at = self.stage.town.spawn_points[0]
        self.car = self._add("vehicle.audi.tt", at)
        self._add("vehicle.nissan.patrol", at._replace(x=at.x + 15.0))
        self.stage.measure(0.05)

    def _add(self, name: str, at: CarlaTransform) -> int:
        return self.stage.add_body(new_body("0.9.16", [0, name, []], at)).id

    def camera(self, kind: str, at: CarlaTransform, *attributes: list[object]) -> tuple[Instrument, Sensor]:
        """Return a camera on the first car that is ready."""
        sensor = new_actor("0.9.16", [0, f"sensor.camera.{kind}", [*SIZE, *attributes]], at)
        assert isinstance(sensor, Sensor)
        sensor.parent, sensor.relative = self.car, at
        self.stage.add(sensor)
        instrument = INSTRUMENTS[sensor.blueprint.name](self.stage, sensor)
        instrument.prepare()
        return instrument, sensor

    def drive(self, seconds: float) -> None:
        """Let the first car accelerate for a step."""
        car = self.stage.actors[self.car]
        assert isinstance(car, Car)
        car.control[0] = 1.0
        self.stage.driving.command(car)
        self.stage.step(seconds)

    def image(self, camera: tuple[Instrument, Sensor], frame: int) -> bytes | None:
        """Return what a camera sends in a frame."""
        instrument, sensor = camera
        return instrument.measure(self.stage, sensor, frame, 0.05, RAIN)


def test_cameras_at_one_mount_draw_a_scene_once() -> None:
    """The lines of Python of the others together are fewer than those of the first one, which draws."""
    mounted = Mounted()
    cameras = {kind: mounted.camera(kind, AHEAD) for kind in KINDS}
    for frame in (1, 2):
        lines = {kind: counted(partial(mounted.image, cameras[kind], frame))[1] for kind in KINDS}
    assert sum(lines.values()) < 2 * lines["rgb"]


@pytest.mark.parametrize("kind", KINDS)
def test_a_camera_beside_others_sends_what_it_would_send_alone(kind: str) -> None:
    mounted, alone = Mounted(), Mounted()
    cameras, only = [mounted.camera(one, AHEAD) for one in KINDS], alone.camera(kind, AHEAD)
    for frame in (1, 2):
        for one in (mounted, alone):
            one.drive(0.2)
        images = [mounted.image(camera, frame) for camera in cameras]
        assert images[KINDS.index(kind)] == alone.image(only, frame)
        assert mounted.image(cameras[0], frame) == images[0]


@pytest.mark.parametrize(
    ("at", "attributes"),
    [(AHEAD._replace(x=1.6), []), (AHEAD, [["fov", 3, "60.0"]]), (AHEAD._replace(yaw=1.0), [])],
)
def test_another_mount_or_lens_sees_something_else(at: CarlaTransform, attributes: list[list[object]]) -> None:
    mounted = Mounted()
    one, other = mounted.camera("rgb", AHEAD), mounted.camera("rgb", at, *attributes)
    assert mounted.image(one, 1) != mounted.image(other, 1)
    assert mounted.image(one, 2) != mounted.image(other, 2)
