"""The work of a tick, without a client of CARLA's."""

from __future__ import annotations

import asyncio
from pathlib import Path

from scenario_compiler.carla_server.actors import Sensor
from scenario_compiler.carla_server.host import Host
from scenario_compiler.carla_server.sensors.bearings import Gnss
from scenario_compiler.carla_server.sensors.instrument import Simple
from scenario_compiler.carla_server.spawning import new_actor
from scenario_compiler.carla_server.stage import Stage
from scenario_compiler.carla_server.towns import load_town
from scenario_compiler.carla_server.transport import SIZE
from scenario_compiler.frames import CarlaTransform
from scenario_compiler.vocabulary.weather import Weather

HERE = CarlaTransform(0.0, 0.0, 2.0, 0.0, 0.0, 0.0)


class Broken(Simple):
    """An instrument that fails in each measurement."""

    def measure(self, stage: Stage, sensor: Sensor, frame: int, dt: float, weather: Weather) -> bytes:
        """Fail."""
        raise ValueError("broken")


async def listen(host: Host, port: int, made: type[Broken | Gnss]) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
    """Spawn a sensor with an instrument; return the connection to its stream."""
    sensor = new_actor("0.9.16", [0, "sensor.other.gnss", []], HERE)
    assert isinstance(sensor, Sensor)
    host.stage.add(sensor)
    host.employ(sensor, made(host.stage, sensor))
    host.streams.announce(sensor.stream)
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    writer.write(SIZE.pack(sensor.stream))
    await host.streams.wait_for_announced(60.0)
    return reader, writer


def test_a_sensor_that_fails_stops_only_itself(tmp_path: Path) -> None:
    lines: list[str] = []
    stage = Stage(load_town("open_ground", ()), "0.9.16")

    async def run() -> None:
        host = Host("0.9.16", (), tmp_path, 0, lines.append, stage)
        server = await asyncio.get_running_loop().create_server(host.streams.connection, "127.0.0.1", 0)
        port = server.sockets[0].getsockname()[1]
        _, broken = await listen(host, port, Broken)
        reader, works = await listen(host, port, Gnss)
        for _ in range(2):
            cued = host.cue()
            frame = cued if isinstance(cued, int) else await cued
            (size,) = SIZE.unpack(await reader.readexactly(SIZE.size))
            message = await reader.readexactly(size)
            assert int.from_bytes(message[8:16], "little") == frame
        server.close()
        for writer in (broken, works):
            writer.close()
            await writer.wait_closed()
        while host.streams.open:
            await asyncio.sleep(0)

    asyncio.run(run())
    (line,) = lines
    assert "is stopped: it failed at test_host.py:" in line
    assert line.endswith("ValueError: broken")
