"""CARLA's own client spawns, drives and moves actors."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable
from typing import Any

import pytest

from tests.carla_server.conftest import LANDED, STEP, Served
from tests.live.serving import waited_for

pytestmark = [pytest.mark.slow, pytest.mark.apart]
"""Run by `make test-carla`."""

Spawn = Callable[..., Any]


def ticks(world: Any, count: int) -> None:
    for _ in range(count):
        world.tick()


def test_the_library_has_carlas_vehicles_with_their_attributes(world: Any) -> None:
    library = world.get_blueprint_library()
    assert len(library.filter("vehicle.*")) == 41
    assert len(library.filter("walker.pedestrian.*")) >= 51
    model = library.find("vehicle.tesla.model3")
    assert model.get_attribute("base_type").as_str() == "car"
    assert model.get_attribute("number_of_wheels").as_int() == 4
    assert model.get_attribute("color").recommended_values
    assert not model.get_attribute("generation").is_modifiable
    for blueprint in library:
        assert all(attribute.recommended_values for attribute in blueprint)


def test_a_vehicle_stands_where_it_was_spawned(world: Any, spawn: Spawn) -> None:
    car = spawn("vehicle.tesla.model3", role_name="hero", color="10,20,30")
    ticks(world, LANDED)
    there, wanted = car.get_transform(), world.get_map().get_spawn_points()[0]
    assert there.location.distance(wanted.location) < 0.6
    assert there.location.z == pytest.approx(0.0, abs=1e-3)
    assert there.rotation.yaw == pytest.approx(wanted.rotation.yaw, abs=1e-3)
    assert (car.attributes["role_name"], car.attributes["color"]) == ("hero", "10,20,30")
    assert car.bounding_box.extent.x == pytest.approx(4.792 / 2)
    assert world.get_actor(car.id).type_id == "vehicle.tesla.model3"


def fallen(count: int) -> float:
    """Return how far a body falls in a number of ticks, m."""
    return 0.5 * 9.81 * (count * STEP) ** 2


def test_a_vehicle_falls_onto_the_road_from_where_it_was_spawned_or_put(world: Any, spawn: Spawn) -> None:
    """Programs such as MACAD-Gym take a vehicle whose height is 0 after the first tick for one that is not there."""
    import carla

    car, point = spawn("vehicle.tesla.model3"), world.get_map().get_spawn_points()[0]
    sensor = world.spawn_actor(
        world.get_blueprint_library().find("sensor.other.gnss"), carla.Transform(carla.Location(z=1.0)), attach_to=car
    )

    def falls_from(height: float) -> None:
        speed = 0.0
        for count in range(1, 40):
            world.tick()
            here = max(height - fallen(count), 0.0)
            assert car.get_location().z == pytest.approx(here, abs=2e-3)
            assert sensor.get_location().z == pytest.approx(here + 1.0, abs=2e-3)
            speed = min(speed, car.get_velocity().z)
        assert speed == pytest.approx(-math.sqrt(2.0 * 9.81 * height), rel=0.2)
        assert car.get_velocity().length() < 1e-3

    falls_from(point.location.z)
    point.location.z = 6.0
    car.set_transform(point)
    falls_from(6.0)
    sensor.destroy()


def test_a_blocked_place_is_refused(world: Any, spawn: Spawn) -> None:
    spawn("vehicle.tesla.model3")
    blueprint = world.get_blueprint_library().find("vehicle.audi.tt")
    point = world.get_map().get_spawn_points()[0]
    assert world.try_spawn_actor(blueprint, point) is None
    with pytest.raises(RuntimeError, match="collision at spawn position"):
        world.spawn_actor(blueprint, point)


def test_throttle_steer_and_brake_have_carlas_signs(world: Any, spawn: Spawn) -> None:
    import carla

    car = spawn("vehicle.audi.tt")
    world.tick()
    begin = car.get_transform()
    car.apply_control(carla.VehicleControl(throttle=0.6, steer=0.1))
    ticks(world, 40)
    now = car.get_transform()
    away = now.location - begin.location
    right, ahead = begin.get_right_vector(), begin.get_forward_vector()
    assert away.x * ahead.x + away.y * ahead.y > 2.0
    assert away.x * right.x + away.y * right.y > 0.1  # positive steers to the right
    assert (now.rotation.yaw - begin.rotation.yaw + 180.0) % 360.0 - 180.0 > 0.5
    assert car.get_angular_velocity().z > 0.0
    speed = car.get_velocity().length()
    assert speed == pytest.approx(0.6 * 3.5 * 2.0, rel=0.05)
    assert car.get_control().throttle == pytest.approx(0.6)
    car.apply_control(carla.VehicleControl(brake=1.0))
    ticks(world, 40)
    assert car.get_velocity().length() == pytest.approx(0.0, abs=1e-3)


def test_the_hand_brake_stops_and_reverse_goes_back(world: Any, spawn: Spawn) -> None:
    import carla

    car = spawn("vehicle.audi.tt")
    car.apply_control(carla.VehicleControl(throttle=0.5, reverse=True))
    ticks(world, 20)
    velocity, ahead = car.get_velocity(), car.get_transform().get_forward_vector()
    assert velocity.x * ahead.x + velocity.y * ahead.y < -1.0
    assert car.get_control().gear == -1
    car.apply_control(carla.VehicleControl(throttle=0.5, hand_brake=True))
    ticks(world, 20)
    assert car.get_velocity().length() < 0.01
    assert car.get_control().gear == 1
    car.apply_control(carla.VehicleControl(manual_gear_shift=True, gear=3))
    world.tick()
    assert car.get_control().gear == 3


def test_a_control_that_does_not_stick_is_forgotten(world: Any, spawn: Spawn) -> None:
    import carla

    car = spawn("vehicle.audi.tt", sticky_control="false")
    ticks(world, LANDED)
    car.apply_control(carla.VehicleControl(throttle=1.0))
    world.tick()
    world.tick()
    assert car.get_control().throttle == 0.0
    assert car.get_velocity().length() == pytest.approx(3.5 * STEP, rel=0.05)


def test_velocities_and_impulses(world: Any, spawn: Spawn) -> None:
    import carla

    car = spawn("vehicle.audi.tt")
    ticks(world, LANDED)
    ahead = car.get_transform().get_forward_vector()
    car.set_target_velocity(carla.Vector3D(ahead.x * 7.0, ahead.y * 7.0, 0.0))
    ticks(world, 2)
    assert car.get_velocity().length() == pytest.approx(7.0, abs=0.02)
    car.add_impulse(carla.Vector3D(ahead.x * 2000.0, ahead.y * 2000.0, 0.0))
    ticks(world, 2)
    assert car.get_velocity().length() == pytest.approx(7.0 + 2000.0 / car.get_physics_control().mass, abs=0.04)
    car.enable_constant_velocity(carla.Vector3D(3.0, 0.0, 0.0))
    ticks(world, 5)
    assert car.get_velocity().length() == pytest.approx(3.0, abs=0.01)
    car.disable_constant_velocity()
    car.apply_control(carla.VehicleControl(brake=1.0))
    ticks(world, 20)
    assert car.get_velocity().length() < 0.01


def rolled(world: Any, spawn: Spawn, seconds: float, drag: float, friction: float, *, weighs: bool = True) -> float:
    """Return the speed, m/s, that a car at 20 m/s still has when it has rolled on for a while."""
    import carla

    car = spawn("vehicle.audi.tt")
    world.tick()
    control = car.get_physics_control()
    control.drag_coefficient = drag
    wheels = control.wheels
    for wheel in wheels:
        wheel.tire_friction = friction
    control.wheels = wheels
    car.apply_physics_control(control)
    car.set_enable_gravity(weighs)
    ahead = car.get_transform().get_forward_vector()
    car.set_target_velocity(carla.Vector3D(ahead.x * 20.0, ahead.y * 20.0, 0.0))
    ticks(world, round(seconds / STEP))
    speed: float = car.get_velocity().length()
    car.destroy()
    world.tick()
    return speed


def test_wheels_and_air_slow_a_rolling_car_down(world: Any, spawn: Spawn) -> None:
    car = spawn("vehicle.audi.tt")
    control, box = car.get_physics_control(), car.bounding_box.extent
    world.tick()  # 0.9.15 takes an actor for dead that it has not seen in a snapshot
    car.destroy()
    world.tick()
    damped = sum(wheel.damping_rate / (0.01 * wheel.radius) ** 2 for wheel in control.wheels) / control.mass
    dragged = 0.5 * 1.25 * 0.3 * 4.0 * box.y * box.z / control.mass
    wheels = 20.0 * math.exp(-2.0 * damped)
    air = 20.0 / (1.0 + 2.0 * 20.0 * dragged)
    assert rolled(world, spawn, 2.0, drag=0.0, friction=3.5) == pytest.approx(wheels, abs=0.02)
    assert rolled(world, spawn, 2.0, drag=0.3, friction=0.0) == pytest.approx(air, abs=0.02)
    assert rolled(world, spawn, 2.0, drag=0.3, friction=3.5, weighs=False) == pytest.approx(air, abs=0.02)
    assert rolled(world, spawn, 2.0, drag=0.0, friction=0.0) == pytest.approx(20.0, abs=1e-4)


def test_ackermann_control_reaches_speed_and_angle(world: Any, spawn: Spawn) -> None:
    import carla

    car = spawn("vehicle.audi.tt")
    car.apply_ackermann_control(carla.VehicleAckermannControl(steer=0.05, speed=5.0, acceleration=3.0))
    ticks(world, 80)
    assert car.get_velocity().length() == pytest.approx(5.0, abs=0.1)
    assert car.get_angular_velocity().z == pytest.approx(math.degrees(5.0 * math.tan(0.05) / 2.653), rel=0.05)


def test_physics_control_is_read_and_applied(world: Any, spawn: Spawn) -> None:
    import carla

    car = spawn("vehicle.audi.tt")
    world.tick()
    physics = car.get_physics_control()
    assert max(wheel.max_steer_angle for wheel in physics.wheels) == 70.0
    assert len(physics.wheels) == 4
    physics.mass = 2000.0
    wheels = physics.wheels
    for wheel in wheels:
        wheel.max_steer_angle = min(wheel.max_steer_angle, 35.0)
    physics.wheels = wheels
    car.apply_physics_control(physics)
    assert car.get_physics_control().mass == 2000.0
    car.apply_control(carla.VehicleControl(steer=1.0))
    ticks(world, 20)
    assert car.get_wheel_steer_angle(carla.VehicleWheelLocation.FL_Wheel) == pytest.approx(35.0, abs=0.5)
    physics.wheels = wheels[:2]
    car.apply_physics_control(physics)
    assert len(car.get_physics_control().wheels) == 4
    before = car.get_physics_control().wheels[0].position
    at = car.get_transform()
    car.set_transform(carla.Transform(at.location + carla.Location(y=3.0), at.rotation))
    world.tick()
    assert car.get_physics_control().wheels[0].position.y == pytest.approx(before.y + 300.0, abs=1.0)


def test_a_transform_moves_it_and_physics_can_be_switched_off(world: Any, spawn: Spawn) -> None:
    import carla

    car = spawn("vehicle.audi.tt")
    car.set_simulate_physics(False)
    point = world.get_map().get_spawn_points()[5]
    raised = carla.Transform(point.location + carla.Location(z=2.0), point.rotation)
    car.set_transform(raised)
    ticks(world, 3)
    assert car.get_location().distance(raised.location) < 1e-3
    assert car.get_velocity().length() < 1e-3
    car.set_simulate_physics(True)
    ticks(world, 2)
    assert car.get_location().z == pytest.approx(2.0 + point.location.z - fallen(2), abs=0.01)
    ticks(world, 14)
    assert car.get_location().z == pytest.approx(0.0, abs=0.01)


def test_a_car_falls_to_the_ground_beside_the_roads_too(world: Any, spawn: Spawn) -> None:
    import carla

    car = spawn("vehicle.audi.tt")
    ticks(world, LANDED)
    car.set_transform(carla.Transform(carla.Location(x=3000.0, y=3000.0, z=4.0), carla.Rotation(yaw=20.0)))
    ticks(world, 6)
    assert car.get_location().z == pytest.approx(4.0 - fallen(6), abs=0.01)
    ticks(world, 20)
    assert car.get_location().z == pytest.approx(0.0, abs=0.01)


def test_in_neutral_the_engine_drives_nothing(world: Any, spawn: Spawn) -> None:
    import carla

    car = spawn("vehicle.audi.tt")
    ticks(world, LANDED)
    for gear, moves in ((0, False), (1, True)):
        car.apply_control(carla.VehicleControl(throttle=1.0, manual_gear_shift=True, gear=gear))
        ticks(world, 20)
        assert (car.get_velocity().length() > 1.0) is moves
        assert car.get_control().gear == gear


def test_an_ackermann_controller_sets_the_control(world: Any, spawn: Spawn) -> None:
    import carla

    car = spawn("vehicle.audi.tt")
    ticks(world, LANDED)
    for speed in (6.0, -3.0):
        car.apply_ackermann_control(carla.VehicleAckermannControl(steer=0.2, speed=speed))
        ticks(world, 10)
        control = car.get_control()
        assert control.throttle > 0.0 or control.brake > 0.0
        assert control.reverse is (speed < 0.0)
        assert control.steer == pytest.approx(0.2 / math.radians(70.0), abs=1e-3)


@pytest.mark.parametrize("name", ["static.prop.streetbarrier", "static.prop.container"])
def test_a_prop_stands_in_the_way(world: Any, spawn: Spawn, name: str) -> None:
    """As in CARLA, where no physics moves it: a car that drives against it with full throttle does not get through."""
    import carla

    car = spawn("vehicle.audi.tt")
    ticks(world, LANDED)
    at = car.get_transform()
    ahead = at.get_forward_vector()
    place = carla.Location(at.location.x + ahead.x * 15.0, at.location.y + ahead.y * 15.0, at.location.z)
    prop = spawn(name, carla.Transform(place, carla.Rotation(yaw=at.rotation.yaw + 90.0)))
    ticks(world, 2)
    stood = prop.get_location()
    car.apply_control(carla.VehicleControl(throttle=1.0))
    ticks(world, 200)
    gap = car.get_location().distance(stood) - car.bounding_box.extent.x - prop.bounding_box.extent.y
    assert -0.3 < gap < 1.0
    assert prop.get_location().distance(stood) < 1e-4


def test_a_prop_on_a_car_goes_along_and_is_no_obstacle_to_it(world: Any, spawn: Spawn) -> None:
    import carla
    import numpy as np

    car = spawn("vehicle.audi.tt")
    ticks(world, LANDED)
    mounted = carla.Transform(carla.Location(x=-0.4, y=0.2, z=1.0), carla.Rotation(yaw=90.0))
    box = spawn("static.prop.travelcase", mounted, car)
    camera = spawn("sensor.camera.rgb", carla.Transform(carla.Location(z=2.0)), box)
    assert box.parent.id == car.id
    for _ in range(40):
        car.apply_control(carla.VehicleControl(throttle=0.6, steer=0.2))
        world.tick()
    assert car.get_velocity().length() > 3.0
    carrier = np.array(car.get_transform().get_matrix())
    there = carrier @ np.array(mounted.get_matrix())
    assert np.array(box.get_transform().get_matrix()) == pytest.approx(there, abs=1e-3)
    seen = there @ [0.0, 0.0, 2.0, 1.0]
    at = camera.get_location()
    assert (at.x, at.y, at.z) == pytest.approx(seen[:3].tolist(), abs=1e-3)
    assert box.get_velocity().length() == pytest.approx(car.get_velocity().length(), rel=0.1)
    camera.destroy()


def test_a_colour_that_is_none_does_not_hide_the_actors(server: Served, world: Any, spawn: Spawn) -> None:
    blueprint = world.get_blueprint_library().find("vehicle.audi.tt")
    with pytest.raises(ValueError, match="color"):
        blueprint.set_attribute("color", "red")
    with contextlib.suppress(ValueError, RuntimeError):  # whether the client still sends it depends on its version
        world.spawn_actor(blueprint, world.get_map().get_spawn_points()[4])
    client = server.client()
    seen = client.get_world()
    car = spawn("vehicle.audi.tt", 5)
    waited_for(lambda: world.tick() > 0 and len(seen.get_actors()) > 0)  # until it has joined the stream of snapshots
    assert car.id in {actor.id for actor in seen.get_actors()}


def test_cars_that_meet_collide_and_lose_speed(world: Any, spawn: Spawn) -> None:
    import carla

    rear = spawn("vehicle.audi.tt")
    world.tick()
    at = rear.get_transform()
    ahead = at.get_forward_vector()
    before = carla.Transform(at.location + carla.Location(ahead.x * 12.0, ahead.y * 12.0, 0.2), at.rotation)
    front = spawn("vehicle.tesla.model3", before)
    sensor = spawn("sensor.other.collision", carla.Transform(), rear)
    met: list[Any] = []
    sensor.listen(met.append)
    rear.set_target_velocity(carla.Vector3D(ahead.x * 10.0, ahead.y * 10.0, 0.0))
    for _ in range(60):
        frame = world.tick()
    for _ in range(200):
        if met:
            break
        world.tick()
    assert met
    first = met[0]
    assert first.frame <= frame + 200
    assert (first.actor.id, first.other_actor.id) == (rear.id, front.id)
    pushed = first.normal_impulse
    assert pushed.x * ahead.x + pushed.y * ahead.y < -1000.0
    sensor.stop()
    sensor.destroy()
    assert front.get_velocity().length() > 1.0
    assert rear.get_velocity().length() < 7.0


def test_a_walker_walks_where_it_is_commanded(world: Any, spawn: Spawn) -> None:
    import carla

    point = world.get_map().get_spawn_points()[3]
    walker = spawn("walker.pedestrian.0005", point)
    world.tick()
    begin = walker.get_location()
    assert begin.z == pytest.approx(0.93, abs=0.01)  # a walker's origin is its middle
    walker.apply_control(carla.WalkerControl(direction=carla.Vector3D(0.0, 1.0, 0.0), speed=1.5))
    ticks(world, 40)
    moved = walker.get_location() - begin
    assert (moved.x, moved.y) == pytest.approx((0.0, 3.0), abs=0.1)
    assert walker.get_transform().rotation.yaw == pytest.approx(90.0, abs=0.1)
    assert walker.get_control().speed == pytest.approx(1.5)
    assert walker.get_velocity().length() == pytest.approx(1.5, abs=0.01)


def test_a_walker_walks_by_the_length_of_its_direction_and_jumps(world: Any, spawn: Spawn) -> None:
    """As CARLA's `AWalkerController`: the direction times the speed is its movement, and it jumps with 5 m/s."""
    import carla

    walker = spawn("walker.pedestrian.0005", world.get_map().get_spawn_points()[3])
    world.tick()
    for x, y, z, speed, yaw, walks in (
        (0.0, 0.5, 0.0, 2.0, 90.0, 1.0),
        (0.0, 0.0, 0.0, 2.0, 90.0, 0.0),
        (0.6, 0.0, 0.8, 2.0, 0.0, 1.2),
        (3.0, 0.0, 0.0, 0.5, 0.0, 1.5),
        (0.0, 1.0, 0.0, -1.0, -90.0, 1.0),
        (0.0, 1.0, 0.0, 0.0, -90.0, 0.0),
    ):
        walker.apply_control(carla.WalkerControl(carla.Vector3D(x, y, z), speed))
        ticks(world, 20)
        assert walker.get_velocity().length() == pytest.approx(walks, abs=0.01)
        assert walker.get_transform().rotation.yaw == pytest.approx(yaw, abs=0.1)
    ground = walker.get_location().z
    walker.apply_control(carla.WalkerControl(jump=True))
    heights = []
    for _ in range(30):
        world.tick()
        heights.append(walker.get_location().z - ground)
        walker.apply_control(carla.WalkerControl())
    assert max(heights) == pytest.approx(5.0**2 / (2.0 * 9.81), abs=0.02)
    assert heights[-1] == pytest.approx(0.0, abs=1e-3)
    assert sum(height > 0.0 for height in heights) == pytest.approx(2.0 * 5.0 / 9.81 / STEP, abs=1.0)


