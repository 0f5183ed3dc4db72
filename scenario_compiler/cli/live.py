"""`drive`: a person at the wheel of a scenario, in a browser; and the page of `run --watch`."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from scenario_compiler.cli.options import (
    AT_FAULT,
    FINE,
    Commands,
    WrongUse,
    add_diagnostics,
    add_maps,
    add_scenario,
    add_target,
    add_templates,
    compiled,
    has_errors,
    is_filled,
    new_sink,
    show,
    told,
    trust_of,
)
from scenario_compiler.cli.terminal import flush_streams, put
from scenario_compiler.cli.worlds import add_world, note_findings, world_options

if TYPE_CHECKING:
    from scenario_compiler.diagnostics import Diagnostics
    from scenario_compiler.plan.model import Plan
    from scenario_compiler.report.run import Run
    from scenario_compiler.roads import Network
    from scenario_compiler.worlds import WorldFinding

STEP = 0.02
"""Length of a time step of what is driven or watched, s, unless --dt gives another."""


def add(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "drive",
        help="take over and drive a scenario in a browser (the extra study)",
        description="Open a page in which a person takes the place of the driver: keyboard, gamepad, wheel or touch. "
        "Every run is kept in a folder of its own below -o. Ctrl-C ends the command.",
    )
    add_target(parser)
    parser.add_argument(
        "-o", dest="output", type=Path, metavar="DIR", help="folder for the runs; none are kept without"
    )
    parser.add_argument("--force", action="store_true", help="write into a folder that is not empty")
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="seed of the first run; later ones count on")
    add_world(parser)
    add_address(parser)
    add_scenario(parser)
    add_maps(parser)
    add_templates(parser)
    add_diagnostics(parser)
    parser.set_defaults(command=drive_command, driven_by="person")


def add_address(parser: argparse.ArgumentParser) -> None:
    """Add where the page is served."""
    parser.add_argument(
        "--host",
        default="127.0.0.1",
        metavar="ADDRESS",
        help="address of the page; on another than this machine's own, pages need the token that is printed",
    )
    parser.add_argument("--port", type=int, default=8000, metavar="N", help="port of the page; 0 takes a free one")


def drive_command(options: argparse.Namespace) -> int:
    """Serve the page until the program is interrupted."""
    from scenario_compiler.controllers import refuse_untrusted

    of_world = world_options(options)
    if options.output is not None and not options.force and is_filled(options.output):
        raise WrongUse(f"{options.output} is not empty; --force writes into it all the same")
    options.dt = options.dt or STEP
    sink = new_sink(options)
    compilation = compiled(options, sink)
    if compilation is not None:
        refuse_untrusted(compilation.plan, sink, trust_of(options))
    if compilation is None or has_errors(sink, options):
        show(sink, options)
        return AT_FAULT
    if compilation.plan.controller is None:
        raise WrongUse("nobody can take over: the scenario has no automated vehicle")
    show(sink, options)
    sink = new_sink(options)
    serve_plan(compilation.plan, compilation.network, options, of_world, sink)
    show(sink, options)
    return FINE


@contextmanager
def serving() -> Iterator[None]:
    """Say which extra installs what a server of pages needs and is missing."""
    try:
        yield
    except ModuleNotFoundError as missing:
        if (missing.name or "").partition(".")[0] not in ("starlette", "uvicorn", "websockets", "markdown_it"):
            raise
        raise WrongUse("the page needs starlette and uvicorn: pip install 'scenario-compiler[study]'") from None


def serve_plan(
    plan: Plan,
    network: Network,
    options: argparse.Namespace,
    of_world: dict[str, object],
    sink: Diagnostics,
    watches: Callable[[Run], None] | None = None,
) -> str:
    """Serve a plan's page and return how the last run ended; WrongUse where the server's packages are missing.

    Where `watches` takes the run, nobody drives, and it is the only one. What the world does otherwise is reported.
    """
    watched = watches is not None
    with serving():
        from scenario_compiler.live.server import serve
    from scenario_compiler.live.session import Drive

    folder = None if watched else options.output
    findings: list[WorldFinding] = []
    found = findings.extend
    drive = Drive(plan, network, options.world, options.seed, trust_of(options), folder, options=of_world, found=found)
    ended = serve(
        drive,
        host=options.host,
        port=options.port,
        watched=watched,
        kept=watches,
        told=lambda address: _print_address(address, options),
    )
    note_findings(findings, plan, sink)
    return ended


def _print_address(address: str, options: argparse.Namespace) -> None:
    put(f"page: {address}", told(options))
    flush_streams()
