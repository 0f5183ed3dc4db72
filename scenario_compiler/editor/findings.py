"""The findings for a text in an editor: those of `validate` for a file with this text.

A text that is not well-formed has only the finding that it is not. While it is being written, the findings for the
previous text are still shown wherever that text is unchanged.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from scenario_compiler.diagnostics import Diagnostic, Place, Severity
from scenario_compiler.document import MALFORMED
from scenario_compiler.editor.draft import Draft
from scenario_compiler.files import unsaved
from scenario_compiler.validation import validate_files


@dataclass(frozen=True, slots=True)
class Note:
    """Another place to which a finding refers: its file, its line and column counted from 0, and a text."""

    file: str
    line: int
    column: int
    length: int
    message: str


@dataclass(frozen=True, slots=True)
class Finding:
    """A fault in a text.

    Attributes:
        start: Offset of the fault.
        end: Offset after it.
        code: Id of the diagnostic's code.
        severity: Its severity.
        message: The message and the hint.
        notes: Other places that belong to it.
    """

    start: int
    end: int
    code: str
    severity: Severity
    message: str
    notes: tuple[Note, ...] = ()


def findings(
    path: str, draft: Draft, held: Mapping[str, bytes] | None = None, maps: Sequence[Path] = ()
) -> list[Finding]:
    """Return the findings for a text.

    Args:
        path: The text's file.
        draft: The text.
        held: Contents of other files that an editor has open, by their real paths.
        maps: Folders in which maps are looked for first.
    """
    own = os.path.realpath(path)
    with unsaved({**(held or {}), own: draft.content}):
        (found,) = validate_files([Path(path)], maps)
    return [_finding(one, own, draft) for one in found]


def carried_over(before: Sequence[Finding], old: str, new: str) -> Iterator[Finding]:
    """Yield the findings for an old text in the parts that are unchanged in the new one, with their places there."""
    first = _alike(old, new)
    last = min(min(len(old), len(new)) - first, _alike(old[::-1], new[::-1]))
    moved = len(new) - len(old)
    for one in before:
        if one.end < first:
            yield one
        elif one.start > len(old) - last:
            yield Finding(one.start + moved, one.end + moved, one.code, one.severity, one.message, one.notes)


def _alike(one: str, other: str) -> int:
    """Return the number of equal characters at the beginning of two texts."""
    least, most = 0, min(len(one), len(other))
    while least < most:
        middle = (least + most + 1) // 2
        least, most = (middle, most) if one[least:middle] == other[least:middle] else (least, middle - 1)
    return least


def while_written(found: Sequence[Finding], before: Iterable[Finding]) -> list[Finding]:
    """Return the findings for a text, with those `before` if it is not well-formed now."""
    malformed = any(one.code == MALFORMED.id for one in found)
    return [*found, *(one for one in before if one.code != MALFORMED.id)] if malformed else list(found)


def _finding(one: Diagnostic, own: str, draft: Draft) -> Finding:
    """Return a finding at its place in a text, or at the place of the use or include that brought it in."""
    places = [one.place, *one.chain()]
    here = next((index for index, place in enumerate(places) if os.path.realpath(place.file) == own), None)
    start, end = (0, 0) if here is None else _stretch(places[here], draft)
    notes = [_note(place, "here") for place in places[: 0 if here is None else here]]
    notes += [_note(place, "in this use") for place in places[1 if here is None else here + 1 :]]
    notes += [_note(other.place, other.message) for other in one.related]
    message = f"{one.message} ({one.hint})" if one.hint else one.message
    return Finding(start, end, one.code.id, one.severity, message, tuple(note for note in notes if note.file))


def _stretch(place: Place, draft: Draft) -> tuple[int, int]:
    """Return the offsets of a place, or those of its line's text if the column is not known."""
    if place.line <= 0:
        return 0, 0
    line = place.line - 1
    if place.column <= 0:
        text = draft.line_text(line)
        begin = draft.offset_at(line, len(text) - len(text.lstrip()))
        return begin, draft.offset_at(line, len(text))
    begin = draft.offset_at(line, place.column - 1)
    return begin, min(begin + max(place.length, 1), len(draft.text))


def _note(place: Place, message: str) -> Note:
    return Note(place.file, max(place.line - 1, 0), max(place.column - 1, 0), max(place.length, 0), message)
