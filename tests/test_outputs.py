"""Output files are written completely or not at all, never replace an input, and failures are reported in one line."""

from __future__ import annotations

import json
import os
import resource
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from scenario_compiler.outputs import make_folder, write_whole
from scenario_compiler.resources import find_map
from tests.command import call

CONFLICT = """\
<scenarios version="1">
  <scenario name="short" map="highway_loop" duration="0.5">
    <parameter name="speed" type="speed" default="20"/>
    <ego speed="$speed"><start><spawn_point name="straight"/></start></ego>
  </scenario>
</scenarios>
"""

AISA = '<config><scenarios><scenario name="it" town="highway_loop"/></scenarios></config>'


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder to work in, with a scenario, a plan and a map."""
    monkeypatch.chdir(tmp_path)
    Path("mine.xml").write_text(CONFLICT, encoding="utf-8")
    road = find_map("highway_loop")
    shutil.copy(road, "road.xodr")
    shutil.copy(road.with_name("map.toml"), "map.toml")
    return tmp_path


@contextmanager
def full_disk(room: int) -> Iterator[None]:
    """Let no file grow beyond a number of bytes."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (room, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, handler)


RUN = ("run", "mine.xml", "--perception", "ideal")
WRITERS: list[tuple[object, ...]] = [
    ("compile", "mine.xml", "-o", "PLACE.json"),
    (*RUN, "-o", "PLACE"),
    (*RUN, "--trajectory", "PLACE.csv"),
    ("preview", "mine.xml", "-o", "PLACE.png"),
    ("preview", "mine.xml", "-o", "PLACE.svg"),
    ("list", "mine.xml", "--html", "PLACE.html"),
    ("export", "mine.xml", "-o", "PLACE.xosc"),
    ("map", "plot", "road.xodr", "-o", "PLACE.png"),
    ("map", "export", "--for", "carla", "road.xodr", "-o", "PLACE.xodr"),
    ("map", "export", "--mesh", "road.xodr", "-o", "PLACE.obj"),
    ("map", "export", "--mesh", "road.xodr", "-o", "PLACE.glb"),
]
"""Commands that write a file, with where it goes as PLACE."""


def told_in_one_line(capsys: pytest.CaptureFixture[str]) -> str:
    """Return the line that a command fails with."""
    lines = [line for line in capsys.readouterr().err.splitlines() if line.startswith("scenario-compiler: ")]
    assert len(lines) == 1
    return lines[0]


