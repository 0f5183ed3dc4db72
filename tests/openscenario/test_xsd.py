"""ASAM's schemas and rules: our declarations say the same, and they give the verdict where the user has them."""

from __future__ import annotations

import copy
import csv
from pathlib import Path

import pytest
from lxml import etree

from scenario_compiler.diagnostics import Diagnostics, Severity
from scenario_compiler.document import Document, parse_document
from scenario_compiler.openscenario.structure import check_structure
from scenario_compiler.openscenario.structure.grammar import FIRST_MINOR, LAST_MINOR, OPENSCENARIO
from scenario_compiler.openscenario.structure.words import WORDS
from scenario_compiler.openscenario.validation import validate_openscenario
from scenario_compiler.openscenario.xsd import is_installed, validate_with_xsd
from scenario_compiler.structure.content import AnyOrder, Choice, Content, Model, Name, Repeat, Sequence
from scenario_compiler.structure.schemas import Schemas, find_schema
from tests.asam import schemas_of_wheel
from tests.command import call

XS = "{http://www.w3.org/2001/XMLSchema}"
VERSIONS = range(FIRST_MINOR, LAST_MINOR + 1)

with_checker = pytest.mark.skipif(
    not is_installed(), reason="ASAM's checker is not installed (the extra asam, which needs lxml below 6)"
)
without_checker = pytest.mark.skipif(is_installed(), reason="ASAM's checker is installed")


@pytest.fixture(scope="session")
def schemas() -> Path:
    """Folder of ASAM's schemas of OpenSCENARIO XML."""
    return schemas_of_wheel("asam-qc-openscenarioxml", "qc_openscenario")


def schema_root(schemas: Path, minor: int) -> etree._Element:
    path = find_schema(schemas, "OpenSCENARIO", minor)
    assert path is not None
    return etree.parse(str(path)).getroot()


def our_name(type_name: str) -> str:
    """Return the name of our declaration of a type: all locations of catalogs are one."""
    if type_name.endswith("CatalogLocation"):
        return "CatalogLocation"
    return "OpenSCENARIO" if type_name == "OpenScenario" else type_name


def model_of(part: etree._Element, root: etree._Element) -> Model:
    """Return the content model of a part of a schema's type."""
    inner: Model
    if part.tag == f"{XS}element":
        inner = Name(part.get("name", ""), our_name(part.get("type", "")))
    elif part.tag == f"{XS}group":
        group = next(one for one in root.findall(f"{XS}group") if one.get("name") == part.get("ref"))
        inner = Sequence(tuple(model_of(one, root) for one in group if one.tag != f"{XS}annotation"))
    else:
        parts = tuple(model_of(one, root) for one in part if one.tag != f"{XS}annotation")
        inner = Choice(parts) if part.tag == f"{XS}choice" else Sequence(parts)
    least, most = int(part.get("minOccurs", "1")), part.get("maxOccurs", "1")
    return inner if (least, most) == (1, "1") else Repeat(inner, least, None if most == "unbounded" else int(most))


def content_of(declared: etree._Element, root: etree._Element) -> Content:
    kinds = {f"{XS}{kind}" for kind in ("sequence", "choice", "group", "all")}
    part = next((one for one in declared if one.tag in kinds), None)
    if part is None:
        return Content.of(Sequence(()))
    if part.tag != f"{XS}all":
        return Content.of(model_of(part, root))
    return AnyOrder.of_parts(
        (Name(one.get("name", ""), our_name(one.get("type", ""))), one.get("minOccurs") != "0") for one in part
    )


def same(one: Content, other: Content) -> bool:
    """Tell whether two automata take the same children."""
    tags = set(one.tags()) | set(other.tags())
    if any(one.declaration(tag) != other.declaration(tag) for tag in tags):
        return False
    pending, seen = [(one.start, other.start)], set()
    while pending:
        pair = pending.pop()
        if pair in seen:
            continue
        seen.add(pair)
        if one.complete(pair[0]) != other.complete(pair[1]):
            return False
        for tag in tags:
            after = (one.move(pair[0], tag), other.move(pair[1], tag))
            if bool(after[0]) != bool(after[1]):
                return False
            if after[0]:
                pending.append(after)
    return True


