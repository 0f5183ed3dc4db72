"""`serve-carla`: our world behind CARLA's wire protocol."""

from __future__ import annotations

import argparse
from pathlib import Path

from scenario_compiler.cli.options import FINE, Commands, WrongUse, add_maps, suggestion
from scenario_compiler.cli.terminal import complain, flush_streams, put

PORT = 2000
"""The port that CARLA's clients ask at if they are not told another."""

TOWN = "town_grid"


def add(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser("serve-carla", help="answer CARLA's clients (the extra carla)")
    parser.add_argument(
        "--port", type=int, default=PORT, help="port of the calls; the streams use the next one (default: %(default)s)"
    )
    parser.add_argument("--map", default=TOWN, metavar="NAME", help="the first map (default: %(default)s)")
    parser.add_argument(
        "--host",
        default="127.0.0.1",
        help="address to listen on; the protocol knows no password (default: %(default)s)",
    )
    parser.add_argument(
        "--carla-version",
        choices=("0.9.15", "0.9.16"),
        default="0.9.16",
        help="version of the clients (default: %(default)s)",
    )
    parser.add_argument(
        "--recordings", type=Path, default=Path("carla-recordings"), metavar="DIR", help="folder of recordings"
    )
    add_maps(parser)
    parser.set_defaults(command=serve_command)


def serve_command(options: argparse.Namespace) -> int:
    """Serve until Ctrl-C."""
    import asyncio

    try:
        from scenario_compiler.carla_server.serve import LOOPBACK, CannotServeError, Service, serve
        from scenario_compiler.carla_server.towns import known_towns
    except ModuleNotFoundError as missing:
        if missing.name != "msgpack":
            raise
        raise WrongUse("the server needs msgpack: pip install 'scenario-compiler[carla]'") from None
    if not 0 <= options.port < 65535:
        raise WrongUse(f"--port is {options.port}: the calls and the streams need two ports from 1 to 65535")
    towns = known_towns(options.maps)
    if options.map not in towns and options.map.removesuffix("_Opt") not in towns:
        raise WrongUse(f"there is no map '{options.map}'{suggestion(options.map, towns)}")
    if options.host not in LOOPBACK:
        complain(f"warning: on {options.host} whoever reaches this machine can use the server: it knows no password")
    service = Service(
        options.carla_version, options.host, options.port, options.map, tuple(options.maps), options.recordings
    )

    def ready(place: str) -> None:
        put(f"CARLA {options.carla_version} is served on {place} (map {options.map}); Ctrl-C ends it")
        flush_streams()

    try:
        asyncio.run(serve(service, ready, complain))
    except CannotServeError as fault:
        raise WrongUse(str(fault)) from None
    return FINE
