"""A road file's elements are those of `parse_document`, which also judges whether the file can be used."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree

from scenario_compiler.diagnostics import Diagnostics, as_text
from scenario_compiler.document import MAX_ATTRIBUTES, drop_namespace, parse_document
from scenario_compiler.roads import load_network
from scenario_compiler.roads.elements import PlainElement, RoadFile
from tests.roads.make import road

PIECES = (
    *("<a>", "</a>", "<b/>", "<b c='1' d=\"&amp;&#38;&lt;\"/>", "<c>text &gt;</c>", "<!-- <b/> -->", "<?pi?>", "&e;"),
    *("<![CDATA[<b/>]]>", "<a xmlns='urn:x'>", "<a xmlns:p='urn:x'>", "<p:b p:c='1'/>", "<b xml:id='i'/>", "&", "<"),
    *("<b xml:id='1'/>", "<b c='1' c='2'/>", "<a xmlns=':'>", "<!DOCTYPE a [<!ENTITY e 'x'>]>", "\x00", "\r\n"),
)


@given(
    pieces=st.lists(st.sampled_from(PIECES), max_size=8),
    start=st.sampled_from(["<a>", "<a xmlns='urn:x'>", "<?xml version='1.0'?><a>", "<!DOCTYPE a><a>"]),
    end=st.sampled_from(["</a>", "</a></a>", ""]),
    encoding=st.sampled_from(["utf-8", "utf-8-sig", "utf-16"]),
)
def test_elements_and_findings_are_those_of_a_document(pieces: list[str], start: str, end: str, encoding: str) -> None:
    raw = "".join((start, *pieces, end)).encode(encoding)
    theirs, ours = Diagnostics(), Diagnostics()
    document, root = parse_document(raw, "a.xodr", theirs), RoadFile("a.xodr", raw).parse(lambda _: None, ours)
    assert [as_text(one) for one in ours] == [as_text(one) for one in theirs]
    assert (root is None) == (document is None)
    if root is not None and document is not None:
        drop_namespace(document.root)
        expected = [(one.tag, dict(one.attrib)) for one in document.root.iter(etree.Element)]
        assert [(one.tag, dict(one.attrib)) for one in root.iter()] == expected
        assert [one.number for one in root.iter()] == list(range(len(expected)))


@pytest.mark.parametrize("encoding", ["utf-8", "us-ascii", "iso-8859-1", "windows-1252", "utf-16", "utf-16-le"])
@pytest.mark.parametrize("declared", [True, False])
def test_an_element_has_a_greatest_number_of_attributes(encoding: str, declared: bool) -> None:
    """Names of a letter and empty values between other elements: no tag with so many attributes is shorter."""
    letters = encoding.startswith("utf")
    names = [chr(i) for i in range(0x3C00, 0x4200)] if letters else [f"n{i}" for i in range(MAX_ATTRIBUTES + 1)]
    start = f'<?xml version="1.0" encoding="{encoding.removesuffix("-le")}"?>' if declared else ""

    def codes(count: int) -> list[str]:
        attributes = "".join(f' {name}=""' for name in names[:count])
        raw = (b"\xff\xfe" if encoding == "utf-16-le" else b"") + f"{start}<a><b/><c{attributes}/></a>".encode(encoding)
        sink = Diagnostics()
        assert (RoadFile("a.xodr", raw).parse(lambda _: None, sink) is None) == sink.has_errors
        return [one.code.id for one in sink]

    assert codes(MAX_ATTRIBUTES) == []
    assert codes(MAX_ATTRIBUTES + 1) == ["SC103"]


def test_a_long_text_is_refused_like_in_a_document() -> None:
    raw = b"<a>" + 11_000_000 * b"x" + b"</a>"
    sink = Diagnostics()
    assert RoadFile("a.xodr", raw).parse(lambda _: None, sink) is None
    assert [one.code.id for one in sink] == ["SC102"]


def test_the_place_of_an_element_is_found_after_comments_and_instructions() -> None:
    file = RoadFile("a.xodr", b"<a><!-- <b/> -->\n<?pi <b/>?><b/>\n  <b c='1'/></a>")
    root = file.parse(lambda _: None, Diagnostics())
    assert root is not None
    places = [file.origin(one, "c" if one.get("c") else None) for one in root]
    assert [(one.line, one.column) for one in places] == [(2, 12), (3, 9)]


def test_children_of_the_root_are_given_when_they_are_complete() -> None:
    given_so_far: list[str] = []

    def take(element: PlainElement) -> None:
        given_so_far.append(f"{element.tag}{len(element)}")
        element.clear()

    root = RoadFile("a.xodr", b"<a><b><c/><d><e/></d></b><f/></a>").parse(take, Diagnostics())
    assert root is not None
    assert given_so_far == ["b2", "f0"]
    assert [one.tag for one in root.iter()] == ["a", "b", "f"]


def test_descendants_are_found_by_paths() -> None:
    root = RoadFile("a.xodr", b"<a><b><c n='1'/><d/><c n='2'/></b><b><c n='3'/></b></a>").parse(print, Diagnostics())
    assert root is not None
    assert [one.get("n") for one in root.findall("b/c")] == ["1", "2", "3"]
    first = root.find("b/c")
    assert first is not None
    assert (first.get("n"), first.get("m"), first.get("m", "0")) == ("1", None, "0")
    assert root.find("c") is None


def test_a_file_that_breaks_off_after_a_wrong_number_is_only_malformed(tmp_path: Path) -> None:
    path = tmp_path / "made.xodr"
    path.write_text("<OpenDRIVE>" + road().replace('hdg="0"', 'hdg="x"'), encoding="utf-8")
    sink = Diagnostics()
    assert load_network(path, cache=False, sink=sink) is None
    assert [one.code.id for one in sink] == ["SC102"]
