"""Tables for people to read."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TextIO


def print_table(headings: Sequence[str], rows: Sequence[Sequence[str]], file: TextIO | None = None) -> None:
    """Print a table that folds to the terminal's width, on stdout without a `file`; nothing without a row."""
    from rich import box
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Column, Table

    table = Table(*(Column(one, overflow="fold") for one in headings), box=box.SIMPLE_HEAD, pad_edge=False)
    for row in rows:
        table.add_row(*map(escape, row))
    if rows:
        Console(file=file).print(table)
