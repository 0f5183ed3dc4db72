"""Files as real ones are: comments that XML does not allow, odd versions, namespaces, no road."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenario_compiler.compiler import compile_target
from scenario_compiler.diagnostics import Diagnostics, Severity
from scenario_compiler.openscenario.files import beside, read_forgiving
from scenario_compiler.validation import validate_file
from tests.openscenario.made import condition, expanded, scenario_text


@pytest.mark.parametrize("comment", ["a -- b", "a --- b", "-- a", "a -", "a\n--\n--b"])
def test_comments_with_hyphens_are_corrected(tmp_path: Path, comment: str) -> None:
    file = tmp_path / "odd.xosc"
    file.write_text(f"<a>\n<!--{comment}-->\n<b c='1'/></a>", encoding="utf-8")
    sink = Diagnostics()
    document = read_forgiving(file, sink)
    assert document is not None
    assert [one.code.id for one in sink] == ["SC740"]
    assert document.position(document.root[-1], "c")[0] == 3 + comment.count("\n")


def test_other_faults_stay(tmp_path: Path) -> None:
    file = tmp_path / "odd.xosc"
    file.write_text("<a><!-- a -- b --><b></a>", encoding="utf-8")
    sink = Diagnostics()
    assert read_forgiving(file, sink) is None
    assert [one.code.id for one in sink] == ["SC102"]
    assert read_forgiving(tmp_path / "none.xosc", Diagnostics()) is None


@pytest.mark.parametrize(
    ("minor", "codes"), [("0", []), ("1", []), ("2", []), ("3", []), ("9", ["SC741"]), ("x", ["SC741"])]
)
def test_unknown_versions_are_read_as_the_nearest(minor: str, codes: list[str]) -> None:
    text = scenario_text(minor=minor, stop=condition())
    assert [code for code in expanded(text)[1] if code == "SC741"] == codes


def test_a_namespace_makes_no_difference() -> None:
    text = scenario_text().replace("<OpenSCENARIO>", '<OpenSCENARIO xmlns="urn:x">')
    assert expanded(text)[0].actors[0].id == "Ego"


def test_an_empty_path_leads_nowhere() -> None:
    assert beside(Path("x"), "  ") == []


def test_without_a_road_file_the_plane_is_taken(tmp_path: Path) -> None:
    file = tmp_path / "free.xosc"
    file.write_text(scenario_text(road="", stop=condition()), encoding="utf-8")
    sink = Diagnostics()
    found = compile_target(file, {}, sink)
    assert found is not None
    assert found.network.name == "open_ground"
    assert [one.code.id for one in sink] == ["SC746"]


def test_a_missing_map_is_reported_where_it_is_named(tmp_path: Path) -> None:
    file = tmp_path / "lost.xosc"
    file.write_text(scenario_text(road='<LogicFile filepath="nowhere.xodr"/>'), encoding="utf-8")
    sink = Diagnostics()
    assert compile_target(file, {}, sink) is None
    (one,) = [one for one in sink if one.code.id == "SC204"]
    assert one.place.source_line[one.place.column - 1 :].startswith("nowhere.xodr")


def test_validate_reports_parts_without_meaning_as_warnings(tmp_path: Path) -> None:
    file = tmp_path / "lost.xosc"
    file.write_text(scenario_text(road='<LogicFile filepath="nowhere.xodr"/>', stop=condition()), encoding="utf-8")
    sink = Diagnostics()
    validate_file(file, sink)
    assert [(one.code.id, one.severity) for one in sink] == [("SC204", Severity.WARNING)]
