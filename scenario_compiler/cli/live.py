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
    new_sink,
    refuse_filled,
    show,
    text_stream,
    trust_of,
    whole_number,
)
from scenario_compiler.cli.terminal import flush_streams, put
from scenario_compiler.cli.worlds import add_world, note_failures, note_findings, world_options
from scenario_compiler.garbage_collection import stay_small

if TYPE_CHECKING:
    from scenario_compiler.diagnostics import Diagnostics
    from scenario_compiler.plan.model import Plan
    from scenario_compiler.report.run import Run
    from scenario_compiler.roads import Network
    from scenario_compiler.worlds import WorldFinding

STEP = 0.02
"""Default length of a time step for `drive`, `study` and `run --watch`, s."""


def add(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "drive",
        help="drive a scenario in a browser and take over from the automation (needs the extra 'study')",
        description="Serve a page in which a person takes the driver's place, with keyboard, gamepad, steering wheel "
        "or touch. Every run gets a folder of its own in the folder of -o. Ctrl-C ends the command.",
    )
    add_target(parser)
    parser.add_argument(
        "-o", dest="output", type=Path, metavar="DIR", help="folder for the runs; without it no run is kept"
    )
    parser.add_argument("--force", action="store_true", help="write into a folder that is not empty")
    parser.add_argument(
        "--seed", type=int, default=1, metavar="N", help="seed of the first run; each later run takes the next number"
    )
    add_world(parser)
    add_address(parser)
    add_scenario(parser)
    add_maps(parser)
    add_templates(parser)
    add_diagnostics(parser)
    parser.set_defaults(command=drive_command, driven_by="person")


def add_address(parser: argparse.ArgumentParser) -> None:
    """Add the options for the address of the page."""
    parser.add_argument(
        "--host",
        default="127.0.0.1",
        metavar="ADDRESS",
        help="address to listen on; if other machines can reach it, the page needs the token that is printed",
    )
    parser.add_argument(
        "--port",
        type=whole_number(0, 65535),
        default=8000,
        metavar="N",
        help="port of the page; 0 chooses a free one",
    )


def drive_command(options: argparse.Namespace) -> int:
    """Serve the page until the program is interrupted."""
    from scenario_compiler.controllers.named import refuse_untrusted

    of_world = world_options(options)
    if options.output is not None:
        refuse_filled(options.output, force=options.force)
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
    try:
        serve_plan(compilation.plan, compilation.network, options, of_world, sink)
    finally:  # Ctrl-C ends the command
        show(sink, options)
    return FINE


@contextmanager
def serving() -> Iterator[None]:
    """Turn a missing package of the page server into a WrongUse that names the extra which installs it."""
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
    """Serve the page of a plan until it is closed or interrupted.

    It reports where the world deviates from the plan, and why runs of `drive` broke off.

    Args:
        plan: What is driven.
        network: The plan's map.
        options: Of the command: address, world, seed, folder and trusted code.
        of_world: Options of the world.
        sink: Receives the diagnostics.
        watches: Receives the finished run of `run --watch`, which nobody drives; None lets a person drive any number of
            runs.

    Returns:
        How the last run ended, in words.

    Raises:
        WrongUse: The server's packages are not installed.
    """
    watched = watches is not None
    with serving():
        from scenario_compiler.live.server import serve
    from scenario_compiler.live.session import Drive

    folder = None if watched else options.output
    findings: list[WorldFinding] = []
    found = findings.extend

    def keep(run: Run) -> None:
        note_failures(run.recording, run.plan, options.target, sink)

    drive = Drive(
        plan,
        network,
        options.world,
        options.seed,
        variant=options.variant if watched else 0,
        interpreted=options.interpreted if watched else False,
        trust=trust_of(options),
        folder=folder,
        options=of_world,
        found=found,
    )
    stay_small()
    try:
        return serve(
            drive,
            host=options.host,
            port=options.port,
            watched=watched,
            kept=watches or keep,
            told=lambda address: _print_address(address, options),
        )
    finally:
        note_findings(findings, plan, sink)


def _print_address(address: str, options: argparse.Namespace) -> None:
    put(f"page: {address}", text_stream(options))
    flush_streams()
