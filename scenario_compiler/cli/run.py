"""`compile` and `run`: from a scenario to a plan, a run and its report."""

from __future__ import annotations

import argparse
from contextlib import nullcontext
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from scenario_compiler.cli.live import add_address, serve_plan
from scenario_compiler.cli.options import (
    AT_FAULT,
    CRITERIA_FAILED,
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
    inputs_of,
    keep_inputs,
    needing,
    new_sink,
    refuse_filled,
    refuse_idle,
    show,
    text_stream,
    trust_of,
    whole_number,
)
from scenario_compiler.cli.report import add_shows, film_path, write_film
from scenario_compiler.cli.terminal import complain, put, shown_progress
from scenario_compiler.cli.worlds import add_world, note_failures, note_findings, world_options
from scenario_compiler.diagnostics import Diagnostics, FilePlace
from scenario_compiler.files import is_plan_file, split_target
from scenario_compiler.forms.machine_code import why_interpreted
from scenario_compiler.interruption import Interruption, noted
from scenario_compiler.outputs import whole_folder

if TYPE_CHECKING:
    from scenario_compiler.controllers.person import Person, RecordedPerson
    from scenario_compiler.plan.model import Plan
    from scenario_compiler.recording.recording import Recording
    from scenario_compiler.report.run import Run
    from scenario_compiler.roads import Network
    from scenario_compiler.worlds import World

MOST_VARIANTS = 999_999_999_999
"""Greatest number of a variant that the option can name."""


def add(commands: Commands) -> None:
    """Declare the commands."""
    _add_compile(commands)
    _add_run(commands)


def _add_compile(commands: Commands) -> None:
    parser = commands.add_parser("compile", help="compile a scenario to a plan")
    add_target(parser)
    parser.add_argument("-o", dest="output", type=Path, required=True, metavar="PLAN.json", help="file of the plan")
    add_scenario(parser)
    add_maps(parser)
    add_templates(parser)
    add_diagnostics(parser)
    parser.set_defaults(command=compile_command)


def _add_run(commands: Commands) -> None:
    parser = commands.add_parser("run", help="run a scenario or a plan")
    add_target(parser, "FILE[#name]|NAME|PLAN.json")
    parser.add_argument(
        "-o", dest="output", type=Path, metavar="DIR", help="folder for the run: plan, recording, outcome, report"
    )
    parser.add_argument("--force", action="store_true", help="write into a folder that is not empty")
    parser.add_argument(
        "--seed",
        type=int,
        metavar="N",
        help="seed of all random draws (default: that of the run of --inputs, else 1)",
    )
    parser.add_argument(
        "--variant",
        type=whole_number(0, MOST_VARIANTS),
        default=0,
        metavar="N",
        help="number of the variant, whose random numbers in a sweep with the same seed are drawn; --set gives its "
        "parameter values",
    )
    add_world(parser)
    parser.add_argument(
        "--show", choices=("route",), help="draw the route to the destination as route.png in the folder"
    )
    parser.add_argument("--trajectory", type=Path, metavar="FILE.csv", help="write the trajectories of all entities")
    parser.add_argument(
        "--video",
        type=film_path,
        metavar="FILE.mp4|FILE.gif",
        help="write a film of the run (needs the extra 'video')",
    )
    add_shows(parser)
    parser.add_argument(
        "--watch",
        action="store_true",
        help="show the run in a browser page while it happens, in real time (needs the extra 'study')",
    )
    add_address(parser)
    parser.add_argument(
        "--pilot",
        dest="driven_by",
        action="store_const",
        const="model",
        help="let the driver model answer where the plan has a person at the wheel",
    )
    parser.add_argument(
        "--inputs",
        type=Path,
        metavar="DIR",
        help="folder of a run with a person at the wheel, whose recorded inputs are used again",
    )
    parser.add_argument("--interpreted", action="store_true", help="run the engine as plain Python, for a debugger")
    parser.add_argument("--strict", action="store_true", help="exit with 3 if a criterion fails")
    add_scenario(parser)
    add_maps(parser)
    add_templates(parser)
    add_diagnostics(parser)
    parser.set_defaults(command=run_command)


def compile_command(options: argparse.Namespace) -> int:
    """Compile a scenario and write its plan."""
    from scenario_compiler.plan.store import write_plan

    sink = new_sink(options)
    keep_inputs([options.target], options.output)
    compilation = compiled(options, sink)
    if show(sink, options) or compilation is None:
        return AT_FAULT
    keep_inputs(inputs_of(compilation.plan), options.output)
    write_plan(compilation.plan, options.output)
    return FINE


def _planned(options: argparse.Namespace, sink: Diagnostics) -> tuple[Plan, Network] | None:
    if not is_plan_file(options.target):
        compilation = compiled(options, sink)
        return None if compilation is None else (compilation.plan, compilation.network)
    return stored_plan(options, sink)


