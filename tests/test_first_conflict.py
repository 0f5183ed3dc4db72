"""docs/your-first-conflict.md is correct: each file is checked, each command runs, each output is as shown."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest
from lxml import etree

from scenario_compiler import judge, open_world, run
from scenario_compiler.compiler import Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics, as_text
from scenario_compiler.resources import schema_file
from scenario_compiler.validation import validate_file
from tests.command import call
from tests.pages import code_blocks

PAGE = Path(__file__).parent.parent / "docs" / "your-first-conflict.md"
TEXT = PAGE.read_text(encoding="utf-8")


def _named(block: str) -> tuple[str, str]:
    """Return the file that a block is, by the comment in its first line: (name, text)."""
    found = re.match(r"<!-- (\S+\.xml) -->\n", block)
    assert found, block
    return found.group(1), block


FILES = dict(map(_named, code_blocks(TEXT, "xml")))
COMMANDS = [block.splitlines() for block in code_blocks(TEXT, "sh")]
VALID = sorted(set(FILES) - {"wrong.xml"})


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a folder that is the working one and holds the page's files."""
    monkeypatch.chdir(tmp_path)
    for name, text in FILES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


def test_the_page_has_files_and_commands() -> None:
    assert len(FILES) == 5
    assert len(COMMANDS) >= 6
    assert all(line.startswith("scenario-compiler ") for lines in COMMANDS for line in lines)


@pytest.mark.parametrize("name", VALID)
def test_file_has_no_finding_and_keeps_to_the_schema(folder: Path, name: str) -> None:
    sink = Diagnostics()
    validate_file(folder / name, sink)
    assert [as_text(one) for one in sink] == []
    etree.XMLSchema(etree.parse(schema_file("conflict.xsd"))).assertValid(etree.parse(folder / name))


@pytest.mark.parametrize("lines", COMMANDS, ids=lambda lines: lines[0])
def test_commands_run(folder: Path, lines: list[str]) -> None:
    for line in lines:
        assert call(*shlex.split(line)[1:]) == 0, line
        if "-o out" in line:
            assert (folder / "out" / "report.html").is_file()


def test_faults_are_reported_as_shown(folder: Path) -> None:
    sink = Diagnostics()
    validate_file(Path("wrong.xml"), sink)
    assert code_blocks(TEXT, "text") == ["\n".join(as_text(one) for one in sink) + "\n"]


@pytest.mark.parametrize(("name", "cause"), [("mine", ""), ("narrow", "path_blocked"), ("van", "path_blocked")])
def test_conflict_does_what_the_page_says(folder: Path, name: str, cause: str) -> None:
    compilation = compile_target(folder / f"{name}.xml", {}, Diagnostics(), overrides=Overrides(perception="ideal"))
    assert compilation is not None
    recording = run(compilation.plan, open_world("kinematic", compilation.plan, compilation.network), seed=1)
    assert (judge(compilation.plan, recording).cause or "") == cause


def test_links_lead_somewhere() -> None:
    links = re.findall(r"\]\(([^)#:]+)\)", TEXT)
    assert links
    assert [link for link in links if not (PAGE.parent / link).exists()] == []
