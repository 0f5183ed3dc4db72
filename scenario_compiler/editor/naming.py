"""The declaration and all uses of a name in the files of a workspace, and renaming it."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from scenario_compiler.editor.analysis import IN_A_FILE, Analysis, Mention, Symbol
from scenario_compiler.editor.draft import Tag
from scenario_compiler.vocabulary.word import ENTITY_ID, IDENTIFIER

PATTERNS = {
    "parameter": IDENTIFIER,
    "template": IDENTIFIER,
    "entity": ENTITY_ID,
    "event": ENTITY_ID,
    "part": ENTITY_ID,
    "spawn_point": ENTITY_ID,
    "traffic": ENTITY_ID,
}
"""The allowed new names by kind; other kinds allow any text without quotes and spaces."""

ANY_NAME = r"[^\s\"'<>&$]+"


class CannotRenameError(Exception):
    """A thing cannot be renamed; the message gives the reason."""


@dataclass(frozen=True, slots=True)
class Occurrence:
    """A mention of a symbol in a file."""

    analysis: Analysis
    mention: Mention


def uses_of(symbol: Symbol, files: Iterable[Analysis]) -> Iterator[Occurrence]:
    """Yield every mention of a symbol in some files, including its declaration."""
    for analysis in files:
        if _may_name(analysis.draft.text, symbol.name):
            seen = set()
            for mention in analysis.mentions:
                if mention.symbol == symbol and (mention.start, mention.end) not in seen:
                    seen.add((mention.start, mention.end))
                    yield Occurrence(analysis, mention)


def _may_name(text: str, name: str) -> bool:
    """Return whether a name can be in a text: as it is, with other white space, or with character references."""
    return name in text or name.split() != [name] or "&" in text


def renaming(symbol: Symbol, name: str, files: Iterable[Analysis]) -> list[Occurrence]:
    """Return the mentions of a symbol that a new name replaces.

    Raises:
        CannotRenameError: It is declared in none of the files, or the new name is not legal or is already used.
    """
    files = list(files)
    home = next((one for one in files if os.path.realpath(one.path) == symbol.file), None)
    if home is None:
        raise CannotRenameError(f"'{symbol.name}' is declared in {symbol.file}, which is not among the files open here")
    if not re.fullmatch(PATTERNS.get(symbol.kind, ANY_NAME), name):
        raise CannotRenameError(f"'{name}' cannot be the new name: {_wanted(symbol.kind)}")
    if symbol.kind == "parameter" and name in ("template", "id"):
        raise CannotRenameError(f"<use> needs the attribute '{name}' for itself")
    if name != symbol.name and _is_taken(symbol, name, home):
        raise CannotRenameError(f"another thing is called '{name}' there already")
    return list(uses_of(symbol, files))


def _wanted(kind: str) -> str:
    allowed = {
        IDENTIFIER: "use letters, digits and _, and no digit at the start",
        ENTITY_ID: "letters, digits, _ and -, a letter first",
    }
    return allowed.get(PATTERNS.get(kind, ""), "no spaces, quotes or brackets")


def _is_taken(symbol: Symbol, name: str, home: Analysis) -> bool:
    """Return whether another thing of the same kind already has a name where a symbol is known."""
    offset = home.draft.offset_at(symbol.line - 1, symbol.column - 1)
    around: Tag | None = home.draft.root if symbol.kind in IN_A_FILE else home.part_of(home.draft.innermost(offset))
    kinds = ("entity", "part", "traffic") if symbol.kind in ("entity", "part", "traffic") else (symbol.kind,)
    if around is None:
        return False
    return any(written == name for kind in kinds for written, _, _ in home.declared_in(around, kind))
