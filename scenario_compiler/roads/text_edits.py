"""Changes to an XML document that leave all other characters of its text unchanged."""

from __future__ import annotations

import re
from xml.sax.saxutils import quoteattr

from lxml import etree

from scenario_compiler.document import Document

_TOKENS = re.compile(
    r"<!--.*?-->|<!\[CDATA\[.*?\]\]>|<\?.*?\?>|</(?P<close>[^\s>]+)[^>]*>|"
    r"<(?P<open>[^\s!?/<>]+)(?:[^\"'<>]|\"[^\"]*\"|'[^']*')*>",
    re.DOTALL,
)


def number_of(element: etree._Element, attribute: str) -> float:
    """Return an attribute as a number; 0 if it is missing or not a number."""
    try:
        return float(element.get(attribute, "0"))
    except ValueError:
        return 0.0


class TextEdits:
    """Collects changes to the elements of a document; `result` applies them all."""

    def __init__(self, document: Document) -> None:
        """Start without changes."""
        self._document = document
        self._starts = [0]
        for line in document.text.split("\n"):
            self._starts.append(self._starts[-1] + len(line) + 1)
        self._edits: list[tuple[int, int, str]] = []

    def _start(self, element: etree._Element) -> int:
        line, column, _ = self._document.position(element, None)
        return self._starts[line - 1] + column - 1

    def _end(self, element: etree._Element) -> int:
        """Return the offset after an element's last tag."""
        depth = 0
        for token in _TOKENS.finditer(self._document.text, self._start(element)):
            if token.group("close"):
                depth -= 1
            elif token.group("open") and not token.group().endswith("/>"):
                depth += 1
            if depth == 0:
                return token.end()
        return len(self._document.text)

    def set(self, element: etree._Element, attribute: str, value: str) -> None:
        """Set an attribute; a new one is added after the tag's name."""
        if element.get(attribute) == value:
            return
        start, quoted = self._start(element), quoteattr(value)
        if element.get(attribute) is None:
            name = re.compile(r"<[^\s/>]+").match(self._document.text, start)
            at = name.end() if name else start
            self._edits.append((at, at, f" {attribute}={quoted}"))
            return
        tag = _TOKENS.match(self._document.text, start)
        found = re.compile(rf"\s{re.escape(attribute)}\s*=\s*(?P<value>\"[^\"]*\"|'[^']*')").search(
            self._document.text, start, tag.end() if tag else len(self._document.text)
        )
        if found:
            self._edits.append((*found.span("value"), quoted))

    def remove(self, element: etree._Element) -> None:
        """Remove an element with the white space before it."""
        start = self._start(element)
        while start > 0 and self._document.text[start - 1].isspace():
            start -= 1
        self._edits.append((start, self._end(element), ""))

    def insert_after(self, element: etree._Element, text: str) -> None:
        """Insert lines after an element, with its indentation."""
        end = self._end(element)
        self._edits.append((end, end, self._indented(element, text)))

    def insert_inside(self, element: etree._Element, text: str) -> None:
        """Insert lines as the first children of an element, with the indentation of its first child if it has one."""
        tag = _TOKENS.match(self._document.text, self._start(element))
        if tag is None:
            return
        if tag.group().endswith("/>"):
            self._edits.append((tag.end() - 2, tag.end(), f">{text.strip()}</{tag.group('open')}>"))
            return
        lines = self._indented(element[0], text) if len(element) else text.strip()
        self._edits.append((tag.end(), tag.end(), lines))

    def _indented(self, element: etree._Element, text: str) -> str:
        start = self._start(element)
        indent = self._document.text[self._document.text.rfind("\n", 0, start) + 1 : start]
        if indent.strip():
            indent = ""
        return "".join(f"\n{indent}{line}" for line in text.rstrip("\n").split("\n"))

    def result(self) -> str:
        """Return the text with all changes; a change inside a removed element has no effect."""
        parts: list[str] = []
        done = 0
        for start, end, text in sorted(self._edits, key=lambda one: one[:2]):
            if start < done:
                continue
            parts += (self._document.text[done:start], text)
            done = end
        return "".join((*parts, self._document.text[done:]))
