"""A road file's elements are those of `parse_document`, which also judges whether the file can be used."""

from __future__ import annotations

import gc
import weakref
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree

from scenario_compiler.diagnostics import Diagnostics, as_text
from scenario_compiler.document import MAX_ATTRIBUTES, drop_namespace, parse_document
from scenario_compiler.roads import load_network
from scenario_compiler.roads.elements import PlainElement, RoadFile, grandchildren
from scenario_compiler.roads.parse import read_network
from scenario_compiler.roads.reading import LENGTH_LIMIT, Reader
from scenario_compiler.roads.tables import RoadTables
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


def test_a_road_is_given_when_it_is_complete() -> None:
    raw = b"<a><road><c/><road><e/></road></road><f><road/></f><road n='1'/></a>"
    given_so_far: list[list[str]] = []

    def take(element: PlainElement) -> None:
        given_so_far.append([one.tag for one in element.iter()])
        element.clear()

    root = RoadFile("a.xodr", raw).parse(take, Diagnostics())
    assert root is not None
    assert given_so_far == [["road", "c", "road", "e"], ["road"]]
    assert [one.tag for one in root.iter()] == ["a", "road", "f", "road", "road"]


def test_the_place_of_an_element_is_found_in_its_road_and_after_roads_were_emptied() -> None:
    road_text = "<road><b c='1'/>\n<link><d/></link></road>"
    file = RoadFile("a.xodr", f"<a><!-- -->{road_text}\n<e/>{road_text}</a>".encode())
    lines: list[int] = []

    def take(element: PlainElement) -> None:
        lines.extend(file.origin(one).line for one in element.iter())
        element[0].clear()

    root = file.parse(take, Diagnostics())
    assert root is not None
    assert lines == [1, 1, 2, 2, 3, 3, 4, 4]
    assert [file.origin(one).line for one in root.iter()] == [1, *lines[:4], 3, *lines[4:]]


def test_a_read_file_is_not_kept() -> None:
    """The receiver of the events is kept by lxml together with its parser until the next garbage collection."""
    gc.disable()
    try:
        file = RoadFile("a.xodr", f"<OpenDRIVE>{road()}</OpenDRIVE>".encode())
        kept = weakref.ref(file)
        assert read_network(file, Diagnostics()) is not None
        del file
        assert kept() is None
    finally:
        gc.enable()


def test_the_garbage_collector_pauses_while_a_file_is_read(tmp_path: Path) -> None:
    path = tmp_path / "made.xodr"
    path.write_text("<OpenDRIVE>" + "".join(road(str(i)) for i in range(1000)) + "</OpenDRIVE>", encoding="utf-8")
    begun: list[str] = []

    def collected(phase: str, _: dict[str, int]) -> None:
        begun.append(phase)

    usual = gc.get_threshold()
    gc.callbacks.append(collected)
    try:
        gc.set_threshold(100)
        load_network(path, cache=False)
        assert gc.isenabled()
        assert begun.count("start") < 20, "it was about 250 times"
        gc.disable()
        load_network(path, cache=False)
        assert not gc.isenabled()
    finally:
        gc.enable()
        gc.set_threshold(*usual)
        gc.callbacks.remove(collected)


NUMBERS = ("0", "-0.0", "1", "2.5e1", "1e7", "1.1e7", "-1e7", "-1.1e7", "1e12", "-2e12", "nan", "inf", "x", "")


@given(
    st.lists(st.fixed_dictionaries({}, optional=dict.fromkeys(("s", *"abcd"), st.sampled_from(NUMBERS))), max_size=4),
    st.sampled_from([0.0, -0.0, 12.5]),
)
def test_cubics_are_the_same_at_once_and_one_by_one(records: list[dict[str, str]], origin: float) -> None:
    """Each record is read alone, with its findings, and they are sorted by s."""
    tags = "".join(f"<b {' '.join(f'{name}={text!r}' for name, text in one.items())}/>" for one in records)
    file = RoadFile("a.xodr", f"<a>{tags}</a>".encode())
    root = file.parse(print, Diagnostics())
    assert root is not None
    together, alone = RoadTables(), RoadTables()
    found, expected = Diagnostics(), Diagnostics()
    Reader(file, found).cubics(together, list(root), "s", origin)
    for one in sorted(root, key=lambda one: Reader(file, Diagnostics()).number(one, "s", 0.0, limit=LENGTH_LIMIT)):
        Reader(file, expected).cubics(alone, [one], "s", origin)
    rows = [list(zip(n.cubic_s, n.cubic_a, n.cubic_b, n.cubic_c, n.cubic_d, strict=True)) for n in (together, alone)]
    assert [row for row in rows[0] if any(row[1:])] == rows[1]
    bad = [one.message for one in found if one.code.id == "SC305"]
    assert sorted(bad) == sorted(one.message for one in expected)
    starts = [Reader(file, Diagnostics()).number(one, "s", 0.0, limit=LENGTH_LIMIT) for one in root]
    assert len(found.found) - len(bad) == sum(b < a for a, b in pairwise(starts))


def test_grandchildren_are_in_the_order_of_the_file() -> None:
    root = RoadFile("a.xodr", b"<a><b><c n='1'/><d/><c n='2'/></b><c n='4'/><b><c n='3'/></b></a>").parse(
        print, Diagnostics()
    )
    assert root is not None
    assert [one.get("n") for one in grandchildren(root, "b", "c")] == ["1", "2", "3"]
    assert grandchildren(root, "c", "b") == []


def test_a_file_that_breaks_off_after_a_wrong_number_is_only_malformed(tmp_path: Path) -> None:
    path = tmp_path / "made.xodr"
    path.write_text("<OpenDRIVE>" + road().replace('hdg="0"', 'hdg="x"'), encoding="utf-8")
    sink = Diagnostics()
    assert load_network(path, cache=False, sink=sink) is None
    assert [one.code.id for one in sink] == ["SC102"]
