"""A process that ends or hangs, or a full disk, loses at most one row."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import resource
import shlex
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from scenario_compiler.batch.distributions import SweepError
from scenario_compiler.batch.execute import execute, prepare, run_sweep
from scenario_compiler.batch.finished import read_results
from scenario_compiler.batch.pool import Pool, serve
from scenario_compiler.batch.runner import Batch, Part
from scenario_compiler.batch.search import find_boundary
from scenario_compiler.batch.spec import SweepSpec
from scenario_compiler.batch.tally import Progress
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.trust import Trust
from tests.batch.conftest import conflict_in

CONTROLLER = '''
"""A controller that misbehaves at chosen speeds: it hangs, ends its process, or raises."""

import os
import time

from scenario_compiler import Control, ControllerModel


class Misbehaving(ControllerModel):
    """Ends the process above 19 m/s, hangs above 14 m/s, raises above 11 m/s."""

    def control(self, sensor_data, speed, vehicle):
        """Misbehave, or roll on."""
        if speed > 19:
            os._exit(9)
        if speed > 14:
            time.sleep(60)
        if speed > 11:
            raise ValueError("too fast for me")
        return Control(0.0, 0.0, 0.0)
'''


def _spec(**settings: Any) -> SweepSpec:
    base = {"vary": ("distance=uniform(20, 350)",), "samples": 64, "perception": "ideal"}
    return SweepSpec(**{**base, **settings})


def _in_parts(**settings: object) -> SweepSpec:
    """Return a sweep of short runs in four parts: the interpreted form has 16 variants in a part."""
    return _spec(interpreted=True, duration=1.0, **settings)


def test_a_killed_worker_loses_and_doubles_nothing(conflict: Path, tmp_path: Path) -> None:
    spec = _spec(samples=64)
    run_sweep(conflict, spec, tmp_path / "whole", workers=1, report=False)
    sweep = prepare(conflict, spec, Diagnostics())
    store = sweep.store(tmp_path / "killed")
    store.open(resume=False)
    pool = _KillingPool("interpreted", 2)
    assert execute(sweep, store, pool).broken_off == 0
    store.merge(sweep.parts)
    assert pool.killed == 2
    tables = [(tmp_path / name / "results.parquet").read_bytes() for name in ("whole", "killed")]
    assert tables[0] == tables[1]


class _KillingPool(Pool):
    """A pool, two of whose workers are killed while they work."""

    killed = 0

    def run(self, parts: Iterator[Part]) -> Iterator[tuple[int, Batch]]:
        self._workers[0].process.kill()
        self.killed += 1
        for number, batch in super().run(parts):
            if self.killed < 2:
                self._workers[1].process.kill()
                self.killed += 1
            yield number, batch


def test_variants_that_crash_or_hang_are_rows(conflict: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "misbehaving.py").write_text(CONTROLLER, encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    spec = _spec(
        vary=("speed=choice(8, 12, 16, 20, 9)",),
        method="grid",
        samples=1,
        perception="camera",
        controller="misbehaving:Misbehaving",
        duration=0.2,
        time_limit=10.0,
    )
    result = run_sweep(conflict, spec, tmp_path / "sweep", workers=2, report=False)
    rows, _ = read_results(tmp_path / "sweep")
    assert (result.form, result.tally.broken_off) == ("camera", 3)
    assert rows["error"] == [
        "",
        "controller 'misbehaving:Misbehaving', misbehaving.py:20: ValueError: too fast for me",
        "it took longer than 10 s",
        "the process ended with code 9",
        "",
    ]
    assert rows["parameter.speed"] == [8, 12, 16, 20, 9]


def test_a_full_disk_keeps_what_was_finished(conflict: Path, tmp_path: Path) -> None:
    spec = _in_parts()
    run_sweep(conflict, spec, tmp_path / "whole", workers=1, report=False)
    done = subprocess.run(
        [sys.executable, "-c", FULL_DISK, str(conflict), str(tmp_path / "full")],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.stdout.split() == ["OSError", "2"], done.stderr
    assert not list((tmp_path / "full").rglob("*.tmp"))
    run_sweep(conflict, spec, tmp_path / "full", workers=1, resume=True, report=False)
    tables = [(tmp_path / name / "results.parquet").read_bytes() for name in ("whole", "full")]
    assert tables[0] == tables[1]


FULL_DISK = """
import resource, signal, sys
from pathlib import Path
from scenario_compiler.batch.execute import run_sweep
from scenario_compiler.batch.spec import SweepSpec
from scenario_compiler.batch.tally import Progress, Tally

signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
spec = SweepSpec(vary=("distance=uniform(20, 350)",), samples=64, perception="ideal", interpreted=True, duration=1.0)

def fill(progress):
    if progress.done == 32:
        resource.setrlimit(resource.RLIMIT_FSIZE, (100, resource.RLIM_INFINITY))

folder = Path(sys.argv[2])
try:
    run_sweep(sys.argv[1], spec, folder, workers=1, progress=fill, report=False)
except OSError:
    print("OSError", len(list((folder / "parts").glob("*.parquet"))))
"""


NAMESPACE = ["unshare", "--map-root-user", "--mount", "sh", "-c"]
"""Run a shell whose mounts nobody else sees, without being the administrator."""


@pytest.fixture
def small_disk(tmp_path: Path) -> Path:
    """Folder to mount a small file system on."""
    folder = tmp_path / "disk"
    folder.mkdir()
    try:
        tried = [*NAMESPACE, f"mount -t tmpfs -o size=40k tmpfs {shlex.quote(str(folder))}"]
        subprocess.run(tried, check=True, capture_output=True)
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("no file system can be mounted here")
    return folder


@pytest.mark.parametrize(("size", "fails"), [("40k", "/s/parts/"), pytest.param("200k", "/s/", marks=pytest.mark.slow)])
def test_a_full_tmpfs_keeps_what_was_finished(
    size: str, fails: str, conflict: Path, tmp_path: Path, small_disk: Path
) -> None:
    spec = _spec(samples=2000)
    run_sweep(conflict, spec, tmp_path / "whole", workers=1, report=False)
    sweep = [sys.executable, "-m", "scenario_compiler", "sweep", str(conflict), *("--vary", spec.vary[0])]
    sweep += [
        "--samples",
        "2000",
        "--perception",
        "ideal",
        "--workers",
        "1",
        "--no-report",
        "-o",
        str(small_disk / "s"),
    ]
    disk = shlex.quote(str(small_disk))
    script = [
        f"mount -t tmpfs -o size={size} tmpfs {disk}",
        f"{shlex.join(sweep)}; ended=$?",
        f"cp -r {disk}/s {shlex.quote(str(tmp_path / 'kept'))}",
        "exit $ended",
    ]
    done = subprocess.run([*NAMESPACE, "; ".join(script)], capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 1
    assert fails in done.stderr
    assert "cannot be written: No space left on device; --resume finishes the sweep" in done.stderr
    run_sweep(conflict, spec, tmp_path / "kept", workers=1, resume=True, report=False)
    tables = [(tmp_path / name / "results.parquet").read_bytes() for name in ("whole", "kept")]
    assert tables[0] == tables[1]


def _bytes_of(folder: Path) -> bytes:
    return (folder / "results.parquet").read_bytes()


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with `whole`, a sweep, and `half`, the same one interrupted when two of its four parts were there."""
    folder = tmp_path_factory.mktemp("swept")
    conflict = conflict_in(folder)
    run_sweep(conflict, _in_parts(), folder / "whole", workers=1, report=False)

    def interrupt(progress: Progress) -> None:
        if progress.done == 32:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_sweep(conflict, _in_parts(), folder / "half", workers=1, progress=interrupt, report=False)
    assert len(list((folder / "half" / "parts").iterdir())) == 2
    return folder


@pytest.fixture
def half(swept: Path, tmp_path: Path) -> Path:
    """A copy of the interrupted sweep; `whole` beside it is one of the whole sweep."""
    shutil.copytree(swept / "whole", tmp_path / "whole")
    return shutil.copytree(swept / "half", tmp_path / "half")


def _flip(path: Path) -> None:
    """Change a bit of the last value of the first column."""
    column = pq.read_metadata(path).row_group(0).column(0)
    begin = column.dictionary_page_offset or column.data_page_offset
    content = bytearray(path.read_bytes())
    content[begin + column.total_compressed_size - 1] ^= 0x20
    path.write_bytes(content)


