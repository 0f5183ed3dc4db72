"""A program for CARLA that runs unchanged against CARLA and against `scenario-compiler serve-carla`.

    scenario-compiler serve-carla &            # or CarlaUE4.sh
    python examples/carla_client.py picture.png

A car accelerates towards a parked one and brakes in time; the front camera's last picture is kept.
"""

import queue
import sys

import carla

STEP = 0.05
GAP = 40.0


def main(picture: str, port: int = 2000) -> None:
    """Drive, and keep the last picture."""
    client = carla.Client("127.0.0.1", port)
    client.set_timeout(20.0)
    world = client.get_world()
    before = world.get_settings()
    settings = world.get_settings()
    settings.synchronous_mode, settings.fixed_delta_seconds = True, STEP
    world.apply_settings(settings)
    actors = []
    try:
        library = world.get_blueprint_library()
        start = world.get_map().get_spawn_points()[0]
        ahead = world.get_map().get_waypoint(start.location).next(GAP)[0].transform
        ahead.location.z += 0.5
        ego = world.spawn_actor(library.find("vehicle.tesla.model3"), start)
        actors.append(ego)
        actors.append(world.spawn_actor(library.find("vehicle.audi.tt"), ahead))
        mounted = carla.Transform(carla.Location(x=0.8, z=1.3))
        camera = world.spawn_actor(library.find("sensor.camera.rgb"), mounted, attach_to=ego)
        actors.append(camera)
        images: queue.Queue[carla.Image] = queue.Queue()
        camera.listen(images.put)
        while True:
            frame = world.tick()
            image = images.get(timeout=10.0)
            assert image.frame == frame
            gap = ego.get_location().distance(actors[1].get_location())
            speed = ego.get_velocity().length()
            braking = gap - 8.0 < speed * speed / 10.0
            ego.apply_control(carla.VehicleControl(throttle=0.0 if braking else 0.6, brake=0.8 if braking else 0.0))
            if braking and speed < 0.05:
                break
        image.save_to_disk(picture)
        print(f"stopped {gap - 4.5:.1f} m behind the parked car")
    finally:
        for actor in reversed(actors):
            actor.destroy()
        world.apply_settings(before)


if __name__ == "__main__":
    main(sys.argv[1], *map(int, sys.argv[2:3]))