def test_a_walker_that_was_hit_comes_to_rest_and_one_that_was_stopped_walks_on(world: Any, spawn: Spawn) -> None:
    import carla

    walker = spawn("walker.pedestrian.0005", world.get_map().get_spawn_points()[3])
    world.tick()
    walker.set_target_velocity(walker.get_transform().get_forward_vector() * 6.0)
    world.tick()
    assert walker.get_velocity().length() > 4.0
    ticks(world, 60)
    assert walker.get_velocity().length() == 0.0
    at = walker.get_location()
    wall = spawn("static.prop.container", carla.Transform(carla.Location(at.x, at.y + 2.0, 0.0)))
    walker.apply_control(carla.WalkerControl(direction=carla.Vector3D(0.0, 1.0, 0.0), speed=1.5))
    ticks(world, 100)
    assert walker.get_location().y - at.y < 2.0
    wall.destroy()
    ticks(world, 30)
    assert walker.get_velocity().length() == pytest.approx(1.5, abs=0.01)


def test_batches_answer_each_command_by_itself(server: Served, world: Any, spawn: Spawn) -> None:
    import carla

    client, car = server.client(), spawn("vehicle.audi.tt", 20)
    blueprint = world.get_blueprint_library().find("vehicle.tesla.model3")
    points = world.get_map().get_spawn_points()
    control = carla.VehicleControl(throttle=1.0)
    spawning = [
        carla.command.SpawnActor(blueprint, points[k]).then(
            carla.command.ApplyVehicleControl(carla.command.FutureActor, control)
        )
        for k in (1, 1, 2)
    ]
    found = client.apply_batch_sync(spawning, True)
    assert [bool(one.error) for one in found] == [False, True, False]
    assert "collision" in found[1].error
    first = world.get_actor(found[0].actor_id)
    ticks(world, 5)
    assert first.get_velocity().length() > 0.5
    there = points[7]
    command = carla.command
    orders = [
        command.ApplyTransform(car, there),
        command.ApplyTargetVelocity(car, carla.Vector3D(1.0, 0.0, 0.0)),
        command.SetSimulatePhysics(car, True),
        command.SetVehicleLightState(car, carla.VehicleLightState.Position),  # all the client sends is 0 or 1
        command.ApplyImpulse(car, carla.Vector3D(0.0, 0.0, 0.0)),
        command.ApplyForce(car, carla.Vector3D(0.0, 0.0, 0.0)),
        command.ApplyAngularImpulse(car, carla.Vector3D()),
        command.ApplyTorque(car, carla.Vector3D()),
        command.SetEnableGravity(car, True),
        command.ApplyTargetAngularVelocity(car, carla.Vector3D()),
        command.ApplyVehicleAckermannControl(car, carla.VehicleAckermannControl()),
        command.ApplyVehiclePhysicsControl(car, car.get_physics_control()),
        command.DestroyActor(found[0].actor_id),
        command.DestroyActor(999_999),
    ]
    answers = client.apply_batch_sync(orders, True)
    assert [one.error for one in answers[:-1]] == [""] * (len(orders) - 1)
    assert "not found" in answers[-1].error
    world.tick()  # a batch does not wait for the snapshot of its tick
    assert car.get_location().distance(there.location) < 1.0
    assert car.get_light_state() == carla.VehicleLightState.Position
    assert not world.get_snapshot().has_actor(found[0].actor_id)


