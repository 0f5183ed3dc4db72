"""Walks a road file along its version's declarations and reports every fault of structure."""

from __future__ import annotations

from collections.abc import Mapping
from typing import cast

from lxml import etree

from scenario_compiler.diagnostics import Code, Diagnostics, did_you_mean
from scenario_compiler.document import Document
from scenario_compiler.roads.findings import Findings
from scenario_compiler.roads.structure import codes
from scenario_compiler.roads.structure.conditions import CONDITIONS, FIRST_MINOR_WITH_CONDITIONS
from scenario_compiler.roads.structure.grammar import (
    FIRST_MINOR,
    FIRST_WITH_WORDS,
    LAST_MINOR,
    Attribute,
    Declaration,
    declarations,
    versions_of,
    words,
)
from scenario_compiler.roads.structure.keys import check_keys
from scenario_compiler.roads.structure.words import KINDS, WORDS

_XSI = "{http://www.w3.org/2001/XMLSchema-instance}"


def road_version(document: Document) -> tuple[int, int] | None:
    """Return (revMajor, revMinor) of the header, None where it does not say."""
    header = document.root.find("{*}header")
    try:
        if header is not None:
            return int(header.get("revMajor", "")), int(header.get("revMinor", ""))
    except ValueError:
        pass
    return None


def check_structure(document: Document, sink: Diagnostics) -> bool:
    """Report every fault of a road file's structure, for the version in its header.

    Returns:
        True when the structure is valid. A file of no known version counts as valid unless its root is not
        <OpenDRIVE>: nothing more can be said of it.
    """
    walk = _Walk(document, sink)
    walk.run()
    walk.findings.close()
    return walk.findings.total == walk.findings.of(codes.UNKNOWN_VERSION)


