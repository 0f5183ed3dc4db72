"""ASAM's own schemas give the verdict where the user has them."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.document import Document, parse_document, read_document
from scenario_compiler.roads.xsd import validate_with_xsd
from scenario_compiler.structure.schemas import find_schema
from tests.asam import schemas_of_wheel
from tests.command import call

BY_1_8_1 = "the list used the schema of revision 1.8.1, whose assertions that of 1.8.0 in the wheel does not have"
DIFFERENT = {
    "Scenic/assets/maps/CARLA/Town04.xodr": "objects follow a bridge, which the schema of 1.4 puts last",
    "esmini/EnvironmentSimulator/Unittest/xodr/straight_500m_signs_lht.xodr": BY_1_8_1,
    **{
        f"qc-opendrive/tests/data/not_implemented_yet/rule_{name}_invalid.xodr": BY_1_8_1
        for name in (
            "104_road_lanes_lane_offset_no_offset_if_border_defined",
            "178_junctions_priority_high_and_low_attrib",
            "247_road_object_outline_outline_followed_by_corner",
            "253_road_corner_road_element_min_amount",
            "255_road_corner_local_element_min_amount",
            "257_road_object_skeleton_polyline_followed_by_vertex",
            "263_road_object_skeleton_vertex_road_element_min_amount",
            "267_road_object_skeleton_vertex_local_element_min_amount",
            "285_road_object_border_useCompleteOutline_true",
            "286_road_object_border_useCompleteOutline_false",
            "371_general_optional_param_used",
        )
    },
}
"""Files whose verdict by the wheel's schemas differs from the corpus's list, and why."""


@pytest.fixture(scope="session")
def schemas() -> Path:
    """Folder of ASAM's schemas of OpenDRIVE."""
    return schemas_of_wheel("asam-qc-opendrive", "qc_opendrive")


def made(text: str) -> Document:
    document = parse_document(text.encode(), "made.xodr", Diagnostics())
    assert document is not None
    return document


def test_there_is_a_schema_for_every_version(schemas: Path) -> None:
    assert all(find_schema(schemas, "OpenDRIVE", minor) is not None for minor in range(1, 9))
    assert find_schema(schemas, "OpenDRIVE", 9) is None


@pytest.mark.parametrize("minor", [7, 8])
def test_faults_have_their_place(schemas: Path, minor: int) -> None:
    sink = Diagnostics()
    text = f'<OpenDRIVE>\n <header revMajor="1" revMinor="{minor}" made="up"/>\n <road/>\n</OpenDRIVE>'
    assert validate_with_xsd(made(text), schemas, sink) is False
    assert {"SC331"} == {d.code.id for d in sink}
    assert {2, 3} <= {d.place.line for d in sink}


@pytest.mark.parametrize("version", ['revMajor="1" revMinor="9"', ""])
def test_without_a_schema_there_is_no_verdict(tmp_path: Path, version: str) -> None:
    sink = Diagnostics()
    assert validate_with_xsd(made(f"<OpenDRIVE><header {version}/></OpenDRIVE>"), tmp_path, sink) is None
    assert [(d.code.id, d.severity.value) for d in sink] == [("SC332", "warning")]


@pytest.mark.parametrize(
    "schema", ["", "<a", "<xs:schema xmlns:xs='http://www.w3.org/2001/XMLSchema'><xs:made/></xs:schema>"]
)
@pytest.mark.parametrize("minor", [7, 8])
def test_an_invalid_schema_is_reported(tmp_path: Path, schema: str, minor: int) -> None:
    marker = '<!-- <xs:element name="OpenDRIVE"> -->'
    (tmp_path / f"OpenDRIVE_1.{minor}.xsd").write_text(schema + marker, encoding="utf-8")
    sink = Diagnostics()
    header = f'<OpenDRIVE><header revMajor="1" revMinor="{minor}"/></OpenDRIVE>'
    assert validate_with_xsd(made(header), tmp_path, sink) is None
    assert [d.code.id for d in sink] == ["SC332"]


def test_the_latest_revision_is_taken(tmp_path: Path) -> None:
    for revision in ("1.8.0", "1.8.1"):
        (tmp_path / revision).mkdir()
        path = tmp_path / revision / "OpenDRIVE_Core.xsd"
        path.write_text('<xs:element name="OpenDRIVE"/>', encoding="utf-8")
    assert find_schema(tmp_path, "OpenDRIVE", 8) == path


@pytest.mark.parametrize("every", [4, pytest.param(1, marks=pytest.mark.slow)])
def test_the_verdict_agrees_with_the_corpus(schemas: Path, corpus: Path, every: int) -> None:
    different, compared = [], set()
    with (corpus / "MANIFEST.csv").open(encoding="utf-8", newline="") as rows:
        for row in [row for row in csv.DictReader(rows) if row["subtype"] == "road"][::every]:
            compared.add(row["file"])
            document = read_document(corpus / row["file"], Diagnostics())
            assert document is not None
            valid = validate_with_xsd(document, schemas, Diagnostics())
            if {None: "no-xsd", True: "valid", False: "invalid"}[valid] != row["validation"]:
                different.append(row["file"])
    assert len(compared) > 270 // every
    assert sorted(different) == sorted(compared & set(DIFFERENT))


def test_validate_lets_the_schema_judge(schemas: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "bad.xodr"
    file.write_text('<OpenDRIVE><header revMajor="1" revMinor="6" made="up"/><road/></OpenDRIVE>', encoding="utf-8")
    assert call("validate", file, "--xsd", schemas) == 1
    said = capsys.readouterr().err
    assert "SC331" in said
    assert "SC32" not in said
