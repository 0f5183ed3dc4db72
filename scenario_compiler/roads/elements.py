"""The elements of a road file as its network is read from them: one road after the other, and without places.

With lxml's elements, which lxml makes for each visit from a tree of the whole file, visiting them would take most of
the time to read a road file. Here lxml's parser only reports which elements begin and end, so the same files are
well-formed, and the elements are those of Python's library, which are made once. A road is read and emptied before the
next one is parsed. If a finding needs a place, `parse_document` parses the file again, and its element at the same
position in the tree has the place.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cached_property
from typing import TypeAlias, cast

from lxml import etree

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.document import Document, Origin, is_unusual, parse_document, quiet_parser
from scenario_compiler.interruption import put_off

with put_off():  # Python's library takes an interruption of this import for a missing module, and ignores it
    from xml.etree import ElementTree

PlainElement: TypeAlias = ElementTree.Element
"""An element of a `RoadFile`. Names in the namespace of the file's root have no namespace."""

Element: TypeAlias = etree._Element | PlainElement
"""An element of a `Document` or of a `RoadFile`."""


def grandchildren(element: PlainElement, tag: str, inner: str) -> list[PlainElement]:
    """Return the children with the tag `inner` of an element's children with another tag, in the order of the file."""
    found: list[PlainElement] = []
    for child in element.findall(tag):
        found += child.findall(inner)
    return found


class RoadFile:
    """A road file: its path as the user named it, and its bytes."""

    def __init__(self, path: str, raw: bytes) -> None:
        """Keep both; nothing is parsed yet."""
        self.path = path
        self._raw = raw
        self._root, self._at = PlainElement(""), 0
        self._placed: dict[PlainElement, etree._Element] = {}

    def parse(self, take: Callable[[PlainElement], None], sink: Diagnostics) -> PlainElement | None:
        """Parse the file and return its root.

        Args:
            take: Receives each road when it is complete. It may clear elements in it, but not move any.
            sink: Receives the diagnostics of `parse_document` if the file cannot be used.

        Returns:
            The root; None if the file cannot be used. What `take` has received then means nothing.
        """

        def take_road(root: PlainElement, at: int) -> None:
            self._root, self._at = root, at
            take(root[at])

        if is_unusual(self._raw) and parse_document(self._raw, self.path, sink) is None:
            return None
        parser = quiet_parser(_Builder(take_road))
        try:
            root = cast(PlainElement, etree.fromstring(self._raw, parser))
        except (etree.XMLSyntaxError, _Unusable):
            parse_document(self._raw, self.path, sink)
            return None
        if len(parser.error_log) > 0 and parse_document(self._raw, self.path, sink) is None:
            return None
        self._root = root
        return root

    @cached_property
    def _document(self) -> tuple[Document, list[etree._Element]]:
        """The file with places, and the children of its root."""
        document = parse_document(self._raw, self.path, Diagnostics())
        if document is None:
            raise _Unusable("the file is not well-formed after the element that is reported")
        return document, list(document.root.iterchildren(etree.Element))

    def origin(self, element: PlainElement, attribute: str | None = None) -> Origin:
        """Return the place of an element's start tag, or of one of its attributes."""
        document, parts = self._document
        here = slice(self._at, self._at + 1)
        for mine, theirs in (*zip(self._root[here], parts[here], strict=True), (self._root, document.root)):
            if element not in self._placed:
                self._placed = dict(_pairs(mine, theirs))
        return document.origin(self._placed[element], attribute)


def _pairs(mine: PlainElement, theirs: etree._Element) -> Iterator[tuple[PlainElement, etree._Element]]:
    """Yield the elements of a tree with those at the same positions of a tree that has the same elements or more."""
    yield mine, theirs
    for one, other in zip(mine, theirs.iterchildren(etree.Element), strict=False):
        yield from _pairs(one, other)


class _Unusable(Exception):
    """The file cannot be used, for a reason that `parse_document` reports."""


class _Builder:
    """Receives the parser's events, and makes elements without texts, comments and processing instructions."""

    def __init__(self, take: Callable[[PlainElement, int], None]) -> None:
        """Begin before the root; `take` receives the root and the index of each road in it when it is complete."""
        self.start, self.end, self.close = self._events(take)

    def _events(
        self, take: Callable[[PlainElement, int], None]
    ) -> tuple[Callable[[str, dict[str, str]], None], Callable[[str], PlainElement], Callable[[], PlainElement]]:
        """Return the functions for begins, ends and the end of the file.

        Variables of a function are faster than attributes of an object, and `TreeBuilder.end` is faster than a function
        that calls it; therefore a road is taken when the next one begins or the file ends.
        """
        tree = ElementTree.TreeBuilder()
        begin = tree.start
        above = begin("", {})
        namespace, at = "that of the root, which comes first", -1

        def bare(tag: str) -> str:
            nonlocal namespace
            if len(above) == 0:
                namespace = tag[: tag.rfind("}") + 1]
            return tag.removeprefix(namespace)

        def start(tag: str, attributes: dict[str, str]) -> None:
            """Begin an element; without attributes lxml gives an empty mapping that is not a dictionary."""
            nonlocal at
            if namespace:
                tag = bare(tag)
            element = begin(tag, attributes or {})
            if tag == "road" and above[0][-1:] == [element]:
                if at >= 0:
                    take(above[0], at)
                at = len(above[0]) - 1

        def close() -> PlainElement:
            """Return the root, and let go of `take`: lxml keeps this function until the next garbage collection."""
            nonlocal take
            root = next(iter(above), above)
            if at >= 0:
                take(root, at)
            del take
            return root

        return start, tree.end, close

    def doctype(self, *_: str | None) -> None:
        """Refuse a document type, which could declare entities."""
        raise _Unusable("a document type")
