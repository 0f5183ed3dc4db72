"""Files: only ordinary files of a limited size are read, and every name is accepted, whatever bytes it has."""

from __future__ import annotations

import json
import os
import shutil
import sys
import tracemalloc
from pathlib import Path

import pytest

from scenario_compiler.batch.distributions import SweepError
from scenario_compiler.batch.finished import read_results
from scenario_compiler.cli.options import WrongUse, keep_inputs
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.files import is_file, is_folder, read_file, split_target
from scenario_compiler.languages import parse, read_scenario_document
from scenario_compiler.plan.store import read_plan
from scenario_compiler.recording.store import RecordingError, read_recording
from scenario_compiler.recording.trajectory import read_trajectory
from scenario_compiler.resources import find_map
from scenario_compiler.roads import load_network
from scenario_compiler.structure.schemas import find_schema
from tests.command import call


def test_impossible_file_names_are_missing_files() -> None:
    assert not is_file(Path("a\0b"))
    assert not is_folder(Path("a" * 5000))


INCLUDING = '<scenarios version="1"><include file="{}"/></scenarios>'


def test_a_file_is_read_up_to_its_limit(tmp_path: Path) -> None:
    file = tmp_path / "a"
    content = os.urandom(2 * 1024 * 1024 + 7)
    file.write_bytes(content)
    assert read_file(file) == content
    assert read_file(file, len(content)) == content
    with pytest.raises(OSError, match=f"at most {len(content) - 1} are read"):
        read_file(file, len(content) - 1)


def test_memory_for_a_file_is_reserved_once(tmp_path: Path) -> None:
    size = 8 * 1024 * 1024
    (tmp_path / "a").write_bytes(bytes(size))
    tracemalloc.start()
    try:
        assert len(read_file(tmp_path / "a")) == size
        assert tracemalloc.get_traced_memory()[1] < 1.5 * size
    finally:
        tracemalloc.stop()


@pytest.mark.skipif(not Path("/proc/self/maps").exists(), reason="a file of another size than it says")
def test_the_stated_size_of_a_file_is_not_relied_on() -> None:
    assert Path("/proc/self/maps").stat().st_size == 0
    assert len(read_file("/proc/self/maps")) > 100
    with pytest.raises(OSError, match="it is longer than 100 bytes"):
        read_file("/proc/self/maps", 100)


@pytest.mark.parametrize("kind", ["pipe", "device", "folder", "loop"])
def test_only_ordinary_files_are_read(tmp_path: Path, kind: str) -> None:
    path = _odd(tmp_path, kind)
    with pytest.raises(OSError, match=r"pipe, a socket or a device|directory|symbolic links"):
        read_file(path)


@pytest.mark.parametrize("kind", ["pipe", "device", "folder", "loop"])
def test_no_reader_waits_for_a_pipe(tmp_path: Path, kind: str) -> None:
    path = _odd(tmp_path, kind)
    including = tmp_path / "including.xml"
    including.write_text(INCLUDING.format(path.name), encoding="utf-8")
    found = []
    for read in (read_scenario_document, read_plan, lambda path, sink: load_network(path, sink=sink)):
        sink = Diagnostics()
        assert read(path, sink) is None
        found += [one.code.id for one in sink.found]
    sink = Diagnostics()
    document = read_scenario_document(including, sink)
    assert document is not None
    parse(document, sink)
    assert [*found, *(one.code.id for one in sink.found)] == ["SC101", "SC101", "SC101", "SC220"]


@pytest.mark.parametrize("kind", ["pipe", "device", "folder", "loop"])
def test_a_schema_that_is_not_an_ordinary_file_is_ignored(tmp_path: Path, kind: str) -> None:
    odd = _odd(tmp_path, kind)
    odd.rename(odd.with_name("OpenDRIVE_1.4.xsd"))
    assert find_schema(tmp_path, "OpenDRIVE", 4) is None


