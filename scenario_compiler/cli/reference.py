"""The page on the commands (docs/commands.md), made from what their parser declares."""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from scenario_compiler.cli import make_parser

SHARED_BY = 3
"""Commands that must have the very same option for it to be described once for all."""

_HEAD = """# Commands

Made from the program's own help by `make generate`; `scenario-compiler COMMAND --help` says the same.
`python -m scenario_compiler` is the same program.

`FILE` is a conflict, an OpenSCENARIO file or the AISA toolkit's; `FILE#name` is one scenario of a file that holds
several, `NAME` a conflict of the library (`list` shows them), and `PLAN.json` what `compile` has written.

## Exit codes

| code | means |
|---|---|
| 0 | fine; warnings may have been told |
| 1 | the input, the controller or the world is at fault, or a run broke off, and the diagnostics say how; \
`compare`: the runs differ; `sweep`: all variants failed, or it broke off |
| 2 | wrong use: an option that there is not, a name that is missing, \
a folder that is not empty, a file that cannot be written |
| 3 | `run --strict`: a criterion failed |
| 130 | interrupted by Ctrl-C or SIGTERM: one line says so, and nothing is left half written; a sweep keeps what is \
done for `--resume` |

## Diagnostics

As text they go to stderr, so that stdout holds results alone; as `json`, `sarif` or `github` they go to stdout, which
then holds nothing else: what is said about results goes to stderr.
`explain CODE` tells what a code means and what to do. Of each file, code and severity 100 are listed and the rest is
counted. Whatever files and their names hold, no control character, no mark that turns the direction of writing and no
line that a build service would take for a command is printed: they are shown as escapes.

`--error CODE` makes a warning an error, also where a file allows it with `<allow>`; `--error all` every one that no
file allows.
`--allow CODE` leaves a warning out; errors stay. `--strict` means two things: `validate --strict` takes every warning
for an error (exit 1); `run --strict` runs all the same, and exits with 3 when a criterion fails.

`validate` of an OpenSCENARIO or OpenDRIVE file exits with 1 if and only if the file is not well-formed or its structure
is not that of its own version: what else is found are warnings. `run` makes errors of what it cannot use.

## Code that files name

A scenario may name code of its author's own as the controller: `package.module:Class` or `file.py:Class`. Reading a
file never runs it: `validate`, `compile`, `export`, `preview` and `list` check the spelling of the name, and warn that
the controller's properties were not checked (SC507). `run` and `sweep` refuse it with the same code, unless you say
that you trust it. What you name is trusted:

- `--controller NAME`: that controller, in place of the scenario's;
- `--trust NAME|FILE`: a class (`our_lab.steering:Mine`), a module or package with all that is in it (`our_lab`), a
  Python file (`steering.py`), or a scenario's file with all that it names;
- for good, the list in your configuration file, `scenario-compiler/config.toml` in `$XDG_CONFIG_HOME`, on Windows in
  `%APPDATA%`, else in `~/.config`; never a file beside a scenario. Python files have absolute paths in it.

```toml
trust = ["our_lab.steering", "/home/me/steering.py"]
```

A module that the command line names is looked for in the current folder and beside the scenario too; one that only a
file names is not. The path of a Python file starts from the current folder on the command line, and from the scenario's
folder in a scenario. So does a path in a property that the controller's `Params` declare as a `pathlib.Path`.

## Files

What a command writes is whole or not there, and never what it reads. `run` and `sweep` want a folder that is new or
empty, `new` and `export` files that are not there yet, unless `--force` is given (`sweep`: `--resume`, for a folder of
its own); other commands replace the file that `-o` names. What lies in a run's folder: [run-folder.md](run-folder.md);
in a sweep's: [sweeps.md](sweeps.md).

## Environment

A map is looked for beside the file that names it, then in the folders of `--maps`, then here. A template is looked for
in the file that uses it and in what that includes, then in the folders of `--templates`, then here, then in the
library, and at last in installed packages ([sharing templates](sharing-templates.md)):

| variable | is |
|---|---|
| `SCENARIO_COMPILER_MAPS` | folders, separated as in `PATH` |
| `SCENARIO_COMPILER_TEMPLATES` | folders of templates, looked in after those of `--templates` |
| `CARLA_ROOT` | CARLA's folder: its maps in `CarlaUE4/Content/Carla/Maps/OpenDrive`; \
at last come the maps of this program |
| `SCENARIO_COMPILER_CACHE` | folder for read maps, which belongs to the user alone, else \
`scenario-compiler` in `$XDG_CACHE_HOME` or `~/.cache` |
"""


