"""`schema`, `lsp` and `--version`: the commands that editors and pipelines use."""

from __future__ import annotations

import re
import subprocess
import sys

import pytest
from lxml import etree

from scenario_compiler.resources import schema_file
from tests.command import call


@pytest.mark.parametrize(("words", "file"), [((), "conflict.xsd"), (("study",), "study.xsd")])
def test_schema_prints_the_schema(words: tuple[str, ...], file: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert call("schema", *words) == 0
    printed = capsys.readouterr().out
    assert printed == schema_file(file).read_text(encoding="utf-8")
    etree.XMLSchema(etree.fromstring(printed.encode()))


def test_version_is_that_of_the_project(capsys: pytest.CaptureFixture[str]) -> None:
    project = (schema_file("").parents[0] / "pyproject.toml").read_text(encoding="utf-8")
    version = re.search(r'^version = "([^"]+)"', project, re.MULTILINE)
    assert version is not None
    assert call("--version") == 0
    assert capsys.readouterr().out == f"scenario-compiler {version.group(1)}\n"


WITHOUT_PYGLS = """
import sys
sys.modules["pygls"] = None
from scenario_compiler.cli import main
sys.exit(main(["lsp"]))
"""


def test_without_pygls_the_server_says_how_to_get_it() -> None:
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT_PYGLS], capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode == 2
    assert "pip install 'scenario-compiler[editor]'" in done.stderr
    assert "Traceback" not in done.stderr


def test_the_server_ends_with_its_editor() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "scenario_compiler", "lsp"],
        input="",
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert "Traceback" not in done.stderr
    assert done.stdout == ""
