"""`sweep`: many variants of one scenario."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from scenario_compiler.cli.options import (
    AT_FAULT,
    CRITERIA_FAILED,
    FINE,
    INTERRUPTED,
    MOST_PROCESSES,
    Commands,
    WrongUse,
    add_diagnostics,
    add_maps,
    add_scenario,
    add_target,
    add_templates,
    new_sink,
    positive,
    reason_of,
    refuse_idle,
    settings_of,
    show,
    text_stream,
    whole_number,
)
from scenario_compiler.cli.terminal import complain, put, tell
from scenario_compiler.diagnostics import CompileError, Diagnostics
from scenario_compiler.files import is_plan_file
from scenario_compiler.garbage_collection import keep_loaded, paused

if TYPE_CHECKING:
    from rich.progress import TaskID

    from scenario_compiler.batch.spec import SweepSpec
    from scenario_compiler.batch.tally import OnProgress, Progress, Stage, Tally
    from scenario_compiler.vocabulary.variation import Vary

MOST_SAMPLES = 1_000_000_000
"""Greatest number of draws, repetitions or runs of a search that an option can ask for."""

OF_SWEEPS = ("samples", "method", "traces", "workers", "scheduler", "report", "pass_rate", "time_limit")
"""Options without an effect on a search."""

METHODS = ("random", "grid", "latin", "sobol")


def add(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser("sweep", help="run many variants of a scenario")
    add_target(parser, "FILE[#name]|NAME|PLAN.json")
    parser.add_argument("-o", dest="output", type=Path, required=True, metavar="DIR", help="folder of the sweep")
    _add_variants(parser)
    parser.add_argument(
        "--traces", default="", metavar="worst:K|random:K|all", help="variants whose recordings are kept"
    )
    parser.add_argument("--resume", action="store_true", help="finish an interrupted sweep")
    parser.add_argument(
        "--workers",
        type=whole_number(1, MOST_PROCESSES),
        metavar="N",
        help="number of processes (default: chosen by the work there is)",
    )
    parser.add_argument("--scheduler", metavar="tcp://HOST:PORT", help="run the variants through this Dask scheduler")
    _add_search(parser)
    parser.add_argument("--no-report", action="store_false", dest="report", help="write the table without a report")
    parser.add_argument(
        "--pass-rate", type=share, metavar="SHARE", help="exit with 3 if a smaller share of the variants passes"
    )
    parser.add_argument("--time-limit", type=positive, metavar="S", help="longest computing time of a variant, s")
    add_scenario(parser)
    add_maps(parser)
    add_templates(parser)
    add_diagnostics(parser)
    parser.set_defaults(command=sweep_command)


def _add_variants(parser: argparse.ArgumentParser) -> None:
    """Add the options that say which variants there are."""
    parser.add_argument(
        "--vary",
        action="append",
        default=[],
        metavar="NAME=DISTRIBUTION",
        help="vary a parameter, as in gap=uniform(5,40)",
    )
    parser.add_argument("--method", choices=METHODS, default="random", help="way to sample the distributions")
    parser.add_argument(
        "--samples",
        type=whole_number(1, MOST_SAMPLES),
        metavar="N",
        help="number of draws (default: that of the scenario, else 1)",
    )
    parser.add_argument(
        "--repeat",
        type=whole_number(1, MOST_SAMPLES),
        default=1,
        metavar="N",
        help="runs of each draw or listed point, with successive seeds",
    )
    parser.add_argument(
        "--where",
        action="append",
        default=[],
        metavar="EXPRESSION",
        help="condition on the parameters that every variant must meet",
    )
    parser.add_argument(
        "--seed", type=int, metavar="N", help="seed of the draws (default: that of the scenario, else 1)"
    )


def _add_search(parser: argparse.ArgumentParser) -> None:
    """Add the options of a search for a boundary or for the least value of a measure."""
    search = parser.add_mutually_exclusive_group()
    search.add_argument(
        "--boundary",
        metavar="EXPRESSION",
        help="find the parameter value at which an expression, such as collision, begins to hold",
    )
    search.add_argument("--minimise", metavar="MEASURE", help="find the parameter values at which a measure is least")
    parser.add_argument(
        "--tolerance",
        type=float,
        default=0.1,
        metavar="X",
        help="width of the interval to which a boundary is narrowed down",
    )
    parser.add_argument(
        "--evaluations",
        type=whole_number(1, MOST_SAMPLES),
        default=100,
        metavar="N",
        help="approximate number of runs of a minimisation",
    )


def sweep_command(options: argparse.Namespace) -> int:
    """Run a sweep, or a search, into its folder."""
    with paused():  # so that the collector never visits what is loaded here
        from scenario_compiler.batch import execute  # noqa: F401  # loaded only
        from scenario_compiler.batch.distributions import SweepError
        from scenario_compiler.batch.folder import MANIFEST
        from scenario_compiler.languages import ScenarioNameNeededError

        keep_loaded()
    _refuse_idle(options)
    sink = new_sink(options)
    try:
        if options.boundary is not None or options.minimise is not None:
            return _search(options, sink)
        return _sweep(options, sink)
    except CompileError as error:
        show(error.diagnostics, options)
        return AT_FAULT
    except ScenarioNameNeededError as needed:
        raise WrongUse(f"the file has several scenarios; name one as FILE#name: {', '.join(needed.names)}") from None
    except SweepError as error:
        raise WrongUse(str(error)) from None
    except OSError as error:
        if not (options.output / MANIFEST).is_file():
            raise
        complain(f"{reason_of(error)}; --resume finishes the sweep")
        return AT_FAULT
    except KeyboardInterrupt:
        complain("interrupted; --resume finishes the sweep")
        return INTERRUPTED


def _refuse_idle(options: argparse.Namespace) -> None:
    """Raise WrongUse for options of a sweep given to a search, and for those of another search."""
    if options.boundary is None:
        refuse_idle(options, "only with --boundary", "tolerance")
    if options.minimise is None:
        refuse_idle(options, "only with --minimise", "evaluations")
    if options.boundary is not None or options.minimise is not None:
        refuse_idle(options, "not with --boundary and --minimise", *OF_SWEEPS)


def _spec(options: argparse.Namespace) -> SweepSpec:
    from scenario_compiler.batch.spec import SweepSpec

    written = _written(options)
    given = {*settings_of(options.settings), *(text.partition("=")[0].strip() for text in options.vary)}
    return SweepSpec(
        vary=(*(axis.spelling() for axis in written.axes if axis.parameter not in given), *options.vary),
        method=options.method,
        samples=_first(options.samples, written.samples),
        repeat=options.repeat,
        seed=_first(options.seed, written.seed),
        where=(*(constraint.holds for constraint in written.constraints), *options.where),
        settings=settings_of(options.settings),
        perception=options.perception,
        controller=options.controller,
        step=options.dt,
        duration=options.duration,
        trust=tuple(options.trust),
        traces=options.traces,
        errors=tuple(options.error),
        allowed=tuple(options.allow),
        time_limit=options.time_limit,
    )


def _sweep(options: argparse.Namespace, sink: Diagnostics) -> int:
    from scenario_compiler.batch.execute import run_sweep

    with shown_progress() as progress:
        result = run_sweep(
            options.target,
            _spec(options),
            options.output,
            resume=options.resume,
            progress=progress,
            scheduler=options.scheduler,
            workers=options.workers,
            maps=options.maps,
            report=options.report,
            say=tell,
            sink=sink,
        )
    show(sink, options)
    tally = result.tally
    ending = "" if tally.runs == 1 else "s"
    put(
        f"{tally.runs} variant{ending}: {tally.in_words(automated=result.automated)}: {result.table}",
        text_stream(options),
    )
    if options.report:
        put(f"report: {result.folder / 'report.html'}", text_stream(options))
    if tally.broken_off:
        how_many = "all" if tally.broken_off == tally.runs else f"{tally.broken_off} of {tally.runs}"
        complain(f"{how_many} variants broke off; the most frequent reason: {result.commonest}")
    if tally.broken_off == tally.runs:
        return AT_FAULT
    return FINE if options.pass_rate is None else _gate(tally, options)


def _gate(tally: Tally, options: argparse.Namespace) -> int:
    """Print how many variants passed, and return the exit code for the share that --pass-rate requires."""
    enough = tally.passed >= options.pass_rate * tally.runs
    comparison = "at least" if enough else "less than"
    sentence = (
        f"{tally.passed} of {tally.runs} variants passed: {comparison} the required share of {options.pass_rate:g}"
    )
    put(sentence, text_stream(options) if enough else sys.stderr)
    return FINE if enough else CRITERIA_FAILED


def share(text: str) -> float:
    """Return a share from 0 to 1 that an option gives."""
    value = float(text)
    if not 0.0 <= value <= 1.0:
        raise argparse.ArgumentTypeError(f"{text} is not between 0 and 1")
    return value


def _search(options: argparse.Namespace, sink: Diagnostics) -> int:
    from scenario_compiler.batch.search import find_boundary, minimise
    from scenario_compiler.expressions import format_value

    where = (options.target, _spec(options), options.output)
    again = {"resume": options.resume, "maps": options.maps, "sink": sink}
    if options.boundary is not None:
        with shown_progress() as progress:
            found = find_boundary(
                *where, when=options.boundary, tolerance=options.tolerance, progress=progress, **again
            )
        show(sink, options)
        without, with_it = format_value(found.without), format_value(found.with_it)
        values = f"{found.name} = {without} and holds at {found.name} = {with_it}"
        put(f"{options.boundary} does not hold at {values}", text_stream(options))
        return FINE
    with shown_progress() as progress:
        least = minimise(*where, measure=options.minimise, evaluations=options.evaluations, progress=progress, **again)
    show(sink, options)
    values = ", ".join(f"{name} = {format_value(value)}" for name, value in least.values.items())
    put(f"least {options.minimise}: {least.measure:g} at {values}, {least.evaluations} runs", text_stream(options))
    return FINE


def _first(*numbers: int | None) -> int:
    """Return the first number that is not None, or 1."""
    return next((number for number in numbers if number is not None), 1)


def _written(options: argparse.Namespace) -> Vary:
    """Return the variation that the scenario itself declares, or one without axes."""
    from scenario_compiler.compiler import variation_of
    from scenario_compiler.vocabulary.variation import Vary

    nothing = Vary.model_construct(axes=())
    if is_plan_file(options.target):
        return nothing
    return variation_of(options.target, settings_of(options.settings), Diagnostics()) or nothing


EVERY = 30.0
"""Interval between lines on progress when stderr is not a terminal, s."""

DOING: dict[Stage, str] = {
    "variants": "variants",
    "traces": "traces of variants",
    "cases": "cases for the report",
    "evaluations": "runs of the search",
}
"""Name of each stage in the output."""


@contextmanager
def shown_progress() -> Iterator[OnProgress]:
    """Yield a function that shows a sweep's progress as a bar, or without a terminal as a line every `EVERY` s."""
    if not sys.stderr.isatty():
        yield _Lines().update
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]}"),
        TimeRemainingColumn(),
        TextColumn("{task.fields[came_to]}"),
    )
    with Bar(*columns, console=Console(stderr=True), speed_estimate_period=600.0) as bar:
        tasks: dict[Stage, TaskID] = {}

        def update(progress: Progress) -> None:
            if progress.stage not in tasks:
                tasks[progress.stage] = bar.add_task(DOING[progress.stage], total=None, rate="", came_to="")
            task = tasks[progress.stage]
            speed = next(one.speed for one in bar.tasks if one.id == task)
            bar.update(
                task,
                completed=progress.done,
                total=progress.total,
                rate="" if not speed else f"{speed:.3g}/s",
                came_to=_came_to(progress.tally),
            )

        yield update


class _Lines:
    """Prints lines on a sweep's progress for a log, with the remaining time estimated from the pace so far."""

    def __init__(self) -> None:
        self._stage: Stage | None = None
        self._began = self._told = 0.0
        self._first = 0

    def update(self, progress: Progress) -> None:
        """Print a line if the last one is old enough."""
        now = time.monotonic()
        if progress.stage != self._stage:
            self._stage, self._began, self._told, self._first = progress.stage, now, now, progress.done
        since = progress.done - self._first
        if now - self._told < EVERY or not since:
            return
        self._told = now
        left = (progress.total - progress.done) * (now - self._began) / since
        shown = f"{progress.done} of {progress.total} {DOING[progress.stage]}, about {_duration(left)} left"
        came_to = _came_to(progress.tally)
        tell(f"{shown}; {came_to}" if came_to else shown)


def _came_to(tally: Tally) -> str:
    return f"{tally.failed} failed, {tally.broken_off} broken off" if tally.runs else ""


def _duration(seconds: float) -> str:
    """Return a duration for people: 40 s, 12 min, 3.5 h."""
    if seconds < 90.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 5400.0 else f"{seconds / 3600.0:.1f} h"