def test_commands_after_a_spawning_are_for_what_was_spawned(server: Served, world: Any, spawn: Spawn) -> None:
    """As in CARLA: also one that names somebody else; but its id is not put into the place of a parent."""
    import carla

    client, bystander = server.client(), spawn("vehicle.audi.tt", 20)
    library = world.get_blueprint_library()
    command = carla.command
    point = world.get_map().get_spawn_points()[1]
    car, camera = library.find("vehicle.tesla.model3"), library.find("sensor.camera.rgb")
    brake = carla.VehicleControl(brake=0.7)
    spawning = command.SpawnActor(car, point)
    spawning = spawning.then(command.ApplyVehicleControl(bystander, brake))
    spawning = spawning.then(command.SpawnActor(camera, carla.Transform(), command.FutureActor))
    (found,) = client.apply_batch_sync([spawning], True)
    assert not found.error
    assert world.get_actor(found.actor_id).get_control().brake == pytest.approx(0.7)
    assert bystander.get_control().brake == 0.0
    assert not list(world.get_actors().filter("sensor.camera.rgb"))


def test_calls_about_the_dead_do_no_harm(server: Served, world: Any, spawn: Spawn) -> None:
    import carla

    car = spawn("vehicle.audi.tt")
    again = server.client().get_world().get_actor(car.id)
    assert car.destroy()
    again.apply_control(carla.VehicleControl(throttle=1.0))
    again.set_simulate_physics(False)
    world.tick()
    assert not world.get_snapshot().has_actor(car.id)