DAMAGES: dict[str, Callable[[Path], object]] = {
    "cut": lambda path: path.write_bytes(path.read_bytes()[:-20]),
    "empty": lambda path: path.write_bytes(b""),
    "a bit": _flip,
    "other columns": lambda path: pq.write_table(pa.table({"x": [1.0]}), path),
    "text": lambda path: path.write_text("variant,result", encoding="utf-8"),
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_part_is_done_again(conflict: Path, half: Path, damage: str) -> None:
    DAMAGES[damage](half / "parts" / "00000001.parquet")
    told: list[str] = []
    run_sweep(conflict, _in_parts(), half, workers=1, resume=True, report=False, say=told.append)
    assert told[0] == "damaged, and made again: 00000001.parquet"
    assert _bytes_of(half) == _bytes_of(half.parent / "whole")


@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_table_is_made_again(conflict: Path, half: Path, damage: str) -> None:
    whole = half.parent / "whole"
    good = _bytes_of(whole)
    DAMAGES[damage](whole / "results.parquet")
    run_sweep(conflict, _in_parts(), whole, workers=1, resume=True, report=False)
    assert _bytes_of(whole) == good


@pytest.mark.parametrize("damage", [*DAMAGES, "missing"])
def test_a_damaged_table_of_takeovers_is_made_again(conflict: Path, half: Path, damage: str) -> None:
    whole = half.parent / "whole"
    table = whole / "takeovers.parquet"
    good = table.read_bytes()
    {**DAMAGES, "missing": Path.unlink}[damage](table)
    run_sweep(conflict, _in_parts(), whole, workers=1, resume=True, report=False)
    assert table.read_bytes() == good
    assert not (whole / "parts").exists()


@pytest.mark.parametrize("damaged", [True, False])
def test_what_a_killed_process_left_behind_is_deleted(conflict: Path, half: Path, damaged: bool) -> None:
    """It was killed while it moved a trace into its folder, or while it deleted the parts of the finished table."""
    whole = half.parent / "whole"
    before = _bytes_of(whole)
    shutil.copytree(half / "parts", whole / "parts")
    draft = whole / "traces" / "00000003" / ".1-2.tmp"
    draft.mkdir(parents=True)
    (draft / "plan.json").touch()
    (whole / "report.html.1-2.tmp").touch()
    if damaged:
        _flip(whole / "results.parquet")
    run_sweep(conflict, _in_parts(), whole, workers=1, resume=True, report=False)
    assert _bytes_of(whole) == before
    assert not draft.exists()
    assert sorted(path.name for path in whole.iterdir()) == [
        "codebook.csv", "results.parquet", "sweep.json", "takeovers.parquet", "traces",
    ]  # fmt: skip


def test_a_trace_of_which_a_file_was_not_moved_is_made_again(conflict: Path, half: Path) -> None:
    """The recording is moved last."""
    whole, spec = half.parent / "whole", _in_parts(traces="worst:1")
    run_sweep(conflict, spec, whole, workers=1, resume=True, report=False)
    (trace,) = (whole / "traces").iterdir()
    files = sorted(path.name for path in trace.iterdir())
    (trace / files[-1]).unlink()
    run_sweep(conflict, spec, whole, workers=1, resume=True, report=False)
    assert sorted(path.name for path in trace.iterdir()) == files


def test_a_damaged_evaluation_of_a_search_is_done_again(conflict: Path, tmp_path: Path) -> None:
    spec = SweepSpec(vary=("distance=uniform(20, 350)",), perception="ideal", interpreted=True)
    search = partial(find_boundary, conflict, spec, tmp_path / "found", when="final_speed < -5", tolerance=100.0)
    with pytest.raises(SweepError, match="no boundary"):
        search()
    part = tmp_path / "found" / "parts" / "00000000.parquet"
    _flip(part)
    with pytest.raises(SweepError, match="no boundary"):
        search(resume=True)
    assert part.is_file()


def test_a_sweep_is_resumed_from_any_folder(conflict: Path, half: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(half)
    target = Path("..") / conflict.name
    run_sweep(target, _in_parts(), Path(), workers=1, resume=True, report=False)
    assert _bytes_of(half) == _bytes_of(half.parent / "whole")


def test_another_sweep_is_not_resumed(conflict: Path, half: Path) -> None:
    with pytest.raises(SweepError, match=r"holds another sweep: it differs in --seed$"):
        run_sweep(conflict, _in_parts(seed=2), half, workers=1, resume=True, report=False)


@pytest.mark.parametrize("resume", [False, True])
def test_a_second_sweep_in_one_folder_is_refused_at_once(conflict: Path, tmp_path: Path, resume: bool) -> None:
    folder, refused = tmp_path / "taken", []

    def try_the_same(progress: Progress) -> None:
        if progress.done == 16:
            told = [sys.executable, "-c", SECOND, str(conflict), str(folder), str(resume)]
            refused.append(subprocess.run(told, capture_output=True, text=True, timeout=120, check=False).stdout)

    run_sweep(conflict, _in_parts(), folder, workers=1, progress=try_the_same, report=False)
    expected = (
        f"another sweep is writing into {folder} (process {os.getpid()})" if resume else "contains a sweep already"
    )
    assert expected in refused[0]
    assert sorted(path.name for path in folder.iterdir()) == [
        "codebook.csv",
        "results.parquet",
        "sweep.json",
        "takeovers.parquet",
    ]


SECOND = """
import sys
from pathlib import Path
from scenario_compiler.batch.distributions import SweepError
from scenario_compiler.batch.execute import run_sweep
from scenario_compiler.batch.spec import SweepSpec
from scenario_compiler.batch.tally import Progress, Tally

spec = SweepSpec(vary=("distance=uniform(20, 350)",), samples=64, perception="ideal", interpreted=True, duration=1.0)
try:
    run_sweep(sys.argv[1], spec, Path(sys.argv[2]), workers=1, report=False, resume=sys.argv[3] == "True")
except SweepError as refused:
    print(refused)
"""


def test_two_sweeps_that_begin_together_do_not_mix(conflict: Path, tmp_path: Path) -> None:
    words = [sys.executable, "-c", SECOND, str(conflict), str(tmp_path / "both"), "False"]
    both = [subprocess.Popen(words, stdout=subprocess.PIPE, text=True) for _ in range(2)]
    told = [one.communicate(timeout=120)[0] for one in both]
    assert sum("another sweep is writing" in text or "contains a sweep already" in text for text in told) == 1
    run_sweep(conflict, _in_parts(), tmp_path / "whole", workers=1, report=False)
    assert _bytes_of(tmp_path / "both") == _bytes_of(tmp_path / "whole")


@pytest.mark.slow
def test_kill_9_keeps_what_was_finished(conflict: Path, tmp_path: Path) -> None:
    spec = _in_parts(samples=640)
    run_sweep(conflict, spec, tmp_path / "whole", workers=1, report=False)
    folder = tmp_path / "killed"
    script = KILLED.format(target=str(conflict), folder=str(folder))
    process = subprocess.Popen([sys.executable, "-c", script])
    with contextlib.suppress(FileNotFoundError):
        while process.poll() is None and len(list((folder / "parts").glob("*.parquet"))) < 3:
            time.sleep(0.02)
    process.kill()
    process.wait()
    assert not (folder / "results.parquet").exists()
    run_sweep(conflict, spec, folder, workers=2, resume=True, report=False)
    assert (folder / "results.parquet").read_bytes() == (tmp_path / "whole" / "results.parquet").read_bytes()


KILLED = """
from pathlib import Path
from scenario_compiler.batch.execute import run_sweep
from scenario_compiler.batch.spec import SweepSpec
from scenario_compiler.batch.tally import Progress, Tally

spec = SweepSpec(vary=("distance=uniform(20, 350)",), samples=640, perception="ideal", interpreted=True, duration=1.0)
run_sweep("{target}", spec, Path("{folder}"), workers=1, report=False)
"""


@pytest.mark.slow
def test_a_sweep_needs_little_memory(conflict: Path, tmp_path: Path) -> None:
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    run_sweep(conflict, _spec(samples=10_000), tmp_path / "sweep", workers=1, report=False)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 500_000


def test_a_worker_whose_sweep_is_gone_ends_without_a_word() -> None:
    """A pipe that is closed before the sweep has read everything resets the connection; it does not end the input."""
    ours, theirs = multiprocessing.Pipe()
    theirs.send("what the sweep does not read any more")
    ours.close()
    serve(theirs, "interpreted", Trust())
