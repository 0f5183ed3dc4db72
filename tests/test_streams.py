"""Commands do the same with closed or broken standard streams and with streams of another encoding."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from _pytest.mark.structures import ParameterSet

from scenario_compiler.legible import legible, legible_json, legible_line
from tests.command import call

GOOD = '<scenarios version="1"><template name="t"/></scenarios>'
BAD = '<scenarios version="1">' + '<a b="c"/>\n' * 90 + "</scenarios>"
PROGRAM = f"{sys.executable} -m scenario_compiler"


def shell(command: str, folder: Path, **environment: str) -> subprocess.CompletedProcess[bytes]:
    """Run a command by a shell in a folder."""
    return subprocess.run(
        ["bash", "-c", command], cwd=folder, capture_output=True, timeout=120, check=False, env=os.environ | environment
    )


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "good.xml").write_text(GOOD, encoding="utf-8")
    (tmp_path / "bad.xml").write_text(BAD, encoding="utf-8")
    return tmp_path


ALIKE = {("good.xml", "2>&-"), ("good.xml", ">&- 2>&-"), ("bad.xml", "<&-"), ("bad.xml", "> /dev/null 2>&1")}
ALIKE |= {("good.xml", "json"), ("good.xml", "sarif"), ("good.xml", "github")}
"""Files with nothing to write, and streams that nothing is written to: others show the same, and these are slow."""


def files_with(*others: str) -> list[ParameterSet]:
    """Return (file, exit code, other) for a good and a bad file and each of some others."""
    return [
        pytest.param(file, code, other, marks=[pytest.mark.slow] if (file, other) in ALIKE else [])
        for file, code in (("good.xml", 0), ("bad.xml", 1))
        for other in others
    ]


@pytest.mark.parametrize(
    ("file", "code", "streams"),
    files_with(">&-", "2>&-", ">&- 2>&-", "<&-", ">&- 2>&- <&-", "> /dev/null 2>&1"),
)
def test_closed_streams_are_not_an_error(folder: Path, file: str, code: int, streams: str) -> None:
    done = shell(f"{PROGRAM} validate {file} {streams}", folder)
    assert done.returncode == code
    assert b"Traceback" not in done.stderr


@pytest.mark.parametrize(("file", "code", "form"), files_with("text", "json", "sarif", "github"))
def test_a_reader_that_closes_the_pipe_is_not_an_error(folder: Path, file: str, code: int, form: str) -> None:
    both = f"{PROGRAM} validate {file} --format {form} 2>&1 | true; echo ${{PIPESTATUS[0]}}"
    done = shell(both, folder)
    assert done.stdout.split() == [str(code).encode()]
    assert done.stderr == b""


AS_LIST = [pytest.param(one, marks=pytest.mark.slow) for one in ("coverage conflict", "map info town_grid")]
"""Commands that print a table, as `list` does."""


@pytest.mark.parametrize("command", ["explain SC401", "list", "--help", *AS_LIST])
def test_no_command_fails_because_nobody_reads_its_output(folder: Path, command: str) -> None:
    done = shell(f"{PROGRAM} {command} | true; echo ${{PIPESTATUS[0]}}", folder)
    assert (done.stdout.split(), done.stderr) == ([b"0"], b"")


def test_output_to_a_closed_stdout_does_not_go_into_a_file(folder: Path) -> None:
    """A file that is opened while stdout is closed must not get its number."""
    done = shell(f"{PROGRAM} compile good.xml -o plan.json >&-; {PROGRAM} new fresh --from cut_in >&-", folder)
    assert done.stderr.count(b"Traceback") == 0
    assert (folder / "fresh.xml").read_text(encoding="utf-8").startswith("<?xml")


@pytest.mark.parametrize("encoding", ["ascii", "latin-1", "utf-8"])
def test_characters_that_the_encoding_lacks_are_escaped(folder: Path, encoding: str) -> None:
    (folder / "straße–🚗.xml").write_text(BAD, encoding="utf-8")
    done = shell(f"{PROGRAM} validate *.xml", folder, PYTHONIOENCODING=encoding)
    assert done.returncode == 1
    assert b"Traceback" not in done.stderr


HOSTILE = {
    "escape": "\x1b[31mred\x1b[0m\x1b]0;title\x07",
    "bidi": "a\u202eb\u2066c\u200f",
    "lines": "a\n::error file=x::b\r\n##[error]c\u2028d\u2029e\x85f",
    "start": "::error file=x::injected",
    "vso": "##vso[task.setvariable variable=a]b",
    "surrogate": "a\udcffb",
    "nul and bell": "a\x07b\x08c\x7fd\x9b31m",
}

FORBIDDEN = [
    chr(number) for number in (*range(9), *range(11, 32), *range(127, 160), 0x61C, 0x200E, 0x200F, 0x2028, 0x2029)
]
FORBIDDEN += [chr(number) for number in (*range(0x202A, 0x202F), *range(0x2066, 0x206A), 0xFEFF)]


@pytest.mark.parametrize("name", HOSTILE)
def test_invisible_characters_and_commands_of_build_services_are_escaped(name: str) -> None:
    text = HOSTILE[name]
    for shown in (legible(text), legible_line(text), legible_json(text.replace("\n", ""))):
        assert not [one for one in FORBIDDEN if one in shown]
        shown.encode("utf-8")
    line = legible_line(text)
    assert "\n" not in line
    assert not line.lstrip().startswith("::")
    assert "##[" not in line
    assert "##vso[" not in line


@pytest.mark.parametrize("form", ["text", "json", "sarif", "github"])
def test_file_names_are_escaped_in_logs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], form: str
) -> None:
    folder = tmp_path / "library"
    folder.mkdir()
    names = [text.replace("/", "_") for name, text in HOSTILE.items() if "nul" not in name]
    for name in names:
        (folder / f"{name}.xml").write_text(BAD, encoding="utf-8")
    (folder / "template.xml").write_text(GOOD.replace('"t"', '"&#10;::error::x&#x202e;"'), encoding="utf-8")
    monkeypatch.chdir(folder)
    assert call("validate", ".", "--format", form) == 1
    told = "".join(capfd.readouterr())
    assert not [one for one in FORBIDDEN if one in told]
    for line in told.splitlines():
        ours = form == "github" and line.startswith(("::error file=", "::warning file="))
        assert ours or not line.lstrip().startswith("::")
        assert "##[" not in line
        assert "##vso[" not in line


@pytest.mark.parametrize(
    "command", ["validate {}", "run {}", "compile {} -o x.json", "list {}", "report {}", "map info {}"]
)
def test_names_on_the_command_line_are_escaped(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], command: str
) -> None:
    monkeypatch.chdir(tmp_path)
    assert call(*(word.format("\x1b[2J\u202e::error") for word in command.split())) in (1, 2)
    told = "".join(capfd.readouterr())
    assert not [one for one in FORBIDDEN if one in told]
