"""Options that commands share, and how diagnostics are shown."""

from __future__ import annotations

import argparse
import errno
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, TextIO, TypeAlias

from scenario_compiler.cli.terminal import put_raw
from scenario_compiler.diagnostic_formats import FORMATS, formatted
from scenario_compiler.diagnostics import (
    Diagnostic,
    Diagnostics,
    Severity,
    all_codes,
    code_named,
    suggestion,
    weighed,
)
from scenario_compiler.files import split_target
from scenario_compiler.garbage_collection import keep_loaded
from scenario_compiler.processes import available_cores
from scenario_compiler.resources import ConflictNotFoundError, library_target
from scenario_compiler.trust import Trust

if TYPE_CHECKING:
    from scenario_compiler.compiler import Compilation
    from scenario_compiler.plan.model import Plan

PERCEPTIONS = ("camera", "ideal", "surrogate")
"""Sources of the lane confidence, as in `vocabulary.sensors.Perception`, which takes too long to load for help."""

FINE, AT_FAULT, WRONG_USE, CRITERIA_FAILED, INTERRUPTED = 0, 1, 2, 3, 130
"""Exit codes."""

EXTRAS = {"av": "video", "mcap": "mcap", "pylsl": "lsl", "rerun": "rerun", "xgboost": "fit"}
"""The extra that installs each optional package."""

Commands: TypeAlias = "argparse._SubParsersAction[argparse.ArgumentParser]"


class WrongUse(Exception):
    """The command was used in a way that cannot work; the message says which."""


def refuse_idle(options: argparse.Namespace, why: str, *names: str) -> None:
    """Refuse options that would be ignored.

    Args:
        options: The arguments of a command.
        why: When the options have an effect, as in "only with --watch".
        names: The names of their attributes.

    Raises:
        WrongUse: One of them was given another value than its default.
    """
    for name in names:
        if getattr(options, name) != options.default_of(name):
            spelled = {"output": "-o", "report": "--no-report"}.get(name, f"--{name.replace('_', '-')}")
            raise WrongUse(f"{spelled}: {why}")


def reason_of(fault: OSError) -> str:
    """Return in one line which file could not be read or written, and why.

    Without a file it is the output or, if something is missing, the current folder, which somebody has deleted.
    """
    unnamed = "the current folder" if fault.errno == errno.ENOENT else "output"
    return f"{fault.filename or unnamed}: {fault.strerror or fault}"


def keep_inputs(inputs: Iterable[str | Path], *outputs: Path | None) -> None:
    """Refuse to overwrite a file that the command reads.

    Args:
        inputs: Files that the command reads; the part after a # is the name of a scenario in the file.
        outputs: Files that the command will write; None stands for an output that was not asked for.

    Raises:
        WrongUse: An output is also an input.
    """
    read = [Path(split_target(one)[0]) for one in inputs]
    for output in outputs:
        if output is not None and any(one.exists() and output.exists() and one.samefile(output) for one in read):
            raise WrongUse(f"{output} is read by this command and would be written over: name another file")


def inputs_of(plan: Plan) -> Iterator[str]:
    """Yield the files from which a plan was made, as far as it names them."""
    yield plan.map.file
    yield from {origin.file: None for origin in plan.origins.values()}


def add_scenario(parser: argparse.ArgumentParser) -> None:
    """Add the options that change a scenario."""
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="set a parameter of the scenario",
        dest="settings",
    )
    parser.add_argument("--perception", choices=PERCEPTIONS, help="source of the lane confidence")
    parser.add_argument(
        "--controller",
        metavar="NAME|package.module:Class|file.py:Class",
        help="controller that drives the ego; your own code is trusted if you name it here",
    )
    add_trust(parser)
    parser.add_argument(
        "--dt",
        type=step_length,
        metavar="S",
        help="length of a time step, s; the time between control steps is rounded to a whole number of them",
    )
    parser.add_argument("--duration", type=positive, metavar="S", help="latest end of the run, s")