@dataclass(frozen=True)
class _Row:
    """An argument as the page shows it: how it is written, and what it is; both as Markdown."""

    spelling: str
    text: str
    is_option: bool


@dataclass(frozen=True)
class _Command:
    """A command as the page shows it: its words, what it does, its arguments, what excludes what."""

    name: str
    text: str
    rows: tuple[_Row, ...]
    exclusions: tuple[str, ...]


def commands_page() -> str:
    """Return the page on all commands: exit codes, diagnostics, environment, then each command with its arguments."""
    commands = list(_commands(make_parser(), ""))
    counts = Counter(row for command in commands for row in command.rows if row.is_option)
    shared = [row for row in counts if counts[row] >= SHARED_BY]
    parts = [_HEAD, "## Options of several commands\n", _table(shared)]
    parts.append("In the tables below, what must be given is bold.\n")
    parts += [_section(command, shared) for command in commands]
    return "\n".join(parts)


def _commands(parser: argparse.ArgumentParser, before: str) -> Iterator[_Command]:
    """Yield the commands below a parser, those of a group in place of the group."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            told = {one.dest: one.help or "" for one in action._get_subactions()}
            for name, inner in action.choices.items():
                if any(isinstance(one, argparse._SubParsersAction) for one in inner._actions):
                    yield from _commands(inner, f"{before}{name} ")
                else:
                    yield _command(inner, f"{before}{name}", told.get(name, ""))


def _command(parser: argparse.ArgumentParser, name: str, summary: str) -> _Command:
    actions = [one for one in parser._actions if not isinstance(one, argparse._HelpAction)]
    actions.sort(key=lambda one: bool(one.option_strings))
    texts = (summary, parser.description, parser.epilog)
    about = " ".join(_sentence(" ".join(text.split())) for text in dict.fromkeys(texts) if text)
    expand = parser._get_formatter()._expand_help
    rows = tuple(_row(one, expand(one) if one.help else "") for one in actions if one.help != argparse.SUPPRESS)
    return _Command(name, about, rows, tuple(_exclusions(parser)))


def _exclusions(parser: argparse.ArgumentParser) -> Iterator[str]:
    for group in parser._mutually_exclusive_groups:
        names = " and ".join(f"`{one.option_strings[-1]}`" for one in group._group_actions)
        yield f"One of {names} is given." if group.required else f"At most one of {names} is given."


def _row(action: argparse.Action, told: str) -> _Row:
    text = "; ".join(part for part in (" ".join(told.split()), *_notes(action, told)) if part)
    spelling = f"`{_spelling(action)}`"
    is_needed = action.required and action.nargs != "*"
    return _Row(f"**{spelling}**" if is_needed else spelling, text, bool(action.option_strings))


def _notes(action: argparse.Action, told: str) -> Iterator[str]:
    """Yield what the help of an option may not say: that it can be given more than once, and its default."""
    if isinstance(action, argparse._AppendAction):
        yield "any number of times"
    elif action.nargs != 0 and action.default not in (None, "") and "left out" not in told and "default" not in told:
        yield f"`{action.default}` when left out"


def _spelling(action: argparse.Action) -> str:
    metavar = action.metavar if isinstance(action.metavar, str) else None
    value = metavar or ("|".join(map(str, action.choices)) if action.choices else action.dest.upper())
    if action.nargs in ("?", "*"):
        value = f"[{value}]" if action.nargs == "?" else f"[{value} ...]"
    if not action.option_strings:
        return value
    return action.option_strings[-1] if action.nargs == 0 else f"{action.option_strings[-1]} {value}"


def _section(command: _Command, shared: list[_Row]) -> str:
    own = [row for row in command.rows if row not in shared]
    others = [row.spelling.strip("*`").split()[0] for row in command.rows if row in shared]
    parts = [f"## {command.name}\n", f"{command.text}\n"]
    if own:
        parts.append(_table(own))
    parts += [f"{text}\n" for text in command.exclusions]
    if others:
        parts.append(f"And {', '.join(f'`{name}`' for name in others)}: see [above](#options-of-several-commands).\n")
    return "\n".join(parts)


def _table(rows: Iterable[_Row]) -> str:
    lines = (f"| {_cell(row.spelling)} | {_cell(row.text)} |" for row in rows)
    return "\n".join(["| argument | |", "|---|---|", *lines]) + "\n"


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


def _sentence(text: str) -> str:
    """Return a help text as a sentence."""
    return text[:1].upper() + text[1:] + ("" if text.endswith((".", "!", "?")) else ".")
