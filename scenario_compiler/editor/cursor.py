"""The place of a cursor in a draft: after a bracket, in an attribute's name, in a value, or between elements."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal

from scenario_compiler.editor.draft import Draft, Tag

CursorPlace = Literal["element", "attribute", "value", "end"]


@dataclass(frozen=True, slots=True)
class Cursor:
    """A place in a draft at which something can be written.

    Attributes:
        place: What can be written: an element, an attribute's name, an attribute's value, an end tag.
        offset: The offset.
        tag: The element concerned: the parent of an element, or the owner of the attribute or end tag.
        start: Offset of the name or value that contains the cursor.
        end: Offset after it.
        attribute: Name of the attribute whose value it is.
        value_start: Offset at which the value begins.
        bracket: Whether an opening bracket is already before the name.
        written: The unfinished element whose name contains the cursor.
        rest: The text after the name on its line.
    """

    place: CursorPlace
    offset: int
    tag: Tag
    start: int
    end: int
    attribute: str = ""
    value_start: int = 0
    bracket: bool = False
    written: Tag | None = None
    rest: str = ""


def cursor_at(draft: Draft, offset: int) -> Cursor | None:
    """Return the cursor at an offset; None if nothing can be completed, as in a comment or after a value."""
    if any(start < offset < end or (offset == end == len(draft.text)) for start, end in draft.passed_over):
        return None
    tag = draft.innermost(offset)
    if tag.parent is not None and offset <= tag.head_end and not (tag.closed and offset == tag.head_end):
        return _in_start_tag(draft, tag, offset)
    before = draft.text[max(0, offset - 200) : offset]
    ending = re.search(r"</([^\s=\"'<>/]*)\Z", before)
    if ending is not None:
        rest = re.match(r"[^\s=\"'<>/]*>?", draft.text[offset:])
        end = offset + (0 if rest is None else rest.end())
        open_tag = tag if tag.parent is not None else None
        return None if open_tag is None else Cursor("end", offset, open_tag, offset - len(ending.group(1)) - 1, end)
    if offset > tag.end_start >= 0 and tag.ended:
        return None
    word = re.search(r"[A-Za-z_][A-Za-z0-9_]*\Z", before)
    return Cursor("element", offset, tag, offset - (0 if word is None else len(word.group())), offset)


def _in_start_tag(draft: Draft, tag: Tag, offset: int) -> Cursor | None:
    name_end = tag.start + 1 + len(tag.name)
    if offset <= name_end:
        rest = draft.line_text(draft.line_of(offset))[name_end - draft.line_starts[draft.line_of(offset)] :]
        parent = tag.parent or tag
        finished = rest.strip() if tag.attributes or tag.closed else ""
        return Cursor("element", offset, parent, tag.start + 1, name_end, bracket=True, written=tag, rest=finished)
    for one in tag.attributes:
        if one.has_value and one.value_start <= offset <= one.value_end:
            return Cursor("value", offset, tag, one.value_start, one.value_end, one.name, one.value_start)
        if one.start <= offset <= one.start + len(one.name):
            end = one.start + len(one.name)
            return Cursor("attribute", offset, tag, one.start, end, rest=draft.text[end : end + 1])
    if draft.text[offset - 1 : offset].isspace():
        return Cursor("attribute", offset, tag, offset, offset)
    return None
