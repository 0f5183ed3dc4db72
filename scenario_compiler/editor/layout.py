"""Formatting: indents a file's lines by the nesting of its elements, and keeps everything else in a line.

Elements are indented by two spaces for each element around them. Further lines of a start tag are aligned with its
first attribute, and lines of a comment move with its first line. Lines inside values, and texts between elements, are
unchanged. Spaces at the ends of lines are removed, and one of several consecutive empty lines is kept.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.document import parse_document
from scenario_compiler.editor.draft import Draft, Tag

STEP = 2
"""Number of spaces by which an element is indented relative to the one around it."""


@dataclass(frozen=True, slots=True)
class Edit:
    """A part of a text, by offsets, and its replacement."""

    start: int
    end: int
    text: str


def layout_edits(draft: Draft) -> list[Edit]:
    """Return the edits that format a text; none if it is formatted already or is not well-formed."""
    if parse_document(draft.content, "", Diagnostics()) is None:
        return []
    edits: list[Edit] = []
    moved = 0
    for line, start in enumerate(draft.line_starts):
        text = draft.line_text(line)
        stripped = text.strip(" \t")
        if _is_kept(draft, start):
            continue
        if not stripped:
            edits += _emptied(draft, line)
            continue
        first = start + len(text) - len(text.lstrip(" \t"))
        within = next((one for one in draft.passed_over if one[0] < first < one[1]), None)
        if within is not None:
            indent = max(0, _width(text[: first - start]) + moved)
        else:
            indent = _indent(draft, first)
            moved = indent - _width(text[: first - start])
        if text[: first - start] != " " * indent:
            edits.append(Edit(start, first, " " * indent))
        end = start + len(text)
        trailing = end - len(text) + len(text.rstrip(" \t"))
        if trailing < end and not _is_kept(draft, end):
            edits.append(Edit(trailing, end, ""))
    return edits


def _emptied(draft: Draft, line: int) -> list[Edit]:
    """Return the edits that remove a line's spaces, or an empty line after another one or at the end."""
    start, text = draft.line_starts[line], draft.line_text(line)
    if line + 1 >= len(draft.line_starts):
        return [Edit(start, start + len(text), "")] if text else []
    if line > 0 and not draft.line_text(line - 1).strip(" \t"):
        return [Edit(start, draft.line_starts[line + 1], "")]
    return [Edit(start, start + len(text), "")] if text else []


def _is_kept(draft: Draft, offset: int) -> bool:
    """Return whether white space at an offset is part of a value, of a text or of something other than a comment."""
    if any(start < offset < end and not draft.text.startswith("<!--", start) for start, end in draft.passed_over):
        return True
    tag = draft.innermost(offset)
    if any(one.has_value and one.value_start <= offset <= one.value_end for one in tag.attributes):
        return True
    return tag.parent is not None and tag.head_end <= offset <= tag.end_start and _holds_text(draft, tag)


def _holds_text(draft: Draft, tag: Tag) -> bool:
    """Return whether an element contains text other than white space between its tags."""
    at = tag.head_end
    inside = [(one.start, one.end) for one in tag.children]
    skipped = [one for one in draft.passed_over if tag.head_end <= one[0] < tag.end_start]
    inside += [one for one in skipped if not draft.text.startswith("<![CDATA[", one[0])]
    for start, end in [*sorted(inside), (tag.end_start, tag.end_start)]:
        if start >= at and draft.text[at:start].strip():
            return True
        at = max(at, end)
    return False


def _indent(draft: Draft, first: int) -> int:
    """Return the indentation of the line whose first character has this offset."""
    tag = draft.innermost(first)
    if tag.parent is not None and tag.start < first < tag.head_end:
        return _tag_indent(draft, tag) + _first_attribute(draft, tag)
    depth = sum(1 for _ in tag.ancestors())
    if tag.parent is not None and first == tag.end_start:
        depth -= 1
    return STEP * depth


def _tag_indent(draft: Draft, tag: Tag) -> int:
    """Return the indentation of an element's start tag after formatting."""
    line = draft.line_of(tag.start)
    text = draft.line_text(line)
    before = text[: tag.start - draft.line_starts[line]]
    first = draft.line_starts[line] + len(text) - len(text.lstrip(" \t"))
    indent = _indent(draft, first) if not before.strip() or first < tag.start else 0
    return indent + len(before.lstrip(" \t"))


def _first_attribute(draft: Draft, tag: Tag) -> int:
    """Return the distance of an element's first attribute from its bracket; two steps if it is on a later line."""
    if tag.attributes and draft.line_of(tag.attributes[0].start) == draft.line_of(tag.start):
        return tag.attributes[0].start - tag.start
    return 2 * STEP


def _width(space: str) -> int:
    return len(re.sub(r"\t", " " * 4, space))