@pytest.mark.parametrize("words", WRITERS, ids=" ".join)
def test_a_file_that_cannot_be_written_is_reported_in_one_line(
    words: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(*(word.replace("PLACE", "/proc/none/it") for word in words)) == 2
    line = told_in_one_line(capsys)
    assert "/proc/none" in line
    assert line.endswith("cannot be written: No such file or directory")


@pytest.mark.parametrize("words", WRITERS, ids=" ".join)
def test_a_full_disk_leaves_no_half_file(words: tuple[str, ...], capsys: pytest.CaptureFixture[str]) -> None:
    before = sorted(Path().rglob("*"))
    with full_disk(100):
        assert call(*(word.replace("PLACE", "it") for word in words)) == 2
    assert told_in_one_line(capsys).endswith("cannot be written: File too large")
    left = [path for path in sorted(Path().rglob("*")) if path not in before]
    assert not [path for path in left if path.is_file()]


def test_a_file_that_cannot_be_replaced_stays_unchanged(capsys: pytest.CaptureFixture[str]) -> None:
    Path("it.json").write_text("old", encoding="utf-8")
    with full_disk(100):
        assert call("compile", "mine.xml", "-o", "it.json") == 2
    assert told_in_one_line(capsys)
    assert Path("it.json").read_text(encoding="utf-8") == "old"


def test_a_conflict_a_conversion_and_a_report_that_cannot_be_written_are_reported_in_one_line(
    capsys: pytest.CaptureFixture[str],
) -> None:
    Path("toolkit.xml").write_text(AISA, encoding="utf-8")
    call(*RUN, "-o", "out")
    Path("out/report.html").unlink()
    capsys.readouterr()
    for words in (("new", "it", "--from", "cut_in"), ("convert", "toolkit.xml", "-o", "it.xml"), ("report", "out")):
        with full_disk(10):
            assert call(*words) == 2, words
        assert told_in_one_line(capsys).endswith("File too large")
    assert not Path("it.xml").exists()
    assert not Path("out/report.html").exists()


def printed(*words: str, full: str, buffered: bool = True) -> subprocess.CompletedProcess[str]:
    """Return what a process wrote that runs a command with stdout, stderr or both on a full disk."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"}
    with Path("/dev/full").open("w", encoding="utf-8") as disk:
        return subprocess.run(
            [sys.executable, "-m", "scenario_compiler", *words],
            stdout=disk if "out" in full else subprocess.PIPE,
            stderr=disk if "err" in full else subprocess.PIPE,
            text=True,
            check=False,
            env=environment if buffered else {**environment, "PYTHONUNBUFFERED": "1"},
        )


@pytest.mark.parametrize("buffered", [True, False], ids=["buffered", "unbuffered"])
@pytest.mark.parametrize("words", [("list",), ("--help",), ("run", "--help"), ("--version",)], ids=" ".join)
def test_output_that_cannot_be_printed_is_reported_in_one_line(words: tuple[str, ...], buffered: bool) -> None:
    done = printed(*words, full="stdout", buffered=buffered)
    assert (done.returncode, done.stderr) == (2, "scenario-compiler: output: No space left on device\n")


def test_a_current_folder_that_was_deleted_is_reported_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    gone = tmp_path / "gone"
    gone.mkdir()
    monkeypatch.chdir(gone)
    gone.rmdir()
    assert call("run", "obstacle_ahead", "--perception", "ideal", "--duration", "0.2", "-o", "out") == 2
    assert told_in_one_line(capsys) == "scenario-compiler: the current folder: No such file or directory"
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize(
    ("words", "code"),
    [
        pytest.param((*RUN, "-o", "fast", "--set", "speed=60"), 0, id="a warning"),
        pytest.param(("validate", "no_such_file.xml"), 1, id="an error"),
        pytest.param(("run", "no_such_file.xml"), 1, id="a missing file"),
        pytest.param(("run",), 2, id="a missing argument"),
    ],
)
def test_a_command_whose_messages_cannot_be_printed_goes_on_to_its_exit_code(words: tuple[str, ...], code: int) -> None:
    assert printed(*words, full="stderr").returncode == code
    assert Path("fast/outcome.json").is_file() == ("fast" in words)


@pytest.mark.parametrize("words", [("list",), ("--help",), ("validate", "mine.xml"), (*RUN, "-o", "out")], ids=" ".join)
def test_the_exit_code_says_that_nothing_could_be_printed(words: tuple[str, ...]) -> None:
    assert printed(*words, full="stdout and stderr").returncode == 2


def test_a_sweep_that_cannot_begin_does_not_mention_resume(capsys: pytest.CaptureFixture[str]) -> None:
    sweep = ("sweep", "mine.xml", "--perception", "ideal", "--vary", "speed=uniform(10, 20)")
    assert call(*sweep, "-o", "/proc/none/it") == 2
    assert "--resume" not in told_in_one_line(capsys)


OVER: list[tuple[object, ...]] = [
    ("compile", "mine.xml", "-o", "mine.xml"),
    ("compile", "mine.xml#short", "-o", "./mine.xml"),
    (*RUN, "--trajectory", "mine.xml"),
    ("export", "mine.xml", "-o", "mine.xml", "--force"),
    ("list", "mine.xml", "--html", "mine.xml"),
    ("convert", "toolkit.xml", "-o", "toolkit.xml"),
    ("map", "export", "--for", "carla", "road.xodr", "-o", "road.xodr"),
    ("compile", "on_road.xml", "-o", "road.xodr"),
    (*("run", "on_road.xml", "--perception", "ideal"), "--trajectory", "road.xodr"),
]


@pytest.mark.parametrize("words", OVER, ids=" ".join)
def test_no_command_writes_over_what_it_reads(words: tuple[str, ...], capsys: pytest.CaptureFixture[str]) -> None:
    Path("toolkit.xml").write_text(AISA, encoding="utf-8")
    Path("on_road.xml").write_text(CONFLICT.replace('"highway_loop"', '"road.xodr"'), encoding="utf-8")
    before = {path: path.read_bytes() for path in Path().iterdir()}
    assert call(*words) == 2
    assert "would be written over" in told_in_one_line(capsys)
    assert {path: path.read_bytes() for path in Path().iterdir()} == before


def test_a_link_keeps_pointing_and_a_device_is_written_to() -> None:
    Path("real.txt").write_text("old", encoding="utf-8")
    Path("link.txt").symlink_to("real.txt")
    write_whole("link.txt", "new\n")
    assert Path("link.txt").is_symlink()
    assert Path("real.txt").read_text(encoding="utf-8") == "new\n"
    write_whole("/dev/null", b"gone")
    assert Path("/dev/null").is_char_device()


def test_a_plan_is_written_to_a_pipe() -> None:
    words = [sys.executable, "-m", "scenario_compiler", "compile", "mine.xml", "-o", "/dev/stdout"]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    assert json.loads(done.stdout)["name"] == "short"


@pytest.mark.parametrize("write", [lambda path: write_whole(path, "it"), make_folder])
def test_the_fault_names_the_file(write: Callable[[Path], None]) -> None:
    with pytest.raises(FileNotFoundError, match="/proc/none/it") as raised:
        write(Path("/proc/none/it"))
    assert raised.value.strerror == "cannot be written: No such file or directory"


def test_a_file_in_the_place_of_a_folder_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    for words in (("run", "mine.xml"), ("sweep", "mine.xml", "--samples", "2")):
        assert call(*words, "--perception", "ideal", "-o", "mine.xml") == 2
        assert capsys.readouterr().err == "scenario-compiler: mine.xml: cannot be written: it is a file, not a folder\n"