def add_trust(parser: argparse.ArgumentParser) -> None:
    """Add the option that names the code that scenarios may run."""
    parser.add_argument(
        "--trust",
        action="append",
        default=[],
        metavar="NAME|FILE",
        help="trust code that scenarios name: a class (package.module:Class), a module, a Python file, or a scenario's "
        "FILE with all the code that it names; code that is not trusted is never imported",
    )


def trust_of(options: argparse.Namespace) -> Trust:
    """Return which code a command's options trust; it is looked for in the scenario's folder too."""
    named = [*options.trust, *([options.controller] if options.controller else [])]
    return Trust(tuple(named), Path(split_target(options.target)[0]).parent)


def add_maps(parser: argparse.ArgumentParser) -> None:
    """Add the option for folders of maps."""
    parser.add_argument(
        "--maps",
        action="append",
        type=folder,
        default=[],
        metavar="DIR",
        help="folder in which maps are looked for first",
    )


def add_templates(parser: argparse.ArgumentParser) -> None:
    """Add the option for folders of templates."""
    parser.add_argument(
        "--templates",
        action="append",
        type=folder,
        default=[],
        metavar="DIR",
        help="folder in which templates are looked for first",
    )


def folder(text: str) -> Path:
    """Return the folder that an option names."""
    if not Path(text).is_dir():
        raise argparse.ArgumentTypeError(f"there is no folder '{text}'")
    return Path(text)


def refuse_filled(output: Path, *, force: bool) -> None:
    """Raise WrongUse if a folder for output has files in it, unless `force` is given."""
    if not force and output.is_dir() and any(output.iterdir()):
        raise WrongUse(f"{output} is not empty; --force writes into it anyway")


def add_diagnostics(parser: argparse.ArgumentParser) -> None:
    """Add the options for the format and the severity of diagnostics."""
    parser.add_argument(
        "--format",
        choices=FORMATS,
        default="text",
        help="format of the diagnostics; every format but text goes to stdout, and all other output then to stderr",
    )
    parser.add_argument(
        "--error",
        action="append",
        type=code_or_all,
        default=[],
        metavar="CODE|all",
        help="turn warnings into errors: those with this code, even if a file allows them, or all that no file allows",
    )
    parser.add_argument(
        "--allow",
        action="append",
        type=code_id,
        default=[],
        metavar="CODE",
        help="do not report warnings with this code",
    )


def code_id(text: str) -> str:
    """Return the id of the diagnostic code that an option names, in capitals or not."""
    code = code_named(text)
    if code is None:
        raise argparse.ArgumentTypeError(f"there is no code '{text}'{suggestion(text.upper(), all_codes())}")
    return code.id


def code_or_all(text: str) -> str:
    """Return the id of the diagnostic code that an option names, or `all`."""
    return text if text == "all" else code_id(text)


def new_sink(options: argparse.Namespace) -> Diagnostics:
    """Return a sink that keeps the warnings that --error names, even if the file allows them."""
    return Diagnostics(insisted=frozenset(options.error))


MOST_PROCESSES = 1024
"""Greatest number of processes that an option can ask for."""


def add_workers(parser: argparse.ArgumentParser) -> None:
    """Add the option for the number of processes."""
    parser.add_argument(
        "--workers",
        type=whole_number(1, MOST_PROCESSES),
        default=available_cores(),
        metavar="N",
        help="number of processes (default: one for each core)",
    )


def whole_number(least: int, greatest: int) -> Callable[[str], int]:
    """Return a function that returns a whole number within limits that an option gives."""

    def number(text: str) -> int:
        try:
            value = int(text)
        except ValueError:
            value = None
        if value is None or not least <= value <= greatest:
            raise argparse.ArgumentTypeError(f"{text} is not a whole number from {least} to {greatest}")
        return value

    return number


def positive(text: str) -> float:
    """Return a time in seconds that an option gives."""
    value = float(text)
    if not 0.0 < value < 1.0e6:
        raise argparse.ArgumentTypeError(f"{text} is not a time in seconds")
    return value


