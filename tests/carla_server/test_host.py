"""The work of a tick, without a client of CARLA's."""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TypeVar

from scenario_compiler.carla_server.actors import Sensor
from scenario_compiler.carla_server.host import SNAPSHOTS, Host
from scenario_compiler.carla_server.sensors.bearings import Gnss
from scenario_compiler.carla_server.sensors.instrument import Simple
from scenario_compiler.carla_server.snapshot import EPISODE, HEADER, MAP_CHANGED
from scenario_compiler.carla_server.spawning import new_actor
from scenario_compiler.carla_server.stage import Stage
from scenario_compiler.carla_server.towns import load_town
from scenario_compiler.carla_server.transport import SIZE
from scenario_compiler.frames import CarlaTransform
from scenario_compiler.vocabulary.weather import Weather

HERE = CarlaTransform(0.0, 0.0, 2.0, 0.0, 0.0, 0.0)


Result = TypeVar("Result")


def finished(work: Coroutine[None, None, Result]) -> Result:
    """Return the result of a coroutine; it runs in a thread because tests in a browser leave a loop in this one."""
    with ThreadPoolExecutor(1) as thread:
        return thread.submit(asyncio.run, work).result()


class Broken(Simple):
    """An instrument that fails in each measurement."""

    def measure(self, stage: Stage, sensor: Sensor, frame: int, dt: float, weather: Weather) -> bytes:
        """Fail."""
        raise ValueError("broken")


async def opened(host: Host) -> tuple[asyncio.Server, int]:
    """Return a server of a host's streams and its port."""
    server = await asyncio.get_running_loop().create_server(host.streams.connection, "127.0.0.1", 0)
    return server, server.sockets[0].getsockname()[1]


async def joined(host: Host, port: int, stream: int) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
    """Return a connection to a stream."""
    host.streams.announce(stream)
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    writer.write(SIZE.pack(stream))
    await host.streams.wait_for_announced(60.0)
    return reader, writer


async def message(reader: asyncio.StreamReader) -> bytes:
    """Return the next message of a stream."""
    (size,) = SIZE.unpack(await reader.readexactly(SIZE.size))
    return await reader.readexactly(size)


async def closed(host: Host, server: asyncio.Server, *writers: asyncio.StreamWriter) -> None:
    """Close a server and the connections to it."""
    server.close()
    for writer in writers:
        writer.close()
        await writer.wait_closed()
    while host.streams.open:
        await asyncio.sleep(0)


async def listen(host: Host, port: int, made: type[Broken | Gnss]) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
    """Spawn a sensor with an instrument; return the connection to its stream."""
    sensor = new_actor("0.9.16", [0, "sensor.other.gnss", []], HERE)
    assert isinstance(sensor, Sensor)
    host.stage.add(sensor)
    host.employ(sensor, made(host.stage, sensor))
    return await joined(host, port, sensor.stream)


def test_a_sensor_that_fails_stops_only_itself(tmp_path: Path) -> None:
    lines: list[str] = []
    stage = Stage(load_town("open_ground", ()), "0.9.16")

    async def run() -> None:
        host = Host("0.9.16", (), tmp_path, 0, lines.append, stage)
        server, port = await opened(host)
        _, broken = await listen(host, port, Broken)
        reader, works = await listen(host, port, Gnss)
        for _ in range(2):
            cued = host.cue()
            frame = cued if isinstance(cued, int) else await cued
            assert HEADER.unpack_from(await message(reader))[1] == frame
        await closed(host, server, broken, works)

    finished(run())
    (line,) = lines
    assert "is stopped: it failed at test_host.py:" in line
    assert line.endswith("ValueError: broken")


def test_the_first_snapshot_of_an_episode_says_that_the_map_has_changed(tmp_path: Path) -> None:
    """A client of 0.9.15 that asked for the map before a later snapshot got the old one."""
    town = load_town("open_ground", ())

    async def run() -> list[tuple[int, int]]:
        host = Host("0.9.15", (), tmp_path, 0, lambda line: None, Stage(town, "0.9.15"))
        server, port = await opened(host)
        reader, writer = await joined(host, port, SNAPSHOTS)
        host.change_town(town, reset=False)
        host.tick()
        told = [EPISODE.unpack_from(await message(reader), HEADER.size) for _ in range(2)]
        await closed(host, server, writer)
        return [(episode, bits) for episode, *_, bits in told]

    assert finished(run()) == [(2, MAP_CHANGED), (2, 0)]
