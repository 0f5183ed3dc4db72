"""A sink keeps a limited number of findings, whatever a file contains; the others are counted."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenario_compiler.diagnostics import LONGEST_TEXT, MOST_OF_A_KIND, Code, Diagnostics, FilePlace, Severity
from scenario_compiler.document import MAX_TAGS, UNREADABLE
from scenario_compiler.markup.codes import OUT_OF_LIMITS, UNKNOWN_ELEMENT
from scenario_compiler.plan.checks.triggers import NEVER_FIRES
from scenario_compiler.validation import validate_file


def reported(count: int, code: Code = UNKNOWN_ELEMENT, file: str = "a.xml") -> Diagnostics:
    sink = Diagnostics()
    for number in range(count):
        sink.add(code, f"fault {number}", FilePlace(file, number + 1, 1))
    return sink


def test_some_of_a_kind_are_kept_and_the_rest_is_counted() -> None:
    sink = reported(1000)
    found = list(sink)
    assert len(sink.found) == MOST_OF_A_KIND
    assert [one.place.line for one in found[:MOST_OF_A_KIND]] == list(range(1, MOST_OF_A_KIND + 1))
    assert found[-1].message == "900 more findings of SC105 are not listed"
    assert sink.reported == 1000


def test_each_file_code_and_severity_has_its_own_share() -> None:
    sink = reported(MOST_OF_A_KIND)
    sink.absorb(reported(MOST_OF_A_KIND, file="b.xml"))
    sink.absorb(reported(MOST_OF_A_KIND, OUT_OF_LIMITS))
    sink.add(UNKNOWN_ELEMENT, "mild", FilePlace("a.xml"), severity=Severity.NOTE)
    assert len(list(sink)) == 3 * MOST_OF_A_KIND + 1


def test_the_same_finding_again_counts_once() -> None:
    sink = Diagnostics()
    for _ in range(10 * MOST_OF_A_KIND):
        sink.add(UNKNOWN_ELEMENT, "each use of the template says so", FilePlace("a.xml", 3, 4))
    assert len(list(sink)) == 1
    for number in range(MOST_OF_A_KIND + 5):
        sink.add(UNKNOWN_ELEMENT, "another", FilePlace("a.xml", 10 + number, 4))
    for number in range(MOST_OF_A_KIND - 1):
        sink.add(UNKNOWN_ELEMENT, "another", FilePlace("a.xml", 10 + number, 4))
    assert list(sink)[-1].message.startswith("6 more findings")


def test_combined_sinks_add_their_counts() -> None:
    sink = reported(MOST_OF_A_KIND + 7)
    sink.absorb(reported(MOST_OF_A_KIND + 5))
    assert list(sink)[-1].message.startswith("12 more")


def test_allowed_findings_are_not_counted() -> None:
    sink = reported(1000, NEVER_FIRES)
    sink.retain(lambda one: one.code is not NEVER_FIRES)
    assert list(sink) == []


def test_a_message_that_repeats_a_long_text_is_cut() -> None:
    sink = Diagnostics()
    sink.add(UNREADABLE, "x" * 10_000_000, FilePlace("a.xml"), hint="y" * 10_000_000)
    (found,) = sink
    assert max(len(found.message), len(found.hint)) <= LONGEST_TEXT + 3


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.xml", '<scenarios version="1">\n{}</scenarios>'),
        ("a.xosc", '<OpenSCENARIO><FileHeader revMajor="1" revMinor="2"/>\n{}</OpenSCENARIO>'),
        ("a.xodr", '<OpenDRIVE><header revMajor="1" revMinor="6"/>\n{}</OpenDRIVE>'),
    ],
)
def test_a_file_with_many_faults_gives_a_short_output(tmp_path: Path, name: str, text: str) -> None:
    file = tmp_path / name
    file.write_text(text.format('<raod a="1"/>\n' * 20_000), encoding="utf-8")
    sink = Diagnostics()
    validate_file(file, sink)
    found = list(sink)
    assert len(found) < 600
    assert any("more findings of" in one.message for one in found)


@pytest.mark.parametrize("name", ["a.xml", "a.xosc", "a.xodr"])
def test_a_file_of_too_many_tags_is_not_read(tmp_path: Path, name: str) -> None:
    file = tmp_path / name
    file.write_bytes(b"<a>" + b"<b/>" * MAX_TAGS + b"</a>")
    sink = Diagnostics()
    validate_file(file, sink)
    assert [one.code.id for one in sink] == ["SC103"]
