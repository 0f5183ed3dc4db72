"""Diagnostics as values: their order, their text, and the hints in them."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

from scenario_compiler import diagnostics
from scenario_compiler.diagnostics import (
    Code,
    CompileError,
    Diagnostic,
    Diagnostics,
    FilePlace,
    Severity,
    as_record,
    as_text,
    code_named,
    did_you_mean,
)
from scenario_compiler.document import MALFORMED
from scenario_compiler.markup.names import NOT_EXECUTED

FAULT, HINT = MALFORMED, NOT_EXECUTED
"""Two codes that exist, an error and a note: a code made for a test would need a case of its own."""


def test_a_code_is_declared_once() -> None:
    with pytest.raises(ValueError, match="SC102"):
        Code("SC102", "again", "")


def test_every_code_that_is_declared_anywhere_can_be_explained() -> None:
    """In a process of its own: here other tests have loaded what they need."""
    package = Path(diagnostics.__file__).parent
    declared = {
        str(call.args[0].value)
        for file in package.rglob("*.py")
        if "Code(" in (text := file.read_text(encoding="utf-8"))
        for call in ast.walk(ast.parse(text))
        if isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id == "Code"
        if isinstance(call.args[0], ast.Constant)
    }
    probe = "from scenario_compiler.diagnostics import all_codes; print(*all_codes())"
    found = subprocess.run([sys.executable, "-c", probe], capture_output=True, text=True, check=True, timeout=60)
    assert len(declared) > 190
    assert sorted(declared.symmetric_difference(found.stdout.split())) == []


def test_a_code_is_named_in_capitals_or_not() -> None:
    assert code_named("sc102 ") is MALFORMED
    assert code_named("102") is MALFORMED
    assert code_named("SC40") is None
    assert code_named("nonsense") is None


def test_only_a_part_of_a_long_line_is_shown() -> None:
    line = "x" * 5000 + "here" + "y" * 5000
    _, shown, carets = as_text(Diagnostic(FAULT, "wrong", FilePlace("a", 1, 5001, 4, line))).splitlines()
    assert len(shown) < 300
    assert shown[carets.index("^") :].startswith("here")
    assert carets.count("^") == 4
    wide = as_text(Diagnostic(FAULT, "wrong", FilePlace("a", 1, 5001, 5000, line)))
    assert max(map(len, wide.splitlines())) < 300


def test_findings_come_in_the_order_of_the_files_and_once() -> None:
    sink = Diagnostics()
    for file, line, column in (("b", 1, 1), ("a", 2, 1), ("a", 1, 9), ("a", 1, 2), ("a", 1, 2)):
        sink.add(FAULT, "wrong", FilePlace(file, line, column))
    assert [(one.place.file, one.place.line, one.place.column) for one in sink] == [
        ("a", 1, 2),
        ("a", 1, 9),
        ("a", 2, 1),
        ("b", 1, 1),
    ]


def test_only_errors_stop() -> None:
    sink = Diagnostics()
    sink.add(HINT, "fine", FilePlace("a"))
    sink.add(FAULT, "bearable", FilePlace("a"), severity=Severity.WARNING)
    assert not sink.has_errors
    sink.add(FAULT, "not", FilePlace("a"))
    assert sink.has_errors


def test_text_shows_the_line_the_place_the_hint_and_the_chain() -> None:
    outer = FilePlace("study.xml", 12, 5)
    use = FilePlace("parts.xml", 4, 3, within=outer)
    place = FilePlace("cut_in.xml", 7, 4, 3, "\t<a b='1'/>", use)
    text = as_text(Diagnostic(FAULT, "'1' is wrong", place, "did you mean '2'?"))
    assert text.split("\n") == [
        "cut_in.xml:7:4: error[SC102]: '1' is wrong",
        "    7 |  <a b='1'/>",
        "           ^^^",
        "      = help: did you mean '2'?",
        "      = in this use: parts.xml:4:3",
        "      = in this use: study.xml:12:5",
    ]


@pytest.mark.parametrize(
    ("place", "head"), [(FilePlace("a"), "a: "), (FilePlace("a", 3), "a:3: "), (FilePlace("a", 3, 4), "a:3:4: ")]
)
def test_text_of_places_that_are_known_in_part(place: FilePlace, head: str) -> None:
    assert as_text(Diagnostic(FAULT, "x", place)) == f"{head}error[SC102]: x"


def test_record_holds_plain_values() -> None:
    place = FilePlace("a", 1, 2, 3, within=FilePlace("b", 4, 5))
    assert as_record(Diagnostic(HINT, "x", place, severity=Severity.NOTE)) == {
        "code": "SC241",
        "name": "aisa-not-executed",
        "severity": "note",
        "message": "x",
        "file": "a",
        "line": 1,
        "column": 2,
        "length": 3,
        "hint": "",
        "chain": [{"file": "b", "line": 4, "column": 5}],
        "related": [],
    }


@pytest.mark.parametrize(
    ("word", "known", "hint"),
    [
        ("distanse", ["distance", "speed"], "did you mean 'distance'?"),
        ("xyz", ["b", "a"], "known: a, b"),
        ("xyz", [str(i) for i in range(13)], ""),
        ("xyz", [], ""),
        (
            "rain",
            [*map(str, range(13)), "HardRainNoon", "SoftRainNoon"],
            "known with 'rain' in it: HardRainNoon, SoftRainNoon",
        ),
        ("ai", [*map(str, range(13)), "HardRainNoon"], ""),
        ("name", [f"name_{i}_of_many_others" for i in range(13)], ""),
        ("xyz", ["", " ", "a"], "known: a"),
        ("", ["", "distance"], "known: distance"),
        ("x", [""], ""),
    ],
)
def test_did_you_mean(word: str, known: list[str], hint: str) -> None:
    assert did_you_mean(word, known) == hint


def test_compile_error_tells_the_errors() -> None:
    sink = Diagnostics()
    sink.add(HINT, "by the way", FilePlace("a"))
    sink.add(FAULT, "broken", FilePlace("a"))
    error = CompileError(sink)
    assert str(error) == "a: error[SC102]: broken"
    assert error.diagnostics is sink
