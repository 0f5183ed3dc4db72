"""XML is read safely, with exact places."""

from __future__ import annotations

import codecs
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.document import MAX_ATTRIBUTES, Document, parse_document, read_document, written_name

TEXT = """<?xml version="1.0"?>
<!-- <a b="no"/> -->
<a
   one="1"
   two = 'zwei'>
  <![CDATA[<b c="no"/>]]>
\t<b c="3" d=""/><b c="x > y" e="ünï"/>
</a>
"""


def _document(text: str | bytes) -> Document:
    document = parse_document(text.encode() if isinstance(text, str) else text, "a.xml", Diagnostics())
    assert document is not None
    return document


def _codes(raw: bytes) -> list[tuple[str, int]]:
    sink = Diagnostics()
    assert parse_document(raw, "a.xml", sink) is None
    return [(one.code.id, one.place.line) for one in sink]


def test_a_text_is_decoded_when_it_is_needed() -> None:
    raw = '<?xml version="1.0" encoding="iso-8859-1"?>\r\n<a b="ü"/>'.encode("iso-8859-1")
    document = _document(raw)
    assert document.source is raw
    assert document.text == '<?xml version="1.0" encoding="iso-8859-1"?>\n<a b="ü"/>'


def test_places_of_tags_and_attributes() -> None:
    document = _document(TEXT)
    first, second = document.root
    origins = [
        (document.origin(document.root), (3, 1, 2)),
        (document.origin(document.root, "one"), (4, 9, 1)),
        (document.origin(document.root, "two"), (5, 11, 4)),
        (document.origin(first), (7, 2, 2)),
        (document.origin(first).of("c"), (7, 8, 1)),
        (document.origin(second), (7, 17, 2)),
        (document.origin(second, "c"), (7, 23, 5)),
        (document.origin(second, "e"), (7, 33, 3)),
    ]
    for origin, place in origins:
        assert (origin.line, origin.column, origin.length) == place
    assert document.origin(first).source_line == '\t<b c="3" d=""/><b c="x > y" e="ünï"/>'


def test_an_empty_value_is_shown_by_its_name() -> None:
    document = _document(TEXT)
    origin = document.origin(document.root[0], "d")
    assert (origin.line, origin.column, origin.length) == (7, 11, 1)


def test_place_of_an_attributes_name() -> None:
    document = _document(TEXT)
    place = document.origin(document.root).name_of("two")
    assert (place.line, place.column, place.length, place.source_line) == (5, 4, 3, "   two = 'zwei'>")


def test_line_ends_of_every_kind_count_once() -> None:
    for end in ("\n", "\r\n", "\r"):
        document = _document(f"<a>{end}<b/>{end}  <c/></a>")
        origin = document.origin(document.root[1])
        assert (origin.line, origin.column) == (3, 3)
        assert _codes(f"<a>{end}<b/>{end}</c>".encode()) == [("SC102", 3)]


@pytest.mark.parametrize("codec", ["utf-8-sig", "utf-16", "iso-8859-1"])
def test_encodings(codec: str) -> None:
    declared = {"utf-8-sig": "utf-8", "utf-16": "utf-16", "iso-8859-1": "iso-8859-1"}[codec]
    text = f'<?xml version="1.0" encoding="{declared}"?>\n<a ä="ö" b="1"/>'
    document = _document(text.encode(codec))
    assert (document.origin(document.root, "b").line, document.origin(document.root, "b").column) == (2, 13)


@pytest.mark.parametrize("mark", [codecs.BOM_UTF8, codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE])
@pytest.mark.parametrize("declaration", ["", '<?xml version="1.0" encoding="{}"?>'])
def test_a_byte_order_mark_is_no_part_of_the_text(mark: bytes, declaration: str) -> None:
    codec = {codecs.BOM_UTF8: "UTF-8", codecs.BOM_UTF16_LE: "UTF-16LE", codecs.BOM_UTF16_BE: "UTF-16BE"}[mark]
    text = declaration.format(codec) + '<a ä="ö" b="1"/>'
    document = _document(mark + text.encode(codec))
    assert document.text == text
    assert document.origin(document.root, "b").column == text.index('b="') + 4


def test_places_of_texts() -> None:
    text = "<a>\n<b>one</b><!-- two --><?two two?>\n two <b>three</b><![CDATA[ four > ]]> &lt;five</a>"
    document = _document(text)
    places = [document.text_place(document.root, shown) for shown in ("two", "four >", "three", "<five")]
    assert [(place.line, place.column) for place in places] == [(3, 2), (3, 28), (1, 1), (1, 1)]


def test_places_of_names_with_a_prefix() -> None:
    document = _document('<a xmlns:p="urn:p"><p:b p:c="1" c="2"/></a>')
    element = document.root[0]
    assert written_name(element) == "p:b"
    assert written_name(element, "{urn:p}c") == "p:c"
    assert [document.origin(element, name).column for name in ("{urn:p}c", "c")] == [30, 36]
    assert document.origin(element).name_of("{urn:p}c").column == 25


