"""Features that client programs use together: none of them may take another one along."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from tests.carla_server.conftest import LANDED, STEP, Served, free_port
from tests.carla_server.test_sensors import Listening, Spawn, pixels

pytestmark = [pytest.mark.slow, pytest.mark.apart]
"""Run by `make test-carla`."""


def synchronous(client: Any) -> Any:
    """Return the client's world in synchronous mode."""
    world = client.get_world()
    settings = world.get_settings()
    settings.synchronous_mode, settings.fixed_delta_seconds = True, STEP
    world.apply_settings(settings)
    return world


def test_constant_velocity_beside_managed_cars_and_again_in_a_reloaded_world(server: Served) -> None:
    import carla

    client, port = server.client(), free_port()
    for _ in range(2):
        world = synchronous(client)
        manager = client.get_trafficmanager(port)
        manager.set_synchronous_mode(True)
        manager.set_random_device_seed(4)
        library, points = world.get_blueprint_library(), world.get_map().get_spawn_points()
        managed = [world.spawn_actor(library.find("vehicle.tesla.model3"), point) for point in points[10:18]]
        steady = world.spawn_actor(library.find("vehicle.carlamotors.carlacola"), points[0])
        for _ in range(LANDED):
            world.tick()
        begun = {one.id: one.get_location() for one in (*managed, steady)}
        for one in managed:
            one.set_autopilot(True, port)
        steady.enable_constant_velocity(carla.Vector3D(6.0, 0.0, 0.0))
        for _ in range(100):
            world.tick()
            assert steady.get_velocity().length() == pytest.approx(6.0, abs=1e-3)
        assert steady.get_location().distance(begun[steady.id]) == pytest.approx(100 * STEP * 6.0, abs=0.7)
        driven = [one.get_location().distance(begun[one.id]) for one in managed]
        assert sum(distance > 5.0 for distance in driven) >= 6
        steady.disable_constant_velocity()
        for _ in range(40):
            world.tick()
        assert steady.get_velocity().length() < 6.0
        manager.set_synchronous_mode(False)
        manager.shut_down()
        world = client.reload_world(False)
        assert world.get_settings().synchronous_mode
        assert world.get_settings().fixed_delta_seconds == pytest.approx(STEP)
        world.tick()
        assert not world.get_actors().filter("vehicle.*")
    client.reload_world(True)


def test_cameras_on_a_truck_that_turns_stay_where_they_are_mounted(world: Any, spawn: Spawn) -> None:
    import carla

    truck = spawn("vehicle.carlamotors.firetruck")
    world.tick()
    mounts = [
        carla.Transform(carla.Location(x=4.5, z=3.2), carla.Rotation(pitch=-8.0)),
        carla.Transform(carla.Location(x=-4.0, y=1.4, z=2.5), carla.Rotation(yaw=150.0, roll=5.0)),
        carla.Transform(carla.Location(x=-12.0, z=7.0), carla.Rotation(pitch=-20.0)),
    ]
    cameras = [
        Listening(spawn("sensor.camera.instance_segmentation", one, truck, image_size_x=160, image_size_y=120))
        for one in mounts
    ]
    truck.apply_control(carla.VehicleControl(throttle=0.6, steer=0.3))
    headings = set()
    for tick in range(20):
        world.tick()
        carrier = np.array(truck.get_transform().get_matrix())
        headings.add(round(truck.get_transform().rotation.yaw))
        for camera, mount in zip(cameras, mounts, strict=True):
            image = camera.next()
            assert np.array(image.transform.get_matrix()) == pytest.approx(
                carrier @ np.array(mount.get_matrix()), abs=2e-3
            )
            if tick == 19:
                seen = pixels(image).astype(int)
                sees_itself = ((seen[..., 1] + 256 * seen[..., 0]) == truck.id & 0xFFFF).any()
                assert sees_itself == (mount.location.x < -10.0)
    assert len(headings) >= 3
    for camera in cameras:
        camera.sensor.stop()


