"""The command line, and the only package that prints.

Exit codes: 0 success (warnings are allowed), 1 the input, the controller or the world is at fault or a run broke off,
2 wrong use, 3 criteria failed under --strict, 130 interrupted. Each group of commands is one module: `add(commands)`
declares the commands, and other functions carry them out.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from functools import cache
from importlib import import_module
from typing import Any, NoReturn

from scenario_compiler.cli.options import WRONG_USE, WrongUse, existing_target, reason_of
from scenario_compiler.cli.terminal import complain, flush_streams, prepare_streams, put, put_raw
from scenario_compiler.diagnostics import suggestion
from scenario_compiler.legible import legible
from scenario_compiler.resources import templates_from
from scenario_compiler.trust import ConfigurationError

GROUPS = {
    "validate": ("validate",),
    "run": ("compile", "run"),
    "live": ("drive",),
    "study": ("study",),
    "report": ("report", "frame", "export-run"),
    "compare": ("compare",),
    "sweep": ("sweep",),
    "authoring": ("list", "new", "preview", "convert"),
    "library": ("library",),
    "export": ("export",),
    "maps": ("map",),
    "calibrate": ("calibrate",),
    "explain": ("explain",),
    "coverage": ("coverage",),
    "editor": ("schema", "lsp"),
    "carla": ("serve-carla",),
}
"""The modules of this package that declare commands, each with its commands, in the order in which the help lists them.

A module is imported only for one of its commands, or for a command line that needs all of them, such as `--help`.
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command and return its exit code.

    Args:
        arguments: The words of the command line after the program's name; None takes those of this process.

    Raises:
        SystemExit: The arguments cannot be parsed, or they ask for help or the version.
    """
    prepare_streams()
    words = sys.argv[1:] if arguments is None else list(arguments)
    if "" in words:  # as a path it would be the current folder
        complain("an argument is empty, as of a variable of the shell that is not set")
        return WRONG_USE
    code = _carried_out(words)
    try:
        flush_streams()
    except OSError as fault:
        complain(reason_of(fault))
        code = WRONG_USE
    return code


def _carried_out(words: Sequence[str]) -> int:
    """Return the exit code of a command, after a line on what kept it from its work."""
    try:
        options = make_parser(words[0] if words else "").parse_args(words)
        with templates_from([one for one in getattr(options, "templates", ()) if one is not None]):
            if "target" in options:
                options.target = existing_target(options.target)
            code: int = options.command(options)
    except (WrongUse, ConfigurationError) as fault:
        complain(fault)
        code = WRONG_USE
    except OSError as fault:
        complain(reason_of(fault))
        code = WRONG_USE
    return code


class HelpFormatter(argparse.HelpFormatter):
    """Adds to the help of an option whether it may be repeated, or its default, unless the text states it."""

    def _get_help_string(self, action: argparse.Action) -> str:
        text = action.help or ""
        if isinstance(action, argparse._AppendAction):
            return f"{text} (may be repeated)"
        if action.nargs == 0 or action.default in (None, "", argparse.SUPPRESS) or "default" in text:
            return text
        return f"{text} (default: %(default)s)"


class Subcommands(argparse._SubParsersAction):  # type: ignore[type-arg]  # it is generic in typeshed only
    """Makes each command's summary the description in its own help too, unless it has a longer one."""

    def add_parser(self, name: str, **settings: Any) -> argparse.ArgumentParser:
        """Add the parser of a command; `help` is its summary, `description` the text in its own help."""
        settings.setdefault("description", as_sentence(settings["help"]))
        parser: argparse.ArgumentParser = super().add_parser(name, **settings)
        return parser


class Parser(argparse.ArgumentParser):
    """A parser whose error messages show control characters of the arguments as escapes."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(**{"formatter_class": HelpFormatter, **settings})
        self.register("action", "parsers", Subcommands)
        self.set_defaults(default_of=self.get_default)

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> tuple[Any, list[str]]:
        """Return the arguments; unknown ones are an error of the command to which they were given."""
        found, unknown = super().parse_known_args(args, namespace)
        option = next((one.partition("=")[0] for one in unknown if one.startswith("-")), "")
        if option:
            self.error(f"there is no option '{option}'{self._likely(option)}")
        if unknown:
            self.error(f"unrecognized arguments: {' '.join(unknown)}")
        return found, unknown

    def _likely(self, option: str) -> str:
        """Return the likely spelling of an unknown option; dashes, which all options have, make none alike."""
        import difflib  # only a mistake needs it

        names = {one.lstrip("-"): one for one in self._option_string_actions}
        near = difflib.get_close_matches(option.lstrip("-"), names, n=1)
        return suggestion(option, [names[one] for one in near])

    def error(self, message: str) -> NoReturn:
        """Print what is wrong with the arguments and exit with 2."""
        super().error(legible(message))

    def print_help(self, file: Any = None) -> None:
        """Print the help; raise OSError if it cannot be written, which argparse itself ignores."""
        put_raw(self.format_help().removesuffix("\n"), file)

    def exit(self, status: int = 0, message: str | None = None) -> NoReturn:
        """Exit after all output has been written; raise OSError if it cannot be written."""
        try:
            super().exit(status, message)
        finally:
            flush_streams()


def as_sentence(text: str) -> str:
    """Return a help text with a capital letter and a full stop."""
    return text[:1].upper() + text[1:] + ("" if text.endswith((".", "!", "?")) else ".")


class ShowVersion(argparse.Action):
    """Prints the version and exits; the version is looked up only when it is asked for."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> NoReturn:
        """Print the name and the version of the program."""
        from importlib.metadata import version

        put(f"{parser.prog} {version('scenario-compiler')}")
        parser.exit()


@cache
def make_parser(command: str = "") -> argparse.ArgumentParser:
    """Return a parser of the commands of a command's module; of all commands if no command has this name."""
    parser = Parser(
        prog="scenario-compiler",
        description="Compile, check and run conflicts for automated driving.",
        epilog="An extra, such as 'study', is installed by: pip install 'scenario-compiler[study]'",
    )
    parser.add_argument("--version", action=ShowVersion, nargs=0, help="print the version and exit")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    chosen = [module for module, names in GROUPS.items() if command in names]
    for module in chosen or GROUPS:
        import_module(f"{__name__}.{module}").add(commands)
    return parser
