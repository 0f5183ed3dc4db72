"""The structure of road files: every fault at its place, and the verdict on real files."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.document import parse_document, read_document
from scenario_compiler.roads.structure import check_structure
from scenario_compiler.roads.structure.grammar import FIRST_MINOR, LAST_MINOR, OPENDRIVE, declarations
from scenario_compiler.roads.structure.words import KINDS, WORDS

VERSIONS = range(FIRST_MINOR, LAST_MINOR + 1)

FILE = """\
<OpenDRIVE>
  <header revMajor="1" revMinor="7"/>
  <road id="1" length="10" junction="-1">
    <planView>
      <geometry s="0" x="0" y="0" hdg="0" length="10"><line/></geometry>
    </planView>
    <lanes>
      <laneSection s="0">
        <center><lane id="0" type="none"><link/><border sOffset="0" a="0" b="0" c="0" d="0"/></lane></center>
      </laneSection>
    </lanes>
    <objects>
      <object id="7" s="1" t="2" zOffset="0"/>
    </objects>
  </road>
</OpenDRIVE>
"""


SWITCH = '<railroad><switch id="1" name="" position="turn"/></railroad>'
REFERENCE = '<signals><signalReference id="4" s="0" t="0" orientation="+"/></signals>'


def check(text: str) -> tuple[bool, list[tuple[str, int, int, str, str]]]:
    sink = Diagnostics()
    document = parse_document(text.encode(), "made.xodr", sink)
    assert document is not None
    valid = check_structure(document, sink)
    return valid, [(d.code.id, d.place.line, d.place.column, d.message, d.hint) for d in sink]


def test_a_valid_file_has_no_finding() -> None:
    assert check(FILE) == (True, [])


@pytest.mark.parametrize(
    ("old", "new", "code", "line", "column", "hint"),
    [
        ("<line/>", "<lime/>", "SC320", 5, 55, "did you mean 'line'?"),
        ("<lanes>", "<crossSectionSurface/><lanes>", "SC320", 7, 5, ""),
        (
            "</planView>",
            '</planView><lateralProfile><crossfall side="both" s="0" a="0" b="0" c="0" d="0"/></lateralProfile>',
            "SC320",
            6,
            32,
            "it belongs to OpenDRIVE 1.1, 1.2, 1.3, 1.4, 1.5; the file's version is 1.7",
        ),
        ('hdg="0"', 'hdg="0" kurve="1"', "SC321", 5, 43, ""),
        ('t="2"', 't="2" outlineId="1"', "SC321", 13, 34, ""),
        ('revMinor="7"', 'revMinor="7" vendr="x"', "SC321", 2, 37, "did you mean 'vendor'?"),
        (' hdg="0"', "", "SC322", 5, 7, ""),
        ('x="0"', 'x="left"', "SC323", 5, 26, ""),
        ('length="10"><line', 'length="0"><line', "SC323", 5, 51, ""),
        ('type="none"', 'type="drivng"', "SC323", 9, 36, "did you mean 'driving'?"),
        ('type="none"', 'type="slipLane"', "SC323", 9, 36, "it belongs to OpenDRIVE 1.8; the file's version is 1.7"),
        ('lane id="0"', 'lane id="1"', "SC323", 9, 27, ""),
        ("</objects>", "</objects><lanes/>", "SC324", 14, 15, ""),
        ("</objects>", f"</objects>{SWITCH}", "SC325", 14, 25, ""),
        ("<planView>", "words <planView>", "SC326", 4, 5, ""),
        ("<object id", '<object id="7" s="1" t="2" zOffset="0"/><object id', "SC327", 13, 59, ""),
        (
            "</objects>",
            '</objects><signals><signalReference id="4" s="0" t="0" orientation="+"/></signals>',
            "SC328",
            14,
            45,
            "",
        ),
        ('revMinor="7"', 'revMinor="9"', "SC329", 2, 3, ""),
        ("<OpenDRIVE>", '<OpenDRIVE xmlns="made.up">', "SC320", 1, 1, ""),
    ],
)
def test_a_fault_is_found_at_its_place(old: str, new: str, code: str, line: int, column: int, hint: str) -> None:
    text = FILE.replace(old, new, 1)
    valid, found = check(text)
    assert valid == (code == "SC329")
    assert (code, line, column) in [one[:3] for one in found]
    if hint:
        assert hint in [one[4] for one in found]


def test_a_file_without_header_or_version_is_invalid() -> None:
    assert [one[:2] for one in check("<OpenDRIVE><road/></OpenDRIVE>")[1]] == [("SC325", 1)]
    assert check(FILE.replace(' revMinor="7"', ""))[0] is False
    assert check("<roads/>")[0] is False


@pytest.mark.parametrize(
    "inside",
    [
        '<object id="1" s="1" t="2" zOffset="0" radius="1" length="2"/>',
        '<object id="1" s="1" t="2" zOffset="0" width="2"/>',
        '<object id="1" s="1" t="2" zOffset="0" type="tree"><parkingSpace access="all"/></object>',
    ],
)
def test_what_stands_together_since_1_8(inside: str) -> None:
    text = FILE.replace("<border", "<!--<border").replace("/></lane>", "/>--></lane>")
    text = text.replace('<object id="7" s="1" t="2" zOffset="0"/>', inside)
    assert [one[0] for one in check(text.replace('revMinor="7"', 'revMinor="8"'))[1]] == ["SC330"]
    assert check(
        text.replace(' type="none"', "").replace('revMinor="7"', 'revMinor="4"').replace("<!--", "").replace("-->", "")
    )


def test_the_tables_are_complete() -> None:
    """Every child and every kind of value that a table names is declared, in every version."""
    for minor in VERSIONS:
        known = declarations(minor)
        for declaration in known.values():
            cases = declaration.switch[1].values() if declaration.switch else ()
            assert {name.declaration for name in declaration.content.names[1:]} | set(cases) <= set(known)
            for attribute in declaration.attributes.values():
                assert not attribute.kind or attribute.kind in KINDS or attribute.kind in WORDS
    used = {a.kind for minor in VERSIONS for d in declarations(minor).values() for a in d.attributes.values()}
    texts = {d.text for minor in VERSIONS for d in declarations(minor).values() if d.text}
    assert set(WORDS) | set(KINDS) <= used | texts


def test_versions_of_elements_attributes_and_words() -> None:
    assert OPENDRIVE.versions_of("paramPoly3") == [4, 5, 6, 7, 8]
    assert OPENDRIVE.versions_of("crossfall") == [1, 2, 3, 4, 5]
    assert OPENDRIVE.versions_of("road", "rule") == [5, 6, 7, 8]
    assert OPENDRIVE.versions_of("connection", "linkedRoad") == [7, 8]
    assert "slipLane" in OPENDRIVE.words_of("lane_type", 8)
    assert "slipLane" not in OPENDRIVE.words_of("lane_type", 7)


DIFFERENT = {
    "Scenic/assets/maps/CARLA/Town04.xodr": "objects follow a bridge, which the schema of 1.4 puts last; "
    "by that schema, too, the file is invalid, though the list calls it valid",
}
"""Files whose verdict differs from the corpus's list, and why."""


