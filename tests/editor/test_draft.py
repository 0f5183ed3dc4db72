"""Unfinished texts have a tree; that of a well-formed text equals the parser's, with the same places."""

from __future__ import annotations

from pathlib import Path

import pytest
from lxml import etree

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.document import parse_document
from scenario_compiler.editor.draft import Draft, Tag
from scenario_compiler.resources import library_folder

CASES = Path(__file__).resolve().parents[1] / "cases"
FILES = [*sorted(library_folder().glob("*/*.xml")), *sorted(CASES.glob("SC*.xml"))]


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_the_tree_of_a_well_formed_file_is_the_parsers(path: Path) -> None:
    parsed = parse_document(path.read_bytes(), str(path), Diagnostics())
    if parsed is None or "}" in str(parsed.root.tag):
        pytest.skip("not well-formed, or in a namespace")
    drafted = Draft(parsed.text).document(str(path))
    assert drafted is not None
    elements = [one for one in parsed.root.iter(etree.Element) if "}" not in str(one.tag)]
    ours = list(drafted.root.iter(etree.Element))
    assert [one.tag for one in ours] == [one.tag for one in elements]
    for one, other in zip(ours, elements, strict=True):
        written = {str(name): str(text) for name, text in other.attrib.items() if "{" not in str(name)}
        assert written == {str(name): str(text) for name, text in one.attrib.items()}
        for name in (None, *map(str, one.attrib)):
            assert drafted.position(one, name) == parsed.position(other, name)
            assert drafted.position(one, name, of_name=True) == parsed.position(other, name, of_name=True)


def shape(tag: Tag) -> str:
    """Return an element and what it holds, as text."""
    attributes = "".join(f" {one.name}" for one in tag.attributes)
    return f"{tag.name}{attributes}({', '.join(map(shape, tag.children))})"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("<a><b", "a(b())"),
        ("<a><b x=", "a(b x())"),
        ("<a><b x='1 <c/></a>", "a(b x(), c())"),
        ('<a><b x="1>\n<c/></b></a>', "a(b x(c()))"),
        ("<a><b><c></a>", "a(b(c()))"),
        ("<a></b><c/></a>", "a(c())"),
        ("<a>< <c/></a>", "a((), c())"),
        ("<a><!-- <b/>", "a()"),
        ("<a><b / ><c/></a>", "a(b(c()))"),
        ('<a x="1" x="2"/>', "a x x()"),
        ("", ""),
        ("no tag", ""),
    ],
)
def test_an_unfinished_text_has_a_tree(text: str, expected: str) -> None:
    assert ", ".join(map(shape, Draft(text).whole.children)) == expected


def test_lines_end_as_in_the_protocol() -> None:
    draft = Draft("a\r\nb\rc\nd\u2028e\x0bf")
    assert [draft.line_text(line) for line in range(4)] == ["a", "b", "c", "d\u2028e\x0bf"]
    assert draft.line_of(len("a\r\nb\rc")) == 2
    assert draft.offset_at(1, 99) == len("a\r\nb")
    assert (draft.offset_at(99, 0), draft.offset_at(-1, 5)) == (len(draft.text), 0)


def test_elements_that_are_nested_without_end_are_read_to_a_depth() -> None:
    draft = Draft("<scenarios>" + "<a>" * 5000)
    document = draft.document("deep.xml")
    assert document is not None
    assert sum(1 for _ in document.root.iter()) < 300
