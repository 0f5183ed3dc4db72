"""The page on the commands (docs/commands.md), made from the command line's parsers."""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from scenario_compiler.cli import make_parser

SHARED_BY = 3
"""Number of commands from which on an identical option is described once for all of them."""

_HEAD = """# Commands

This page is made from the program's help by `make generate`; `scenario-compiler COMMAND --help` shows the same text.
`python -m scenario_compiler` starts the same program.

`FILE` is a conflict, an OpenSCENARIO file or a file of the AISA toolkit. `FILE#name` is one scenario of a file with
several scenarios, `NAME` is a conflict of the library (`list` shows them), and `PLAN.json` is a plan that `compile` has
written.

## Exit codes

| code | meaning |
|---|---|
| 0 | success; there may have been warnings |
| 1 | the input, the controller or the world is at fault, or a run broke off; the diagnostics say why. \
`compare`: the runs or sweeps differ. `sweep`: all variants broke off, or the sweep itself did. |
| 2 | wrong use: an unknown option, no `#name` for a file with several scenarios, a folder that is not empty, a file \
or an output that cannot be written |
| 3 | `run --strict`: a criterion failed; `sweep --pass-rate`: too few variants passed |
| 130 | interrupted by Ctrl-C or SIGTERM: one line reports it, and no file is left half written; `run` keeps \
what it has recorded, a sweep its finished variants for `--resume`. `serve-carla` ends with 0. |

## Diagnostics

As text, diagnostics go to stderr, so that stdout has only results. In every other format of `--format` they
go to stdout, and all other output goes to stderr. Messages that cannot be written to stderr, for example on a full
disk, do not stop a command.
`explain CODE` explains a code and says what to do about it. At most 100 diagnostics of the same file, code and severity
are listed; the rest are counted. Control characters, characters that change the direction of writing, and lines that a
build service would take for a command are never printed, even if files or their names contain them: they are shown as
escapes.

`--error CODE` turns warnings with this code into errors, even if a file allows them with `<allow>`; `--error all` does
so for all warnings that no file allows. `--allow CODE` leaves out warnings with this code; errors stay. `--strict`
differs between commands: `validate --strict` treats every warning as an error (exit code 1); `run --strict` runs the
scenario in any case, and exits with 3 if a criterion fails.

`validate` of an OpenSCENARIO or OpenDRIVE file exits with 1 if and only if the file is not well-formed or its structure
is not that of its own version; everything else that it finds is a warning. `run` reports an error for whatever it
cannot use.

## Code that files name

A scenario may name code of its author's as the controller: `package.module:Class` or `file.py:Class`. Reading a
file never runs that code: `validate`, `compile`, `export`, `preview` and `list` check the spelling of the name, and
warn that the controller's properties were not checked (SC507). `run`, `sweep`, `drive` and `study` refuse the code with
the same diagnostic unless you trust it. You can trust code in three ways:

- `--controller NAME` trusts that controller, and uses it in place of the scenario's;
- `--trust NAME|FILE` trusts a class (`our_lab.steering:Mine`), a module or a package with everything in it (`our_lab`),
  a Python file (`steering.py`), or a scenario file with all the code that it names;
- the list in your configuration file trusts code permanently. The file is `scenario-compiler/config.toml` in
  `$XDG_CONFIG_HOME`, on Windows in `%APPDATA%`, else in `~/.config`. A file beside a scenario is never read. Write the
  absolute paths of Python files.

```toml
trust = ["our_lab.steering", "/home/me/steering.py"]
```

A module that the command line names is looked for in the current folder and in the scenario's folder too; a module that
only a file names is not. The relative path of a Python file starts from the current folder on the command line, and
from the scenario's folder in a scenario. The same holds for a path in a property that the controller's `Params` declare
as a `pathlib.Path`. In a plan, the relative path of a Python file starts from the plan's folder; if it leads to no file
there, it means the file of the same name that you trust, as in `run plan.json --trust ../steering.py`.

## Files

A command writes a file as a whole or not at all, and never overwrites a file that it reads. Folders
for output must be new or empty, the file of `new` must not exist yet, and those of `export` must not exist with another
content, unless `--force` is given (for `sweep`: `--resume`, which continues in the folder of the same sweep; `study`
continues in the folder of the same study in any case). Other commands replace the file that `-o` names.
[run-folder.md](run-folder.md) describes the folder of a run, [sweeps.md](sweeps.md) that of a sweep.

## Environment

A map is looked for in these places, in this order: beside the file that names it, in the folders of `--maps`, in those
of `SCENARIO_COMPILER_MAPS`, in `CARLA_ROOT`, and among the packaged maps. A template is looked for in the file that
uses it and in the files that this file includes, in the folders of `--templates`, in those of
`SCENARIO_COMPILER_TEMPLATES`, in the library, and in installed packages ([sharing templates](sharing-templates.md)).

| variable | meaning |
|---|---|
| `SCENARIO_COMPILER_MAPS` | folders of maps, separated as in `PATH` |
| `SCENARIO_COMPILER_TEMPLATES` | folders of templates, separated as in `PATH` |
| `CARLA_ROOT` | CARLA's folder; its maps are in `CarlaUE4/Content/Carla/Maps/OpenDrive` |
| `SCENARIO_COMPILER_CACHE` | cache folder for maps that have been read, which only the user can write; \
by default `scenario-compiler` in `$XDG_CACHE_HOME` or `~/.cache` |
| `MPLCONFIGDIR` | folder of Matplotlib, which draws the pictures of reports; if neither it nor the home folder can be \
written, Matplotlib prints two lines about it on stderr and lists the fonts again in every process |
"""


