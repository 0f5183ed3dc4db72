"""One file for each diagnostic: all findings of a faulty file, with line and column.

A case is a file in tests/cases with comments `<!-- error: SC105 7:5 -->` (or warning, note) that say what compiling it
reports. `<!-- run: #name key=value -->` compiles one scenario with arguments in place of validating the whole file.
"""

from __future__ import annotations

import importlib
import pkgutil
import re
from pathlib import Path

import pytest

import scenario_compiler
from scenario_compiler.compiler import compile_target
from scenario_compiler.diagnostics import CODES, Diagnostic, Diagnostics, all_codes, as_text
from scenario_compiler.validation import validate_file

FOLDER = Path(__file__).resolve().parent / "cases"
CASES = sorted(path for path in FOLDER.iterdir() if path.name.startswith("SC"))
EXPECTATION = re.compile(r"<!-- (error|warning|note): (SC\d{3}) (\d+):(\d+) -->")
RUN = re.compile(r"<!-- run: #(\S+)((?: \S+=\S+)*) -->")

WITHOUT_CASE = {
    "SC288": "speaks of scenarios that a program builds: tests/plan/test_keeping.py",
    "SC101": "the file is not there: tests/test_document.py",
    "SC115": "the reader and the schema agree on every file known: tests/source/test_form.py makes them differ",
    "SC117": "speaks of faults of this program: tests/test_validate.py",
    "SC130": "speaks of plan files",
    "SC132": "speaks of plan files: tests/plan/test_store.py",
    "SC131": "speaks of recordings",
    "SC231": "speaks of plan files",
    "SC244": "speaks of the command line: tests/test_aisa.py",
    "SC377": "positions whose parameters have no value: the language gives every parameter one",
    "SC378": "speaks of map.toml files: tests/roads",
    "SC232": "needs a chain of files: tests/hostile/test_hostile.py",
    "SC523": "speaks of runs: tests/runtime/test_break_off.py",
    "SC256": "speaks of --dt: tests/plan/test_findings.py",
    "SC407": "speaks of --perception: tests/test_events.py",
    "SC514": "speaks of --perception: tests/plan/test_findings.py",
    "SC506": "speaks of --perception: tests/plan/test_findings.py",
    "SC533": "speaks of open_world of the Python API: tests/worlds/test_opening.py",
    "SC520": "speaks of worlds that are lost: tests/worlds/test_own_physics.py",
    "SC521": "speaks of controllers that fail: tests/runtime/test_failures.py",
    "SC528": "speaks of controllers of one's own, which have to be trusted: tests/test_trust.py",
    **dict.fromkeys(("SC524", "SC525", "SC526"), "speak of --world carla: tests/worlds"),
    "SC522": "speaks of faults of this program: tests/runtime/test_failures.py",
    "SC783": "speaks of exported files: tests/openscenario/test_export.py",
    **dict.fromkeys(("SC730", "SC731", "SC732", "SC733"), "speak of --xsd: tests/openscenario/test_xsd.py"),
}
"""Codes that no scenario file can cause, with the reasons."""

ROAD_FILES = re.compile(r"SC3[0-6]\d")
"""Codes of OpenDRIVE files have their cases in tests/roads."""


def findings(path: Path) -> Diagnostics:
    """Return what compiling a case reports."""
    sink = Diagnostics()
    run = RUN.search(path.read_text(encoding="utf-8"))
    if run is None:
        validate_file(path, sink)
    else:
        arguments = dict(pair.split("=", 1) for pair in run.group(2).split())
        compile_target(f"{path}#{run.group(1)}", arguments, sink)
    return sink


def _key(one: Diagnostic) -> tuple[str, str, str]:
    return one.severity.value, one.code.id, f"{one.place.line}:{one.place.column}"


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_case_reports_what_it_says(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    expected = sorted((kind, code, f"{line}:{column}") for kind, code, line, column in EXPECTATION.findall(text))
    found = list(findings(path))
    assert sorted(map(_key, found)) == expected, "\n".join(map(as_text, found))


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_case_shows_the_code_it_is_named_for(path: Path) -> None:
    code, _, name = path.stem.partition("_")
    assert code in {found for _, found, _, _ in EXPECTATION.findall(path.read_text(encoding="utf-8"))}
    assert name.startswith(CODES[code].name.replace("-", "_"))


def test_every_code_has_a_case() -> None:
    for module in pkgutil.walk_packages(scenario_compiler.__path__, "scenario_compiler."):
        if not module.name.endswith("__main__"):
            try:
                importlib.import_module(module.name)
            except ModuleNotFoundError as missing:
                if (missing.name or "").startswith("scenario_compiler"):
                    raise
    shown = {path.stem.partition("_")[0] for path in CASES}
    due = {code for code in CODES if not ROAD_FILES.fullmatch(code)} - set(WITHOUT_CASE)
    assert sorted(due - shown) == []
    assert sorted(set(WITHOUT_CASE) & shown) == []


@pytest.mark.parametrize("code", sorted(all_codes()))
def test_every_code_has_a_page(code: str) -> None:
    """An explanation gives the meaning, an example (a block of lines that begin with four spaces), and advice."""
    parts = CODES[code].explanation.split("\n\n")
    examples = [part for part in parts if part.startswith("    ")]
    meaning, *advice = [part for part in parts if part not in examples]
    assert re.fullmatch(r"[a-z]+(-[a-z]+)*", CODES[code].name)
    assert examples
    assert len(meaning) + sum(map(len, advice)) > 60
    assert not parts[0].startswith("    ")
    if ROAD_FILES.fullmatch(code):
        assert advice, "what to do"
