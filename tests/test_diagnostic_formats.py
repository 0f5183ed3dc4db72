"""Diagnostics for other programs: places that they can open, and the uses that led to a place."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from scenario_compiler.diagnostic_formats import FORMATS, formatted
from scenario_compiler.diagnostics import CODES, Diagnostic, FilePlace
from scenario_compiler.document import MALFORMED

USE = FilePlace("two, three/b.xml", 9, 4, within=FilePlace("c%.xml", 2))
FOUND = Diagnostic(MALFORMED, "50 % of it", FilePlace("q s/a#x ü.xml", 7, 3, 2, within=USE), "mend it")


def test_sarif_has_the_uses_as_related_locations() -> None:
    (result,) = json.loads(formatted([FOUND], "sarif"))["runs"][0]["results"]
    (place,) = result["locations"]
    assert place["physicalLocation"]["artifactLocation"]["uri"] == "q%20s/a%23x%20%C3%BC.xml"
    uses = [one["physicalLocation"] for one in result["relatedLocations"]]
    assert [use["artifactLocation"]["uri"] for use in uses] == ["two%2C%20three/b.xml", "c%25.xml"]
    assert [use["region"]["startLine"] for use in uses] == [9, 2]


def test_sarif_names_a_file_with_a_whole_path_by_its_scheme(tmp_path: Path) -> None:
    place = FilePlace(str(tmp_path / "a b.xml"), 1)
    (result,) = json.loads(formatted([Diagnostic(MALFORMED, "", place)], "sarif"))["runs"][0]["results"]
    uri = result["locations"][0]["physicalLocation"]["artifactLocation"]["uri"]
    assert uri.startswith("file:///")
    assert uri.endswith("/a%20b.xml")
    assert "relatedLocations" not in result


def test_github_shows_the_uses_below_the_message() -> None:
    assert formatted([FOUND], "github") == (
        "::error file=q s/a#x ü.xml,line=7,col=3,title=SC102::50 %25 of it (mend it)"
        "%0Ain this use: two, three/b.xml:9:4%0Ain this use: c%25.xml:2"
    )


@pytest.mark.parametrize("form", FORMATS)
def test_a_name_that_is_not_valid_text_can_be_written(form: str) -> None:
    text = formatted([Diagnostic(MALFORMED, "odd", FilePlace("bad\udcff.xml", 1))], form)
    assert text.encode("utf-8")
    if form == "json":
        assert json.loads(text)[0]["file"] == "bad\udcff.xml"
    if form == "sarif":
        assert '"bad%FF.xml"' in text


def test_gitlab_has_severity_place_and_a_fingerprint_that_does_not_move_with_the_line() -> None:
    moved = Diagnostic(MALFORMED, FOUND.message, FilePlace(FOUND.place.file, 70, 3), FOUND.hint)
    other = Diagnostic(MALFORMED, "another", FOUND.place)
    first, third = json.loads(formatted([FOUND, other], "gitlab"))
    (second,) = json.loads(formatted([moved], "gitlab"))
    assert first["description"] == "50 % of it (mend it)"
    assert (first["severity"], first["check_name"]) == ("major", "SC102 malformed-xml")
    assert first["location"] == {"path": "q s/a#x ü.xml", "lines": {"begin": 7}}
    assert first["fingerprint"] == second["fingerprint"] != third["fingerprint"]
    assert json.loads(formatted([], "gitlab")) == []


def test_gitlab_distinguishes_findings_that_differ_only_in_their_lines() -> None:
    found = [Diagnostic(MALFORMED, "the same", FilePlace("a.xml", line, 3)) for line in (4, 9, 12)]
    assert len({one["fingerprint"] for one in json.loads(formatted(found, "gitlab"))}) == 3


def test_sarif_says_where_a_finding_ends_and_counts_code_points() -> None:
    (run,) = json.loads(formatted([FOUND, Diagnostic(MALFORMED, "", FilePlace("a.xml", 3))], "sarif"))["runs"]
    regions = [one["locations"][0]["physicalLocation"]["region"] for one in run["results"]]
    assert regions == [{"startLine": 7, "startColumn": 3, "endColumn": 5}, {"startLine": 3, "startColumn": 1}]
    assert run["columnKind"] == "unicodeCodePoints"


def test_sarif_describes_a_code_that_only_another_process_has_loaded(monkeypatch: pytest.MonkeyPatch) -> None:
    """The processes that check a folder send findings whose codes this process may never load by their ids."""
    monkeypatch.delitem(CODES, MALFORMED.id)
    (run,) = json.loads(formatted([FOUND], "sarif"))["runs"]
    (rule,) = run["tool"]["driver"]["rules"]
    assert rule["id"] == "SC102"
    assert rule["fullDescription"]["text"] == MALFORMED.explanation
