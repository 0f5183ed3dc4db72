"""Reads XML safely into elements whose file, line and column are known.

Elements are lxml's own. lxml gives only the line in which a start tag ends, so exact lines and columns are found by
scanning the text once more, and only when a diagnostic needs them.
"""

from __future__ import annotations

import bisect
import codecs
import re
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from lxml import etree

from scenario_compiler.diagnostics import Code, Diagnostics, FilePlace, Place, did_you_mean
from scenario_compiler.files import SCENARIO_BYTES, read_file

UNREADABLE = Code(
    "SC101",
    "unreadable-file",
    "The file does not exist, is a folder, a pipe or a device, is too large, or cannot be opened. Check the path and "
    "the permissions; paths in a file are relative to that file's folder."
    "\n\n    scenario-compiler validate conflicts/my_conflict.xml     the folder is called `conflict`",
)
MALFORMED = Code(
    "SC102",
    "malformed-xml",
    "The file is not well-formed XML, so nothing in it can be read: a tag is not closed, a quote is missing, a "
    "character is not allowed, or the encoding is not the one that the first line declares. The message names the "
    "place at which the parser stopped; the mistake is often shortly before it.\n\n"
    '    <ego speed="10><start>...</start></ego>     a quote is missing after 10',
)
FORBIDDEN = Code(
    "SC103",
    "forbidden-xml",
    "The file declares entities or a document type, or is too large for a scenario or road file. Entities can read "
    "other files and expand without limit. No scenario or road file needs them, and they are never resolved. Remove "
    "the <!DOCTYPE ...> declaration.\n\n"
    '    <!DOCTYPE scenarios [<!ENTITY start SYSTEM "start.xml">]>     use <include>',
)

MAX_ATTRIBUTES = 1000
"""Greatest number of attributes of an element; real files have at most about twenty."""

MAX_TAGS = 4_000_000
"""Greatest number of tags in a file, which limits the memory: the largest known road files have about 700 000."""

MOST_PLACED = 400_000
"""Greatest number of tags in a file whose findings have line and column; in larger files they have the line only."""


@dataclass(frozen=True)
class Document:
    """A well-formed XML file: its path as the user named it, its text or bytes, and lxml's root element."""

    path: str
    source: str | bytes
    root: etree._Element

    @cached_property
    def text(self) -> str:
        """Text of the file; bytes are decoded when a diagnostic first needs it."""
        if isinstance(self.source, str):
            return self.source
        return _decode(self.source, self.root.getroottree().docinfo.encoding)

    @property
    def folder(self) -> Path:
        """Folder from which relative paths in the file start."""
        return Path(self.path).parent

    def origin(self, element: etree._Element, attribute: str | None = None, within: Place | None = None) -> Origin:
        """Return the place of an element's start tag, or of one of its attributes."""
        return Origin(self, element, attribute, within)

    @cached_property
    def _is_vast(self) -> bool:
        return self.text.count("<") > MOST_PLACED

    @cached_property
    def _lines(self) -> list[str]:
        return self.text.split("\n")

    @cached_property
    def _line_starts(self) -> list[int]:
        starts, at = [], 0
        for line in self._lines:
            starts.append(at)
            at += len(line) + 1
        return starts

    @cached_property
    def _tags(self) -> list[tuple[int, int]]:
        """Start and end offset of every start tag, in document order."""
        return [m.span("tag") for m in _TOKENS.finditer(self.text) if m.group("tag") is not None]

    @cached_property
    def _ordinals(self) -> dict[etree._Element, int]:
        return {element: i for i, element in enumerate(self.root.iter(etree.Element))}

    def position(
        self, element: etree._Element, attribute: str | None, *, of_name: bool = False
    ) -> tuple[int, int, int]:
        """Return (line, column, length), counted from 1, of a start tag's name or of an attribute's value or name.

        Args:
            element: The element of the start tag.
            attribute: The attribute by lxml's name, with the namespace in braces if it has one.
            of_name: Whether the attribute's name is located, not its value.
        """
        ordinal = -1 if self._is_vast else self._ordinals.get(element, -1)
        if not 0 <= ordinal < len(self._tags):
            return int(getattr(element, "sourceline", 0) or 0), 0, 0
        start, end = self._tags[ordinal]
        begin, length = start, len(re.split(r"[\s/>]", self.text[start + 1 : end], maxsplit=1)[0]) + 1
        written = None if attribute is None else written_name(element, attribute)
        for match in _ATTRIBUTES.finditer(self.text, start, end):
            if match.group("name") == written:
                begin, length = match.start("value") + 1, len(match.group("value")) - 2
                if length == 0 or of_name:
                    begin, length = match.start("name"), len(match.group("name"))
        return (*self._line_and_column(begin), length)

    def _line_and_column(self, offset: int) -> tuple[int, int]:
        line = bisect.bisect_right(self._line_starts, offset)
        return line, offset - self._line_starts[line - 1] + 1

    def start_of(self, element: etree._Element) -> int | None:
        """Return the offset of an element's start tag in the text, None in a vast file."""
        ordinal = -1 if self._is_vast else self._ordinals.get(element, -1)
        return self._tags[ordinal][0] if 0 <= ordinal < len(self._tags) else None

    def text_place(self, element: etree._Element, shown: str, within: Place | None = None) -> Place:
        """Return the place of a text that is directly in an element; the element's if the text contains references.

        Args:
            element: The element.
            shown: The text, or the start of its first line.
            within: The use that inserted the element.
        """
        depth, at = 0, self.start_of(element)
        if at is not None:
            for token in _TOKENS.finditer(self.text, at):
                found = self.text.find(shown, at, token.start()) if depth == 1 else -1
                if found < 0 and depth == 1 and token.group().startswith("<![CDATA["):
                    found = self.text.find(shown, *token.span())
                if found >= 0:
                    line, column = self._line_and_column(found)
                    return FilePlace(self.path, line, column, len(shown), self.line_text(line), within)
                depth += _opens(token)
                at = token.end()
                if depth == 0:
                    break
        return self.origin(element, None, within)

    def line_text(self, line: int) -> str:
        """Return the text of a line counted from 1, empty outside the file."""
        return self._lines[line - 1].rstrip("\r") if 0 < line <= len(self._lines) else ""


