"""The structure of OpenSCENARIO files: every fault at its place, its name, and the verdict on real files."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from lxml import etree

from scenario_compiler.diagnostics import Diagnostics, Severity
from scenario_compiler.document import Document, parse_document
from scenario_compiler.openscenario.structure import check_structure, elements, file_version
from scenario_compiler.openscenario.structure.grammar import OPENSCENARIO
from scenario_compiler.openscenario.structure.words import KINDS, WORDS, loosely
from scenario_compiler.openscenario.validation import validate_openscenario

FILE = """\
<OpenSCENARIO>
  <FileHeader revMajor="1" revMinor="2" author="a" date="2020-10-01T12:00:00" description=""/>
  <ParameterDeclarations/>
  <CatalogLocations/>
  <RoadNetwork><LogicFile filepath="road.xodr"/></RoadNetwork>
  <Entities>
    <ScenarioObject name="Ego"><CatalogReference catalogName="cars" entryName="car"/></ScenarioObject>
  </Entities>
  <Storyboard>
    <Init>
      <Actions>
        <Private entityRef="Ego">
          <PrivateAction>
            <TeleportAction><Position><WorldPosition x="1" y="$y"/></Position></TeleportAction>
          </PrivateAction>
        </Private>
      </Actions>
    </Init>
    <Story name="story">
      <Act name="act">
        <ManeuverGroup maximumExecutionCount="1" name="group">
          <Actors selectTriggeringEntities="false"><EntityRef entityRef="Ego"/></Actors>
          <Maneuver name="maneuver">
            <Event name="event" priority="overwrite">
              <Action name="action"><PrivateAction><RoutingAction><AcquirePositionAction>
                <Position><WorldPosition x="${2*$y}" y="0"/></Position>
              </AcquirePositionAction></RoutingAction></PrivateAction></Action>
              <StartTrigger>
                <ConditionGroup>
                  <Condition conditionEdge="none" delay="0" name="near">
                    <ByEntityCondition>
                      <TriggeringEntities triggeringEntitiesRule="any"><EntityRef entityRef="Ego"/></TriggeringEntities>
                      <EntityCondition>
                        <RelativeDistanceCondition entityRef="Ego" freespace="true" rule="lessThan" value="9"
                          relativeDistanceType="cartesianDistance"/>
                      </EntityCondition>
                    </ByEntityCondition>
                  </Condition>
                </ConditionGroup>
              </StartTrigger>
            </Event>
          </Maneuver>
        </ManeuverGroup>
        <StartTrigger/>
      </Act>
    </Story>
    <StopTrigger/>
  </Storyboard>
