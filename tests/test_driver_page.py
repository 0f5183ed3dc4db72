"""docs/driver.md is correct: its scenario compiles."""

from __future__ import annotations

from pathlib import Path

from scenario_compiler.compiler import compile_target
from scenario_compiler.diagnostics import Diagnostics
from tests.pages import code_blocks

PAGE = Path(__file__).parent.parent / "docs" / "driver.md"


def test_the_regression_of_a_study_compiles(tmp_path: Path) -> None:
    (text,) = [one for one in code_blocks(PAGE.read_text(encoding="utf-8"), "xml") if one.startswith("<scenarios")]
    file = tmp_path / "by_age.xml"
    file.write_text(text, encoding="utf-8")
    sink = Diagnostics()
    assert compile_target(file, {}, sink) is not None
    assert list(sink) == []