def test_what_is_attached_goes_along(world: Any, spawn: Spawn) -> None:
    import carla

    car = spawn("vehicle.audi.tt")
    mounted = carla.Transform(carla.Location(1.0, 0.5, 2.0), carla.Rotation(pitch=-10.0, yaw=30.0))
    sensor = spawn("sensor.other.imu", mounted, car)
    car.apply_control(carla.VehicleControl(throttle=0.5, steer=0.2))
    ticks(world, 30)
    expected = car.get_transform().transform(mounted.location)
    assert sensor.get_location().distance(expected) < 0.01
    assert sensor.parent.id == car.id
    turned = sensor.get_transform().rotation.yaw - car.get_transform().rotation.yaw
    assert (turned + 180.0) % 360.0 - 180.0 == pytest.approx(30.0, abs=0.01)


def test_lights_and_doors_are_kept(world: Any, spawn: Spawn) -> None:
    import carla

    car = spawn("vehicle.dodge.charger_2020")
    state = carla.VehicleLightState(carla.VehicleLightState.LowBeam | carla.VehicleLightState.Brake)
    car.set_light_state(state)
    assert car.get_light_state() == state
    dark = spawn("vehicle.audi.tt", 1)
    assert world.get_vehicles_light_states() == {car.id: state, dark.id: carla.VehicleLightState.NONE}
    car.set_light_state(carla.VehicleLightState(0xFFFFFF41))
    assert int(car.get_light_state()) == 0x741  # a Traffic Manager sets bits that name no light
    car.open_door(carla.VehicleDoor.FL)
    car.close_door(carla.VehicleDoor.All)


