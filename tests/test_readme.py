"""The README is correct: its conflict is valid, its commands and its Python run; files that pages name exist."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from tests.command import call
from tests.pages import code_blocks

DOCS = (Path(__file__).parent.parent / "docs").glob("*.md")
README = (Path(__file__).parent.parent / "README.md").read_text(encoding="utf-8")


def block(language: str, holding: str) -> str:
    """Return the README's block of a language that holds a text."""
    return next(text for text in code_blocks(README, language) if holding in text)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a folder that is the working one and holds the README's conflict, cut to two seconds."""
    monkeypatch.chdir(tmp_path)
    text = block("xml", "paint_fades").replace('duration="30"', 'duration="2"')
    (tmp_path / "paint.xml").write_text(text, encoding="utf-8")
    return tmp_path


def commands() -> list[list[str]]:
    lines = (line for line in block("sh", "validate paint.xml").splitlines() if line.startswith("scenario-compiler "))
    return [shlex.split(line, comments=True)[1:] for line in lines]


@pytest.mark.parametrize("arguments", commands(), ids=" ".join)
def test_command_runs(folder: Path, arguments: list[str]) -> None:
    assert call(*arguments) == 0


def test_python_runs(folder: Path) -> None:
    exec(compile(block("python", "compile_scenario"), "README.md", "exec"), {})
    assert (folder / "out" / "report.html").is_file()


PAGES = ("README.md", "ARCHITECTURE.md", "CHANGELOG.md", "CONTRIBUTING.md", *sorted(f"docs/{one.name}" for one in DOCS))


@pytest.mark.parametrize("page", PAGES)
def test_files_that_a_page_names_exist(page: str, repository: Path) -> None:
    file = repository / page
    links = re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", file.read_text(encoding="utf-8"))
    assert [link for link in links if not (file.parent / link).exists()] == []


@pytest.mark.parametrize("page", ["README.md", "docs/index.md"])
def test_a_front_page_names_every_page(page: str, repository: Path) -> None:
    file = repository / page
    named = {
        (file.parent / link).resolve() for link in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", file.read_text("utf-8"))
    }
    pages = {one.resolve() for one in (repository / "docs").glob("*.md") if one.name != "index.md"}
    assert sorted(one.name for one in pages - named) == []


def test_the_conflict_warns_once_and_a_second_before_it_asks(tmp_path: Path) -> None:
    path = tmp_path / "paint.xml"
    path.write_text(block("xml", "paint_fades").replace('duration="30"', 'duration="17"'), encoding="utf-8")
    assert call("run", str(path), "--perception", "ideal", "-o", str(tmp_path / "out")) == 0
    rows = [line.split(",") for line in (tmp_path / "out" / "events.csv").read_text(encoding="utf-8").splitlines()]
    times = {kind: [float(row[0]) for row in rows if row[1] == kind] for kind in ("warning", "request")}
    assert len(times["warning"]) == len(times["request"]) == 1
    assert times["request"][0] - times["warning"][0] >= 1.0