def test_what_a_lidar_meets_of_cars_that_drive_lies_on_their_boxes(server: Served) -> None:
    import carla

    client, port = server.client(), free_port()
    world = synchronous(client)
    manager = client.get_trafficmanager(port)
    manager.set_synchronous_mode(True)
    library, points = world.get_blueprint_library(), world.get_map().get_spawn_points()
    near = sorted(points, key=lambda one: one.location.distance(points[0].location))[:7]
    models = ("vehicle.tesla.model3", "vehicle.carlamotors.firetruck", "vehicle.bh.crossbike", "vehicle.mini.cooper_s")
    cars = [world.spawn_actor(library.find(models[k % 4]), point) for k, point in enumerate(near)]
    blueprint = library.find("sensor.lidar.ray_cast_semantic")
    for key, value in {"range": 80, "points_per_second": 300_000, "rotation_frequency": 20}.items():
        blueprint.set_attribute(key, str(value))
    lidar = Listening(world.spawn_actor(blueprint, carla.Transform(carla.Location(z=3.5)), attach_to=cars[0]))
    world.tick()
    lidar.next()
    for car in cars:
        car.set_autopilot(True, port)
    met = set()
    for _ in range(30):
        world.tick()
        measured = lidar.next()
        rows = np.frombuffer(
            measured.raw_data, np.dtype([("at", "<f4", 3), ("cos", "<f4"), ("id", "<u4"), ("tag", "<u4")])
        )
        for car in cars[1:]:
            points_of = rows["at"][rows["id"] == car.id].astype(np.float64)
            if len(points_of) == 0:
                continue
            met.add(car.id)
            ones = np.concatenate([points_of, np.ones((len(points_of), 1))], axis=1).T
            there = (
                np.array(car.get_transform().get_inverse_matrix()) @ np.array(measured.transform.get_matrix()) @ ones
            )
            box = car.bounding_box
            middle, half = (np.array([one.x, one.y, one.z]) for one in (box.location, box.extent))
            beyond = np.abs(there[:3].T - middle) - half
            assert beyond.max() < 0.01
            assert np.abs(beyond).min(axis=1).max() < 0.01  # on a face
    assert len(met) >= 3
    lidar.sensor.stop()
    manager.set_synchronous_mode(False)
    manager.shut_down()
    client.reload_world(True)


def test_ackermann_and_pedals_take_turns(world: Any, spawn: Spawn) -> None:
    import carla

    car = spawn("vehicle.tesla.model3")
    world.tick()
    car.apply_ackermann_control(carla.VehicleAckermannControl(speed=6.0, acceleration=3.0))
    for _ in range(80):
        world.tick()
    assert car.get_velocity().length() == pytest.approx(6.0, abs=0.1)
    car.apply_control(carla.VehicleControl(brake=1.0))
    for _ in range(60):
        world.tick()
    assert car.get_velocity().length() == 0.0
    car.apply_ackermann_control(carla.VehicleAckermannControl(speed=3.0, acceleration=2.0))
    for _ in range(60):
        world.tick()
    assert car.get_velocity().length() == pytest.approx(3.0, abs=0.1)


def test_who_is_destroyed_has_a_box_until_the_next_snapshot(world: Any, spawn: Spawn) -> None:
    """Programs go through the actors of the last snapshot and ask each for its box; one may have gone meanwhile."""
    car = spawn("vehicle.tesla.model3")
    world.tick()
    (seen,) = world.get_actors().filter("vehicle.*")
    extent = car.bounding_box.extent
    car.destroy()
    assert seen.bounding_box.extent.x == pytest.approx(extent.x)
    world.tick()
    assert not world.get_actors().filter("vehicle.*")


def test_a_walkers_controller_without_a_mesh_does_no_harm(world: Any, spawn: Spawn) -> None:
    """The crowd lives in the client and needs a navigation mesh, of which there is none; walkers obey nevertheless."""
    import carla

    assert world.get_random_location_from_navigation() is None
    at = world.get_map().get_spawn_points()[0]
    at.location.z += 1.0
    walker = spawn("walker.pedestrian.0002", at)
    controller = spawn("controller.ai.walker", carla.Transform(), walker)
    world.tick()
    begun = walker.get_location()
    controller.start()
    controller.set_max_speed(1.4)
    controller.go_to_location(begun + carla.Location(x=10.0))
    for _ in range(5):
        world.tick()
    controller.stop()
    walker.apply_control(carla.WalkerControl(carla.Vector3D(0.0, 1.0, 0.0), 1.5))
    for _ in range(20):
        world.tick()
    there = walker.get_location()
    assert there.y - begun.y == pytest.approx(20 * STEP * 1.5, abs=0.1)
    assert math.isclose(there.x, begun.x, abs_tol=0.05)
    controller.destroy()
    assert walker.destroy()
