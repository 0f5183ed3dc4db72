"""Makes text from files and file names safe to print on a terminal, in a log, or in the log of a build service.

A file of another author may contain escape sequences that rewrite a terminal, marks that change the direction of
writing, line breaks, and lines that GitHub's runner or Azure Pipelines interpret as commands. They are shown as
escapes.
"""

from __future__ import annotations

import re
import unicodedata

_HIDDEN = ("Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp")
"""Unicode's categories of characters that are not visible (Unicode Standard, table 4-4)."""

_COMMAND = re.compile(r"^\s*:(?=:)|#(?=#[\w-]*\[)")
"""Text that a build service interprets as a command: `::name` where a line begins (GitHub's runner, ActionCommand.cs),
`##[name]` and `##vso[name]` anywhere in it (its older form, and Azure Pipelines)."""


def legible(text: str) -> str:
    """Return a text with every invisible character, including line breaks, as its Python escape."""
    return text if text.isprintable() else "".join(map(_shown, text))


def legible_line(text: str) -> str:
    """Return a text as one line that no build service interprets as a command."""
    return _COMMAND.sub(lambda found: found[0][:-1] + f"\\x{ord(found[0][-1]):02x}", legible(text))


def legible_json(text: str) -> str:
    """Return a JSON document in which invisible characters and commands of build services are escaped as in JSON."""
    safe = text if text.replace("\n", "").isprintable() else "".join(map(_shown_in_json, text))
    return re.sub(r"#(?=#[\w-]*\[)", r"\\u0023", safe)


def _shown(character: str) -> str:
    if unicodedata.category(character) not in _HIDDEN:
        return character
    return character.encode("unicode_escape", "surrogatepass").decode("ascii")


def _shown_in_json(character: str) -> str:
    if character == "\n" or unicodedata.category(character) not in _HIDDEN:
        return character
    units = character.encode("utf-16-be", "surrogatepass")
    return "".join(f"\\u{units[at]:02x}{units[at + 1]:02x}" for at in range(0, len(units), 2))
