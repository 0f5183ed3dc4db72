"""Hostile files: every command ends cleanly, prints little and nothing unescaped, and runs no code that they name.

The files are permanent. What would be too large to keep is made here: deep, wide and long files, and chains of them.
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
from pathlib import Path

import pytest

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.source import templates
from scenario_compiler.source.conflict import DEEPEST_INCLUDE
from scenario_compiler.validation import validate_file
from tests.command import call
from tests.test_streams import FORBIDDEN

FOLDER = Path(__file__).resolve().parent / "files"
FILES = sorted(FOLDER.iterdir())

COMMANDS = {
    "validate": "validate {}",
    "list": "list {}",
    "compile": "compile {} -o made.json",
    "run": "run {} --duration 0.2 -o made --perception ideal --trajectory made.csv",
    "sweep": "sweep {} --vary x=values(1,2) --duration 0.1 -o made",
    "export": "export {} -o made.xosc",
    "preview": "preview {} -o made.png",
    "convert": "convert {} -o made.xml",
    "map check": "map check {}",
}

MOST_WORDS = 60_000
"""Most characters that a command says of one of these files."""


@pytest.fixture
def few_items(monkeypatch: pytest.MonkeyPatch) -> None:
    """A tenth of the items that may come together; tests/source/test_small_and_costly.py reaches the whole number."""
    monkeypatch.setattr(templates, "MOST_ITEMS", templates.MOST_ITEMS // 10)


def commands_for(path: Path) -> list[str]:
    """Return the commands that make sense for a file, each with a plan's options left out."""
    if path.suffix == ".xodr":
        return [COMMANDS["validate"], COMMANDS["map check"]]
    chosen = [text for name, text in COMMANDS.items() if name != "map check"]
    if path.suffix == ".json":
        chosen = [text.replace(" --duration 0.2", "").replace(" --perception ideal", "") for text in chosen]
        chosen = [text.replace(" --duration 0.1", "") for text in chosen]
    return chosen


@pytest.mark.usefixtures("few_items")
@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_every_command_ends_cleanly(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(FOLDER.parent))
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "configuration"))
    for command in commands_for(path):
        code = call(*command.format("FILE").replace("FILE", str(path)).split(" "))
        out, err = capfd.readouterr()
        told = out + err
        assert code in (0, 1, 2), command
        assert "Traceback" not in told, command
        assert len(told) < MOST_WORDS, command
        assert [one for one in FORBIDDEN if one in told] == [], command
        assert [line for line in told.splitlines() if line.lstrip().startswith("::") or "##[" in line] == [], command
        assert "SC117" not in told, f"{command}: a fault of the program"
    assert "hostile_code" not in sys.modules
    assert "HOSTILE_CODE_RAN" not in os.environ
    assert [one for one in tmp_path.rglob("*") if ".tmp" in one.name] == []


@pytest.mark.usefixtures("few_items")
@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
@pytest.mark.parametrize("form", ["json", "sarif", "github"])
def test_every_format_holds(path: Path, form: str, capfd: pytest.CaptureFixture[str]) -> None:
    assert call("validate", path, "--format", form) in (0, 1)
    out = capfd.readouterr().out
    assert [one for one in FORBIDDEN if one in out] == []
    if form == "github":
        assert all(line.startswith(("::error ", "::warning ", "::notice ")) for line in out.splitlines())
    else:
        json.loads(out)


def chain(folder: Path, length: int) -> Path:
    """Write files each of which includes the next; return the first."""
    for number in range(length):
        include = f'<include file="{number + 1}.xml"/>' if number + 1 < length else ""
        (folder / f"{number}.xml").write_text(
            f'<scenarios version="1">{include}<template name="t{number}"/></scenarios>', encoding="utf-8"
        )
    return folder / "0.xml"


def test_a_chain_of_includes_has_an_end(tmp_path: Path) -> None:
    sink = Diagnostics()
    validate_file(chain(tmp_path, DEEPEST_INCLUDE + 1), sink)
    assert list(sink) == []
    validate_file(chain(tmp_path, 3000), sink)
    (found,) = sink
    assert found.code.id == "SC232"
    assert f"'{DEEPEST_INCLUDE + 1}.xml' is included through {DEEPEST_INCLUDE + 1} files" in found.message
    assert found.place.file == str(tmp_path / f"{DEEPEST_INCLUDE}.xml")


