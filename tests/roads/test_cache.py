from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.forms.declaration import columns_of
from scenario_compiler.resources import cache_folder
from scenario_compiler.roads import cache, load_network
from tests.roads.make import lane, network, road, section


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("SCENARIO_COMPILER_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache" / "roads"


@pytest.fixture
def path(tmp_path: Path) -> Path:
    network(tmp_path, road(lanes=section(lane(1), lane(-1, kind="lorry"))), sink=Diagnostics())
    return tmp_path / "made.xodr"


def load(path: Path) -> tuple[dict[str, object], list[str]]:
    sink = Diagnostics()
    made = load_network(path, sink=sink)
    assert made is not None
    return {name: getattr(made.tables, name) for name in columns_of(type(made.tables))}, [d.message for d in sink]


def test_the_second_load_gives_the_same_tables_and_findings(folder: Path, path: Path) -> None:
    first = load(path)
    assert len(list(folder.iterdir())) == 1
    stamp = next(folder.iterdir()).stat().st_mtime_ns
    assert load(path) == first
    assert next(folder.iterdir()).stat().st_mtime_ns == stamp
    assert first[1] == ["unknown lane type 'lorry'; 'none' is used"]


@pytest.mark.parametrize("damage", ["cut", "flipped", "empty", "other"])
def test_a_damaged_file_is_made_again(folder: Path, path: Path, damage: str) -> None:
    first = load(path)
    file = next(folder.iterdir())
    good = file.read_bytes()
    flipped = good[:-9] + bytes([good[-9] ^ 1]) + good[-8:]
    file.write_bytes({"cut": good[:-8], "flipped": flipped, "empty": b"", "other": b"SCROADS1" + good}[damage])
    assert load(path) == first
    assert file.read_bytes() == good


def test_a_changed_map_is_read_again(folder: Path, path: Path) -> None:
    load(path)
    path.write_text(path.read_text(encoding="utf-8").replace('a="3.5"', 'a="3.0"'), encoding="utf-8")
    assert load(path)[0]["cubic_a"] == [3.0, 3.0]
    assert len(list(folder.iterdir())) == 2


def test_a_cache_that_cannot_be_written_is_not_a_fault(
    tmp_path: Path, path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    monkeypatch.setenv("SCENARIO_COMPILER_CACHE", str(tmp_path / "file"))
    assert load(path)[0]["road_length"] == [100.0]


def test_the_folder_is_the_users(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv("SCENARIO_COMPILER_CACHE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert cache_folder() == tmp_path / "scenario-compiler"


def test_only_the_user_can_open_it(folder: Path, path: Path) -> None:
    folder.mkdir(parents=True, mode=0o777)
    folder.chmod(0o777)
    load(path)
    assert [one.stat().st_mode & 0o777 for one in (folder, folder.parent)] == [0o700, 0o700]


def test_a_cached_file_of_another_road_is_not_used(folder: Path, path: Path, tmp_path: Path) -> None:
    load(path)
    (file,) = folder.iterdir()
    other = tmp_path / "other"
    other.mkdir()
    network(other, road(length=200.0, lanes=section(lane(1), lane(-1))), sink=Diagnostics())
    load_network(other / "made.xodr", sink=Diagnostics())
    (planted,) = set(folder.iterdir()) - {file}
    file.write_bytes(planted.read_bytes())
    assert load(path)[0]["road_length"] == [100.0]


def test_a_pipe_or_a_folder_in_its_place_is_ignored(folder: Path, path: Path) -> None:
    first = load(path)
    (file,) = folder.iterdir()
    file.unlink()
    os.mkfifo(file)
    assert load(path) == first
    file.unlink()
    file.mkdir()
    assert load(path) == first


@pytest.mark.skipif(os.geteuid() != 0, reason="only the administrator gives folders away")
def test_a_folder_of_somebody_else_is_not_used(folder: Path, path: Path) -> None:
    first = load(path)
    (file,) = folder.iterdir()
    os.chown(folder, 65534, 65534)
    file.write_bytes(b"planted")
    assert load(path) == first
    assert file.read_bytes() == b"planted"


def test_its_name_covers_all_code_that_reads() -> None:
    """A change in any module that is loaded to read a road file makes another name."""
    probe = """
import sys
from pathlib import Path
import scenario_compiler.roads.parse, scenario_compiler.roads.network
package = Path(scenario_compiler.__file__).parent
for name, module in sorted(sys.modules.items()):
    if name.startswith("scenario_compiler") and module.__file__:
        print(Path(module.__file__).relative_to(package))
"""
    done = subprocess.run([sys.executable, "-c", probe], capture_output=True, text=True, check=True, timeout=60)
    covered = {str(one.relative_to(cache.PACKAGE)) for one in cache.sources()}
    assert sorted(set(done.stdout.split()) - covered) == []
