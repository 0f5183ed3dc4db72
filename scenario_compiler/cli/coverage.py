"""`coverage`: which parts of each language are read, executed and exported."""

from __future__ import annotations

import argparse
import json
import sys
from typing import TYPE_CHECKING

from scenario_compiler.cli.options import FINE, Commands, WrongUse
from scenario_compiler.cli.terminal import put, put_raw, put_rendered
from scenario_compiler.coverage import TABLES
from scenario_compiler.diagnostics import suggestion

if TYPE_CHECKING:
    from scenario_compiler.coverage.table import Table


def add(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser("coverage", help="show which parts of each language are read, executed and exported")
    parser.add_argument("languages", nargs="*", metavar="LANGUAGE", help=f"{', '.join(TABLES)}; all by default")
    parser.add_argument("--format", choices=("text", "json"), default="text", help="format of the tables")
    parser.set_defaults(command=coverage_command)


def coverage_command(options: argparse.Namespace) -> int:
    """Print the coverage tables of languages."""
    from scenario_compiler.coverage import table_of

    for language in options.languages:
        if language not in TABLES:
            raise WrongUse(f"there is no language '{language}'{suggestion(language, TABLES)}")
    tables = [table_of(language) for language in options.languages or TABLES]
    if options.format == "json":
        put_raw(json.dumps({table.language: table.records() for table in tables}, indent=1))
        return FINE
    for table in tables:
        _print(table)
    return FINE


def _print(table: Table) -> None:
    """Print a table, folded to the width of a terminal; without a terminal each row is one line, for programs."""
    if sys.stdout.isatty():
        _print_folded(table)
        return
    lines = [table.columns, *table.rows]
    widths = [max(len(line[k]) for line in lines) for k in range(len(table.columns))]
    put(table.title)
    for line in lines:
        put("  ".join(text.ljust(width) for text, width in zip(line, widths, strict=True)).rstrip())


def _print_folded(table: Table) -> None:
    from rich.table import Table as Grid
    from rich.text import Text

    grid = Grid(title=table.title, title_justify="left", box=None, pad_edge=False)
    for column in table.columns:
        grid.add_column(column, overflow="fold")
    for row in table.rows:
        grid.add_row(*map(Text, row))
    put_rendered(grid)
