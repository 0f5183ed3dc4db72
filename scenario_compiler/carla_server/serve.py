"""The server: opens both ports, runs the clock, and ends on a signal."""

from __future__ import annotations

import asyncio
import signal
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from scenario_compiler.addresses import bracketed
from scenario_compiler.carla_server.call_error import CallError
from scenario_compiler.carla_server.host import Host
from scenario_compiler.carla_server.protocol import Protocol
from scenario_compiler.carla_server.stage import Stage
from scenario_compiler.carla_server.towns import Town, load_town
from scenario_compiler.carla_server.transport import Calls


class CannotServeError(Exception):
    """The server cannot be started: there is no such map, or a port is in use."""


@dataclass(frozen=True)
class Service:
    """The settings of the server.

    Attributes:
        version: Version of CARLA whose protocol is spoken.
        host: Address on which it listens.
        port: Port of the calls; that of the streams is the next one. 0 for any that is free.
        town: Name of the first map.
        folders: Folders in which maps are looked for first.
        files: Folder of recordings.
    """

    version: str
    host: str
    port: int
    town: str
    folders: tuple[Path, ...]
    files: Path


def first_town(name: str, folders: Sequence[Path]) -> Town:
    """Load the first map; raise CannotServeError if that fails."""
    try:
        return load_town(name, folders)
    except CallError as fault:
        raise CannotServeError(str(fault)) from None


async def serve(service: Service, ready: Callable[[str], None], log: Callable[[str], None]) -> None:
    """Serve until SIGINT or SIGTERM.

    Args:
        service: The settings of the server.
        ready: Called with the address and port when connections are accepted and the first camera need not wait.
        log: Called with each line about a faulty client.

    Raises:
        CannotServeError: The map cannot be loaded, or a port is taken.
    """
    town = first_town(service.town, service.folders)
    loop = asyncio.get_running_loop()
    ended = asyncio.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, ended.set)
    host = Host(service.version, service.folders, service.files, 0, log, Stage(town, service.version))
    protocol = Protocol(host)
    connections: set[asyncio.BaseTransport] = set()
    try:
        streams = await loop.create_server(
            host.streams.connection, service.host, service.port + 1 if service.port else 0
        )
        host.port = streams.sockets[0].getsockname()[1]
        calls = await loop.create_server(lambda: Calls(protocol.answer, connections, log), service.host, service.port)
    except OSError as fault:
        raise CannotServeError(f"cannot listen on {bracketed(service.host)}:{service.port}: {fault.strerror}") from None
    await asyncio.to_thread(town.prepare)
    clock = asyncio.ensure_future(host.run_freely())
    clock.add_done_callback(lambda one: ended.set())
    ready(f"{bracketed(service.host)}:{calls.sockets[0].getsockname()[1]}")
    try:
        await ended.wait()
    finally:
        for server in (calls, streams):
            server.close()
        for transport in (*connections, *host.streams.open):
            transport.close()
        host.finish_recording()
        clock.cancel()
    if clock.done() and not clock.cancelled() and clock.exception() is not None:
        raise clock.exception() or CannotServeError("the clock has stopped")
