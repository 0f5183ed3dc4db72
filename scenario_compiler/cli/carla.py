"""`serve-carla`: the built-in world served by CARLA's network protocol."""

from __future__ import annotations

import argparse
from pathlib import Path

from scenario_compiler.addresses import LOOPBACK
from scenario_compiler.cli.options import FINE, Commands, WrongUse, add_maps, whole_number
from scenario_compiler.cli.terminal import complain, flush_streams, put
from scenario_compiler.diagnostics import suggestion
from scenario_compiler.garbage_collection import stay_small

PORT = 2000
"""CARLA's default port."""

TOWN = "town_grid"

VERSIONS = ("0.9.15", "0.9.16")
"""Versions of CARLA whose clients are served; the last is the default."""


def add(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser("serve-carla", help="run a server for CARLA clients (needs the extra 'carla')")
    parser.add_argument(
        "--port", type=whole_number(0, 65534), default=PORT, help="port for calls; sensor streams use the next port"
    )
    parser.add_argument("--map", default=TOWN, metavar="NAME", help="map that is loaded at the start")
    parser.add_argument(
        "--host",
        default="127.0.0.1",
        help="address to listen on; the protocol has no password",
    )
    parser.add_argument(
        "--carla-version",
        choices=VERSIONS,
        default=VERSIONS[-1],
        help="CARLA version of the clients",
    )
    parser.add_argument(
        "--recordings",
        type=Path,
        default=Path("carla-recordings"),
        metavar="DIR",
        help="folder for the recordings that clients start",
    )
    add_maps(parser)
    parser.set_defaults(command=serve_command)


def serve_command(options: argparse.Namespace) -> int:
    """Serve clients until Ctrl-C."""
    import asyncio

    try:
        from scenario_compiler.carla_server.serve import CannotServeError, Service, serve
        from scenario_compiler.carla_server.towns import known_towns
    except ModuleNotFoundError as missing:
        if missing.name != "msgpack":
            raise
        raise WrongUse("the server needs msgpack: pip install 'scenario-compiler[carla]'") from None
    towns = known_towns(options.maps)
    if options.map not in towns and options.map.removesuffix("_Opt") not in towns:
        raise WrongUse(f"there is no map '{options.map}'{suggestion(options.map, towns)}")
    if options.host not in LOOPBACK:
        complain(f"warning: anyone who can reach {options.host} can use this server, which has no password")
    service = Service(
        options.carla_version, options.host, options.port, options.map, tuple(options.maps), options.recordings
    )

    def ready(place: str) -> None:
        put(f"CARLA {options.carla_version} is served on {place} (map {options.map}); press Ctrl-C to end it")
        flush_streams()

    stay_small()
    try:
        asyncio.run(serve(service, ready, complain))
    except CannotServeError as fault:
        raise WrongUse(str(fault)) from None
    return FINE