@pytest.mark.parametrize("kind", ["pipe", "device", "folder", "loop"])
def test_tables_are_read_from_ordinary_files_only(tmp_path: Path, kind: str) -> None:
    path = _odd(tmp_path, kind)
    with pytest.raises(RecordingError, match="cannot be read: "):
        read_recording(path)
    with pytest.raises(SweepError, match="is not the table of a sweep"):
        read_results(path)


@pytest.mark.parametrize("kind", ["pipe", "device", "loop"])
def test_trajectories_are_read_from_ordinary_files_only(tmp_path: Path, kind: str) -> None:
    with pytest.raises(OSError, match=r"pipe, a socket or a device|symbolic links"):
        read_trajectory(_odd(tmp_path, kind))


def _odd(folder: Path, kind: str) -> Path:
    """Return a path to something that is not an ordinary file."""
    path = folder / f"{kind}.xml"
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "folder":
        path.mkdir()
    else:
        path.symlink_to("/dev/zero" if kind == "device" else path.name)
    return path


@pytest.mark.parametrize(
    ("target", "expected"),
    [
        ("a#1/b#2.xml", ("a#1/b#2.xml", None)),
        ("a#1/b#2.xml#c", ("a#1/b#2.xml", "c")),
        ("a#1/b#2.xml#c#3", ("a#1/b#2.xml", "c#3")),
        ("a#1/missing.xml#c", ("a#1/missing.xml", "c")),
    ],
)
def test_a_file_and_a_scenario_may_both_have_a_number_sign(
    target: str, expected: tuple[str, str | None], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a#1").mkdir()
    (tmp_path / "a#1" / "b#2.xml").touch()
    monkeypatch.chdir(tmp_path)
    assert split_target(target) == expected


def test_a_file_with_a_number_sign_is_not_written_over(tmp_path: Path) -> None:
    file = tmp_path / "a#b.xml"
    file.touch()
    with pytest.raises(WrongUse, match="written over"):
        keep_inputs([f"{file}#c"], file)


SHORT = """\
<scenarios version="1">
  <scenario name="short" map="roads.xodr" duration="0.2">
    <parameter name="speed" type="speed" default="20"/>
    <ego speed="$speed"><start><lane road="1" lane="-1" s="20"/></start></ego>
  </scenario>
</scenarios>
"""


@pytest.fixture
def latin(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A file in a folder, relative to the current one; both names are in Latin-1, as in archives of other systems."""
    if sys.platform != "linux":
        pytest.skip("names of files are Unicode")
    monkeypatch.chdir(tmp_path)
    folder = Path(os.fsdecode(b"stra\xdfe"))
    file = folder / os.fsdecode(b"k\xfcrz.xml")
    folder.mkdir()
    file.write_text(SHORT, encoding="utf-8")
    shutil.copy(find_map("highway_loop"), folder / "roads.xodr")
    return file


def test_a_name_that_is_not_utf_8_is_accepted(latin: Path) -> None:
    folder, plan = latin.parent, latin.parent / "plan.json"
    for words in (
        ("validate", latin),
        ("run", latin, "--perception", "ideal", "-o", folder / "run"),
        ("report", folder / "run"),
        ("compare", folder / "run", folder / "run", "--html", folder / "compared.html"),
        ("compile", latin, "-o", plan),
        ("run", plan, "--maps", folder, "-o", folder / "again"),
    ):
        assert call(*words) == 0, words
    assert r"stra\udcdfe/k\udcfcrz.xml" in json.loads(plan.read_text(encoding="utf-8"))["origins"]["scenario"]["file"]


@pytest.mark.slow
def test_sweeps_accept_a_name_that_is_not_utf_8(latin: Path) -> None:
    folder = latin.parent
    sweep = ("sweep", latin, "--vary", "speed=values(10, 20)", "-o", folder / "swept")
    for words in (
        (*sweep, "--workers", "2"),
        (*sweep, "--resume"),
        ("compare", folder / "swept", folder / "swept", "--html", folder / "sweeps.html"),
        ("library", folder, "-o", folder / "library"),
    ):
        assert call(*words) == 0, words
