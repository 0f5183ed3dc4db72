"""Calls about the session: version, settings, maps, weather, files, ticks."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable
from typing import Any

from scenario_compiler.carla_server.actors import on_wire
from scenario_compiler.carla_server.blueprints import definitions
from scenario_compiler.carla_server.call_error import CallError
from scenario_compiler.carla_server.host import SNAPSHOTS, Host, Settings, sky_of
from scenario_compiler.carla_server.towns import GENERATED, drivable_towns, generate_town, town_name

FOLDER = "/Game/Carla/Maps/"
LONGEST_MAP = 32 << 20
"""Folder of CARLA's maps, as its server names it; and the greatest size of a client's own map, bytes."""


def version(host: Host) -> str:
    """Answer with the version that is served."""
    return host.version


def episode_info(host: Host) -> list[Any]:
    """Answer with the episode's number and the token of the snapshots."""
    return [host.episode, [host.token(SNAPSHOTS)]]


def sensor_token(host: Host, stream: int) -> list[Any]:
    """Answer with the token of a stream; its listener will connect next."""
    if not host.knows(stream):
        raise CallError(f"unable to find the stream {stream}")
    host.streams.announce(stream)
    return [host.token(stream)]


def settings(host: Host) -> list[Any] | Awaitable[list[Any]]:
    """Answer with the settings; if Traffic Managers are held, as soon as they may go on."""
    host.note_question()
    return host.settings.on_wire() if host.gate is None else _settings_later(host, host.gate)


async def _settings_later(host: Host, gate: asyncio.Event) -> list[Any]:
    await gate.wait()
    return host.settings.on_wire()


def set_settings(host: Host, wire: list[Any]) -> int:
    """Apply settings; answer with the frame."""
    return host.change_settings(Settings.of(wire))


def tick(host: Host) -> int | Awaitable[int]:
    """Do a tick; answer with its frame."""
    return host.cue()


def available_maps(host: Host) -> list[str]:
    """Answer with the maps that can be driven on, as CARLA writes them."""
    return [FOLDER + name for name in drivable_towns(host.folders)]


def map_info(host: Host) -> list[Any]:
    """Answer with the map's name and spawn points."""
    town = host.stage.town
    return [f"Carla/Maps/{town.name}", [on_wire(point) for point in town.spawn_points]]


def map_data(host: Host) -> str:
    """Answer with the map's OpenDRIVE."""
    return host.stage.town.text


async def load_episode(host: Host, name: str, reset: bool, layers: int) -> None:
    """Load a map, or the present one again."""
    del layers
    if town_name(name) == GENERATED and host.generated:
        town = await asyncio.to_thread(generate_town, host.generated)
    else:
        town = await host.load(name)
    host.change_town_when_joined(town, reset=reset)


def copy_opendrive(host: Host, text: str, parameters: list[Any]) -> None:
    """Keep a client's own map until it asks for it."""
    del parameters
    if len(text) > LONGEST_MAP:
        raise CallError(f"the OpenDRIVE text is longer than {LONGEST_MAP} bytes")
    host.generated = text


def required_files(host: Host, folder: str) -> list[str]:
    """Answer with an empty list: a map needs no files beside its OpenDRIVE, since there is no navigation mesh."""
    del host, folder
    return []


def request_file(host: Host, name: str) -> bytes:
    """Refuse the call: the server serves no files."""
    del host
    raise CallError(f"the file '{name}' is not served")


def navigation_mesh(host: Host) -> bytes:
    """Answer with no bytes: no navigation mesh is made."""
    del host
    return b""


def actor_definitions(host: Host) -> list[Any]:
    """Answer with the blueprint library."""
    return definitions(host.version)


def weather(host: Host) -> list[float]:
    """Answer with the weather."""
    return list(host.weather)


def set_weather(host: Host, numbers: list[float]) -> None:
    """Set the weather."""
    host.weather, host.sky = tuple(numbers), sky_of(numbers)


def gravity(host: Host) -> float:
    """Answer with the gravity that inertial units measure, m/s2."""
    return host.stage.gravity


def set_gravity(host: Host, value: float) -> None:
    """Set the gravity that inertial units measure, m/s2."""
    host.stage.gravity = value


def manager_runs(host: Host, port: int) -> bool:
    """Answer whether a Traffic Manager has registered under a port."""
    return port in host.managers


def manager(host: Host, port: int) -> list[Any]:
    """Answer with the address of a Traffic Manager; with port 0 if there is none."""
    return host.managers.get(port, ["", 0])


def add_manager(host: Host, address: list[Any]) -> bool:
    """Register a Traffic Manager; answer whether its port was free."""
    if address[1] in host.managers or len(host.managers) >= 256:
        return False
    host.managers[address[1]] = address
    return True


def remove_manager(host: Host, port: int) -> bool:
    """Forget a Traffic Manager."""
    return host.managers.pop(port, None) is not None


def draw_shape(host: Host, shape: list[Any]) -> None:
    """Show a debug shape to colour cameras for its life time."""
    host.stage.shapes.add(shape, host.stage.time)


def clear_shapes(host: Host) -> None:
    """Forget the debug shapes."""
    host.stage.shapes.clear()
