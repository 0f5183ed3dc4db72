"""`study`: take participants through a study in a browser, pilot it with driver models, export its data."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from scenario_compiler.cli.live import STEP, add_address, serving
from scenario_compiler.cli.options import (
    AT_FAULT,
    FINE,
    PERCEPTIONS,
    Commands,
    WrongUse,
    add_diagnostics,
    add_maps,
    add_templates,
    add_trust,
    has_errors,
    needing,
    new_sink,
    refuse_idle,
    show,
    step_length,
    text_stream,
)
from scenario_compiler.cli.terminal import flush_streams, put, shown_progress
from scenario_compiler.cli.worlds import add_world, world_options
from scenario_compiler.files import suffix_of
from scenario_compiler.garbage_collection import keep_loaded, stay_small
from scenario_compiler.trust import Trust

if TYPE_CHECKING:
    from scenario_compiler.diagnostics import Diagnostics
    from scenario_compiler.study_plans import StudyCompilation


SIZES = {"1280x720": (1280, 720), "960x540": (960, 540), "640x360": (640, 360)}
"""Sizes of the view ahead, pixels; smaller ones suit several participants at once."""


OF_PAGES = ("size", "lsl", "host", "port")
"""Options of the participants' and the experimenter's pages."""

IDLE = {
    "run": (),
    "pilot": OF_PAGES,
    "plan": ("output", "pilot", *OF_PAGES),
    "export": ("pilot", "perception", "dt", "world", *OF_PAGES),
}
"""Options without an effect on each use of the command."""


def add(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "study",
        help="take participants through a study in a browser, pilot it, export its data (needs the extra 'study')",
        description="`study STUDY.xml -o DIR` serves a page for the participants and one for the experimenter; started "
        "again with the same `--perception` and `--dt`, it continues where it ended. With `--pilot`, driver models go "
        "through the study in place of people. `study plan STUDY.xml` prints the order of conditions for each "
        "participant. `study export DIR -o table.csv` writes one table of all runs.",
    )
    parser.add_argument(
        "action", nargs="?", choices=("run", "plan", "export"), default="run", help="what to do with the study"
    )
    parser.add_argument(
        "path", type=Path, metavar="STUDY.xml|DIR", help="study file; for export, the folder of its data"
    )
    parser.add_argument(
        "-o", dest="output", type=Path, metavar="PATH", help="folder for the data; for export, the table"
    )
    parser.add_argument("--pilot", action="store_true", help="let driver models take the place of the participants")
    parser.add_argument("--perception", choices=PERCEPTIONS, help="source of the lane confidence")
    parser.add_argument(
        "--dt",
        type=step_length,
        metavar="S",
        help="length of a time step, s; the time between control steps is rounded to a whole number of them "
        "(default: 0.02)",
    )
    parser.add_argument("--size", choices=SIZES, default="1280x720", help="size of the view ahead in pixels")
    parser.add_argument(
        "--lsl", action="store_true", help="send events to the Lab Streaming Layer (needs the extra 'lsl')"
    )
    add_world(parser)
    add_address(parser)
    add_maps(parser)
    add_templates(parser)
    add_trust(parser)
    add_diagnostics(parser)
    parser.set_defaults(command=study_command)


def study_command(options: argparse.Namespace) -> int:
    """Run, plan, pilot or export a study."""
    from scenario_compiler.study.folder import StudyError

    how = "pilot" if options.action == "run" and options.pilot else options.action
    refuse_idle(options, f"not with {'--pilot' if how == 'pilot' else f'`study {how}`'}", *IDLE[how])
    try:
        of_world = world_options(options)
        if options.action == "export":
            return _export(options)
        if options.action == "run" and options.output is None:
            raise WrongUse("name a folder for the data with -o")
        if options.world != "kinematic" and (options.pilot or options.action == "plan"):
            raise WrongUse("--world is for participants: driver models go through a study in the built-in world")
        sink = new_sink(options)
        compilation = _compiled(options, sink)
        failed = compilation is None or has_errors(sink, options)
        show(sink, options)
        if compilation is None or failed:
            return AT_FAULT
        if options.action == "plan":
            return _plan(compilation, options)
        return _pilot(compilation, options) if options.pilot else _serve(compilation, options, of_world)
    except StudyError as fault:
        raise WrongUse(str(fault)) from None


def _trust(options: argparse.Namespace) -> Trust:
    return Trust(tuple(options.trust), options.path.parent)


def _compiled(options: argparse.Namespace, sink: Diagnostics) -> StudyCompilation | None:
    from scenario_compiler.compiler import Overrides, read_source
    from scenario_compiler.controllers.named import refuse_untrusted
    from scenario_compiler.languages import check_source
    from scenario_compiler.source.study_file import StudyFile
    from scenario_compiler.study_plans import compile_study

    keep_loaded()
    by_model = options.pilot or options.action == "plan"
    step = options.dt or STEP
    overrides = Overrides(perception=options.perception, step=step, driven_by="model" if by_model else "person")
    read = read_source(options.path, sink)
    if read is None:
        return None
    source = read[1]
    if not isinstance(source, StudyFile) or source.questionnaire is not None:
        raise WrongUse(f"{options.path} is not a study: its first element is not <study>")
    check_source(source, sink)
    compilation = compile_study(source, sink, maps=options.maps, overrides=overrides, trust=_trust(options))
    if compilation is not None:
        for done in (*(one for _, one in compilation.conditions.values()), *compilation.others.values()):
            refuse_untrusted(done.plan, sink, _trust(options))
    return compilation


def _plan(compilation: StudyCompilation, options: argparse.Namespace) -> int:
    """Print the runs of each participant and session in order."""
    from scenario_compiler.study.procedure import procedure

    study = compilation.study
    for participant in range(1, study.participants + 1):
        for session in range(1, study.sessions + 1):
            steps = procedure(study, participant, session)
            runs = [one.trial for one in steps if one.trial is not None]
            names = [one.what if one.role == "trial" else f"{one.role} {one.what}" for one in runs]
            put(f"sub-{participant:02d} ses-{session:02d}: {', '.join(names)}", text_stream(options))
    return FINE


def _pilot(compilation: StudyCompilation, options: argparse.Namespace) -> int:
    from scenario_compiler.study.effects import write_effects
    from scenario_compiler.study.folder import study_folder
    from scenario_compiler.study.pilot import run_pilot

    stay_small()
    with study_folder(options.output, compilation, pilot=True):
        with shown_progress("sessions") as progress:
            run_pilot(compilation, options.output, trust=_trust(options), progress=progress)
        page = write_effects(compilation, options.output)
    put(f"data: {options.output}", text_stream(options))
    put(f"expected effects: {page}", text_stream(options))
    return FINE


def _serve(compilation: StudyCompilation, options: argparse.Namespace, of_world: dict[str, object]) -> int:
    from scenario_compiler.study.folder import study_folder

    with serving():
        from scenario_compiler.study.server import serve_study

    def tell(participants: str, experimenter: str) -> None:
        put(f"participants: {participants}", text_stream(options))
        put(f"experimenter: {experimenter}", text_stream(options))
        flush_streams()

    mark = None
    if options.lsl:
        with needing("pylsl"):
            from scenario_compiler.study.outlet import MarkerOutlet
        mark = MarkerOutlet(compilation.study.name).mark
    stay_small()
    with study_folder(options.output, compilation, pilot=False):
        serve_study(
            compilation,
            options.output,
            host=options.host,
            port=options.port,
            trust=_trust(options),
            size=SIZES[options.size],
            world=options.world,
            options=of_world,
            mark=mark,
            told=tell,
        )
    return FINE


def _export(options: argparse.Namespace) -> int:
    from scenario_compiler.study.tables import write_tidy

    if options.output is None or suffix_of(options.output) != ".csv":
        raise WrongUse("name the table with -o; it ends in .csv")
    count = write_tidy(options.path, options.output)
    put(f"{count} run{'s' * (count != 1)}: {options.output}", text_stream(options))
    return FINE