def test_the_levels_boxes_are_those_of_what_stands_there(world: Any, spawn: Spawn) -> None:
    import carla

    car, walker = spawn("vehicle.audi.tt", 3), spawn("walker.pedestrian.0002", 8)
    world.tick()
    (box,) = world.get_level_bbs(carla.CityObjectLabel.Car)
    middle = car.get_transform().transform(car.bounding_box.location)
    assert box.location.distance(middle) < 1e-3
    assert box.extent.x == pytest.approx(car.bounding_box.extent.x)
    assert box.rotation.yaw == pytest.approx(car.get_transform().rotation.yaw, abs=1e-3)
    (box,) = world.get_level_bbs(carla.CityObjectLabel.Pedestrians)
    assert box.location.distance(walker.get_location()) < 1e-3
    assert world.get_level_bbs(carla.CityObjectLabel.Buildings) == []
    assert len(world.get_level_bbs()) == 2


def test_a_vehicle_in_the_air_stays_there_without_physics(world: Any, spawn: Spawn) -> None:
    """The co-simulation with SUMO spawns vehicles so, and moves them itself."""
    below, point = spawn("vehicle.audi.tt", 3), world.get_map().get_spawn_points()[3]
    ticks(world, LANDED)
    point.location.z += 25.0
    above = spawn("vehicle.tesla.model3", point)
    above.set_simulate_physics(False)
    world.tick()
    assert above.get_location().distance(point.location) < 1e-3
    above.set_transform(world.get_map().get_spawn_points()[5])
    world.tick()
    point.location.z -= 25.0
    with pytest.raises(RuntimeError, match="collision"):
        spawn("vehicle.tesla.model3", point)
    assert below.get_location().z == pytest.approx(0.0, abs=0.05)


