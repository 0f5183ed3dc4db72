"""Options that choose a world, and the reports on its deviations from the plan and on why a run broke off.

The options of CARLA are its address, what moves the ego, and whose pictures are used.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from typing import TYPE_CHECKING

from scenario_compiler.cli.options import WrongUse, whole_number
from scenario_compiler.diagnostics import suggestion

if TYPE_CHECKING:
    from scenario_compiler.diagnostics import Diagnostics
    from scenario_compiler.plan.model import Plan
    from scenario_compiler.recording.recording import Recording
    from scenario_compiler.worlds import WorldFinding

BUILT_IN = "kinematic"
"""The world that needs no other program."""

CARLA_OPTIONS = {
    "carla_host": "host",
    "carla_port": "port",
    "ego": "ego",
    "camera": "camera",
    "carla_recording": "recording",
}
"""Option of the world for each option of the command."""


def add_world(parser: argparse.ArgumentParser) -> None:
    """Add the choice of a world, and the options of the CARLA world."""
    from scenario_compiler.worlds import WORLDS

    others = " or ".join(sorted(set(WORLDS) - {BUILT_IN}))
    parser.add_argument(
        "--world", default=BUILT_IN, metavar="NAME", help=f"world of the run: {BUILT_IN} (built in) or {others}"
    )
    carla = parser.add_argument_group("with --world carla (needs the extra 'carla')")
    carla.add_argument("--carla-host", metavar="HOST", help="address of the CARLA server (default: 127.0.0.1)")
    carla.add_argument(
        "--carla-port",
        type=whole_number(1, 65535),
        metavar="PORT",
        help="port of the CARLA server (default: 2000)",
    )
    carla.add_argument(
        "--ego",
        choices=("physics", "kinematic"),
        help="what moves the ego: CARLA's physics or the kinematic model (default: physics)",
    )
    carla.add_argument(
        "--camera",
        choices=("carla", "built-in"),
        help="camera whose pictures are used (default: carla, unless the scenario changes road marks)",
    )
    carla.add_argument("--carla-recording", metavar="NAME", help="let the CARLA server record the run under this name")


def world_options(options: argparse.Namespace) -> dict[str, object]:
    """Return the given options of the world; raise WrongUse for an unknown world, or options that it does not have."""
    from scenario_compiler.worlds import WORLDS

    if options.world not in WORLDS:
        raise WrongUse(f"there is no world '{options.world}'{suggestion(options.world, WORLDS)}")
    given = {name: getattr(options, name) for name in CARLA_OPTIONS if getattr(options, name) is not None}
    if given and options.world != "carla":
        names = ", ".join(f"--{name.replace('_', '-')}" for name in given)
        raise WrongUse(f"{names}: only with --world carla")
    return {CARLA_OPTIONS[name]: value for name, value in given.items()}


def note_findings(findings: Iterable[WorldFinding], plan: Plan, sink: Diagnostics) -> None:
    """Report where a world deviates from the plan, each finding once and with its line in the scenario."""
    from scenario_compiler.plan.provenance import place_of

    for finding in dict.fromkeys(findings):
        sink.add(finding.code, finding.message, place_of(plan, finding.part))


def note_failures(recording: Recording, plan: Plan, target: str, sink: Diagnostics) -> None:
    """Report why a run of FILE#name broke off: one diagnostic for each event that ended it, at its entity if any."""
    from scenario_compiler.diagnostics import FilePlace, code_named
    from scenario_compiler.files import split_target
    from scenario_compiler.plan.provenance import place_of

    for event in recording.events:
        code = code_named(event.cause) if event.kind == "broken_off" else None
        if code is not None:
            place = place_of(plan, f"entities/{event.entity}")
            sink.add(code, event.message, place if place.line else FilePlace(split_target(target)[0]))