@dataclass(frozen=True)
class _Row:
    """An argument on the page: its spelling and its description, both as Markdown."""

    spelling: str
    text: str
    is_option: bool


@dataclass(frozen=True)
class _Command:
    """A command on the page: its name, its description, its arguments, and which of them exclude each other."""

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
    parts.append("In the tables below, required arguments are bold.\n")
    parts += [_section(command, shared) for command in commands]
    return "\n".join(parts)


def _commands(parser: argparse.ArgumentParser, before: str) -> Iterator[_Command]:
    """Yield the commands of a parser; a group such as `map` is replaced by its commands."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for name, inner in action.choices.items():
                if any(isinstance(one, argparse._SubParsersAction) for one in inner._actions):
                    yield from _commands(inner, f"{before}{name} ")
                else:
                    yield _command(inner, f"{before}{name}")


def _command(parser: argparse.ArgumentParser, name: str) -> _Command:
    actions = [one for one in parser._actions if not isinstance(one, argparse._HelpAction)]
    actions.sort(key=lambda one: bool(one.option_strings))
    about = parser.description or ""
    expand = parser._get_formatter()._expand_help
    rows = tuple(_row(one, expand(one)) for one in actions if one.help != argparse.SUPPRESS)
    return _Command(name, about, rows, tuple(_exclusions(parser)))


def _exclusions(parser: argparse.ArgumentParser) -> Iterator[str]:
    for group in parser._mutually_exclusive_groups:
        names = " and ".join(f"`{one.option_strings[-1]}`" for one in group._group_actions)
        yield f"Exactly one of {names} must be given." if group.required else f"At most one of {names} can be given."


def _row(action: argparse.Action, text: str) -> _Row:
    spelling = f"`{_spelling(action)}`"
    is_needed = action.required and action.nargs != "*"
    return _Row(f"**{spelling}**" if is_needed else spelling, text, bool(action.option_strings))


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
        parts.append(f"[Shared options](#options-of-several-commands): {', '.join(f'`{name}`' for name in others)}.\n")
    return "\n".join(parts)


def _table(rows: Iterable[_Row]) -> str:
    lines = (f"| {_cell(row.spelling)} | {_cell(row.text)} |" for row in rows)
    return "\n".join(["| argument | meaning |", "|---|---|", *lines]) + "\n"


def _cell(text: str) -> str:
    return text.replace("|", "\\|")
