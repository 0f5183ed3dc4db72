"""Options that commands share, and how diagnostics are shown."""

from __future__ import annotations

import argparse
import gc
import re
import sys
from collections.abc import Iterable, Iterator, Sequence
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
    did_you_mean,
    weighed,
)
from scenario_compiler.files import split_target
from scenario_compiler.trust import Trust

if TYPE_CHECKING:
    from scenario_compiler.compiler import Compilation
    from scenario_compiler.plan.model import Plan

PERCEPTIONS = ("camera", "ideal", "surrogate")
"""What the lane confidence may come from, as `vocabulary.sensors.Perception`, which need not be loaded for this."""

FINE, AT_FAULT, WRONG_USE, CRITERIA_FAILED, INTERRUPTED = 0, 1, 2, 3, 130
"""Exit codes."""

Commands: TypeAlias = "argparse._SubParsersAction[argparse.ArgumentParser]"


class WrongUse(Exception):
    """The command was used in a way that cannot work; the message says which."""


def suggestion(word: str, known: Iterable[str]) -> str:
    """Return what to put behind a word that is not known: what may be meant, in brackets; nothing where none is."""
    hint = did_you_mean(word, known)
    return f" ({hint})" if hint else ""


def reason_of(fault: OSError) -> str:
    """Return what could not be read or written and why, in one line; without a file's name it is what is printed."""
    return f"{fault.filename or 'output'}: {fault.strerror or fault}"


def keep_inputs(inputs: Iterable[str | Path], *outputs: Path | None) -> None:
    """Refuse to write over what is read.

    Args:
        inputs: Files that are read; what stands behind a # is the name of a scenario in them.
        outputs: Files that are to be written, None for those that are not.

    Raises:
        WrongUse: One of them is an input.
    """
    read = [Path(str(one).partition("#")[0]) for one in inputs]
    for output in outputs:
        if output is not None and any(one.exists() and output.exists() and one.samefile(output) for one in read):
            raise WrongUse(f"{output} is read by this command and would be written over: name another file")


def inputs_of(plan: Plan) -> Iterator[str]:
    """Yield the files that a plan was made from, as far as it names them."""
    yield plan.map.file
    yield from {origin.file: None for origin in plan.origins.values()}


def add_scenario(parser: argparse.ArgumentParser) -> None:
    """Add the options that change a scenario."""
    parser.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE", help="give a parameter a value", dest="settings"
    )
    parser.add_argument("--perception", choices=PERCEPTIONS, help="what the lane confidence comes from")
    parser.add_argument(
        "--controller",
        metavar="NAME|package.module:Class|file.py:Class",
        help="what drives the ego vehicle; code of your own that is named here is trusted",
    )
    add_trust(parser)
    parser.add_argument("--dt", type=step_length, metavar="S", help="length of a time step")
    parser.add_argument("--duration", type=positive, metavar="S", help="when the run ends at the latest")


def add_trust(parser: argparse.ArgumentParser) -> None:
    """Add what code of their own scenarios may run."""
    parser.add_argument(
        "--trust",
        action="append",
        default=[],
        metavar="NAME|FILE",
        help="trust code that scenarios name: a class (package.module:Class), a module, a Python file, or all that a "
        "scenario's FILE names; code that is not trusted is never imported",
    )


def trust_of(options: argparse.Namespace) -> Trust:
    """Return what a command's options trust; code that they name is looked for beside the scenario too."""
    named = [*options.trust, *([options.controller] if options.controller else [])]
    return Trust(tuple(named), Path(split_target(options.target)[0]).parent)


def add_maps(parser: argparse.ArgumentParser) -> None:
    """Add the folders of maps."""
    parser.add_argument(
        "--maps", action="append", type=Path, default=[], metavar="DIR", help="look for maps here first"
    )


def add_templates(parser: argparse.ArgumentParser) -> None:
    """Add the folders of templates."""
    parser.add_argument(
        "--templates", action="append", type=folder, default=[], metavar="DIR", help="look for templates here first"
    )