@pytest.mark.parametrize("minor", VERSIONS)
def test_our_declarations_agree_with_the_schema(schemas: Path, minor: int) -> None:
    root = schema_root(schemas, minor)
    types = {our_name(one.get("name", "")): one for one in root.findall(f"{XS}complexType")}
    assert set(types) == OPENSCENARIO.reachable(minor)
    different = []
    for name, declared in types.items():
        ours = OPENSCENARIO.declaration(name, minor)
        attributes = {
            one.get("name"): (one.get("type", "").replace("String", ""), one.get("use") == "required")
            for one in declared.iter(f"{XS}attribute")
        }
        text = declared.find(f"{XS}simpleContent") is not None
        if attributes != {name: (one.kind, one.required) for name, one in ours.attributes.items()}:
            different.append(f"attributes of {name}")
        if not same(ours.content, content_of(declared, root)) or text != (ours.text is not None):
            different.append(f"children of {name}")
    assert different == []


@pytest.mark.parametrize("minor", VERSIONS)
def test_our_words_are_the_schema_s(schemas: Path, minor: int) -> None:
    found = {
        str(one.get("name")): {str(word.get("value")) for word in one.iter(f"{XS}enumeration")}
        for one in schema_root(schemas, minor).findall(f"{XS}simpleType")
    }
    listed = {name: words for name, words in found.items() if words}
    assert set(listed) <= set(WORDS)
    assert listed == {name: OPENSCENARIO.words_of(name, minor) for name in listed}


Fault = tuple[int, str, str]
"""Number of an element in its file, what is done to it, and the attribute that it is done to."""


def possible_faults(root: etree._Element) -> list[Fault]:
    found: list[Fault] = []
    for at, element in enumerate(root.iter(etree.Element)):
        if at > 1:
            found += [(at, what, "") for what in ("delete", "rename", "duplicate", "text", "blank")]
            found += [
                (at, what, str(name)) for name in element.attrib for what in ("delete", "rename", "", "x", "$x", "${1}")
            ]
    return found


def damaged(root: etree._Element, fault: Fault) -> etree._Element:
    """Return a copy of a file with one fault."""
    at, what, name = fault
    changed = copy.deepcopy(root)
    element = list(changed.iter(etree.Element))[at]
    parent = element.getparent()
    assert parent is not None
    if name and what in {"delete", "rename"}:
        value = element.attrib.pop(name)
        if what == "rename":
            element.set(f"{name}s", value)
    elif name:
        element.set(name, what)
    elif what == "delete":
        parent.remove(element)
    elif what == "rename":
        element.tag = f"{element.tag}s"
    elif what == "duplicate":
        parent.insert(parent.index(element), copy.deepcopy(element))
    else:
        element.text = (element.text or "") + ("x" if what == "text" else " ")
    return changed


FILES = (
    ("esmini/resources/xosc/lane_change.xosc", 0),
    ("esmini/resources/xosc/Catalogs/Maneuvers/HWManeuvers.xosc", 1),
    ("esmini/EnvironmentSimulator/Unittest/xosc/traffic_light_tests.xosc", 2),
    ("esmini/EnvironmentSimulator/Unittest/xosc/override_action_with_group_type.xosc", 3),
    ("OSC-NCAP-scenarios/OpenSCENARIO/NCAP/CA-FC_2026/Variations/StandardRange/CCFtap.xosc", 3),
)
TRIED = 250