@pytest.mark.parametrize(
    ("raw", "expected"),
    [
        (b"", [("SC102", 1)]),
        (b"<a>\n<b></a>", [("SC102", 2)]),
        (b"<a>\x00</a>", [("SC102", 1)]),
        (b"\xff\xfe\xff", [("SC102", 1)]),
        (b"just text", [("SC102", 1)]),
        (b'<a>\n<b c="1" c="2"/></a>', [("SC102", 2)]),
        (b"<?xml version='1.0'?>\n<!DOCTYPE a>\n<a/>", [("SC103", 2)]),
        (codecs.BOM_UTF16_LE + "<!DOCTYPE a><a/>".encode("utf-16-le"), [("SC103", 1)]),
        (b"<a" + "".join(f' b{i}="1"' for i in range(MAX_ATTRIBUTES + 1)).encode() + b"/>", [("SC103", 1)]),
    ],
)
def test_files_that_are_refused(raw: bytes, expected: list[tuple[str, int]]) -> None:
    assert _codes(raw) == expected


def test_a_doctype_in_a_comment_is_ignored() -> None:
    assert _document("<!-- <!DOCTYPE a> --><a/>").root.tag == "a"


def test_entities_are_never_resolved() -> None:
    lol = "".join(f'<!ENTITY l{i} "{f"&l{i - 1};" * 10 if i else "lol"}">' for i in range(9))
    assert _codes(f"<!DOCTYPE a [{lol}]><a>&l8;</a>".encode()) == [("SC103", 1)]


def test_deep_nesting_is_one_finding() -> None:
    assert [code for code, _ in _codes(b"<a>" * 100_000)] == ["SC102"]


@pytest.mark.parametrize("name", ["missing.xml", ".", "a\0b.xml"])
def test_unreadable_paths(tmp_path: Path, name: str) -> None:
    sink = Diagnostics()
    assert read_document(f"{tmp_path}/{name}", sink) is None
    assert [one.code.id for one in sink] == ["SC101"]


def test_a_missing_file_is_compared_with_its_neighbours(tmp_path: Path) -> None:
    (tmp_path / "conflict.xml").write_text("<a/>", encoding="utf-8")
    sink = Diagnostics()
    read_document(tmp_path / "conflcit.xml", sink)
    assert [one.hint for one in sink] == ["did you mean 'conflict.xml'?"]


def test_a_common_suffix_does_not_make_the_names_of_files_alike(tmp_path: Path) -> None:
    for name in ("s1.xml", "s2.xml"):
        (tmp_path / name).write_text("<a/>", encoding="utf-8")
    sink = Diagnostics()
    read_document(tmp_path / "nope.xml", sink)
    assert [one.hint for one in sink] == ["known: s1.xml, s2.xml"]


def test_a_file_that_is_there_is_not_offered_for_itself(tmp_path: Path) -> None:
    (tmp_path / "loop1.xml").symlink_to("loop1.xml")
    (tmp_path / "dangling.xml").symlink_to("nowhere.xml")
    (tmp_path / "folder.xml").mkdir()
    sink = Diagnostics()
    for name in ("loop1.xml", "folder.xml", "dangling.xml"):
        assert read_document(tmp_path / name, sink) is None
    assert [one.hint for one in sink.found] == ["", "", ""]
    assert [one.message for one in sink.found][2] == "cannot read the file: it is a link to a missing file"


def test_a_documents_folder_is_where_relative_paths_start(tmp_path: Path) -> None:
    (tmp_path / "a.xml").write_text("<a/>", encoding="utf-8")
    document = read_document(tmp_path / "a.xml", Diagnostics())
    assert document is not None
    assert document.folder == tmp_path


@given(raw=st.one_of(st.binary(max_size=60), st.text(alphabet="<>/a=\"' !-[]?&;\n", max_size=60).map(str.encode)))
def test_any_bytes_give_a_document_or_a_finding(raw: bytes) -> None:
    sink = Diagnostics()
    document = parse_document(raw, "a.xml", sink)
    assert (document is None) == sink.has_errors


@given(
    values=st.lists(st.text(alphabet="ab <>&\"'\n\t=/-", max_size=8), min_size=1, max_size=5),
    comment=st.text(alphabet='ab <>="/', max_size=10),
)
def test_every_start_tag_is_found_where_it_stands(values: list[str], comment: str) -> None:
    root = etree.Element("root")
    for value in values:
        root.append(etree.Comment(comment))
        etree.SubElement(root, "child", first=value, second="2")
    text = etree.tostring(root, encoding="unicode")
    document = _document(text)
    for child in document.root.iter("child"):
        line, column, _ = document.position(child, None)
        assert document.line_text(line)[column - 1 :].startswith("<child")
        line, column, length = document.position(child, "second")
        assert document.line_text(line)[column - 1 : column - 1 + length] == "2"


def test_a_fault_in_a_very_long_line_has_its_column() -> None:
    """Programs write whole files as one line; the line itself is not shown."""
    sink = Diagnostics()
    text = f'<a b="{"x" * 600}" c="<"/>'
    assert parse_document(text.encode(), "a.xml", sink) is None
    (found,) = sink
    assert (found.place.line, found.place.column, found.place.source_line) == (1, text.rindex("<") + 1, "")