def test_a_ray_meets_all_that_it_passes_through(world: Any, spawn: Spawn) -> None:
    import carla

    car = spawn("vehicle.audi.tt", 3)
    ticks(world, LANDED)
    at = car.get_location()
    above, below = carla.Location(at.x, at.y, at.z + 10.0), carla.Location(at.x, at.y, at.z - 10.0)
    roof, road = world.cast_ray(above, below)
    assert (roof.label, road.label) == (carla.CityObjectLabel.Car, carla.CityObjectLabel.Roads)
    assert roof.location.z == pytest.approx(at.z + 2.0 * car.bounding_box.extent.z, abs=0.01)
    assert road.location.z == pytest.approx(at.z, abs=0.01)
    assert world.cast_ray(above, carla.Location(at.x, at.y, at.z + 5.0)) == []
    assert world.ground_projection(above, 20.0).location.z == pytest.approx(roof.location.z, abs=1e-3)


def test_wheels_can_be_turned_where_physics_does_not_move_the_vehicle(world: Any, spawn: Spawn) -> None:
    import carla

    car, wheel = spawn("vehicle.audi.tt"), carla.VehicleWheelLocation.FL_Wheel
    car.set_wheel_steer_direction(wheel, 20.0)
    assert car.get_wheel_steer_angle(wheel) == 0.0
    car.set_simulate_physics(False)
    car.set_wheel_steer_direction(wheel, 20.0)
    world.tick()
    assert car.get_wheel_steer_angle(wheel) == 20.0
    assert car.get_wheel_steer_angle(carla.VehicleWheelLocation.FR_Wheel) == 0.0
    car.set_simulate_physics(True)
    assert car.get_wheel_steer_angle(wheel) == 0.0