@pytest.mark.parametrize("every", [4, pytest.param(1, marks=pytest.mark.slow)])
def test_the_verdict_agrees_with_the_corpus(corpus: Path, every: int) -> None:
    """On every file, but for the differences that are explained."""
    different, compared = [], set()
    with (corpus / "MANIFEST.csv").open(encoding="utf-8", newline="") as rows:
        judged = [
            row
            for row in csv.DictReader(rows)
            if row["subtype"] == "road" and row["validation"] in {"valid", "invalid"} and row["version"] >= "1.1"
        ]
        for row in judged[::every]:
            sink = Diagnostics()
            document = read_document(corpus / row["file"], sink)
            assert document is not None
            compared.add(row["file"])
            valid = check_structure(document, sink)
            assert valid != sink.has_errors
            if valid != (row["validation"] == "valid"):
                different.append(row["file"])
    assert len(compared) > 190 // every
    assert sorted(different) == sorted(compared & set(DIFFERENT))


ASAM = "http://code.asam.net/simulation/standard/opendrive_schema"


@pytest.mark.parametrize(
    ("namespace", "minor", "valid"),
    [
        (ASAM, 8, True),
        (ASAM, 7, True),
        (f"{ASAM.replace('http', 'https')}/", 8, True),
        (ASAM, 5, False),
        ("urn:other", 8, False),
        ("www.vires.com", 2, True),
    ],
)
def test_a_file_may_be_in_its_versions_namespace(namespace: str, minor: int, valid: bool) -> None:
    found = check(
        f"""\
<OpenDRIVE xmlns="{namespace}"><header revMajor="1" revMinor="{minor}"/><road id="1" length="10" junction="-1">
<planView><geometry s="0" x="0" y="0" hdg="0" length="10"><line/></geometry></planView>
<lanes><laneSection s="0"><center><lane id="0" type="none"/></center></laneSection></lanes></road></OpenDRIVE>
"""
    )
    assert found[0] == valid
    wrong = f"the elements are in the namespace '{namespace}', which OpenDRIVE 1.{minor} does not have"
    assert [one[3] for one in found[1]] == ([] if valid else [wrong])


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('type="2"', 'type="driving"'),
        ('<road id="1"', '<road id="a"'),
        ('level="0"', 'level="false"'),
        ('junction="-1"', 'junction="x"'),
    ],
)
def test_numbers_of_1_1_are_numbers(old: str, new: str) -> None:
    """Types, levels and ids are unsigned integers in the schema of 1.1, and texts from 1.2 on."""
    good = """\
<OpenDRIVE><header revMajor="1" revMinor="1"/><road id="1" length="10" junction="-1">
<planView><geometry s="0" x="0" y="0" hdg="0" length="10"><line/></geometry></planView>
<lanes><laneSection s="0"><right><lane id="-1" type="2" level="0">
<width sOffset="0" a="3" b="0" c="0" d="0"/></lane></right></laneSection></lanes></road></OpenDRIVE>
"""
    assert check(good) == (True, [])
    assert [one[0] for one in check(good.replace(old, new))[1]] == ["SC323"]
