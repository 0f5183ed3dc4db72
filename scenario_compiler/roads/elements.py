"""The elements of a road file as its network is read from them: one road after the other, and without places.

With lxml's elements, which lxml makes for each visit from a tree of the whole file, visiting them would take most of
the time to read a road file. Here lxml's parser only reports which elements begin and end, so the same files are
well-formed, and a road is read and forgotten before the next one is parsed. If a finding needs a place,
`parse_document` parses the file again, and its element with the same number has the place.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from itertools import count
from typing import TypeAlias, cast, overload

from lxml import etree

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.document import Document, Origin, is_unusual, parse_document, quiet_parser


class PlainElement(list["PlainElement"]):
    """An element as the list of its child elements, with the part of lxml's interface that reading a network needs.

    Attributes:
        tag: Its name, without the namespace of the file's root.
        attrib: Its attributes.
        number: Number of elements before it in the file.
    """

    __slots__ = ("attrib", "number", "tag")
    __eq__ = object.__eq__
    __hash__ = object.__hash__  # type: ignore[assignment]

    tag: str
    attrib: Mapping[str, str]
    number: int

    @overload
    def get(self, name: str) -> str | None: ...

    @overload
    def get(self, name: str, default: str) -> str: ...

    def get(self, name: str, default: str | None = None) -> str | None:
        """Return the value of an attribute."""
        return self.attrib.get(name, default)

    def findall(self, path: str) -> list[PlainElement]:
        """Return the descendants at a path of names, such as "lanes/laneSection", in the order of the file."""
        found: list[PlainElement] = [self]
        for name in path.split("/"):
            found = [child for one in found for child in one if child.tag == name]
        return found

    def find(self, path: str) -> PlainElement | None:
        """Return the first descendant at a path, None if there is none."""
        return next(iter(self.findall(path)), None)

    def iter(self) -> Iterator[PlainElement]:
        """Yield this element and all that it contains."""
        yield self
        for child in self:
            yield from child.iter()


Element: TypeAlias = etree._Element | PlainElement
"""An element of a `Document` or of a `RoadFile`."""


class RoadFile:
    """A road file: its path as the user named it, and its bytes."""

    def __init__(self, path: str, raw: bytes) -> None:
        """Keep both; nothing is parsed yet."""
        self.path = path
        self._raw = raw

    def parse(self, take: Callable[[PlainElement], None], sink: Diagnostics) -> PlainElement | None:
        """Parse the file and return its root.

        Args:
            take: Receives each child of the root when it is complete, and may empty it.
            sink: Receives the diagnostics of `parse_document` if the file cannot be used.

        Returns:
            The root; None if the file cannot be used. What `take` has received then means nothing.
        """
        if is_unusual(self._raw) and parse_document(self._raw, self.path, sink) is None:
            return None
        builder = _Builder(take)
        parser = quiet_parser(builder)
        try:
            root = cast(PlainElement, etree.fromstring(self._raw, parser))
        except (etree.XMLSyntaxError, _Unusable):
            parse_document(self._raw, self.path, sink)
            return None
        if (builder.unusual or len(parser.error_log) > 0) and parse_document(self._raw, self.path, sink) is None:
            return None
        return root

    @cached_property
    def _placed(self) -> tuple[Document, list[etree._Element]]:
        """The file with places, and its elements by their numbers."""
        document = parse_document(self._raw, self.path, Diagnostics())
        if document is None:
            raise _Unusable("the file is not well-formed after the element that is reported")
        return document, list(document.root.iter(etree.Element))

    def origin(self, element: PlainElement, attribute: str | None = None) -> Origin:
        """Return the place of an element's start tag, or of one of its attributes."""
        document, elements = self._placed
        return document.origin(elements[element.number], attribute)


class _Unusable(Exception):
    """The file cannot be used, for a reason that `parse_document` reports."""


_ID = "{http://www.w3.org/XML/1998/namespace}id"


class _Builder:
    """Receives the parser's events, and makes elements without texts, comments and processing instructions.

    Attributes:
        unusual: Whether an element has an id of XML's own, which only `parse_document` judges.
    """

    def __init__(self, take: Callable[[PlainElement], None]) -> None:
        """Begin with an element above the root."""
        self.unusual = False
        self._open = [PlainElement()]
        self.start, self.end = self._events(take)

    def _events(
        self, take: Callable[[PlainElement], None]
    ) -> tuple[Callable[[str, Mapping[str, str]], None], Callable[[str], None]]:
        """Return the functions for begins and ends; variables of a function are faster than attributes of an object."""
        opened, next_number, namespace = self._open, count().__next__, ""

        def start(tag: str, attributes: Mapping[str, str]) -> None:
            nonlocal namespace
            if tag[0] == "{":
                if len(opened) == 1:
                    namespace = tag[: tag.rindex("}") + 1]
                tag = tag.removeprefix(namespace)
            element = PlainElement()
            element.tag = tag
            element.attrib = attributes
            element.number = next_number()
            opened[-1].append(element)
            opened.append(element)
            if _ID in attributes:
                self.unusual = True

        def end(_: str) -> None:
            element = opened.pop()
            if len(opened) == 2:
                take(element)

        return start, end

    def doctype(self, *_: str | None) -> None:
        """Refuse a document type, which could declare entities."""
        raise _Unusable("a document type")

    def close(self) -> PlainElement | None:
        """Return the root and let go of it, because lxml keeps a target until the next garbage collection."""
        root = next(iter(self._open[0]), None)
        self._open.clear()
        return root