class _Walk:
    """One pass over one document."""

    def __init__(self, document: Document, sink: Diagnostics) -> None:
        self.document = document
        self.findings = Findings(document, sink)
        self.minor = LAST_MINOR
        self._fine: set[tuple[str, str]] = set()

    def run(self) -> None:
        """Check version, elements and keys."""
        root = self.document.root
        if root.tag != "OpenDRIVE" and etree.QName(root).localname != "OpenDRIVE":
            self._report(codes.UNKNOWN_ELEMENT, f"the root element is <{_tag(root)}>, not <OpenDRIVE>", root)
            return
        version = road_version(self.document)
        if version is None and root.find("{*}header") is None:
            self._report(codes.MISSING_ELEMENT, "<OpenDRIVE> lacks <header>", root)
            return
        if version is None or version[0] != 1 or not FIRST_MINOR <= version[1] <= LAST_MINOR:
            header = root.find("{*}header")
            named = "no version" if version is None else f"version {version[0]}.{version[1]}"
            message = f"the header names {named}; 1.{FIRST_MINOR} to 1.{LAST_MINOR} are known"
            code = codes.MISSING_ATTRIBUTE if version is None else codes.UNKNOWN_VERSION
            self._report(code, message, root if header is None else header)
            return
        self.minor = version[1]
        self._elements(root)
        check_keys(self.findings, root, self.minor)

    def _report(
        self, code: Code, message: str, element: etree._Element, attribute: str | None = None, hint: str = ""
    ) -> None:
        self.findings.report(code, message, element, attribute, hint=hint)

    def _elements(self, root: etree._Element) -> None:
        known = declarations(self.minor)
        pending = [(root, known["OpenDRIVE"])]
        if root.tag != "OpenDRIVE" and self.minor > 2:
            self._report(codes.UNKNOWN_ELEMENT, f"OpenDRIVE 1.{self.minor} has no namespace", root)
        while pending:
            element, declaration = pending.pop()
            if declaration.switch is not None:
                attribute, cases = declaration.switch
                declaration = known[cases.get(element.get(attribute, ""), declaration.name)]
            self._attributes(element, declaration)
            if self.minor >= FIRST_MINOR_WITH_CONDITIONS and declaration.name in CONDITIONS:
                for fault in CONDITIONS[declaration.name](element):
                    self._report(codes.EXCLUDED, f"<{_tag(element)}> {fault}", element)
            if declaration.anything:
                if declaration.text is None:
                    self._no_text(element)
                continue
            children = self._children(element, declaration)
            pending.extend((child, known[name]) for child, name in reversed(children))

    def _attributes(self, element: etree._Element, declaration: Declaration) -> None:
        given = cast(Mapping[str, str], element.attrib)
        for name, value in given.items():
            attribute = declaration.attributes.get(name)
            if attribute is None:
                if not name.startswith(_XSI):
                    self._unknown_attribute(element, name, declaration)
            elif attribute.kind and (attribute.kind, value) not in self._fine:
                self._value(element, name, value, attribute)
        for name, attribute in declaration.attributes.items():
            if attribute.required and name not in given:
                self._report(codes.MISSING_ATTRIBUTE, f"<{_tag(element)}> lacks {name}", element)

    def _unknown_attribute(self, element: etree._Element, name: str, declaration: Declaration) -> None:
        tag = _tag(element)
        hint = ""
        if self.findings.lists(codes.UNKNOWN_ATTRIBUTE):
            hint = self._elsewhere(versions_of(tag, name)) or did_you_mean(name, declaration.attributes)
        shown = name if not name.startswith("{") else etree.QName(name).localname
        message = f"<{tag}> has no attribute {shown[:60]}"
        self.findings.report(codes.UNKNOWN_ATTRIBUTE, message, element, name, by_name=True, hint=hint)

    def _elsewhere(self, versions: list[int]) -> str:
        """Return a hint naming the versions that know something which this one does not."""
        others = [f"1.{minor}" for minor in versions if minor != self.minor]
        if not others or self.minor in versions:
            return ""
        return f"it belongs to OpenDRIVE {', '.join(others)}; the file says 1.{self.minor}"

    def _value(self, element: etree._Element, name: str | None, value: str, attribute: Attribute) -> None:
        """Check a value; `name` None: the element's text."""
        kind = attribute.kind
        hint = ""
        if kind in WORDS:
            if self.minor < FIRST_WITH_WORDS or value in words(kind, self.minor):
                self._fine.add((kind, value))
                return
            expected = "none of its words"
            if self.findings.lists(codes.BAD_VALUE):
                minors = range(FIRST_WITH_WORDS, LAST_MINOR + 1)
                knowing = [minor for minor in minors if value in words(kind, minor)]
                hint = self._elsewhere(knowing) or did_you_mean(value[:80], words(kind, self.minor))
        else:
            described, test = KINDS[kind]
            if test(value.strip(" \t\n\r"), self.minor):
                self._fine.add((kind, value))
                return
            expected = f"not {described}"
        where = f"the text of <{_tag(element)}>" if name is None else f"{name} of <{_tag(element)}>"
        self._report(codes.BAD_VALUE, f"{where} is '{value[:40]}', {expected}", element, name, hint)

    def _children(self, element: etree._Element, declaration: Declaration) -> list[tuple[etree._Element, str]]:
        """Check the order of the children; return those that are declared with their declarations' names."""
        content = declaration.content
        state = content.start
        found = []
        for child in element.iterchildren(etree.Element):
            tag = child.tag
            if tag.startswith("{"):
                tag = _tag(child) if self.minor <= 2 else tag
            after = content.move(state, tag)
            if not after:
                if content.declaration(tag) is None:
                    self._unknown_element(child, element, declaration)
                    continue
                lacking = content.missing(state, tag)
                if lacking is None:
                    self._report(codes.MISPLACED_ELEMENT, self._misplaced(child, element), child)
                    after = state
                else:
                    names = " and ".join(f"<{name}>" for name in lacking[0])
                    self._report(codes.MISSING_ELEMENT, f"<{_tag(element)}> lacks {names} before <{tag}>", child)
                    after = lacking[1]
            state = after
            name = content.declaration(tag)
            if name is not None:
                found.append((child, name))
        if not content.complete(state) and (lacking := content.missing(state, None)) is not None:
            names = " and ".join(f"<{name}>" for name in lacking[0])
            self._report(codes.MISSING_ELEMENT, f"<{_tag(element)}> lacks {names}", element)
        if declaration.text is None:
            self._no_text(element)
        elif declaration.text:
            self._value(element, None, element.text or "", Attribute(declaration.text, True))
        return found

    def _misplaced(self, child: etree._Element, parent: etree._Element) -> str:
        tag = _tag(child)
        if any(one.tag == child.tag for one in child.itersiblings(preceding=True)):
            return f"<{tag}> stands too often or too late in <{_tag(parent)}>"
        return f"<{tag}> stands too late in <{_tag(parent)}>"

    def _unknown_element(self, child: etree._Element, parent: etree._Element, declaration: Declaration) -> None:
        tag = _tag(child)
        hint = ""
        if self.findings.lists(codes.UNKNOWN_ELEMENT):
            knowing = [
                minor for minor in range(FIRST_MINOR, LAST_MINOR + 1) if _has_child(declaration.name, tag, minor)
            ]
            hint = self._elsewhere(knowing) or did_you_mean(tag, declaration.content.tags())
        self._report(codes.UNKNOWN_ELEMENT, f"<{_tag(parent)}> has no child <{tag[:60]}>", child, None, hint)

    def _no_text(self, element: etree._Element) -> None:
        texts = [element.text, *(child.tail for child in element)]
        stray = next((text for text in texts if text and not text.isspace()), None)
        if stray is not None:
            shown = stray.strip()[:40]
            self._report(codes.STRAY_TEXT, f"text in <{_tag(element)}>: '{shown}'", element)


def _has_child(name: str, tag: str, minor: int) -> bool:
    return declarations(minor)[name].content.declaration(tag) is not None


def _tag(element: etree._Element) -> str:
    return etree.QName(element).localname
