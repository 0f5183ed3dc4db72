"""The files for the repository's hosts and tools are correct, and links between pages have a target."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
import yaml
from markdown_it import MarkdownIt
from markdown_it.token import Token

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).resolve().parent.parent
PROJECT: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
MAKEFILE = (ROOT / "Makefile").read_text(encoding="utf-8")
PAGES = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/*.md"), *ROOT.glob(".github/*.md")])


def read(path: str) -> Any:
    """Return what a YAML file of the repository holds."""
    return yaml.safe_load((ROOT / path).read_text(encoding="utf-8"))


@cache
def parsed(text: str) -> list[Token]:
    """Return the blocks of a page's text."""
    return MarkdownIt("commonmark").enable("table").parse(text)


@cache
def anchors(text: str) -> set[str]:
    """Return the anchors of a page's text: its headings as GitHub names them, and those that it sets itself."""
    found = set(re.findall(r'<a id="([^"]+)"', text))
    for before, block in pairwise(parsed(text)):
        if before.type == "heading_open":
            text = "".join(one.content for one in block.children or () if one.type in ("text", "code_inline"))
            found.add(re.sub(r"[^\w\- ]", "", text.lower()).strip().replace(" ", "-"))
    return found


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_link_leads_somewhere(page: Path) -> None:
    wrong = []
    text = page.read_text(encoding="utf-8")
    for one in (inner for block in parsed(text) for inner in block.children or ()):
        target = str(one.attrGet("href") or one.attrGet("src") or "")
        if not target or re.match(r"[a-z]+:", target):
            continue
        file, _, anchor = target.partition("#")
        there = (page.parent / file).resolve() if file else page
        if not there.exists() or (anchor and anchor not in anchors(there.read_text(encoding="utf-8"))):
            wrong.append(target)
    assert wrong == []


def test_a_link_that_leads_nowhere_is_found(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    for text in ("[a](nowhere.md)", "[b](#no-heading)", "![c](no.png)"):
        page.write_text(f"# Heading\n\n{text}\n", encoding="utf-8")
        with pytest.raises(AssertionError):
            test_every_link_leads_somewhere(page)
    page.write_text("# A `heading`, twice\n\n[d](#a-heading-twice) [e](https://example.org)\n", encoding="utf-8")
    test_every_link_leads_somewhere(page)


def test_the_workflow_runs_the_makefiles_targets_on_every_supported_python() -> None:
    jobs = read(".github/workflows/check.yml")["jobs"]
    steps = [step.get("run", "") for job in jobs.values() for step in job["steps"]]
    made = [word for step in steps for word in re.findall(r"make (\S+)", step)]
    assert {"setup", "check", "test", "site", "wheel-test"} <= set(made)
    assert [name for name in made if not re.search(rf"^{name}:", MAKEFILE, re.MULTILINE)] == []
    versions = jobs["linux"]["strategy"]["matrix"]["python"]
    assert versions == ["3.10", "3.11", "3.12", "3.13"]
    assert PROJECT["requires-python"] == f">={versions[0]}"
    assert jobs["elsewhere"]["continue-on-error"] is True


def test_hooks_before_a_commit_are_the_tools_of_make_check() -> None:
    (local, _) = read(".pre-commit-config.yaml")["repos"]
    entries = {hook["id"]: hook["entry"] for hook in local["hooks"] if hook["language"] == "system"}
    assert set(entries) == {"ruff-format", "ruff-check", "mypy", "conflicts"}
    for entry in entries.values():
        tool = entry.split()[0].removeprefix(".venv/bin/")
        assert tool in PROJECT["scripts"] or any(
            one.startswith(tool) for one in PROJECT["optional-dependencies"]["dev"]
        )
    for name in ("ruff format", "ruff check", "mypy"):
        assert any(name in entry for entry in entries.values())
        assert f"$(BIN)/{name}" in MAKEFILE


@pytest.mark.parametrize(
    ("message", "refused"),
    [("a" * 72, False), ("a" * 73, True), (f"Short.\n\n{'a' * 90}\n", False)],
)
def test_the_hook_for_messages_refuses_a_long_first_line(message: str, refused: bool) -> None:
    configuration = read(".pre-commit-config.yaml")
    (hook,) = (one for one in configuration["repos"][0]["hooks"] if one.get("stages") == ["commit-msg"])
    assert "commit-msg" in configuration["default_install_hook_types"]
    assert (re.search(hook["entry"], message) is not None) == refused


def test_the_citation_is_of_this_version() -> None:
    citation = read("CITATION.cff")
    assert {"cff-version", "title", "message", "authors"} <= set(citation)
    assert (citation["version"], citation["license"]) == (PROJECT["version"], PROJECT["license"])
    assert [one["name"] for one in citation["authors"]] == [one["name"] for one in PROJECT["authors"]]


@pytest.mark.parametrize("name", ["bug", "idea"])
def test_forms_of_issues_can_be_shown(name: str) -> None:
    form = read(f".github/ISSUE_TEMPLATE/{name}.yml")
    assert form["name"]
    assert form["description"]
    assert all(part["type"] in ("textarea", "input") and part["attributes"]["label"] for part in form["body"])
    assert len({part["id"] for part in form["body"]}) == len(form["body"])


@pytest.mark.slow
def test_the_site_is_built_and_a_broken_link_stops_it(tmp_path: Path) -> None:
    pytest.importorskip("material")
    shutil.copytree(ROOT / "docs", tmp_path / "docs")
    shutil.copy(ROOT / "mkdocs.yml", tmp_path)
    command = [sys.executable, "-m", "mkdocs", "build", "--strict"]

    def build() -> subprocess.CompletedProcess[str]:
        return subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=300, check=False)

    assert build().returncode == 0
    assert len(list((tmp_path / "build" / "site").glob("*.html"))) > len(list((ROOT / "docs").glob("*.md")))
    with (tmp_path / "docs" / "index.md").open("a", encoding="utf-8") as page:
        page.write("\n[broken](commands.md#no-such-anchor)\n")
    done = build()
    assert done.returncode != 0
    assert "no-such-anchor" in done.stderr


@pytest.mark.parametrize(("installed_from", "again"), [(None, False), ("", False), ("elsewhere", True)])
def test_a_moved_checkout_is_installed_again(tmp_path: Path, installed_from: str | None, again: bool) -> None:
    """What `make setup` would do; None is a fresh checkout, and an empty folder that of the checkout itself."""
    checkout = tmp_path / "a checkout"
    packages = checkout / ".venv" / "lib" / "python3.12" / "site-packages"
    packages.mkdir(parents=True)
    for name in ("Makefile", "pyproject.toml", "constraints.txt"):
        shutil.copy(ROOT / name, checkout / name)
    (checkout / ".venv" / ".stamp").touch()
    if installed_from is not None:
        (packages / "_scenario_compiler.pth").write_text(str(checkout / installed_from), encoding="utf-8")
    done = subprocess.run(["make", "-n", "setup"], cwd=checkout, capture_output=True, text=True, check=True)
    assert ("rm -rf .venv" in done.stdout) == again
    assert ("-m venv .venv" in done.stdout) == again
