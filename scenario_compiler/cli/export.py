"""`export`: a conflict or a plan as OpenSCENARIO, for other programs."""

from __future__ import annotations

import argparse
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
    inputs_of,
    keep_inputs,
    new_sink,
    show,
    text_stream,
)
from scenario_compiler.cli.terminal import put
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.files import is_plan_file
from scenario_compiler.interruption import put_off
from scenario_compiler.outputs import make_folder, write_whole

if TYPE_CHECKING:
    from scenario_compiler.plan.model import Plan
    from scenario_compiler.roads import Network
    from scenario_compiler.vocabulary.scenario import Scenario

VERSIONS = ("1.0", "1.1", "1.2", "1.3")


def add(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "export", help="write a conflict or a plan as an OpenSCENARIO file, with its road file beside it"
    )
    add_target(parser, "FILE[#name]|NAME|PLAN.json")
    parser.add_argument("-o", dest="output", type=Path, required=True, metavar="OUT.xosc", help="file to write")
    parser.add_argument("--version", choices=VERSIONS, default=VERSIONS[-1], help="version of OpenSCENARIO")
    parser.add_argument("--force", action="store_true", help="overwrite existing files")
    add_scenario(parser)
    add_maps(parser)
    add_templates(parser)
    add_diagnostics(parser)
    parser.set_defaults(command=export_command)


def export_command(options: argparse.Namespace) -> int:
    """Write the scenario, its road file and its variations; report what OpenSCENARIO cannot express."""
    sink = new_sink(options)
    found = _planned(options, sink)
    if found is None:
        show(sink, options)
        return AT_FAULT
    from scenario_compiler.openscenario.export.files import export_files

    plan, network, scenario = found
    major, minor = options.version.split(".")
    files = export_files(plan, network, options.output, (int(major), int(minor)), sink, scenario)
    if show(sink, options):
        return AT_FAULT
    changed = [path for path, content in files.items() if path.exists() and path.read_bytes() != content]
    keep_inputs([options.target, *inputs_of(plan)], *changed)
    if changed and not options.force:
        raise WrongUse(f"{changed[0]} exists already and differs; --force overwrites it")
    with put_off():  # all of them, or none
        for path, content in files.items():
            make_folder(path.parent)
            write_whole(path, content)
    for path in files:
        put(path, text_stream(options))
    return FINE


def _planned(options: argparse.Namespace, sink: Diagnostics) -> tuple[Plan, Network, Scenario | None] | None:
    if is_plan_file(options.target):
        from scenario_compiler.cli.run import stored_plan

        stored = stored_plan(options, sink)
        return None if stored is None else (*stored, None)
    compilation = compiled(options, sink)
    return None if compilation is None else (compilation.plan, compilation.network, compilation.scenario)
