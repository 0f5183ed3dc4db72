"""A server of our own as a process, and CARLA's own client in front of it."""

from __future__ import annotations

import contextlib
import gc
import os
import re
import signal
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

STEP = 0.05
LANDED = 8
"""Ticks after which a vehicle stands on the road that has been spawned 0.5 m above it, where spawn points are."""

PATIENCE = 60.0
"""Time after which an answer that must come is no longer waited for, s: the machine may be slow and busy."""


WORKER = int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw"))
PORTS = iter(range(12000 + 1000 * (WORKER % 20), 13000 + 1000 * (WORKER % 20), 2))
"""Ports of this worker, each of which is given to one test."""


def free_port() -> int:
    """Return a port that nobody listens on, nor on the next one, on which a server sends its pictures.

    Servers and Traffic Managers of other tests start at the same time. Two with the same port would share a
    Traffic Manager, so each worker has ports of its own, below those that the system gives to sockets.
    """
    for port in PORTS:
        with socket.socket() as one, socket.socket() as other:
            try:
                one.bind(("127.0.0.1", port))
                other.bind(("127.0.0.1", port + 1))
            except OSError:  # it is taken
                continue
            return port
    raise RuntimeError("no port is free")


@dataclass
class Served:
    """A server that runs.

    Attributes:
        port: Port of its calls.
        process: The process.
        files: Folder of its recordings.
    """

    port: int
    process: subprocess.Popen[str]
    files: Path

    def client(self) -> Any:
        """Return a new client of it."""
        carla = pytest.importorskip("carla", reason="the CARLA client has no wheel for this Python")
        client = carla.Client("127.0.0.1", self.port)
        client.set_timeout(PATIENCE)
        client.get_world()  # without an episode a batch with a tick ends the client's process
        return client


@contextlib.contextmanager
def served(folder: Path, *arguments: str) -> Iterator[Served]:
    """Run a server until the end of the block; it ends with exit code 0 and without a traceback."""
    command = [sys.executable, "-m", "scenario_compiler", "serve-carla", "--port", "0", "--recordings", str(folder)]
    log = (folder / "stderr.txt").open("w+")
    process = subprocess.Popen([*command, *arguments], stdout=subprocess.PIPE, stderr=log, text=True)
    try:
        assert process.stdout is not None
        line = process.stdout.readline()
        found = re.search(r":(\d+) ", line)
        assert found is not None, (line, Path(log.name).read_text(encoding="utf-8"))
        yield Served(int(found.group(1)), process, folder)
    finally:
        gc.collect()  # clients that nobody holds any more end before their server does
        process.send_signal(signal.SIGINT)
        try:
            code = process.wait(timeout=PATIENCE)
        except subprocess.TimeoutExpired:
            process.kill()
            raise
        log.close()
        if process.stdout is not None:
            process.stdout.close()
    told = Path(log.name).read_text(encoding="utf-8")
    assert code == 0, told
    assert "Traceback" not in told, told[told.find("Traceback") - 200 :][:4000]
    assert "a tick failed" not in told, told[-3000:]
    assert " failed at " not in told, told[-3000:]


@contextlib.contextmanager
def served_map(folder: Path, name: str, content: bytes, version: str) -> Iterator[Served]:
    """Run a server for the clients of a version, with a map of one's own."""
    (folder / f"{name}.xodr").write_bytes(content)
    with served(folder, "--carla-version", version, "--maps", str(folder), "--map", name) as running:
        yield running


def installed_version() -> str:
    """Return the version of the client that is installed, asked in a process of its own: a client has threads."""
    pytest.importorskip("carla", reason="the CARLA client has no wheel for this Python")
    ask = "import carla; print(carla.Client('127.0.0.1', 1).get_client_version())"
    return subprocess.run([sys.executable, "-c", ask], capture_output=True, text=True, check=True).stdout.strip()


@pytest.fixture(scope="session")
def client_version() -> str:
    return installed_version()


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory, client_version: str) -> Iterator[Served]:
    with served(tmp_path_factory.mktemp("carla"), "--carla-version", client_version) as running:
        yield running


@pytest.fixture
def world(server: Served) -> Iterator[Any]:
    """The world in synchronous mode, without anybody; afterwards it is so again."""
    client = server.client()
    world = client.get_world()
    settings = world.get_settings()
    settings.synchronous_mode, settings.fixed_delta_seconds = True, STEP
    world.apply_settings(settings)
    yield world
    world.tick()
    for actor in world.get_actors():
        if actor.type_id.startswith(("vehicle", "walker", "static", "sensor", "controller")):
            if actor.type_id.startswith("sensor"):
                actor.stop()
            actor.destroy()
    settings.synchronous_mode, settings.fixed_delta_seconds = False, None
    world.apply_settings(settings)


@pytest.fixture
def spawn(world: Any) -> Callable[..., Any]:
    """Spawn an actor by its blueprint at a spawn point, or attached to another."""

    def spawned(name: str, at: Any = 0, parent: Any = None, **attributes: object) -> Any:
        blueprint = world.get_blueprint_library().find(name)
        for key, value in attributes.items():
            blueprint.set_attribute(key, str(value))
        where = world.get_map().get_spawn_points()[at] if isinstance(at, int) else at
        return world.spawn_actor(blueprint, where, attach_to=parent)

    return spawned
