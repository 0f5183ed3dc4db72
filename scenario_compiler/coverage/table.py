"""A table of coverage, and its form as Markdown."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace


@dataclass(frozen=True, slots=True)
class Table:
    """The covered parts of a language.

    Attributes:
        language: Short name, the key in `TABLES`.
        title: What the table lists.
        columns: Heads of the columns, as short as fits a screen.
        rows: Texts, as many in each row as there are columns.
    """

    language: str
    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]

    def with_column(self, head: str, texts: Sequence[str]) -> Table:
        """Return the table with one more column, which has a text for each row."""
        rows = tuple((*row, text) for row, text in zip(self.rows, texts, strict=True))
        return replace(self, columns=(*self.columns, head), rows=rows)

    def records(self) -> list[dict[str, str]]:
        """Return each row as column and text."""
        return [dict(zip(self.columns, row, strict=True)) for row in self.rows]


def as_markdown(table: Table) -> str:
    """Return a table as a section of a page."""
    lines = [f"## {table.title}", "", _line(table.columns), _line(["---"] * len(table.columns))]
    return "\n".join([*lines, *map(_line, table.rows)]) + "\n"


def _line(texts: Sequence[str]) -> str:
    return "| " + " | ".join(_cell(text) for text in texts) + " |"


def _cell(text: str) -> str:
    """Return a text as a cell: names of elements as code, bars escaped."""
    return re.sub(r"<\w+>", r"`\g<0>`", text.replace("|", "\\|"))