@pytest.mark.parametrize("name", ["sensor.other.rss"])
def test_what_cannot_be_sensed_is_refused_by_name(spawn: Spawn, name: str) -> None:
    import carla

    with pytest.raises(RuntimeError, match=f"{name} is not served"):
        spawn(name, carla.Transform())


def test_tires_without_friction_neither_drive_nor_brake(world: Any, spawn: Spawn) -> None:
    import carla

    car = spawn("vehicle.audi.tt")
    world.tick()
    physics = car.get_physics_control()
    wheels = physics.wheels
    for wheel in wheels:
        wheel.tire_friction = 0.0
    physics.wheels, physics.drag_coefficient = wheels, 0.0
    car.apply_physics_control(physics)
    ahead = car.get_transform().get_forward_vector()
    car.set_target_velocity(carla.Vector3D(ahead.x * 20.0, ahead.y * 20.0, 0.0))
    car.apply_control(carla.VehicleControl(brake=1.0))
    ticks(world, 20)
    assert car.get_velocity().length() == pytest.approx(20.0, abs=1e-3)


def test_a_friction_trigger_gives_its_friction_to_whom_it_holds(world: Any, spawn: Spawn) -> None:
    import carla

    car = spawn("vehicle.audi.tt")
    world.tick()
    here = carla.Transform(car.get_location())
    trigger = spawn("static.trigger.friction", here, friction=5.0, extent_x=300, extent_y=300, extent_z=300)
    assert car.get_physics_control().wheels[0].tire_friction == 5.0
    trigger.destroy()
    assert car.get_physics_control().wheels[0].tire_friction == pytest.approx(3.5)


