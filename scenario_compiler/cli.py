"""The command line, and the only module that prints.

Exit codes: 0 fine (warnings too), 1 the input is at fault, 2 wrong use, 3 criteria failed under --strict.
"""

from __future__ import annotations

import argparse
import importlib
import sys
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn, TypeAlias

from scenario_compiler.diagnostic_formats import FORMATS, formatted
from scenario_compiler.diagnostics import CODES, Code, Diagnostic, Diagnostics, FilePlace, Severity, did_you_mean

if TYPE_CHECKING:
    from scenario_compiler.compiler import Compilation
    from scenario_compiler.document import Document
    from scenario_compiler.plan.model import Plan
    from scenario_compiler.recording.recording import Recording
    from scenario_compiler.report.run import Run
    from scenario_compiler.roads import Network
    from scenario_compiler.worlds import World

CODE_HOMES = ("compiler",)
"""Modules whose import brings in all others that declare diagnostic codes."""

BAD_RECORDING = Code(
    "SC131",
    "unreadable-recording",
    "The file is not a recording of this version: it is not Parquet, or lacks a column or its header. Run the plan "
    "again.",
)

FINE, AT_FAULT, WRONG_USE, CRITERIA_FAILED = 0, 1, 2, 3


class WrongUse(Exception):
    """The command was used in a way that cannot work; the message says which."""


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Run the command line and exit."""
    parser = make_parser()
    options = parser.parse_args(arguments)
    try:
        code = options.command(options)
    except WrongUse as fault:
        print(f"scenario-compiler: {fault}", file=sys.stderr)
        code = WRONG_USE
    except BrokenPipeError:
        sys.stderr.close()
        code = FINE
    sys.exit(code)


def make_parser() -> argparse.ArgumentParser:
    """Return the parser of all commands."""
    parser = argparse.ArgumentParser(
        prog="scenario-compiler", description="Compile, check and run conflicts for automated driving."
    )
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    _add_validate(commands)
    _add_compile(commands)
    _add_run(commands)
    _add_report(commands)
    _add_map(commands)
    _add_explain(commands)
    prewarm = commands.add_parser("prewarm", help="compile the engine into the cache")
    prewarm.set_defaults(command=prewarm_command)
    return parser


_Commands: TypeAlias = "argparse._SubParsersAction[argparse.ArgumentParser]"


def _add_validate(commands: _Commands) -> None:
    parser = commands.add_parser("validate", help="check scenario and road files")
    parser.add_argument("paths", nargs="+", type=Path, metavar="PATH", help="file or folder")
    _add_maps(parser)
    _add_diagnostics(parser)
    parser.add_argument("--strict", action="store_true", help="warnings are errors")
    parser.set_defaults(command=validate_command)


def _add_compile(commands: _Commands) -> None:
    parser = commands.add_parser("compile", help="compile a scenario to a plan")
    parser.add_argument("target", metavar="FILE[#name]")
    parser.add_argument("-o", dest="output", type=Path, required=True, metavar="PLAN.json")
    _add_scenario(parser)
    _add_maps(parser)
    _add_diagnostics(parser)
    parser.set_defaults(command=compile_command)


def _add_run(commands: _Commands) -> None:
    parser = commands.add_parser("run", help="run a scenario or a plan")
    parser.add_argument("target", metavar="FILE[#name]|PLAN.json")
    parser.add_argument("-o", dest="output", type=Path, metavar="DIR", help="folder of the run")
    parser.add_argument("--force", action="store_true", help="write into a folder that is not empty")
    parser.add_argument("--seed", type=int, default=1, metavar="N")
    parser.add_argument("--world", default="kinematic", metavar="NAME")
    parser.add_argument("--trajectory", type=Path, metavar="FILE.csv", help="write all trajectories")
    parser.add_argument("--strict", action="store_true", help="exit with 3 when a criterion fails")
    _add_scenario(parser)
    _add_maps(parser)
    _add_diagnostics(parser)
    parser.set_defaults(command=run_command)


def _add_report(commands: _Commands) -> None:
    parser = commands.add_parser("report", help="write the report of a run folder again")
    parser.add_argument("folder", type=Path, metavar="DIR")
    _add_maps(parser)
    _add_diagnostics(parser)
    parser.set_defaults(command=report_command)


def _add_map(commands: _Commands) -> None:
    actions = commands.add_parser("map", help="look into road files").add_subparsers(required=True, metavar="ACTION")
    info = actions.add_parser("info", help="sum a map up")
    info.set_defaults(command=map_info_command)
    check = actions.add_parser("check", help="find what is wrong in a road file")
    check.add_argument("--xsd", type=Path, metavar="DIR", help="folder with ASAM's schemas")
    check.set_defaults(command=map_check_command)
    plot = actions.add_parser("plot", help="draw a map")
    plot.add_argument("-o", dest="output", type=Path, required=True, metavar="FILE.png|FILE.svg")
    plot.set_defaults(command=map_plot_command)
    export = actions.add_parser("export", help="write a map for another program")
    form = export.add_mutually_exclusive_group(required=True)
    form.add_argument("--for", choices=("carla",), dest="client", help="OpenDRIVE that the CARLA clients load")
    form.add_argument("--mesh", action="store_true", help="surfaces and marks as .gltf, .glb or .obj")
    export.add_argument("-o", dest="output", type=Path, required=True, metavar="FILE")
    export.set_defaults(command=map_export_command)
    for parser in (info, check, plot, export):
        parser.add_argument("file", metavar="FILE", help="OpenDRIVE file, or the name of a map on the search path")
        _add_maps(parser)
        _add_diagnostics(parser)


def _add_explain(commands: _Commands) -> None:
    parser = commands.add_parser("explain", help="explain a diagnostic's code")
    parser.add_argument("code", metavar="CODE")
    parser.set_defaults(command=explain_command)


def _add_scenario(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE", help="give a parameter a value", dest="settings"
    )
    parser.add_argument("--perception", choices=("camera", "ideal"), help="what the lane confidence comes from")
    parser.add_argument("--controller", metavar="NAME|package.module:Class", help="what drives the ego vehicle")
    parser.add_argument("--dt", type=_positive, metavar="S", help="length of a time step")
    parser.add_argument("--duration", type=_positive, metavar="S", help="when the run ends at the latest")


def _add_maps(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--maps", action="append", type=Path, default=[], metavar="DIR", help="look for maps here first"
    )


def _add_diagnostics(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--format", choices=FORMATS, default="text", help="format of the diagnostics")
    parser.add_argument("--error", action="append", default=[], metavar="CODE|all", help="make it an error")
    parser.add_argument("--allow", action="append", default=[], metavar="CODE", help="do not report it")


def _positive(text: str) -> float:
    value = float(text)
    if not 0.0 < value < 1.0e6:
        raise argparse.ArgumentTypeError(f"{text} is not a time in seconds")
    return value


def judged(found: Iterable[Diagnostic], options: argparse.Namespace) -> list[Diagnostic]:
    """Return the findings as --error, --allow and --strict want them weighed."""
    kept = []
    for diagnostic in found:
        if diagnostic.code.id in options.allow and diagnostic.severity is not Severity.ERROR:
            continue
        lifted = diagnostic.severity is Severity.WARNING and (
            "all" in options.error or (options.command is validate_command and options.strict)
        )
        if lifted or diagnostic.code.id in options.error:
            diagnostic = replace(diagnostic, severity=Severity.ERROR)
        kept.append(diagnostic)
    return kept


def show(found: Iterable[Diagnostic], options: argparse.Namespace) -> bool:
    """Print diagnostics, text on stderr and everything else on stdout; return whether one is an error."""
    weighed = judged(found, options)
    text = formatted(weighed, options.format)
    if text:
        print(text, file=sys.stderr if options.format == "text" else sys.stdout)
    return any(d.severity is Severity.ERROR for d in weighed)


def validate_command(options: argparse.Namespace) -> int:
    """Check files, or all files of folders."""
    from scenario_compiler.compiler import files_below, validate_file

    sink = Diagnostics()
    files = [file for path in options.paths for file in files_below(path)]
    if not files:
        raise WrongUse("there is no .xml, .xosc or .xodr file to check")
    for file in files:
        validate_file(file, sink, options.maps)
    failed = show(sink, options)
    if options.format == "text":
        errors = sum(d.severity is Severity.ERROR for d in judged(sink, options))
        print(f"{len(files)} file{'s' * (len(files) != 1)} checked, {errors} error{'s' * (errors != 1)}")
    return AT_FAULT if failed else FINE


def compile_command(options: argparse.Namespace) -> int:
    """Compile a scenario and write its plan."""
    from scenario_compiler.plan.store import write_plan

    sink = Diagnostics()
    compilation = _compiled(options, sink)
    if show(sink, options) or compilation is None:
        return AT_FAULT
    write_plan(compilation.plan, options.output)
    return FINE


def _compiled(options: argparse.Namespace, sink: Diagnostics) -> Compilation | None:
    from scenario_compiler.compiler import Overrides, compile_target
    from scenario_compiler.source import ScenarioNameNeededError

    overrides = Overrides(
        perception=options.perception, controller=options.controller, step=options.dt, duration=options.duration
    )
    try:
        return compile_target(options.target, _settings(options.settings), sink, maps=options.maps, overrides=overrides)
    except ScenarioNameNeededError as needed:
        raise WrongUse(
            f"{options.target} has several scenarios; name one as FILE#name: {', '.join(needed.names)}"
        ) from None


def _settings(texts: Sequence[str]) -> dict[str, str]:
    settings = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals or not name.strip():
            raise WrongUse(f"--set wants NAME=VALUE, not '{text}'")
        settings[name.strip()] = value.strip()
    return settings


def _planned(options: argparse.Namespace, sink: Diagnostics) -> tuple[Plan, Network] | None:
    if not options.target.endswith(".json"):
        compilation = _compiled(options, sink)
        return None if compilation is None else (compilation.plan, compilation.network)
    from scenario_compiler.plan.maps import open_plan_map
    from scenario_compiler.plan.store import read_plan

    if options.settings or options.perception or options.controller or options.dt or options.duration:
        raise WrongUse(
            "a plan is compiled already: give --set, --perception, --controller, --dt and --duration to compile"
        )
    plan = read_plan(options.target, sink)
    network = None if plan is None else open_plan_map(plan, sink, options.maps)
    return None if plan is None or network is None else (plan, network)


def run_command(options: argparse.Namespace) -> int:
    """Run a scenario or a plan."""
    from scenario_compiler.worlds import WORLDS

    if options.world not in WORLDS:
        raise WrongUse(f"there is no world '{options.world}' ({did_you_mean(options.world, WORLDS)})")
    if options.output is not None and not options.force and _is_filled(options.output):
        raise WrongUse(f"{options.output} is not empty; --force writes into it all the same")
    sink = Diagnostics()
    planned = _planned(options, sink)
    if show(sink, options) or planned is None:
        return AT_FAULT
    plan, network = planned
    from scenario_compiler.recording.outcome import judge
    from scenario_compiler.report.run import Run
    from scenario_compiler.runtime import open_world

    world = open_world(options.world, plan, network)
    try:
        recording = run_with_progress(plan, world, options.seed)
    finally:
        world.close()
    finished = Run(plan, network, recording, judge(plan, recording))
    if options.trajectory is not None:
        from scenario_compiler.recording.trajectory import write_trajectory

        write_trajectory(recording, options.trajectory)
    if options.output is not None:
        from scenario_compiler.report.folder import write_run_folder

        write_run_folder(finished, options.output)
    print_run(finished, options.output)
    return CRITERIA_FAILED if options.strict and finished.outcome.result != "pass" else FINE


def run_with_progress(plan: Plan, world: World, seed: int) -> Recording:
    """Run a plan, with a progress bar where stderr is a terminal."""
    from scenario_compiler.runtime import run

    if not sys.stderr.isatty():
        return run(plan, world, seed=seed)
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(plan.name, total=plan.duration)
        return run(plan, world, seed=seed, progress=lambda t: bar.update(task, completed=t))


def _is_filled(folder: Path) -> bool:
    return folder.exists() and (not folder.is_dir() or any(folder.iterdir()))


def print_run(run: Run, folder: Path | None) -> None:
    """Print what a run came to."""
    from rich.console import Console
    from rich.table import Table

    from scenario_compiler.report.wording import summary_of

    summary = summary_of(run)
    table = Table(show_header=False, box=None, pad_edge=False)
    for label, value in (
        ("conflict", summary.name),
        ("result", summary.result),
        ("outcome", summary.outcome),
        ("cause of the request", summary.cause),
        ("time of the request", f"{summary.request_time} s"),
        ("takeover time", f"{summary.takeover_time} s"),
        ("minimum time to collision", f"{summary.minimum_ttc} s"),
    ):
        table.add_row(label, value)
    Console().print(table)
    if folder is not None:
        print(f"report: {folder / 'report.html'}")


def report_command(options: argparse.Namespace) -> int:
    """Write the report of a run folder again from its plan and recording."""
    from scenario_compiler.plan.maps import open_plan_map
    from scenario_compiler.plan.store import read_plan
    from scenario_compiler.recording.outcome import judge
    from scenario_compiler.recording.store import RecordingError, read_recording
    from scenario_compiler.report.html import write_report
    from scenario_compiler.report.run import Run

    sink = Diagnostics()
    plan = read_plan(options.folder / "plan.json", sink)
    network = None if plan is None else open_plan_map(plan, sink, options.maps)
    file = options.folder / "recording.parquet"
    try:
        recording = read_recording(file)
    except RecordingError as error:
        sink.add(BAD_RECORDING, str(error), FilePlace(str(file)))
    if show(sink, options) or plan is None or network is None:
        return AT_FAULT
    write_report([Run(plan, network, recording, judge(plan, recording))], options.folder)
    print(f"report: {options.folder / 'report.html'}")
    return FINE


def _map_file(options: argparse.Namespace) -> Path:
    from scenario_compiler.resources import MapNotFoundError, find_map, known_maps

    try:
        return find_map(options.file, folders=options.maps)
    except MapNotFoundError as missing:
        raise WrongUse(f"{missing} ({did_you_mean(options.file, known_maps(options.maps))})") from None


def _loaded_map(options: argparse.Namespace) -> tuple[Document, Network] | None:
    from scenario_compiler.document import read_document
    from scenario_compiler.roads import load_network

    sink = Diagnostics()
    path = _map_file(options)
    document = read_document(path, sink)
    network = None if document is None else load_network(path, sink=sink)
    show(sink, options)
    return None if document is None or network is None else (document, network)


def map_info_command(options: argparse.Namespace) -> int:
    """Print what a map holds."""
    from dataclasses import fields

    from scenario_compiler.roads.describe import describe_network

    loaded = _loaded_map(options)
    if loaded is None:
        return AT_FAULT
    description = describe_network(loaded[1])
    for one in fields(description):
        print(f"{one.name.replace('_', ' '):<26}{_listed(getattr(description, one.name))}")
    return FINE


def _listed(value: object) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{name}: {_listed(count)}" for name, count in value.items()) or "none"
    if isinstance(value, tuple):
        return ", ".join(_listed(one) for one in value)
    return f"{value:.2f}" if isinstance(value, float) else str(value)


def map_check_command(options: argparse.Namespace) -> int:
    """Print everything that is wrong in a road file."""
    from scenario_compiler.document import read_document
    from scenario_compiler.roads.check import check_file
    from scenario_compiler.roads.check.unread import unread
    from scenario_compiler.roads.xsd import validate_with_xsd

    sink = Diagnostics()
    path = _map_file(options)
    check_file(path, sink)
    document = read_document(path, sink)
    if document is not None and options.xsd is not None:
        validate_with_xsd(document, options.xsd, sink)
    failed = show(sink, options)
    if document is not None and options.format == "text":
        for one in unread(document):
            attribute = f" attribute {one.attribute}" if one.attribute else ""
            print(f"{path}:{one.line}: not read: {one.path}{attribute} ({one.count})")
    return AT_FAULT if failed else FINE


def map_plot_command(options: argparse.Namespace) -> int:
    """Draw a map."""
    from scenario_compiler.report.map_plot import plot_map
    from scenario_compiler.roads.spawn_points import read_spawn_points

    if options.output.suffix not in (".png", ".svg"):
        raise WrongUse(f"{options.output}: a map is drawn as .png or .svg")
    loaded = _loaded_map(options)
    if loaded is None:
        return AT_FAULT
    sink = Diagnostics()
    spawn_points = read_spawn_points(loaded[1].path, sink)
    show(sink, options)
    plot_map(loaded[1], options.output, spawn_points=spawn_points)
    return FINE


def map_export_command(options: argparse.Namespace) -> int:
    """Write a map for another program."""
    loaded = _loaded_map(options)
    if loaded is None:
        return AT_FAULT
    document, network = loaded
    if options.mesh:
        from scenario_compiler.roads.export_mesh import FORMATS as MESH_FORMATS
        from scenario_compiler.roads.export_mesh import export_mesh

        if options.output.suffix not in MESH_FORMATS:
            raise WrongUse(f"{options.output}: a mesh is written as {', '.join(MESH_FORMATS)}")
        export_mesh(network, options.output)
        return FINE
    from scenario_compiler.roads.export_carla import export_for_carla

    options.output.write_bytes(export_for_carla(document, network))
    return FINE


def explain_command(options: argparse.Namespace) -> int:
    """Print the page of a diagnostic's code."""
    import textwrap

    for module in CODE_HOMES:
        importlib.import_module(f"scenario_compiler.{module}")
    code = CODES.get(options.code.upper())
    if code is None:
        raise WrongUse(f"there is no code '{options.code}' ({did_you_mean(options.code.upper(), CODES)})")
    print(f"{code.id} {code.name} ({code.severity.value})\n")
    print("\n\n".join(textwrap.fill(part, 100) for part in code.explanation.split("\n\n")))
    return FINE


def prewarm_command(options: argparse.Namespace) -> int:
    """Compile the engine into the cache, so that later commands find it there."""
    del options
    from scenario_compiler.engine.build import warm

    warm(say=lambda text: print(text, file=sys.stderr))
    print("the compiled engine is ready")
    return FINE