def stored_plan(options: argparse.Namespace, sink: Diagnostics) -> tuple[Plan, Network] | None:
    """Return the plan of a file and its map, or None if it has errors.

    Raises:
        WrongUse: Options are given that only compiling a scenario can follow.
    """
    from scenario_compiler.plan.maps import open_plan_map
    from scenario_compiler.plan.store import read_plan, sealed
    from scenario_compiler.runtime.runnable import check_runnable

    if options.settings or options.perception or options.controller or options.dt or options.duration:
        raise WrongUse(
            "a plan is compiled already: give --set, --perception, --controller, --dt and --duration to `compile`"
        )
    plan = read_plan(options.target, sink)
    beside = Path(options.target).parent
    network = None if plan is None else open_plan_map(plan, sink, options.maps, beside)
    if plan is None or network is None:
        return None
    if getattr(options, "driven_by", None) is not None:
        plan = sealed(driven_by_model(plan))
    check_runnable(plan, network, options.target, sink)
    return None if sink.has_errors else (plan, network)


def driven_by_model(plan: Plan) -> Plan:
    """Return the plan with the driver model in the place of a person at the wheel."""
    driver = plan.takeover.driver.model_copy(update={"by_person": None})
    return plan.model_copy(update={"takeover": plan.takeover.model_copy(update={"driver": driver})})


def run_command(options: argparse.Namespace) -> int:
    """Run a scenario or a plan."""
    # What runs is loaded before the scenario, so that `keep_loaded` includes it.
    from scenario_compiler.controllers.named import refuse_untrusted
    from scenario_compiler.recording import outcome  # noqa: F401  # loaded only
    from scenario_compiler.runtime import loop  # noqa: F401  # loaded only
    from scenario_compiler.worlds import WorldError

    of_world = world_options(options)
    _refuse_wrong_use(options)
    sink = new_sink(options)
    planned = _planned(options, sink)
    if planned is not None:
        refuse_untrusted(planned[0], sink, trust_of(options))
    if planned is None or has_errors(sink, options):
        show(sink, options)
        return AT_FAULT
    if options.format == "text":  # before a run that may take long; other formats are one document at the end
        show(sink, options)
        sink = new_sink(options)
    plan, network = planned
    _refuse_wrong_use_of(plan, options)
    person = _recorded_person(options, plan.step)
    if options.seed is None:
        options.seed = 1 if person is None else person.seed
    try:
        with nullcontext() if options.output is None else whole_folder(options.output) as draft:
            finished, interrupted = _finished_run(plan, network, options, of_world, sink, person)
            _write_run(finished, options, draft)
        if options.video is not None:  # once the folder is there: a film that cannot be made must not lose the run
            write_film(finished, options.video, options)
    except WorldError as fault:
        sink.add(fault.code, str(fault), FilePlace(split_target(options.target)[0]))
        show(sink, options)
        return AT_FAULT
    if interrupted:  # what was recorded until then is written
        raise KeyboardInterrupt
    print_run(finished, options.output, text_stream(options))
    note_failures(finished.recording, finished.plan, options.target, sink)
    if show(sink, options):
        return AT_FAULT
    return CRITERIA_FAILED if options.strict and finished.outcome.result != "pass" else FINE


def _refuse_wrong_use(options: argparse.Namespace) -> None:
    """Raise WrongUse for options that cannot be followed, before a scenario is compiled."""
    if options.output is not None:
        refuse_filled(options.output, force=options.force)
    if not options.watch:
        refuse_idle(options, "only with --watch", "host", "port")
    elif options.inputs is not None:
        raise WrongUse("--inputs: not with --watch; the report of a run plays it")
    if options.video is None:
        refuse_idle(options, "only with --video", "video_shows")
    if options.show is not None and options.output is None:
        raise WrongUse("--show draws into the folder of the run: name one with -o")
    if options.video is not None:  # before a run that may take long
        with needing("av"):
            import scenario_compiler.report.video  # noqa: F401  # fails here if PyAV is missing
    keep_inputs([options.target], options.trajectory, options.video)


def _refuse_wrong_use_of(plan: Plan, options: argparse.Namespace) -> None:
    """Raise WrongUse for options that cannot be followed with a plan."""
    if plan.takeover.driver.by_person is not None and options.inputs is None:
        raise WrongUse("this plan has a person at the wheel: run it with `drive`, or with --pilot for the driver model")
    if plan.takeover.driver.by_person is None and options.inputs is not None:
        raise WrongUse("--inputs has no effect: there is no person at the wheel of this plan")
    if not plan.entities and (options.watch or options.video is not None):
        raise WrongUse("pictures show the view of the first vehicle: this scenario has no entity")
    keep_inputs(inputs_of(plan), options.trajectory, options.video)