def test_sticky_control_is_read_as_clients_write_it(world: Any, spawn: Spawn) -> None:
    import carla

    car = spawn("vehicle.audi.tt", sticky_control="False")
    ticks(world, LANDED)
    car.apply_control(carla.VehicleControl(throttle=1.0))
    ticks(world, 3)
    assert car.get_velocity().length() == pytest.approx(3.5 * STEP, rel=0.05)


def test_who_is_gone_before_the_first_tick_leaves_nothing(server: Served, world: Any, spawn: Spawn) -> None:
    import carla

    for _ in range(3):
        gone = carla.command.DestroyActor(spawn("vehicle.audi.tt").id)
        assert server.client().apply_batch_sync([gone], False)[0].error == ""
    car = spawn("vehicle.tesla.model3")
    world.tick()
    assert world.get_snapshot().has_actor(car.id)


def test_a_prop_of_a_mesh_that_the_server_does_not_have_is_an_actor_without_a_box(world: Any, spawn: Spawn) -> None:
    """As in CARLA where the path names no mesh: Bench2Drive and its like spawn parked cars so."""
    path = "/Game/Carla/Static/Car/4Wheeled/ParkedVehicles/TeslaM3/TeslaM3_parked.TeslaM3_parked"
    prop = spawn("static.prop.mesh", 0, mesh_path=path, scale="1.5")
    car = spawn("vehicle.audi.tt")
    world.tick()
    assert prop.attributes["mesh_path"] == path
    assert prop.bounding_box.extent.x == 0.0
    assert prop.get_location().distance(world.get_map().get_spawn_points()[0].location) < 1e-3
    assert car.get_location().distance(prop.get_location()) < 1.0