class Origin:
    """The place of an element or attribute in a document; line and column are found when they are first read."""

    __slots__ = ("_found", "attribute", "document", "element", "within")

    def __init__(
        self,
        document: Document,
        element: etree._Element,
        attribute: str | None = None,
        within: Place | None = None,
    ) -> None:
        """Store the element and the attribute; the text is not searched yet."""
        self.document = document
        self.element = element
        self.attribute = attribute
        self.within = within
        self._found: tuple[int, int, int] | None = None

    def __reduce__(self) -> tuple[type[FilePlace], tuple[object, ...]]:
        """Pickle as plain numbers, because a plan is sent to another process without its document."""
        return FilePlace, (self.file, self.line, self.column, self.length, self.source_line, self.within)

    def of(self, attribute: str) -> Origin:
        """Return the place of one of this element's attributes."""
        return Origin(self.document, self.element, attribute, self.within)

    def name_of(self, attribute: str) -> Place:
        """Return the place of the name of one of this element's attributes."""
        line, column, length = self.document.position(self.element, attribute, of_name=True)
        return FilePlace(self.document.path, line, column, length, self.document.line_text(line), self.within)

    def _position(self) -> tuple[int, int, int]:
        if self._found is None:
            self._found = self.document.position(self.element, self.attribute)
        return self._found

    @property
    def file(self) -> str:
        """Path of the file as the user named it."""
        return self.document.path

    @property
    def line(self) -> int:
        """Line, counted from 1."""
        return self._position()[0]

    @property
    def column(self) -> int:
        """Column, counted from 1."""
        return self._position()[1]

    @property
    def length(self) -> int:
        """Number of characters covered."""
        return self._position()[2]

    @property
    def source_line(self) -> str:
        """Text of the line."""
        return self.document.line_text(self.line)


