"""Several clients at once, one that is slow, and one that dies in the middle of a tick."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.carla_server.conftest import Served, free_port
from tests.live.serving import waited_for

pytestmark = [pytest.mark.slow, pytest.mark.apart]
"""Run by `make test-carla`."""

Spawn = Callable[..., Any]

ASKING = """
import carla, sys
client = carla.Client("127.0.0.1", int(sys.argv[1]))
client.set_timeout(60.0)
world = client.get_world()
for _ in range(int(sys.argv[2])):
    snapshot = world.wait_for_tick(60.0)
print(snapshot.frame, len(world.get_actors().filter("vehicle.*")))
"""

DYING = """
import carla, os, signal, sys
client = carla.Client("127.0.0.1", int(sys.argv[1]))
client.set_timeout(60.0)
world = client.get_world()
world.wait_for_tick(60.0)
vehicle = world.get_actors().filter("vehicle.*")[0]
camera = world.get_blueprint_library().find("sensor.camera.rgb")
sensor = world.spawn_actor(camera, carla.Transform(), attach_to=vehicle)
sensor.listen(lambda image: os.kill(os.getpid(), signal.SIGKILL))
print("ready", flush=True)
signal.pause()
"""

SLOW = """
import carla, sys, time
client = carla.Client("127.0.0.1", int(sys.argv[1]))
client.set_timeout(60.0)
world = client.get_world()
world.wait_for_tick(60.0)
vehicle = world.get_actors().filter("vehicle.*")[0]
camera = world.get_blueprint_library().find("sensor.camera.rgb")
sensor = world.spawn_actor(camera, carla.Transform(), attach_to=vehicle)
sensor.listen(lambda image: time.sleep(0.5))
print("ready", flush=True)
time.sleep(60)
"""

LOADING = """
import carla, sys
client = carla.Client("127.0.0.1", int(sys.argv[1]))
client.set_timeout(60.0)
synchronous, port = sys.argv[2] == "synchronous", int(sys.argv[3])
manager = client.get_trafficmanager(port)
for name in ("highway_loop", "town_grid", "town_grid"):
    world = client.load_world(name)
    settings = world.get_settings()
    settings.synchronous_mode, settings.fixed_delta_seconds = synchronous, 0.05
    world.apply_settings(settings)
    manager.set_synchronous_mode(synchronous)
    tick = world.tick if synchronous else world.wait_for_tick
    blueprint, points = world.get_blueprint_library().find("vehicle.audi.tt"), world.get_map().get_spawn_points()
    cars = [world.spawn_actor(blueprint, point) for point in points[:4]]
    tick()
    for car in cars:
        car.set_autopilot(True, port)
        manager.update_vehicle_lights(car, True)
    for _ in range(60):
        tick()
    while max(car.get_velocity().length() for car in cars) < 1.0:
        tick()
    lights = [int(car.get_light_state()) for car in cars]
    print(name, max(lights) < 1 << 11, flush=True)
settings.synchronous_mode, settings.fixed_delta_seconds = False, None
world.apply_settings(settings)
manager.shut_down()
"""

DESTROYING = """
import carla, sys
client = carla.Client("127.0.0.1", int(sys.argv[1]))
client.set_timeout(60.0)
world, port = client.get_world(), int(sys.argv[2])
blueprint, points = world.get_blueprint_library().find("vehicle.audi.tt"), world.get_map().get_spawn_points()
manager = client.get_trafficmanager(port)
for _ in range(6):
    cars = [world.spawn_actor(blueprint, point) for point in points[:10]]
    for car in cars:
        car.set_autopilot(True, port)
    for _ in range(10):
        world.wait_for_tick()
    for car in cars:
        car.destroy()
settings = world.get_settings()
car = world.spawn_actor(blueprint, points[0])
car.destroy()
settings.synchronous_mode = True
world.apply_settings(settings)
settings = world.get_settings()
settings.synchronous_mode = False
world.apply_settings(settings)
print("done", flush=True)
manager.shut_down()
"""


def program(text: str, *arguments: object) -> subprocess.Popen[str]:
    command = [sys.executable, "-c", text, *map(str, arguments)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)


def tick_until_ready(world: Any, client: subprocess.Popen[str]) -> None:
    """Tick until a client says that it is ready."""
    assert client.stdout is not None
    said: list[str] = []
    listening = threading.Thread(target=lambda: said.append(client.stdout.readline() if client.stdout else ""))
    listening.start()
    while listening.is_alive():
        world.tick()
        time.sleep(0.02)
    client.stdout.close()
    assert said == ["ready\n"]


def test_five_clients_see_the_same_world(server: Served, world: Any, spawn: Spawn) -> None:
    for k in range(3):
        spawn("vehicle.audi.tt", k)
    clients = [program(ASKING, server.port, 20) for _ in range(4)]
    waited_for(lambda: world.tick() > 0 and all(one.poll() is not None for one in clients))
    told = [one.communicate()[0].split() for one in clients]
    assert [one.returncode for one in clients] == [0] * 4
    assert [one[1] for one in told] == ["3"] * 4


def test_a_client_that_dies_in_a_tick_takes_nobody_along(server: Served, world: Any, spawn: Spawn) -> None:
    spawn("vehicle.audi.tt")
    world.tick()
    dying = program(DYING, server.port)
    tick_until_ready(world, dying)
    waited_for(lambda: world.tick() > 0 and dying.poll() is not None)
    assert dying.returncode == -signal.SIGKILL
    frames = [world.tick() for _ in range(20)]
    assert frames[-1] - frames[0] == 19


def test_a_slow_consumer_does_not_stop_the_others(server: Served, world: Any, spawn: Spawn) -> None:
    spawn("vehicle.audi.tt")
    world.tick()
    slow = program(SLOW, server.port)
    tick_until_ready(world, slow)
    memory = resident(server.process.pid)
    for _ in range(60):
        world.tick()
    assert resident(server.process.pid) - memory < 300 << 20
    slow.kill()
    slow.wait()
    world.tick()


def resident(process: int) -> int:
    """Return how much memory a process has, bytes."""
    pages = Path(f"/proc/{process}/statm").read_text(encoding="ascii").split()[1]
    return int(pages) * os.sysconf("SC_PAGE_SIZE")


@pytest.mark.parametrize("mode", ["synchronous", "asynchronous"])
def test_maps_can_be_loaded_beside_a_traffic_manager(server: Served, mode: str) -> None:
    """The client's own process used to end: its Traffic Manager met an episode that was not there yet."""
    ended = subprocess.run(
        [sys.executable, "-c", LOADING, str(server.port), mode, str(free_port())],
        capture_output=True,
        text=True,
        timeout=240,
    )
    assert ended.returncode == 0, ended.stderr
    assert ended.stdout.split("\n")[:-1] == ["highway_loop True", "town_grid True", "town_grid True"]


def test_vehicles_can_be_destroyed_while_a_traffic_manager_drives_them(server: Served) -> None:
    """The client's own process used to end: its Traffic Manager was in the middle of a step with a vehicle."""
    command = [sys.executable, "-c", DESTROYING, str(server.port), str(free_port())]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=240)
    assert (ended.returncode, ended.stdout) == (0, "done\n"), ended.stderr
