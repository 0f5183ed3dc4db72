"""Texts as cells of CSV files that a spreadsheet displays but does not execute.

A spreadsheet treats a cell that begins with =, +, -, @, a tab or a line break as a formula, which may call programs
(OWASP, "CSV Injection"). Such a text is written with an apostrophe before it, which marks text; numbers are not.
"""

from __future__ import annotations

import re

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
_FORMULA = re.compile(r"'*[=+\-@\t\r\n]")


def text_cell(text: str) -> str:
    """Return a text as the content of a cell: with an apostrophe before it if a spreadsheet would execute it."""
    return f"'{text}" if _FORMULA.match(text) and not _NUMBER.fullmatch(text) else text


def cell_text(cell: str) -> str:
    """Return the text of a cell: the inverse of `text_cell`."""
    return cell[1:] if cell.startswith("'") and _FORMULA.match(cell[1:]) else cell
