"""Text from files and file names, made safe to print: on a terminal, in a log, in the log of a build service.

A file of another author may hold escape sequences that rewrite a terminal, marks that turn the direction of writing,
line breaks, and lines that GitHub's runner or Azure Pipelines take for commands. They are shown as escapes.
"""

from __future__ import annotations

import re
import unicodedata

_HIDDEN = ("Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp")
"""Unicode's categories of characters that have no picture of their own (Unicode Standard, table 4-4)."""

_COMMAND = re.compile(r"^\s*:(?=:)|#(?=#[\w-]*\[)")
"""What a build service takes for a command: `::name` where a line begins (GitHub's runner, ActionCommand.cs),
`##[name]` and `##vso[name]` anywhere in it (its older form, and Azure Pipelines)."""


def legible(text: str) -> str:
    """Return a text with each character that would not be seen, a line break too, as the escape that Python has."""
    return text if text.isprintable() else "".join(map(_shown, text))


def legible_line(text: str) -> str:
    """Return a text as one line that no build service takes for a command."""
    return _COMMAND.sub(lambda found: found[0][:-1] + f"\\x{ord(found[0][-1]):02x}", legible(text))


def legible_json(text: str) -> str:
    """Return a JSON document with what would not be seen, or would be taken for a command, escaped as JSON does it."""
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