def read_document(path: str | Path, sink: Diagnostics, limit: int = SCENARIO_BYTES) -> Document | None:
    """Read an XML file; return None, with a diagnostic, if it is missing, malformed or hostile.

    Entities are never resolved, no other file is loaded, and the memory is limited by the file's size.

    Args:
        path: The file.
        sink: Receives the diagnostics.
        limit: Greatest size of the file, bytes; road files are larger than scenarios.
    """
    name = str(path)
    try:
        raw = read_file(path, limit)
    except FileNotFoundError as error:
        dangling = Path(path).is_symlink()
        why, hint = ("it is a link to a missing file", "") if dangling else (error.strerror, _beside(Path(path)))
        sink.add(UNREADABLE, f"cannot read the file: {why}", FilePlace(name), hint=hint)
        return None
    except OSError as error:
        sink.add(UNREADABLE, f"cannot read the file: {error.strerror}", FilePlace(name))
        return None
    except ValueError:
        sink.add(UNREADABLE, "cannot read the file: this is not a possible file name", FilePlace(name))
        return None
    return parse_document(raw, name, sink)


def written_name(element: etree._Element, attribute: str | None = None) -> str:
    """Return the name of an element or of one of its attributes as the file writes it, with the namespace's prefix."""
    if attribute is None:
        local = etree.QName(element).localname
        return f"{element.prefix}:{local}" if element.prefix else local
    name = etree.QName(attribute)
    prefix = next((one for one, space in element.nsmap.items() if one and space == name.namespace), None)
    return f"{prefix}:{name.localname}" if prefix else name.localname


def one_of(tags: Iterable[str]) -> str:
    """Return the words for an element with one of these tags, at least one: `<a>`, or `one of <a>, <b>`."""
    shown = [f"<{tag}>" for tag in tags]
    return shown[0] if len(shown) == 1 else "one of " + ", ".join(shown)


def drop_namespace(root: etree._Element) -> str:
    """Rename elements of the root's namespace to their bare names; return the namespace, empty for none."""
    namespace = etree.QName(root).namespace or ""
    if namespace:
        for element in root.iter(f"{{{namespace}}}*"):
            element.tag = etree.QName(element).localname
    return namespace


def quiet_parser(target: Any) -> etree.XMLParser:
    """Return a parser that makes no tree, loads no other file, and resolves the entities of the file itself.

    Args:
        target: Receives the events. It must refuse document types, so that there are no entities but `&amp;` and such.
    """
    return etree.XMLParser(target=target, no_network=True, load_dtd=False, huge_tree=False)


def parse_document(raw: bytes, name: str, sink: Diagnostics) -> Document | None:
    """Parse the bytes of an XML file called `name`; see `read_document`.

    A carriage return alone ends a line, as in XML and in editors. libxml2 does not count it, so it becomes a line feed.
    """
    if b"\r" in raw and b"\x00" not in raw[:8]:
        raw = _LONE_RETURN.sub(b"\n", raw)
    line = _doctype_line(raw)
    if line > 0:
        sink.add(FORBIDDEN, _DOCTYPE_MESSAGE, FilePlace(name, line, 1))
        return None
    tags = raw.count(b"<") if len(raw) > MAX_TAGS else 0
    if tags > MAX_TAGS:
        sink.add(FORBIDDEN, f"the file has {tags} tags; at most {MAX_TAGS} are read", FilePlace(name))
        return None
    parser = etree.XMLParser(
        resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False, remove_blank_text=False
    )
    try:
        root = etree.fromstring(raw, parser)
    except (etree.XMLSyntaxError, ValueError) as error:
        line, column = getattr(error, "position", (0, 0)) or (0, 0)
        text = _decode(raw, None)
        lines = text.split("\n")
        known = 0 < line <= len(lines)
        source = lines[line - 1].rstrip("\r") if known and len(lines[line - 1]) < 400 else ""
        place = FilePlace(name, line, column if known else 0, 1, source)
        sink.add(MALFORMED, f"not well-formed XML: {_short(str(error))}", place)
        return None
    info = root.getroottree().docinfo
    if info.internalDTD is not None:
        sink.add(FORBIDDEN, _DOCTYPE_MESSAGE, FilePlace(name, 1, 1))
        return None
    document = Document(name, raw, root)
    for element in root.iter(etree.Element):
        if len(element.attrib) > MAX_ATTRIBUTES:
            message = f"<{element.tag}> has {len(element.attrib)} attributes; at most {MAX_ATTRIBUTES} are read"
            sink.add(FORBIDDEN, message, document.origin(element))
            return None
    return document


