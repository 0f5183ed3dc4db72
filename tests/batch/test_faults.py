"""What ends a process, hangs or fills a disk costs a row, or nothing."""

from __future__ import annotations

import contextlib
import os
import resource
import shlex
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from scenario_compiler.batch.execute import execute, prepare, run_sweep
from scenario_compiler.batch.pool import Pool
from scenario_compiler.batch.results import read_results
from scenario_compiler.batch.runner import Batch, Part
from scenario_compiler.batch.spec import SweepSpec
from scenario_compiler.diagnostics import Diagnostics

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


def _spec(**settings: object) -> SweepSpec:
    base = {"vary": ("distance=uniform(20, 350)",), "samples": 64, "perception": "ideal"}
    return SweepSpec.model_validate({**base, **settings})


def test_a_killed_worker_loses_and_doubles_nothing(conflict: Path, tmp_path: Path) -> None:
    spec = _spec(samples=64)
    run_sweep(conflict, spec, tmp_path / "whole", workers=1, report=False)
    sweep = prepare(conflict, spec, Diagnostics())
    store = sweep.store(tmp_path / "killed")
    store.open(resume=False)
    pool = _KillingPool("interpreted", spec.seed, 2)
    assert execute(sweep, store, pool) == 0
    store.merge(sweep.parts)
    assert pool.killed == 2
    tables = [(tmp_path / name / "results.parquet").read_bytes() for name in ("whole", "killed")]
    assert tables[0] == tables[1]


class _KillingPool(Pool):
    """A pool, two of whose workers are killed while they work."""

    killed = 0

    def run(self, parts: Iterator[Part]) -> Iterator[tuple[int, Batch]]:
        os.kill(self.processes[0], signal.SIGKILL)
        self.killed += 1
        for number, batch in super().run(parts):
            if self.killed < 2:
                os.kill(self.processes[1], signal.SIGKILL)
                self.killed += 1
            yield number, batch


def test_variants_that_crash_or_hang_are_rows(conflict: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "misbehaving.py").write_text(CONTROLLER, encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    spec = _spec(
        vary=("speed=choice(8, 12, 16, 20, 9)",),
        method="grid",
        perception="camera",
        controller="misbehaving:Misbehaving",
        duration=0.2,
        time_limit=5.0,
    )
    result = run_sweep(conflict, spec, tmp_path / "sweep", workers=2, report=False)
    rows, _ = read_results(tmp_path / "sweep")
    assert (result.form, result.failed) == ("camera", 3)
    assert rows["error"] == [
        "",
        "controller 'misbehaving:Misbehaving', misbehaving.py:20: ValueError: too fast for me",
        "it took longer than 5 s",
        "the process ended with code 9",
        "",
    ]
    assert rows["parameter.speed"] == [8, 12, 16, 20, 9]


def test_a_full_disk_keeps_what_was_finished(conflict: Path, tmp_path: Path) -> None:
    spec = _spec(samples=64, interpreted=True)
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

signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
spec = SweepSpec(vary=("distance=uniform(20, 350)",), samples=64, perception="ideal", interpreted=True)

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


@pytest.mark.parametrize(("size", "fails"), [("40k", "/s/parts/"), ("200k", "/s/results.parquet")])
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
    assert "cannot be written: No space left on device; --resume does the rest" in done.stderr
    run_sweep(conflict, spec, tmp_path / "kept", workers=1, resume=True, report=False)
    tables = [(tmp_path / name / "results.parquet").read_bytes() for name in ("whole", "kept")]
    assert tables[0] == tables[1]


@pytest.mark.slow
def test_kill_9_keeps_what_was_finished(conflict: Path, tmp_path: Path) -> None:
    spec = _spec(samples=640, interpreted=True)
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

spec = SweepSpec(vary=("distance=uniform(20, 350)",), samples=640, perception="ideal", interpreted=True)
run_sweep("{target}", spec, Path("{folder}"), workers=1, report=False)
"""


@pytest.mark.slow
def test_a_sweep_needs_little_memory(conflict: Path, tmp_path: Path) -> None:
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    run_sweep(conflict, _spec(samples=10_000), tmp_path / "sweep", workers=1, report=False)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 500_000
