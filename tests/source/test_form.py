"""The reader and the XSD accept the same files: shown on mutated files of the library and on made-up values."""

from __future__ import annotations

import copy
import itertools
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree

from scenario_compiler.diagnostics import Diagnostics, Place, as_text
from scenario_compiler.document import Document, Origin, parse_document
from scenario_compiler.markup import codes
from scenario_compiler.markup.environment import Environment, ReadingContext
from scenario_compiler.markup.reading import read_word
from scenario_compiler.markup.values import SPACE
from scenario_compiler.resources import library_folder
from scenario_compiler.source.catalogs import CatalogElement
from scenario_compiler.source.conflict import LibraryElement
from scenario_compiler.source.form import conflict_xsd, judge_form
from scenario_compiler.vocabulary.grammar import EXPRESSION, grammar_of
from scenario_compiler.vocabulary.schema import words_below

SCHEMA = etree.XMLSchema(etree.fromstring(conflict_xsd().encode()))
EVERY_WORD = Path(__file__).with_name("every_word.xml")
EVERY_ACTION = EVERY_WORD.with_name("every_action.xml")
FILES = [*sorted(library_folder().glob("*/*.xml")), EVERY_WORD, EVERY_ACTION]
BEYOND = {codes.BAD_EXPRESSION.id}
"""Codes of faults that no schema can see."""

VALUES = (
    "", " ", "abc", "a b", "-1", "0", "1", " 3 ", "+5", ".5", "5.", "0.5", "1,5", "1e9", "1e999", "-1e-9", "NaN", "INF",
    "0x1F", "\uff11",
    "99999999999999999999", "true", "1 2", "text tone", "$name", "${1 + $name}", "${", "$", "50 km/h",
    "${}", "${ }", "${1}", " ${-1e6} ", "${'audio'}",
)  # fmt: skip


class Anything(frozenset[str]):
    """A set that holds every name: all parameters are undetermined."""

    def __contains__(self, name: object) -> bool:
        return True


def faults(root: etree._Element) -> list[str]:
    """Return the structural faults that the reader finds."""
    text = etree.tostring(root, encoding="unicode")
    sink = Diagnostics()
    document = parse_document(text.encode(), "mutant.xml", sink)
    assert document is not None
    reading = ReadingContext(document, sink, Environment(undetermined=Anything()))
    read_word(document.root, CatalogElement if root.tag == "catalog" else LibraryElement, reading)
    return [as_text(one) for one in sink if one.code.id not in BEYOND and not _of_an_expression(one.place)]


def _of_an_expression(place: Place) -> bool:
    """Return whether a fault is that of an expression's value, which no schema can see."""
    written = place.element.get(place.attribute, "") if isinstance(place, Origin) and place.attribute else ""
    return re.fullmatch(EXPRESSION, written.strip(SPACE)) is not None


def disagreement(root: etree._Element) -> str:
    """Return what the two judges say where they differ, empty where they agree."""
    found = faults(root)
    valid = SCHEMA.validate(root)
    if valid != (not found):
        return f"XSD: {valid} {SCHEMA.error_log}; reader: {found or 'no fault'}"
    return ""


def mutants(root: etree._Element, seen: set[str]) -> Iterator[tuple[str, etree._Element]]:
    """Yield copies of a document with one fault (or harmless change) each, named by what was done.

    What `seen` names already is left out: the same change to the same kind of element tells nothing new.
    """
    for index, original in enumerate(root.iter(etree.Element)):
        for name, change in CHANGES.items():
            key = f"{_tag(original)} in {_tag(original.getparent())}: {name}"
            if key not in seen:
                mutant = copy.deepcopy(root)
                if change(list(mutant.iter(etree.Element))[index]):
                    seen.add(key)
                    yield key, mutant
        for attribute, value in _values(original, seen):
            key = f"{_tag(original)} {attribute}={value!r}"
            if key not in seen:
                seen.add(key)
                mutant = copy.deepcopy(root)
                element = list(mutant.iter(etree.Element))[index]
                if value is None:
                    del element.attrib[attribute]
                else:
                    element.set(attribute, value)
                yield key, mutant


def _values(element: etree._Element, seen: set[str]) -> Iterator[tuple[str, str | None]]:
    """Yield the values to try for each attribute, None for none: all where nothing declared alike was tried before."""
    for attribute in map(str, element.attrib):
        declared = str(sorted(DECLARED.get((_tag(element), attribute), {f"{_tag(element)} {attribute}"})))
        tried = (None, "", "abc", "-1", "$name") if declared in seen else (None, *VALUES)
        seen.add(declared)
        yield from itertools.product((attribute,), tried)


