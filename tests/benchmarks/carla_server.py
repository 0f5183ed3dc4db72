"""Measures `serve-carla` with CARLA's own client: ticks per second, and CPU time of server and client per tick.

    python -m tests.benchmarks.carla_server

Client and server share the machine, so ticks a second say something on two idle cores only; the CPU time a tick, which
is 1.5 to 2 times as long on a machine that is busy, says it anywhere.
"""

from __future__ import annotations

import os
import queue
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import carla

from tests.carla_server.conftest import STEP, Served, served

TICKS_PER_SECOND = os.sysconf("SC_CLK_TCK")


def spent(process: int) -> float:
    """Return the CPU time of a process, s."""
    fields = Path(f"/proc/{process}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICKS_PER_SECOND


def resident(process: int) -> int:
    """Return how much memory a process has, bytes."""
    return int(Path(f"/proc/{process}/statm").read_text(encoding="ascii").split()[1]) * os.sysconf("SC_PAGE_SIZE")


def measure(name: str, server: Served, count: int, tick: Callable[[], object]) -> None:
    """Print what some ticks cost."""
    for _ in range(20):
        tick()
    begin, own = time.perf_counter(), time.process_time()
    cpu, memory = spent(server.process.pid), resident(server.process.pid)
    for _ in range(count):
        tick()
    took, used = time.perf_counter() - begin, spent(server.process.pid) - cpu
    own = time.process_time() - own
    grown = (resident(server.process.pid) - memory) / 2**20
    print(
        f"{name:<46} {count / took:7.0f} ticks/s  server {1e3 * used / count:6.3f} ms, "
        f"client {1e3 * own / count:6.3f} ms a tick  memory {grown:+.1f} MiB"
    )


def spawn_driving(client: Any, world: Any, count: int) -> list[int]:
    """Spawn vehicles that drive in circles; return their ids."""
    blueprint, points = world.get_blueprint_library().find("vehicle.tesla.model3"), world.get_map().get_spawn_points()
    control = carla.VehicleControl(throttle=0.3, steer=0.4)
    command = carla.command
    orders = [
        command.SpawnActor(blueprint, point).then(command.ApplyVehicleControl(command.FutureActor, control))
        for point in points[:count]
    ]
    return [one.actor_id for one in client.apply_batch_sync(orders, True)]


def main() -> None:
    """Measure."""
    with tempfile.TemporaryDirectory() as folder, served(Path(folder)) as server:
        client = server.client()
        world = client.get_world()
        settings = world.get_settings()
        settings.synchronous_mode, settings.fixed_delta_seconds = True, STEP
        world.apply_settings(settings)
        measure("nobody", server, 5_000, world.tick)
        measure("nobody, for long", server, 100_000, world.tick)
        ids = spawn_driving(client, world, 10)
        mounted = carla.Transform(carla.Location(x=-30.0, z=6.0), carla.Rotation(pitch=-8.0))
        cameras: list[Any] = []
        images: queue.Queue[Any] = queue.Queue()

        def tick_and_look() -> None:
            world.tick()
            for _ in cameras:
                images.get(timeout=10.0)

        for kind in ("rgb", "depth", "semantic_segmentation", "instance_segmentation"):
            blueprint = world.get_blueprint_library().find(f"sensor.camera.{kind}")
            cameras.append(world.spawn_actor(blueprint, mounted, attach_to=world.get_actor(ids[0])))
            cameras[-1].listen(images.put)
            measure(f"10 driving vehicles, {len(cameras)} cameras of 800 x 600", server, 100, tick_and_look)
        for camera in cameras:
            camera.stop()
            camera.destroy()
        client.apply_batch_sync([carla.command.DestroyActor(one) for one in ids], True)
        spawn_driving(client, world, 50)
        measure("50 driving vehicles", server, 3_000, world.tick)
        settings.synchronous_mode = False
        world.apply_settings(settings)


if __name__ == "__main__":
    main()
