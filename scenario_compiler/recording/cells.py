"""Texts as cells of CSV files, which a spreadsheet shows but does not execute.

A spreadsheet takes a cell that begins with =, +, -, @, a tab or a line break for a formula, which may call programs
(OWASP, "CSV Injection"). Such a text gets an apostrophe before it, by which spreadsheets mark text; numbers do not.
"""

from __future__ import annotations

import re

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
_FORMULA = re.compile(r"'*[=+\-@\t\r\n]")


def text_cell(text: str) -> str:
    """Return a text as a cell holds it: one that a spreadsheet would run begins with an apostrophe."""
    return f"'{text}" if _FORMULA.match(text) and not _NUMBER.fullmatch(text) else text


def cell_text(cell: str) -> str:
    """Return the text that a cell holds: the inverse of `text_cell`."""
    return cell[1:] if cell.startswith("'") and _FORMULA.match(cell[1:]) else cell