def folder(text: str) -> Path:
    """Return the folder that an option names."""
    if not Path(text).is_dir():
        raise argparse.ArgumentTypeError(f"there is no folder '{text}'")
    return Path(text)


def is_filled(output: Path) -> bool:
    """Return whether something lies in a folder already, or in its place."""
    return output.exists() and (not output.is_dir() or any(output.iterdir()))


def add_diagnostics(parser: argparse.ArgumentParser) -> None:
    """Add how diagnostics are shown and weighed."""
    parser.add_argument(
        "--format",
        choices=FORMATS,
        default="text",
        help="format of the diagnostics; all but text are printed on stdout, and on stderr what else there is to tell",
    )
    parser.add_argument(
        "--error",
        action="append",
        type=code_or_all,
        default=[],
        metavar="CODE|all",
        help="make a warning an error: that of a code even where a file allows it, or all that no file allows",
    )
    parser.add_argument(
        "--allow", action="append", type=code_id, default=[], metavar="CODE", help="do not report it unless an error"
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
    """Return a sink that keeps the warnings that --error names, whatever the file allows."""
    return Diagnostics(insisted=frozenset(options.error))


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
    """Return the findings as --error, --allow and --strict want them weighed."""
    strict = getattr(options, "strict_warnings", False)
    return list(weighed(found, options.error, options.allow, strict=strict))


def show(found: Iterable[Diagnostic], options: argparse.Namespace) -> bool:
    """Print diagnostics, text on stderr and everything else on stdout; return whether one is an error."""
    weighed = judged(found, options)
    text = formatted(weighed, options.format)
    if text:
        put_raw(text, sys.stderr if options.format == "text" else sys.stdout)
    return any(d.severity is Severity.ERROR for d in weighed)


def has_errors(found: Iterable[Diagnostic], options: argparse.Namespace) -> bool:
    """Return whether one of the diagnostics is an error, by what the command line says of their codes."""
    return any(d.severity is Severity.ERROR for d in judged(found, options))


def told(options: argparse.Namespace) -> TextIO:
    """Return where what is for people to read goes: stderr where stdout holds diagnostics for a program."""
    return sys.stdout if options.format == "text" else sys.stderr


def settings_of(texts: Sequence[str]) -> dict[str, str]:
    """Return the values that --set gives, by name."""
    settings = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals or not name.strip():
            raise WrongUse(f"--set wants NAME=VALUE, not '{text}'")
        settings[name.strip()] = value.strip()
    return settings


def keep_loaded() -> None:
    """Spare the garbage collector what has been loaded: looking through it as the process ends takes 40 ms and more.

    Called before anything of the user's is loaded: of that, what is not closed is closed by the collector in the end.
    """
    gc.freeze()


def library_target(text: str) -> str:
    """Return FILE#name of a conflict of the library that a bare name names; anything else stays as it is.

    Raises:
        WrongUse: There is neither a file nor a conflict of that name.
    """
    if Path(text).exists() or not re.fullmatch(IDENTIFIER, text):
        return text
    from scenario_compiler.listing import find_conflict, list_library
    from scenario_compiler.resources import library_folder

    folder = library_folder() / "conflicts"
    found = find_conflict(text, folder)
    if found is None:
        known = [one.name for one in list_library(folder, Diagnostics())]
        raise WrongUse(f"there is no file and no conflict of the library called '{text}'{suggestion(text, known)}")
    return found


IDENTIFIER = r"[A-Za-z_]\w*"
"""What a bare name of a conflict looks like: no folder, no ending."""


def add_target(parser: argparse.ArgumentParser, metavar: str = "FILE[#name]|NAME") -> None:
    """Add the scenario that a command is about: a file, one of its scenarios, or a conflict of the library by name."""
    parser.add_argument("target", metavar=metavar, help="a scenario's file, or the name of a conflict of the library")


def compiled(options: argparse.Namespace, sink: Diagnostics) -> Compilation | None:
    """Compile what a command names, with the changes that its options make."""
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
