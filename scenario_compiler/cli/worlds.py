"""Options that choose a world: where it is, and who moves and sees in it."""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from typing import TYPE_CHECKING

from scenario_compiler.cli.options import WrongUse, suggestion

if TYPE_CHECKING:
    from scenario_compiler.diagnostics import Diagnostics
    from scenario_compiler.plan.model import Plan
    from scenario_compiler.worlds import WorldFinding

CARLA_OPTIONS = {
    "carla_host": "host",
    "carla_port": "port",
    "ego": "ego",
    "camera": "camera",
    "carla_recording": "recording",
}
"""Options of commands to those of the world."""


def add_world(parser: argparse.ArgumentParser) -> None:
    """Add the choice of a world, and the options of CARLA's."""
    parser.add_argument("--world", default="kinematic", metavar="NAME", help="kinematic (built in) or carla")
    carla = parser.add_argument_group("with --world carla (the extra carla)")
    carla.add_argument("--carla-host", metavar="HOST", help="where the server is (default: 127.0.0.1)")
    carla.add_argument("--carla-port", type=int, metavar="PORT", help="its port (default: 2000)")
    carla.add_argument("--ego", choices=("physics", "kinematic"), help="who moves the ego (default: CARLA's physics)")
    carla.add_argument(
        "--camera",
        choices=("carla", "built-in"),
        help="whose pictures count (default: CARLA's, unless paint is changed)",
    )
    carla.add_argument("--carla-recording", metavar="NAME", help="let the server record the run")


def world_options(options: argparse.Namespace) -> dict[str, object]:
    """Return the options of the world that are given; WrongUse where there is no such world, or it has none such."""
    from scenario_compiler.worlds import WORLDS

    if options.world not in WORLDS:
        raise WrongUse(f"there is no world '{options.world}'{suggestion(options.world, WORLDS)}")
    given = {name: getattr(options, name) for name in CARLA_OPTIONS if getattr(options, name) is not None}
    if given and options.world != "carla":
        names = ", ".join(f"--{name.replace('_', '-')}" for name in given)
        raise WrongUse(f"{names}: only with --world carla")
    return {CARLA_OPTIONS[name]: value for name, value in given.items()}


def note_findings(findings: Iterable[WorldFinding], plan: Plan, sink: Diagnostics) -> None:
    """Report what a world does otherwise than the plan says, each with its line and once."""
    from scenario_compiler.plan.provenance import place_of

    for finding in dict.fromkeys(findings):
        sink.add(finding.code, finding.message, place_of(plan, finding.part))