WIDE = "<a/>\n" * 1_000_000

LARGE = {
    "wide.xml": lambda: '<scenarios version="1">' + '<a b="c"/>\n' * 1_000_000 + "</scenarios>",
    "wide.xosc": lambda: (
        '<OpenSCENARIO><FileHeader revMajor="1" revMinor="2"/>' + "<a/>\n" * 1_000_000 + "</OpenSCENARIO>"
    ),
    "wide.xodr": lambda: '<OpenDRIVE><header revMajor="1" revMinor="6"/>' + "<road/>\n" * 500_000 + "</OpenDRIVE>",
    "deep.xml": lambda: '<scenarios version="1">' + "<template>" * 200_000,
    "long.xml": lambda: f'<scenarios version="{"9" * 10_000_000}"/>',
    "attributes.xml": lambda: "<scenarios " + " ".join(f'a{i}="1"' for i in range(100_000)) + "/>",
    "comments.xosc": lambda: "<OpenSCENARIO>" + "<!--" * 3_000_000,
    "one_line.xml": lambda: '<scenarios version="1">' + "<a/>" * 1_000_000 + "</scenarios>",
}
"""Files of some 10 MB."""

MOST_MEMORY = 1_500 * 1024
"""Most memory that one of them may take, kB."""


@pytest.mark.slow
@pytest.mark.parametrize("name", LARGE)
def test_a_large_file_takes_bounded_memory_and_words(tmp_path: Path, name: str) -> None:
    file = tmp_path / name
    file.write_text(LARGE[name](), encoding="utf-8")
    program = (
        "import resource, sys\nfrom scenario_compiler.cli import main\n"
        "code = main(sys.argv[1:])\n"
        "print('PEAK', resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, file=sys.stderr)\nsys.exit(code)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program, "validate", str(file)], capture_output=True, text=True, timeout=300, check=False
    )
    *told, peak = done.stderr.splitlines()
    assert done.returncode == 1
    assert len("\n".join(told)) < MOST_WORDS
    assert int(peak.split()[1]) < MOST_MEMORY
    assert resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss > 0


READ = {"report": ("plan.json", "recording.parquet", "map.xodr"), "compare": ("recording.parquet", "outcome.json")}
"""The files of a run folder that a command reads."""

REFUSED = {"report": 1, "compare": 2}
"""Exit codes for a run that cannot be read."""


@pytest.mark.parametrize("damage", ["cut", "text", "folder", "empty", "other"])
@pytest.mark.parametrize("name", ["plan.json", "recording.parquet", "map.xodr", "outcome.json"])
def test_a_damaged_run_folder_is_reported(
    tmp_path: Path, name: str, damage: str, capfd: pytest.CaptureFixture[str], whole_run: Path
) -> None:
    """A folder in the place of the map is no map, and then the map is found by its name."""
    folder = tmp_path / "run"
    folder.mkdir()
    for one in whole_run.iterdir():
        (folder / one.name).write_bytes(one.read_bytes())
    file = folder / name
    content = file.read_bytes()
    file.unlink()
    if damage == "folder":
        file.mkdir()
    else:
        changed = {"cut": content[: len(content) // 2], "text": b"\x1b[31m\n::error::x", "empty": b"", "other": b"[1]"}
        file.write_bytes(changed[damage])
    for command in (("report", folder), ("compare", folder, folder)):
        code = call(*command)
        told = "".join(capfd.readouterr())
        is_read = name in READ[command[0]] and (name, damage) != ("map.xodr", "folder")
        assert code == (REFUSED[command[0]] if is_read else 0)
        assert [one for one in FORBIDDEN if one in told] == []
        assert len(told) < 5000


@pytest.fixture(scope="module")
def whole_run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run's folder."""
    folder = tmp_path_factory.mktemp("whole")
    file = folder / "s.xml"
    file.write_text(
        '<scenarios version="1"><scenario name="s" map="town_grid" duration="0.3"><ego speed="10"><start>'
        '<lane road="1" lane="-1" s="20"/></start></ego></scenario></scenarios>',
        encoding="utf-8",
    )
    assert call("run", file, "--perception", "ideal", "-o", folder / "out") == 0
    return folder / "out"
