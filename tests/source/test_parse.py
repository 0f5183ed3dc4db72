"""The kind of a file follows from its first element, and no file, however odd, crashes the reader."""

from __future__ import annotations

import contextlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.document import parse_document
from scenario_compiler.languages import ScenarioNameNeededError, check_source, expand, parse
from scenario_compiler.source.aisa_file import AisaConfig
from scenario_compiler.source.conflict import Library
from tests.source.made import EGO, codes_of, library_text, parsed


@pytest.mark.parametrize(
    ("text", "kind"),
    [('<scenarios version="1"/>', Library), ('<catalog version="1"/>', Library), ("<config/>", AisaConfig)],
)
def test_the_first_element_decides(text: str, kind: type) -> None:
    assert isinstance(parsed(text, Diagnostics()), kind)


@pytest.mark.parametrize(
    ("text", "code"),
    [("<OpenSCENARIO/>", "SC108"), ("<scenarioz/>", "SC116"), ('<a xmlns="urn:x"/>', "SC116")],
)
def test_other_first_elements_are_reported(text: str, code: str) -> None:
    sink = Diagnostics()
    document = parse_document(text.encode(), "a.xml", sink)
    assert document is not None
    assert parse(document, sink) is None
    assert [one.code.id for one in sink] == [code]


@pytest.mark.parametrize("text", ['<scenarios version="1"/>', "<config/>", '<catalog version="1"/>'])
def test_a_file_without_scenarios(text: str) -> None:
    sink = Diagnostics()
    assert expand(parsed(text, sink), None, {}, sink) is None
    assert [one.code.id for one in sink] == ["SC212"]


def test_another_version_is_reported() -> None:
    assert codes_of(library_text().replace('version="1"', 'version="2"')) == ["SC111"]


@pytest.mark.parametrize(
    "attribute",
    ['xmlns:x="urn:x" x:a="1"', 'xml:base="."', 'xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:nil="true"'],
)
def test_attributes_of_other_namespaces_are_reported(attribute: str) -> None:
    assert codes_of(library_text(ego=EGO.replace("<ego", f"<ego {attribute}"))) == ["SC106"]


def test_comments_and_instructions_are_ignored() -> None:
    odd = "<!-- a --><?b c?>"
    text = library_text(f"{odd}<criteria>{odd}<no_collision/>{odd}</criteria>{odd}", head=odd)
    assert codes_of(text) == []


TAGS = (
    "scenarios", "scenario", "template", "use", "static", "dynamic", "when", "do", "time", "at", "ahead_of", "ego",
    "start", "lane", "parameter", "takeover", "driver", "include", "catalog", "vehicle", "x",
)  # fmt: skip
ATTRIBUTES = (
    "name",
    "id",
    "template",
    "version",
    "entity",
    "distance",
    "type",
    "default",
    "min",
    "model",
    "map",
    "file",
)
TEXTS = (
    "a",
    "1",
    "-1",
    "$a",
    "${1/0}",
    "${a",
    "",
    "ego",
    "number",
    "template",
    "a.b",
    "nan",
    "${'x'}",
    "${(1)^(99)^9}",
)


@st.composite
def trees(draw: st.DrawFn, depth: int = 4) -> str:
    """Draw an element of known words in no sensible arrangement."""
    tag = draw(st.sampled_from(TAGS))
    attributes = draw(st.dictionaries(st.sampled_from(ATTRIBUTES), st.sampled_from(TEXTS), max_size=4))
    inner = "".join(draw(st.lists(trees(depth - 1), max_size=3))) if depth else ""
    written = "".join(f' {name}="{text}"' for name, text in attributes.items())
    return f"<{tag}{written}>{inner}</{tag}>"


@given(items=trees(), head=trees())
def test_no_file_brings_the_reader_down(items: str, head: str) -> None:
    for text in (items, f'<scenarios version="1">{head}<scenario name="a" map="m">{EGO}{items}</scenario></scenarios>'):
        sink = Diagnostics()
        document = parse_document(text.encode(), "a.xml", sink)
        source = parse(document, sink) if document else None
        if source is not None:
            check_source(source, sink)
            with contextlib.suppress(ScenarioNameNeededError):
                expand(source, None, {"a": "1"}, sink)
        assert all(one.place.file for one in sink)
