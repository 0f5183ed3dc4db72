"""The trial of a mutant: commands must end in time, with an exit code and a short output without control characters."""

from __future__ import annotations

import contextlib
import io
import os
import re
import time
import traceback
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NoReturn

from scenario_compiler.cli import main
from tests.bounded import bounded
from tests.fuzz.mutants import Mutant
from tests.test_streams import FORBIDDEN

LONGEST = 60
"""Time that a command may take, s."""

MOST_WORDS = 400_000
"""Most characters that a command says."""

COMMANDS = {
    "validate": ["validate", "{}"],
    "compile": ["compile", "{}", "-o", "made.json"],
    "run": ["run", "{}", "--perception", "ideal", "--duration", "1", "--trajectory", "made.csv"],
}


class TooLongError(BaseException):
    """A command takes longer than it may."""


@dataclass
class Trial:
    """What came of a mutant: exit codes by command, faults in words, and the time of all its commands, s."""

    results: Counter[str] = field(default_factory=Counter)
    faults: list[str] = field(default_factory=list)
    seconds: float = 0.0


def run_trial(mutant: Mutant, commands: Sequence[str]) -> Trial:
    """Put a mutant through commands, in this process and in its folder."""
    trial = Trial()
    started = time.process_time()
    before = Path.cwd()
    os.chdir(mutant.path.parent)
    try:
        for command in commands:
            target = mutant.path.name + (_first_scenario(mutant.content) if command != "validate" else "")
            words = [word.format(target) for word in COMMANDS[command]]
            if mutant.path.suffix == ".json" and command == "run":
                words = ["run", mutant.path.name, "--trajectory", "made.csv"]
            if mutant.path.suffix == ".xodr" and command == "compile":
                words = ["map", "check", f"./{mutant.path.name}"]
            _try(command, words, trial)
    finally:
        os.chdir(before)
    trial.faults += [f"left {path.name}" for path in mutant.path.parent.glob("*.tmp")]
    for name in (mutant.path.name, "made.json", "made.csv"):
        (mutant.path.parent / name).unlink(missing_ok=True)
    trial.seconds = time.process_time() - started
    return trial


def _first_scenario(content: bytes) -> str:
    """Return #NAME of a file's first scenario where it holds several; else nothing."""
    names = re.findall(rb'<scenario name="(\w+)"', content)
    return f"#{names[0].decode()}" if len(names) > 1 else ""


def _try(command: str, words: list[str], trial: Trial) -> None:
    out, err = io.StringIO(), io.StringIO()
    code: object = "none"
    try:
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), bounded(LONGEST, _too_long):
            code = main(words)
    except SystemExit as left:
        code = left.code
    except TooLongError:
        trial.faults.append(f"{command} takes more than {LONGEST} s")
    except BaseException:
        trial.faults.append(f"{command}: {traceback.format_exc(limit=-4)}")
    told = out.getvalue() + err.getvalue()
    trial.results[f"{command} exits {code}"] += 1
    if code not in (0, 1, 2):
        trial.faults.append(f"{command} exits with {code}")
    if len(told) > MOST_WORDS:
        trial.faults.append(f"{command} says {len(told)} characters")
    if "SC117" in told or "Traceback" in told:
        line = next(line for line in told.splitlines() if "SC117" in line or "Traceback" in line)
        trial.faults.append(f"{command}: {line}")
    if any(one in told for one in FORBIDDEN):
        trial.faults.append(f"{command} prints what cannot be seen")
    if any(line.lstrip().startswith("::") or "##[" in line for line in told.splitlines()):
        trial.faults.append(f"{command} prints a command of a build service")


def _too_long() -> NoReturn:
    raise TooLongError