</OpenSCENARIO>
"""

HEADER = 'revMajor="1" revMinor="2"'


def made(text: str) -> Document:
    document = parse_document(text.encode(), "made.xosc", Diagnostics())
    assert document is not None
    return document


def check(text: str, *, forgiving: bool = False) -> list[tuple[str, int, int, str, str]]:
    sink = Diagnostics()
    check_structure(made(text), sink, forgiving=forgiving)
    return [(one.code.id, one.place.line, one.place.column, one.message, one.hint) for one in sink]


def errors(text: str, *, forgiving: bool = False) -> int:
    sink = Diagnostics()
    check_structure(made(text), sink, forgiving=forgiving)
    return sum(one.severity is Severity.ERROR for one in sink)


def test_a_valid_file_has_no_finding() -> None:
    assert check(FILE) == []
    for minor in (1, 3):
        assert check(FILE.replace(HEADER, f'revMajor="1" revMinor="{minor}"')) == []


@pytest.mark.parametrize(
    ("old", "new", "code", "line", "column", "hint"),
    [
        ("<RoadNetwork>", "<RoadNetwrk/><RoadNetwork>", "SC701", 5, 3, "did you mean 'RoadNetwork'?"),
        ('x="1"', 'x="1" hdg="0"', "SC702", 14, 60, "known: h, p, r, x, y, z"),
        ('entityRef="Ego">\n', ">\n", "SC703", 12, 9, ""),
        ('maximumExecutionCount="1"', 'maximumExecutionCount="-1"', "SC704", 21, 47, ""),
        ('x="1"', 'x="${1"', "SC704", 14, 57, ""),
        ('"lessThan"', '"lesThan"', "SC704", 34, 91, "did you mean 'lessThan'?"),
        ('date="2020-10-01T12:00:00"', 'date="${1}"', "SC704", 2, 58, ""),
        ("<RoadNetwork>", "<CatalogLocations/><RoadNetwork>", "SC705", 5, 3, ""),
        ('<WorldPosition x="1" y="$y"/>', '<WorldPosition x="1" y="0"/><GeoPosition/>', "SC705", 14, 67, ""),
        ("  <CatalogLocations/>\n", "", "SC706", 4, 3, ""),
        ("<Entities>", "<Entities>cars", "SC707", 6, 13, ""),
        (
            "<TeleportAction>",
            '<TrailerAction><ConnectTrailerAction trailerRef="b"/></TrailerAction><TeleportAction>',
            "SC708",
            14,
            13,
            "it belongs to OpenSCENARIO 1.3; the file's version is 1.2",
        ),
        ("  <StopTrigger/>\n  </Storyboard>", "  </Storyboard>", "SC708", 9, 3, ""),
        ('"Ego"><Catalog', '"Ego" x=""><Catalog', "SC702", 7, 32, ""),
        ("<EntityRef entityRef", "<EntityRef  ref", "SC702", 22, 64, "known: entityRef"),
        ("<ParameterDeclarations/>", "", "SC710", 0, 0, ""),
    ],
)
def test_a_fault_is_found_at_its_place(old: str, new: str, code: str, line: int, column: int, hint: str) -> None:
    text = FILE.replace(old, new, 1)
    if code == "SC710":
        text = text.replace("<RoadNetwork>", "<ParameterDeclarations/><RoadNetwork>")
        line, column = 5, 3
    found = check(text)
    assert (code, line, column) in [one[:3] for one in found]
    if hint:
        assert hint in [one[4] for one in found]


@pytest.mark.parametrize(
    ("minor", "old", "new", "line"),
    [
        (0, "", "", 26),  # an expression, in 1.0
        (0, 'x="${2*$y}"', 'x="2"', 0),
        (1, '"overwrite"', '"override"', 24),
        (0, '"cartesianDistance"', '"euclidianDistance"', 35),
        (0, "<RoadNetwork>", '<RoadNetwork><UsedArea><Position/><Position/></UsedArea><LogicFile filepath=""/>', 5),
        (1, "<ParameterDeclarations/>", "<ParameterDeclarations/><VariableDeclarations/>", 3),
    ],
)
def test_words_of_other_versions_are_reported_and_accepted(minor: int, old: str, new: str, line: int) -> None:
    text = FILE.replace(HEADER, f'revMajor="1" revMinor="{minor}"').replace(old, new, 1 if old else 0)
    found = check(text)
    if not line:
        assert found == []
        return
    assert ("SC708", line) in [one[:2] for one in found]
    assert errors(text) > 0
    assert errors(text, forgiving=True) == sum(one[0] not in {"SC708", "SC710"} for one in found)


@pytest.mark.parametrize(
    ("old", "new", "code"),
    [
        ('"false"', '"False"', "SC712"),
        ('"lessThan"', '" lessthan"', "SC712"),
        ('"cartesianDistance"', '"euclideanDistance"', "SC712"),
        ('maximumExecutionCount="1"', 'maximumExecutionCount="1.0"', "SC712"),
        ('y="$y"', 'y=" $y"', "SC712"),
        ('date="2020-10-01T12:00:00"', 'date="2020-1-1"', "SC712"),
        ('date="2020-10-01T12:00:00"', 'date="today"', "SC704"),
        ('author="a" ', "", "SC703"),
        ('<WorldPosition x="1" y="$y"/>', '<WorldPosition x="1" y="$y">\n</WorldPosition>', "SC711"),
    ],
)
def test_faults_with_a_clear_meaning_are_accepted(old: str, new: str, code: str) -> None:
    text = FILE.replace(old, new, 1)
    assert [one[0] for one in check(text)] == [code]
    assert (errors(text), errors(text, forgiving=True)) == (1, 0)


@pytest.mark.parametrize(
    ("kind", "text", "meant"),
    [
        ("Boolean", "TRUE", "true"),
        ("Boolean", "yes", None),
        ("Double", "one", None),
        ("Double", "1,5", None),
        ("Int", "-2.0", "-2"),
        ("DateTime", "2020-02-20 8:30", "2020-02-20T08:30:00"),
        ("DateTime", "2020-02-31", None),
        ("Priority", "Skip", "skip"),
        ("Priority", "$p ", "$p"),
        ("Priority", "never", None),
    ],
)
def test_loose_values(kind: str, text: str, meant: str | None) -> None:
    assert loosely(kind, text, 2) == meant


@pytest.mark.parametrize(
    ("header", "code", "version"),
    [
        ('revMajor="0" revMinor="9"', "SC709", (1, 1)),
        ('revMajor="1" revMinor="9"', "SC741", None),
        ('revMajor="2" revMinor="0"', "SC741", None),
        ('revMajor="${1}" revMinor="$minor"', "SC741", None),
        ('revMajor="1"', "SC703", None),
        ('revMajor="one" revMinor="2"', "SC704", None),
        ('revMajor="1" revMinor="65536"', "SC704", None),
    ],
)
def test_versions(header: str, code: str, version: tuple[int, int] | None) -> None:
    sink = Diagnostics()
    text = FILE.replace(HEADER, header)
    assert check_structure(made(text), sink) == version
    assert [one.code.id for one in sink] == [code]
    assert sink.has_errors == (code != "SC741")
    forgiven = Diagnostics()
    assert check_structure(made(text), forgiven, forgiving=True) is not None
    assert {one.severity for one in forgiven if one.code.id != "SC704"} <= {Severity.WARNING}
    assert file_version(made(FILE)) == (1, 2)


def test_a_file_of_the_format_before_is_not_read() -> None:
    text = '<OpenSCENARIO><FileHeader revMajor="0" revMinor="9"/><Catalogs/></OpenSCENARIO>'
    assert [one[0] for one in check(text)] == ["SC709"]


def test_a_file_without_header_or_root_is_invalid() -> None:
    assert [one[:2] for one in check("<OpenSCENARIO><Entities/></OpenSCENARIO>")] == [("SC706", 1)]
    assert [one[:2] for one in check("<Scenario/>")] == [("SC701", 1)]
    assert check(FILE.replace("<OpenSCENARIO>", '<OpenSCENARIO xmlns="urn:x">'))[0][0] == "SC701"
    assert check(FILE.replace("OpenSCENARIO>", "OpenScenario>")) == []


def test_a_comment_with_two_hyphens_is_one_error_among_all(tmp_path: Path) -> None:
    file = tmp_path / "hyphens.xosc"
    file.write_text(FILE.replace("<Entities>", "<!-- fast -- or slow -->\n<Entities>x"), encoding="utf-8")
    sink = Diagnostics()
    validate_openscenario(file, sink)
    assert [(one.code.id, one.severity, one.place.line) for one in sink] == [
        ("SC740", Severity.ERROR, 6),
        ("SC707", Severity.ERROR, 7),
    ]


def test_the_tables_are_complete() -> None:
    """Every child and every kind of value that a table names is declared, and all that is declared is reached."""
    reached: set[str] = set()
    used: set[str] = set()
    for minor in OPENSCENARIO.minors:
        known = OPENSCENARIO.declarations(minor)
        for declaration in known.values():
            assert {name.declaration for name in declaration.content.names[1:]} <= set(known)
            used |= {attribute.kind for attribute in declaration.attributes.values() if attribute.kind}
        reached |= OPENSCENARIO.reachable(minor)
    assert reached == set(known)
    assert used == set(KINDS) | set(WORDS)


def test_elements_tell_their_versions() -> None:
    found = elements()
    assert len(found) > 270
    assert (found["Trailer"].since, found["Trailer"].until) == (3, 3)
    assert (found["WorldPosition"].since, found["WorldPosition"].until) == (0, 3)
    assert found["Axle"].tags == ("FrontAxle", "RearAxle", "AdditionalAxle")
    assert found["GeoPosition"].attributes["latitudeDeg"] == (2, 3)
    assert found["Phase"].children["TrafficeSignalGroupState"] == (2, 2)
    assert found["OpenSCENARIO"].tags == ("OpenSCENARIO",)
    assert found["ParameterValueDistribution"].since == 1


def test_the_verdict_agrees_with_the_corpus(corpus: Path) -> None:
    different, compared = [], 0
    with (corpus / "MANIFEST.csv").open(encoding="utf-8", newline="") as rows:
        for row in csv.DictReader(rows):
            if row["kind"] == "xosc":
                sink = Diagnostics()
                validate_openscenario(corpus / row["file"], sink)
                if row["validation"] != "no-xsd":
                    compared += 1
                    if sink.has_errors != (row["validation"] != "valid"):
                        different.append(row["file"])
    assert compared > 380
    assert different == []


def test_mutilated_files_give_findings_only(corpus: Path) -> None:
    """Elements and attributes in any place, in any version, give findings and nothing else."""
    draw = np.random.default_rng(5)
    files = sorted((corpus / "openscenario.api.test").rglob("*.xosc"))
    checked = 0
    for file in (files[at] for at in draw.integers(len(files), size=60)):
        try:
            root = etree.parse(str(file), etree.XMLParser(resolve_entities=False)).getroot()
        except etree.XMLSyntaxError:
            continue
        for _ in range(20):
            _mutilate(list(root.iter(etree.Element)), draw)
        document = Document("made.xosc", etree.tostring(root).decode(), root)
        sink = Diagnostics()
        check_structure(document, sink, forgiving=bool(draw.integers(2)))
        assert all(one.message for one in sink)
        checked += 1
    assert checked > 40


def _mutilate(nodes: list[etree._Element], draw: np.random.Generator) -> None:
    """Give one element the attributes, and perhaps the tag, of another, and move it there."""
    one, other = nodes[draw.integers(1, len(nodes))], nodes[draw.integers(len(nodes))]
    for name, value in other.attrib.items():
        one.set(name, str(value)[:50] * int(draw.choice((0, 1, 900))))
    if draw.random() < 0.5:
        one.tag = other.tag
    if one is not other and one not in other.iterancestors():
        other.append(one)
