"""A tree of the tags and attributes of a file in an editor, with their positions, even if it is unfinished.

XML that is not well-formed also gets a tree: a start tag without its bracket ends where the next tag begins and has no
content, a value without its closing quote ends with its line, and an element without an end tag ends with the element
around it. The tree of a well-formed file is that of a parser. Offsets count characters of the text.
"""

from __future__ import annotations

import bisect
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property

from lxml import etree

from scenario_compiler.document import Document

MOST_DEPTH = 200
"""Greatest depth of elements that are read; the parser's own limit is 256."""

_NAME = re.compile(r"[^\s=\"'<>/!?&]+")
_SPACE = re.compile(r"\s*")
_VALUE = {'"': re.compile(r'[^"<]*'), "'": re.compile(r"[^'<]*")}
_UNFINISHED = re.compile(r"[^>\r\n<]*")
_END_TAG = re.compile(r"</([^\s=\"'<>/]*)[^<>]*>?")
_PASSED_OVER = (("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>"), ("<!", ">"))
_ENTITY = re.compile(r"&(?:(lt|gt|amp|quot|apos)|#(\d{1,7})|#x([0-9A-Fa-f]{1,6}));")
_ENTITIES = {"lt": "<", "gt": ">", "amp": "&", "quot": '"', "apos": "'"}
_XML_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_.\-]*")
_NOT_IN_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


@dataclass(slots=True)
class Attribute:
    """An attribute as written: its name, and its value between the quotes if it has one."""

    name: str
    start: int
    value_start: int = -1
    value_end: int = -1
    closed: bool = False

    @property
    def has_value(self) -> bool:
        """Whether an equals sign and an opening quote follow the name."""
        return self.value_start >= 0


@dataclass(slots=True)
class Tag:
    """An element as written.

    Attributes:
        name: Its name; empty if only the bracket is written.
        start: Offset of its `<`.
        head_end: Offset after the start tag.
        closed: Whether the start tag has its `>`.
        parent: The element around it; None for the whole text.
        attributes: In the order of the file.
        children: In the order of the file.
        end_start: Offset of the end tag's `<`; equal to `end` if there is no end tag.
        end: Offset after the element.
        ended: Whether it has an end tag, or needs none.
    """

    name: str
    start: int
    head_end: int = -1
    closed: bool = False
    parent: Tag | None = None
    attributes: list[Attribute] = field(default_factory=list)
    children: list[Tag] = field(default_factory=list)
    end_start: int = -1
    end: int = -1
    ended: bool = False

    def attribute(self, name: str) -> Attribute | None:
        """Return the first attribute with a name."""
        return next((one for one in self.attributes if one.name == name), None)

    def ancestors(self) -> Iterator[Tag]:
        """Yield the element and those around it, innermost first, without the whole text."""
        tag: Tag | None = self
        while tag is not None and tag.parent is not None:
            yield tag
            tag = tag.parent

    def below(self) -> Iterator[Tag]:
        """Yield the element and everything below it, in document order."""
        waiting = [self]
        while waiting:
            tag = waiting.pop()
            yield tag
            waiting += reversed(tag.children)