def _declarations() -> dict[tuple[str, str], set[str]]:
    """Return how attributes are declared, but for their descriptions, by the element's tag and the attribute."""
    found: dict[tuple[str, str], set[str]] = {}
    for word in words_below((LibraryElement, CatalogElement)):
        for rule in grammar_of(word).attributes.values():
            declared = f"{rule.kind} {rule.spelling} {rule.required} {rule.choices}"
            found.setdefault((word.tag(), rule.name), set()).add(declared.replace(repr(rule.spelling.names), ""))
    return found


DECLARED = _declarations()


def _tag(element: etree._Element | None) -> str:
    return "" if element is None else str(element.tag)


def _removed(element: etree._Element) -> bool:
    parent = element.getparent()
    if parent is None:
        return False
    parent.remove(element)
    return True


def _doubled(element: etree._Element) -> bool:
    if element.getparent() is None:
        return False
    element.addnext(copy.deepcopy(element))
    return True


def _renamed(element: etree._Element) -> bool:
    if element.getparent() is None:
        return False
    element.tag = f"{_tag(element)}x"
    return True


def _moved_ahead(element: etree._Element) -> bool:
    before = element.getprevious()
    if before is None:
        return False
    before.addprevious(element)
    return True


def _with_attribute(element: etree._Element) -> bool:
    element.set("surprise", "1")
    return True


def _with_text(element: etree._Element) -> bool:
    element.text = "stray"
    return True


def _with_comment(element: etree._Element) -> bool:
    element.insert(0, etree.Comment("harmless"))
    return True


def _emptied(element: etree._Element) -> bool:
    for child in list(element):
        element.remove(child)
    return True


CHANGES = {
    "removed": _removed,
    "doubled": _doubled,
    "renamed": _renamed,
    "moved ahead": _moved_ahead,
    "an attribute too many": _with_attribute,
    "stray text": _with_text,
    "a comment": _with_comment,
    "emptied": _emptied,
}


def pieces(root: etree._Element) -> Iterator[etree._Element]:
    """Yield a file in pieces, which are judged sooner than the whole.

    Each has one of the file's children, a scenario's with its ego vehicle and one other child.
    """
    for child in root.iterchildren("*"):
        items = [[item] for item in child if item.tag != "ego"] if child.tag == "scenario" else [list(child)]
        for kept in items or [[]]:
            piece = etree.Element(root.tag, {str(k): str(v) for k, v in root.attrib.items()})
            part = etree.SubElement(piece, child.tag, {str(k): str(v) for k, v in child.attrib.items()})
            part.text = child.text
            part.extend(copy.deepcopy(one) for one in child if one in kept or one.tag == "ego")
            yield piece


@pytest.mark.parametrize("every", [10, pytest.param(1, marks=pytest.mark.slow)])
def test_both_judges_agree_on_mutants_of_the_library(every: int) -> None:
    seen: set[str] = set()
    differing = []
    for path in FILES:
        parser = etree.XMLParser(remove_blank_text=True)
        root = etree.parse(str(path), parser).getroot()
        for part in pieces(root):
            for number, (key, mutant) in enumerate(mutants(part, seen)):
                found = disagreement(mutant) if number % every == 0 else ""
                if found:
                    differing.append(f"{path.name}, {key}: {found}")
    assert len(seen) > 9000
    assert differing == []


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_library_file_is_valid(path: Path) -> None:
    root = etree.parse(str(path)).getroot()
    assert SCHEMA.validate(root), SCHEMA.error_log
    assert faults(root) == []


NUMBERS = st.one_of(
    st.floats(allow_nan=True, allow_infinity=True).map(repr),
    st.integers().map(str),
    st.text(alphabet="0123456789.eE+- ", max_size=12),
)


@given(text=NUMBERS)
def test_both_judges_agree_on_any_number(text: str) -> None:
    root = etree.fromstring(
        b'<catalog version="1"><vehicle name="v" length="4" width="2" height="1" wheelbase="2" center="1"/></catalog>'
    )
    for attribute in ("center", "length", "max_steer"):
        mutant = copy.deepcopy(root)
        mutant[0].set(attribute, text)
        assert disagreement(mutant) == ""


@pytest.mark.parametrize("text", ["${}", "${ }", "${\n}"])
def test_an_expression_is_not_empty(text: str) -> None:
    root = etree.fromstring(
        b'<catalog version="1"><vehicle name="v" length="4" width="2" height="1" wheelbase="2" center="1"/></catalog>'
    )
    root[0].set("length", text)
    assert not SCHEMA.validate(root)
    assert faults(root)


def test_the_schema_reports_faults_that_the_reader_accepts() -> None:
    sink = Diagnostics()
    text = '<scenarios version="1">\n  <scenario name="a"/>\n</scenarios>'
    judge_form(Document("a.xml", text, etree.fromstring(text.encode())), sink)
    assert [(one.code.id, one.place.line) for one in sink] == [("SC115", 2)]
