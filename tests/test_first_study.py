"""docs/your-first-study.md is correct: its files are valid, its commands run, and its analysis reads their output."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest
from lxml import etree

from scenario_compiler.resources import schema_file
from tests.command import call
from tests.pages import code_blocks

PAGE = Path(__file__).parent.parent / "docs" / "your-first-study.md"
TEXT = PAGE.read_text(encoding="utf-8")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a folder that is the working one and holds the page's files."""
    monkeypatch.chdir(tmp_path)
    for text in (*code_blocks(TEXT, "xml"), *code_blocks(TEXT, "markdown")):
        named = re.match(r"<!-- (\S+) -->\n", text)
        assert named, text
        (tmp_path / named.group(1)).write_text(text, encoding="utf-8")
    return tmp_path


def test_the_tutorials_commands_do_what_it_says(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    commands = [line for block in code_blocks(TEXT, "sh") for line in block.splitlines()]
    assert len(commands) == 4
    for line in commands:
        program, *words = shlex.split(line)
        assert program == "scenario-compiler"
        assert call(*words) == 0, line
    printed = capsys.readouterr()
    assert printed.err == ""
    assert "2 files checked, 0 errors" in printed.out
    assert "sub-08 ses-01: practice conflicts.xml#blocked, " in printed.out
    assert "48 runs: pilot.csv" in printed.out
    page = (folder / "pilot" / "expected.html").read_text(encoding="utf-8")
    assert "why − what" in page
    for file in ("study.xml", "effort.xml"):
        etree.XMLSchema(etree.parse(schema_file("study.xsd"))).assertValid(etree.parse(folder / file))
    (analysis,) = code_blocks(TEXT, "python")
    exec(compile(analysis, PAGE.name, "exec"), {})
    shown = capsys.readouterr().out
    assert re.search(r"what\s+far\s+\d+\.\d+\s+\d+\.\d+\s+8", shown)