_LONE_RETURN = re.compile(rb"\r(?!\n)")
_DOCTYPE_MESSAGE = "a document type declaration is not allowed"
_TOKENS = re.compile(
    r"<!--.*?-->|<!\[CDATA\[.*?\]\]>|<\?.*?\?>|</[^>]*>|"
    r"(?P<tag><[^\s!?/<>](?:[^\"'<>]|\"[^\"]*\"|'[^']*')*>)",
    re.DOTALL,
)
_ATTRIBUTES = re.compile(r"(?<=\s)(?P<name>[^\s=\"'<>/]+)\s*=\s*(?P<value>\"[^\"]*\"|'[^']*')")


def is_unusual(raw: bytes) -> bool:
    """Return whether only `parse_document` can find all faults of a file: those of its size, texts, ids and encoding.

    A tag has at least five bytes for each attribute, none of them "<", and libxml2 refuses longer texts than these only
    while it makes a tree.
    """
    if _doctype_line(raw) > 0 or len(raw) > MAX_TAGS < raw.count(b"<") or b"\x00" in raw[:8] or _names_an_id(raw):
        return True
    span, at = 5 * MAX_ATTRIBUTES, 0
    while at + span <= len(raw):
        last = raw.rfind(b"<", at, at + span)
        if last < 0:
            return True
        at = last + 1
    return False


def _names_an_id(raw: bytes) -> bool:
    """Return whether XML's own id, `xml:id`, occurs; its colon is rare in files and is found fast."""
    at = raw.find(b":")
    while at >= 0 and raw[at - 3 : at + 3] != b"xml:id":
        at = raw.find(b":", at + 1)
    return at >= 0


def _doctype_line(raw: bytes) -> int:
    """Return the line of a document type declaration before the root element, 0 when there is none.

    It is searched before anything is parsed, so that entities are never expanded. In encodings with two or four bytes
    per character the zero bytes are ignored; in other encodings that do not extend ASCII, the parser finds the
    declaration.
    """
    text = raw.replace(b"\x00", b"") if b"\x00" in raw[:8] else raw
    at = text.find(b"<")
    while at >= 0:
        if text.startswith(b"<!DOCTYPE", at):
            return text.count(b"\n", 0, at) + 1
        begin, close = next((pair for pair in _BEFORE_THE_ROOT if text.startswith(pair[0], at)), (b"", b""))
        end = text.find(close, at + len(begin)) if begin else -1
        at = text.find(b"<", end) if end >= 0 else -1
    return 0


_BEFORE_THE_ROOT = ((b"<!--", b"-->"), (b"<?", b"?>"))


def _opens(token: re.Match[str]) -> int:
    """Return by how much a token of the text changes the depth of nesting."""
    if token.group("tag") is not None:
        return 0 if token.group().endswith("/>") else 1
    return -1 if token.group().startswith("</") else 0


_MARKED = (codecs.BOM_UTF8, "utf-8"), (codecs.BOM_UTF16_LE, "utf-16-le"), (codecs.BOM_UTF16_BE, "utf-16-be")
"""Encodings that a byte order mark declares, whatever the XML declaration says; lxml names none without the latter."""


def _decode(raw: bytes, encoding: str | None) -> str:
    marked = next((codec for mark, codec in _MARKED if raw.startswith(mark)), None)
    for codec in (marked, encoding, "utf-8", "latin-1"):
        if codec is None:
            continue
        try:
            text = raw.decode(codec)
        except (UnicodeDecodeError, LookupError):
            continue
        return text.removeprefix("\ufeff").replace("\r\n", "\n")
    return ""


def _short(message: str) -> str:
    return re.sub(r", line \d+, column \d+.*$", "", message).strip()[:200]


def _beside(path: Path) -> str:
    try:
        alike = [one for one in path.parent.iterdir() if one.suffix == path.suffix]
        stems = [one.stem for one in alike if one.name != path.name and one.is_file()]
    except OSError:
        return ""
    hint = did_you_mean(path.stem, stems)  # the common suffix would make all names alike
    if hint.startswith("known"):
        return "known: " + ", ".join(sorted(f"{one}{path.suffix}" for one in stems))
    return hint.replace("'?", f"{path.suffix}'?")
