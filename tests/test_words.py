"""Texts use the words of the glossary in CONTRIBUTING.md, and none of the phrases that it bans."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PAGES = (*sorted(ROOT.glob("*.md")), *sorted((ROOT / "docs").glob("*.md")))
MODULES = sorted((ROOT / "scenario_compiler").rglob("*.py"))
BESIDE = sorted(path for folder in ("tests", "tools", "examples") for path in (ROOT / folder).rglob("*.py"))


def banned() -> list[str]:
    """Return the phrases of the glossary's last column."""
    glossary = (ROOT / "CONTRIBUTING.md").read_text("utf-8").split("## Words", 1)[1].split("\n## ", 1)[0]
    rows = [line.split("|") for line in glossary.splitlines() if line.startswith("|")][2:]
    return [phrase for row in rows for phrase in re.findall(r"`([^`]+)`", row[-2])]


def found_in(text: str) -> list[str]:
    """Return the banned phrases in a text, over the ends of lines too."""
    return [match.group() for match in PHRASES.finditer(re.sub(r"\s+", " ", text))]


PHRASES = re.compile(rf"\b(?:{'|'.join(map(re.escape, banned()))})\b", re.IGNORECASE)


def texts_of(module: Path) -> Iterator[tuple[int, str]]:
    """Yield docstrings, messages and comments of a module with their lines."""
    source = module.read_text("utf-8")
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.lineno, node.value
    for number, line in enumerate(source.splitlines(), 1):
        if line.lstrip().startswith("#"):
            yield number, line


def names_and_docstrings_of(module: Path) -> Iterator[tuple[int, str]]:
    """Yield the names of a module's tests, as words, and all docstrings, with their lines."""
    for node in ast.walk(ast.parse(module.read_text("utf-8"))):
        if isinstance(node, ast.FunctionDef) and node.name.startswith("test_"):
            yield node.lineno, node.name.replace("_", " ")
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
            yield getattr(node, "lineno", 1), ast.get_docstring(node) or ""


def test_the_glossary_bans_something() -> None:
    assert len(banned()) > 10
    assert found_in("A text that\nis none; it is told.") == ["text that is none", "is told"]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_pages_use_the_glossarys_words(page: Path) -> None:
    text = page.read_text("utf-8")
    if page.name == "CONTRIBUTING.md":
        text = text.split("## Words", 1)[0]
    assert found_in(text) == []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_percentages_have_a_space_and_missing_numbers_a_dash(page: Path) -> None:
    assert re.findall(r"\d%|\| nan(?= \|)", page.read_text("utf-8")) == []


@pytest.mark.parametrize(("modules", "texts"), [(MODULES, texts_of), (BESIDE, names_and_docstrings_of)])
def test_modules_use_the_glossarys_words(
    modules: list[Path], texts: Callable[[Path], Iterator[tuple[int, str]]]
) -> None:
    wrong = [
        f"{module.relative_to(ROOT)}:{line}: {phrase}"
        for module in modules
        for line, text in texts(module)
        for phrase in found_in(text)
    ]
    assert wrong == []