@pytest.mark.parametrize(("file", "minor"), FILES, ids=lambda one: Path(str(one)).stem)
def test_a_single_fault_has_the_schema_s_verdict(schemas: Path, corpus: Path, file: str, minor: int) -> None:
    validator = etree.XMLSchema(etree.parse(str(find_schema(schemas, "OpenSCENARIO", minor))))
    root = etree.parse(str(corpus / file)).getroot()
    faults = possible_faults(root)
    different, invalid = [], 0
    for fault in faults[:: 1 + len(faults) // TRIED]:
        changed = damaged(root, fault)
        sink = Diagnostics()
        check_structure(Document("made.xosc", "", changed), sink)
        invalid += sink.has_errors
        if sink.has_errors == validator.validate(changed):
            different.append((fault, [one.message for one in sink]))
    assert invalid > 50
    assert different == []


def made(text: str) -> Document:
    document = parse_document(text.encode(), "made.xosc", Diagnostics())
    assert document is not None
    return document


BAD = """\
<OpenSCENARIO>
  <FileHeader revMajor="1" revMinor="1" author="" date="2020-10-01T12:00:00" description="" made="up"/>
  <Catalog name="routes">
    <Trajectory closed="no" name="t"/>
  </Catalog>
</OpenSCENARIO>
"""


def test_faults_have_their_place(schemas: Path) -> None:
    sink = Diagnostics()
    assert validate_with_xsd(made(BAD), (1, 1), Schemas(schemas), sink)
    faults = [one for one in sink if one.code.id == "SC730"]
    assert {(one.place.line, one.place.column) for one in faults} == {(2, 3), (4, 5)}
    assert all(one.severity is Severity.ERROR for one in faults)


@pytest.mark.parametrize("version", [None, (1, 9), (0, 9)])
def test_without_a_schema_there_is_no_verdict(schemas: Path, version: tuple[int, int] | None) -> None:
    sink = Diagnostics()
    assert not validate_with_xsd(made(BAD), version, Schemas(schemas), sink)
    assert [(one.code.id, one.severity) for one in sink] == [("SC731", Severity.WARNING)]


def test_an_invalid_schema_is_reported(tmp_path: Path) -> None:
    text = (
        "<xs:schema xmlns:xs='http://www.w3.org/2001/XMLSchema'><xs:made/><xs:element name='OpenSCENARIO'/></xs:schema>"
    )
    (tmp_path / "OpenSCENARIO_1.1.xsd").write_text(text, encoding="utf-8")
    sink = Diagnostics()
    assert not validate_with_xsd(made(BAD), (1, 1), Schemas(tmp_path), sink)
    assert [one.code.id for one in sink] == ["SC731"]


def verdicts(corpus: Path, schemas: Schemas) -> tuple[int, list[str]]:
    """Return the number of files of the corpus's list, and those with another verdict than there."""
    compared, different = 0, []
    with (corpus / "MANIFEST.csv").open(encoding="utf-8", newline="") as rows:
        for row in csv.DictReader(rows):
            if row["kind"] == "xosc" and row["validation"] != "no-xsd":
                sink = Diagnostics()
                validate_openscenario(corpus / row["file"], sink, schemas)
                compared += 1
                if sink.has_errors != (row["validation"] != "valid"):
                    different.append(row["file"])
    return compared, different


def test_the_schemas_verdict_agrees_with_the_corpus(schemas: Path, corpus: Path) -> None:
    compared, different = verdicts(corpus, Schemas(schemas))
    assert compared > 380
    assert different == []


@with_checker
def test_the_installed_checker_s_verdict_agrees_with_the_corpus(corpus: Path) -> None:
    compared, different = verdicts(corpus, Schemas())
    assert compared > 380
    assert different == []


@with_checker
def test_rules_have_their_ids_and_places(tmp_path: Path) -> None:
    actions = '<Private entityRef="Nobody"><PrivateAction><ControllerAction/></PrivateAction></Private>'
    story = f"<Storyboard><Init><Actions>\n{actions}</Actions></Init><StopTrigger/></Storyboard>"
    scenario = f"<CatalogLocations/><RoadNetwork/><Entities/>{story}</OpenSCENARIO>"
    head = BAD.split("  <Catalog")[0].replace(' made="up"', "").replace('revMinor="1"', 'revMinor="2"')
    file = tmp_path / "nobody.xosc"
    file.write_text(head + scenario, encoding="utf-8")
    sink = Diagnostics()
    validate_openscenario(file, sink, Schemas())
    found = [(one.code.id, one.severity, one.place.line, one.message.split(": ")[0]) for one in sink]
    rule = "asam.net:xosc:1.2.0:reference_control.resolvable_entity_references"
    assert ("SC732", Severity.WARNING, 4, rule) in found
    assert not sink.has_errors


@with_checker
def test_a_file_that_the_checker_cannot_read_keeps_its_verdict(tmp_path: Path) -> None:
    file = tmp_path / "latin.xosc"
    declared = '<?xml version="1.0" encoding="iso-8859-1"?>\n'
    file.write_bytes((declared + BAD.replace("made", "m\u00e4de")).encode("iso-8859-1"))
    sink = Diagnostics()
    validate_openscenario(file, sink, Schemas())
    assert {"SC730", "SC733"} <= {one.code.id for one in sink}


@without_checker
def test_without_the_checker_our_declarations_judge(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "bad.xosc"
    file.write_text(BAD, encoding="utf-8")
    assert call("validate", file, "--xsd") == 1
    said = capsys.readouterr().err
    assert "warning[SC731]: ASAM's checker is not installed: pip install 'scenario-compiler[asam]'" in said
    assert "error[SC702]" in said


def test_a_folder_may_hold_the_schemas(schemas: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "bad.xosc"
    file.write_text(BAD, encoding="utf-8")
    assert call("validate", file, "--xsd", schemas) == 1
    assert "error[SC730]" in capsys.readouterr().err