def _finished_run(
    plan: Plan,
    network: Network,
    options: argparse.Namespace,
    of_world: dict[str, object],
    sink: Diagnostics,
    person: RecordedPerson | None,
) -> tuple[Run, bool]:
    """Execute a plan in the named world, judge it, and report where the world deviates from the plan.

    An interruption ends the run; the second value says whether one came.
    """
    from scenario_compiler.recording.outcome import judge
    from scenario_compiler.report.run import Run
    from scenario_compiler.runtime import open_world

    if options.watch:
        return _watched_run(plan, network, options, of_world, sink), False
    if not options.interpreted and (reason := why_interpreted()):
        complain(f"the engine runs interpreted: {reason}")
    with open_world(options.world, plan, network, **of_world) as world:
        with noted() as interruption:
            recording = run_with_progress(plan, world, options, interruption, person)
        note_findings(world.findings, plan, sink)
    return Run(plan, network, recording, judge(plan, recording)), interruption.came


def _watched_run(
    plan: Plan, network: Network, options: argparse.Namespace, of_world: dict[str, object], sink: Diagnostics
) -> Run:
    """Execute a plan in real time while a page shows it.

    Raises:
        WrongUse: The run could not be made.
    """
    runs: list[Run] = []
    ended = serve_plan(plan, network, options, of_world, sink, runs.append)
    if not runs:
        raise WrongUse(ended or "no browser opened the page")
    return runs[0]


def _write_run(run: Run, options: argparse.Namespace, folder: Path | None) -> None:
    """Write the files of a run that the options ask for; `folder` is a draft of the folder that they name."""
    if options.trajectory is not None:
        from scenario_compiler.recording.trajectory import write_trajectory

        write_trajectory(run.recording, options.trajectory)
    if folder is None:
        return
    from scenario_compiler.report.folder import write_run_folder

    write_run_folder(run, folder)
    if options.show == "route":
        from scenario_compiler.report.preview import draw_route

        draw_route(run.plan, run.network, folder / "route.png")


def run_with_progress(
    plan: Plan, world: World, options: argparse.Namespace, interruption: Interruption, person: Person | None = None
) -> Recording:
    """Run a plan until it is interrupted, with a progress bar if stderr is a terminal."""
    from scenario_compiler.runtime import run

    start = partial(
        run,
        plan,
        world,
        options.seed,
        variant=options.variant,
        interpreted=options.interpreted,
        trust=trust_of(options),
        person=person,
        ended=lambda: interruption.came,
    )
    with shown_progress(plan.name) as shown:
        return start(progress=None if shown is None else lambda t: shown(t, plan.duration))


def _recorded_person(options: argparse.Namespace, step: float) -> RecordedPerson | None:
    """Return the recorded person of the run that --inputs names.

    Raises:
        WrongUse: The recording cannot be read, has no person, or has other time steps than the plan.
    """
    if options.inputs is None:
        return None
    from scenario_compiler.controllers.person import RecordedPerson
    from scenario_compiler.recording.store import RecordingError, read_recording

    try:
        recording = read_recording(options.inputs / "recording.parquet")
    except RecordingError as error:
        raise WrongUse(str(error)) from None
    if not RecordedPerson.is_in(recording):
        raise WrongUse(f"there is no person at the wheel of the run in {options.inputs}")
    if recording.header.step != step:
        steps = f"{recording.header.step:g} s, the plan's {step:g} s"
        raise WrongUse(
            f"the inputs in {options.inputs} belong to other time steps: {steps}; --dt changes those of a plan"
        )
    return RecordedPerson(recording)


def print_run(run: Run, folder: Path | None, file: TextIO) -> None:
    """Print the result of a run."""
    from scenario_compiler.report.wording import broken_criteria, summary_of

    summary = summary_of(run)
    of_takeover = (
        ("cause of the request", summary.cause),
        ("time of the request", _seconds(summary.request_time)),
        ("takeover time", _seconds(summary.takeover_time)),
    )
    rows = (
        ("conflict", summary.name),
        ("result", summary.result),
        *((f"broken: {name}", reason) for name, reason in broken_criteria(run.outcome)),
        ("outcome", summary.outcome),
        *(() if run.plan.controller is None else of_takeover),
        ("minimum time to collision", _seconds(summary.minimum_ttc)),
    )
    width = max(len(label) for label, _ in rows)
    for label, value in rows:
        put(f"{label:<{width}}  {value}", file)
    if folder is not None:
        put(f"report: {folder / 'report.html'}", file)


def _seconds(text: str) -> str:
    """Return a time of a summary with its unit; a text that is not a number is returned unchanged."""
    return f"{text} s" if text[:1].isdigit() else text