class Draft:
    """A text and the tree of its tags, which is built when it is first needed."""

    def __init__(self, text: str) -> None:
        """Set the text."""
        self.text = text

    @property
    def content(self) -> bytes:
        """The text as a file's content, with a mark that takes precedence over the encoding which the text declares."""
        return self.text.removeprefix("\ufeff").encode("utf-8-sig", "replace")

    @cached_property
    def _tree(self) -> tuple[Tag, list[tuple[int, int]]]:
        reader = _Reader(self.text)
        return reader.whole, reader.passed_over

    @property
    def whole(self) -> Tag:
        """The tag of the whole text, which contains the first element."""
        return self._tree[0]

    @property
    def passed_over(self) -> list[tuple[int, int]]:
        """Begin and end of comments and the like."""
        return self._tree[1]

    @property
    def root(self) -> Tag | None:
        """The first element."""
        return next((tag for tag in self.whole.children if tag.name), None)

    @cached_property
    def line_starts(self) -> list[int]:
        """Offsets of the beginnings of the lines."""
        return [0, *(match.end() for match in re.finditer(r"\r\n|\n|\r", self.text))]

    def line_of(self, offset: int) -> int:
        """Return the line of an offset, counted from 0."""
        return bisect.bisect_right(self.line_starts, offset) - 1

    def offset_at(self, line: int, column: int) -> int:
        """Return the offset nearest to a line and a column in characters, both counted from 0."""
        if line < 0:
            return 0
        if line >= len(self.line_starts):
            return len(self.text)
        start = self.line_starts[line]
        return min(start + max(column, 0), start + len(self.line_text(line)))

    def line_text(self, line: int) -> str:
        """Return a line, counted from 0, without its end; empty if there is no such line."""
        if not 0 <= line < len(self.line_starts):
            return ""
        last = line + 1 >= len(self.line_starts)
        return self.text[self.line_starts[line] : len(self.text) if last else self.line_starts[line + 1]].rstrip("\r\n")

    def value(self, attribute: Attribute) -> str:
        """Return an attribute's value as written."""
        return self.text[attribute.value_start : attribute.value_end] if attribute.has_value else ""

    def meant(self, attribute: Attribute) -> str:
        """Return an attribute's value as a parser gives it."""
        return _NOT_IN_XML.sub("", _ENTITY.sub(_character, re.sub(r"[\t\r\n]", " ", self.value(attribute))))

    def text_of(self, tag: Tag, name: str) -> str:
        """Return the value of an attribute of an element; empty if it has none."""
        attribute = tag.attribute(name)
        return "" if attribute is None else self.meant(attribute)

    def innermost(self, offset: int) -> Tag:
        """Return the innermost element that contains an offset, from after its `<` to before its end."""
        tag = self.whole
        while True:
            starts = [one.start for one in tag.children]
            at = bisect.bisect_left(starts, offset) - 1
            if at < 0 or not _holds(tag.children[at], offset):
                return tag
            tag = tag.children[at]

    def document(self, path: str) -> DraftDocument | None:
        """Return the text as a document with this path, as far as it is written; None if it has no element."""
        root = self.root
        if root is None or not _XML_NAME.fullmatch(root.name):
            return None
        tags: dict[etree._Element, Tag] = {}
        element = etree.Element(root.name, self._attributes(root))
        tags[element] = root
        waiting = [(element, root, 1)]
        while waiting:
            parent, tag, depth = waiting.pop()
            if depth >= MOST_DEPTH:
                continue
            for child in tag.children:
                if _XML_NAME.fullmatch(child.name):
                    inner = etree.SubElement(parent, child.name, self._attributes(child))
                    tags[inner] = child
                    waiting.append((inner, child, depth + 1))
        return DraftDocument(path, self.text, element, self, tags)

    def _attributes(self, tag: Tag) -> dict[str, str]:
        written: dict[str, str] = {}
        for one in tag.attributes:
            if one.has_value and _XML_NAME.fullmatch(one.name) and one.name != "xmlns":
                written.setdefault(one.name, self.meant(one))
        return written