def step_length(text: str) -> float:
    """Return the length of a time step in seconds that an option gives, within the limits of `step` in a scenario."""
    value = float(text)
    if not 0.001 <= value <= 1.0:
        raise argparse.ArgumentTypeError(f"{text} is not between 0.001 and 1 s")
    return value


def judged(found: Iterable[Diagnostic], options: argparse.Namespace) -> list[Diagnostic]:
    """Return the findings with the severities that --error, --allow and --strict give them."""
    strict = getattr(options, "strict_warnings", False)
    return list(weighed(found, options.error, options.allow, strict=strict))


def show(found: Iterable[Diagnostic], options: argparse.Namespace) -> bool:
    """Print diagnostics, as text on stderr, in other formats on stdout; return whether one of them is an error."""
    weighed = judged(found, options)
    text = formatted(weighed, options.format)
    if text:
        put_raw(text, sys.stderr if options.format == "text" else sys.stdout)
    return any(d.severity is Severity.ERROR for d in weighed)


def has_errors(found: Iterable[Diagnostic], options: argparse.Namespace) -> bool:
    """Return whether one of the diagnostics is an error under the options of the command line."""
    return any(d.severity is Severity.ERROR for d in judged(found, options))


def text_stream(options: argparse.Namespace) -> TextIO:
    """Return the stream for people: stdout, or stderr when stdout holds diagnostics in a format for programs."""
    return sys.stdout if options.format == "text" else sys.stderr


def settings_of(texts: Sequence[str]) -> dict[str, str]:
    """Return the values that --set gives, by name."""
    settings = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals or not name.strip():
            raise WrongUse(f"--set needs NAME=VALUE, not '{text}'")
        if name.strip() in settings:
            raise WrongUse(f"the parameter '{name.strip()}' is given twice")
        settings[name.strip()] = value.strip()
    return settings


def existing_target(text: str) -> str:
    """Return FILE#name for the bare name of a conflict of the library; any other text is returned unchanged.

    Raises:
        WrongUse: There is neither a file nor a conflict of that name.
    """
    try:
        return str(library_target(text))
    except ConflictNotFoundError as missing:
        raise WrongUse(f"{missing} ({missing.hint})" if missing.hint else str(missing)) from None


def add_target(parser: argparse.ArgumentParser, metavar: str = "FILE[#name]|NAME") -> None:
    """Add the scenario that a command works on: a file, one scenario of a file, or the name of a library conflict."""
    plan = "; or a plan that `compile` wrote" if "PLAN" in metavar else ""
    parser.add_argument(
        "target", metavar=metavar, help=f"a scenario file, or the name of a conflict of the library{plan}"
    )


def compiled(options: argparse.Namespace, sink: Diagnostics) -> Compilation | None:
    """Compile the scenario that a command names, with the changes that its options make; None if it has errors."""
    from scenario_compiler.compiler import Overrides, compile_target
    from scenario_compiler.languages import ScenarioNameNeededError

    keep_loaded()
    overrides = Overrides(
        perception=options.perception,
        controller=options.controller,
        step=options.dt,
        duration=options.duration,
        driven_by=getattr(options, "driven_by", None),
    )
    try:
        return compile_target(
            options.target,
            settings_of(options.settings),
            sink,
            maps=options.maps,
            overrides=overrides,
            trust=trust_of(options),
        )
    except ScenarioNameNeededError as needed:
        raise WrongUse(
            f"{options.target} has several scenarios; name one as FILE#name: {', '.join(needed.names)}"
        ) from None


@contextmanager
def needing(package: str) -> Iterator[None]:
    """Turn a missing optional package into a WrongUse that names the extra which installs it."""
    try:
        yield
    except ModuleNotFoundError as missing:
        if (missing.name or "").partition(".")[0] != package:
            raise
        raise WrongUse(f"this needs {package}: pip install 'scenario-compiler[{EXTRAS[package]}]'") from None