class _Reader:
    """Reads a text's tags from beginning to end."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.whole = Tag("", -1, 0, True)
        self.passed_over: list[tuple[int, int]] = []
        self._read()

    def _read(self) -> None:
        text, current, at = self.text, self.whole, 0
        while (at := text.find("<", at)) >= 0:
            begin, close = next((pair for pair in _PASSED_OVER if text.startswith(pair[0], at)), ("", ""))
            if begin:
                end = text.find(close, at + len(begin))
                end = len(text) if end < 0 else end + len(close)
                self.passed_over.append((at, end))
                at = end
            elif text.startswith("</", at):
                current, at = self._end_tag(current, at)
            else:
                tag = self._start_tag(current, at)
                at = tag.head_end
                current = tag if tag.closed and not tag.ended else current
        while current is not self.whole:
            current.end_start = current.end = len(text)
            current = current.parent or self.whole
        self.whole.end_start = self.whole.end = len(text)

    def _end_tag(self, current: Tag, at: int) -> tuple[Tag, int]:
        """End the element that an end tag names and the open ones inside it; return the one that continues."""
        match = _END_TAG.match(self.text, at)
        assert match is not None
        name, after = match.group(1), match.end()
        ended = next((tag for tag in current.ancestors() if tag.name == name), None)
        if ended is None:
            return current, after
        while current is not ended:
            current.end_start = current.end = at
            current = current.parent or self.whole
        ended.end_start, ended.end, ended.ended = at, after, True
        return ended.parent or self.whole, after

    def _start_tag(self, parent: Tag, start: int) -> Tag:
        text = self.text
        name = _NAME.match(text, start + 1)
        tag = Tag("" if name is None else name.group(), start, parent=parent)
        parent.children.append(tag)
        at = start + 1 if name is None else name.end()
        while name is not None:
            behind = _SPACE.match(text, at)
            at = at if behind is None else behind.end()
            if text.startswith(("/>", ">"), at):
                tag.closed, tag.ended = True, text[at] == "/"
                at += 1 + tag.ended
                break
            if at >= len(text) or text[at] == "<":
                break
            at = self._attribute(tag, at)
        tag.head_end = at
        if tag.ended or not tag.closed:
            tag.end_start = tag.end = at
        return tag

    def _attribute(self, tag: Tag, at: int) -> int:
        """Read an attribute, or skip a character that begins none; return the offset after it."""
        text = self.text
        name = _NAME.match(text, at)
        if name is None:
            return at + 1
        attribute = Attribute(name.group(), at)
        tag.attributes.append(attribute)
        equals = re.compile(r"\s*=\s*").match(text, name.end())
        if equals is None:
            return name.end()
        quote = text[equals.end() : equals.end() + 1]
        if quote not in _VALUE:
            return equals.end()
        attribute.value_start = equals.end() + 1
        value = _VALUE[quote].match(text, attribute.value_start)
        assert value is not None
        if text.startswith(quote, value.end()):
            attribute.value_end, attribute.closed = value.end(), True
            return value.end() + 1
        unfinished = _UNFINISHED.match(text, attribute.value_start)
        assert unfinished is not None
        attribute.value_end = unfinished.end()
        return unfinished.end()


@dataclass(frozen=True)
class DraftDocument(Document):
    """A document made of a draft, whose elements have the places of the draft's tags."""

    draft: Draft
    tags: Mapping[etree._Element, Tag]

    def start_of(self, element: etree._Element) -> int | None:
        """Return the offset of an element's start tag in the text."""
        return self.tags[element].start

    def position(
        self, element: etree._Element, attribute: str | None, *, of_name: bool = False
    ) -> tuple[int, int, int]:
        """Return (line, column, length), counted from 1, of a start tag's name or of an attribute's value or name."""
        tag = self.tags[element]
        begin, length = tag.start, len(tag.name) + 1
        written = None if attribute is None else tag.attribute(attribute)
        if written is not None:
            begin, length = written.start, len(written.name)
            if not of_name and written.value_end > written.value_start:
                begin, length = written.value_start, written.value_end - written.value_start
        line = self.draft.line_of(begin)
        return line + 1, begin - self.draft.line_starts[line] + 1, length


def _holds(tag: Tag, offset: int) -> bool:
    """Return whether an element contains an offset; an unfinished one also contains the offset after it."""
    return offset < tag.end or (offset == tag.end and not tag.ended)


def _character(match: re.Match[str]) -> str:
    name, decimal, hexadecimal = match.groups()
    if name:
        return _ENTITIES[name]
    number = int(decimal) if decimal else int(hexadecimal, 16)
    return chr(number) if number < 0x110000 and not 0xD800 <= number < 0xE000 else ""
