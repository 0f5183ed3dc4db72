"""A Dask cluster of processes on this machine gives the same table as the local run, though processes end."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass, field
from functools import cached_property
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

from scenario_compiler.batch.distributions import SweepError
from scenario_compiler.batch.execute import prepare, run_sweep
from scenario_compiler.batch.finished import read_results
from scenario_compiler.batch.runner import Part
from scenario_compiler.batch.spec import SweepSpec
from scenario_compiler.batch.tally import Progress
from scenario_compiler.diagnostics import Diagnostics

pytestmark = pytest.mark.skipif(find_spec("distributed") is None, reason="needs the extra `cluster`")
ENDS = """
import os

from scenario_compiler import Control, ControllerModel


class Ends(ControllerModel):
    def control(self, sensor_data, speed, vehicle):
        if speed > 19:
            os._exit(9)
        return Control(0.0, 0.0, 0.0)
"""
"""A controller that ends its process at more than 19 m/s."""


@dataclass
class Dask:
    """A scheduler and its workers, which import modules from their folder."""

    folder: Path
    processes: list[subprocess.Popen[bytes]] = field(default_factory=list)

    @property
    def workers(self) -> list[subprocess.Popen[bytes]]:
        """The workers, dead ones too."""
        return self.processes[1:]

    @cached_property
    def address(self) -> str:
        """The address of the scheduler, which starts."""
        self._start("scheduler", "--host", "127.0.0.1", "--port", "0")
        return _address(self.folder / "scheduler.log")

    def start(self, count: int, threads: int = 1) -> None:
        """Start workers."""
        for _ in range(count):
            self._start("worker", self.address, "--nthreads", str(threads), "--no-nanny")

    def _start(self, what: str, *options: str) -> None:
        command = [sys.executable, "-m", f"distributed.cli.dask_{what}", *options, "--no-dashboard"]
        settings = {"PYTHONPATH": str(self.folder), "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "0"}
        with (self.folder / f"{what}.log").open("ab") as sink:
            self.processes.append(
                subprocess.Popen(command, stderr=sink, cwd=self.folder, env={**os.environ, **settings})
            )


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[Dask]:
    """A scheduler, and no worker."""
    dask = Dask(tmp_path)
    try:
        yield dask
    finally:
        for process in dask.processes:
            process.kill()
        for process in dask.processes:
            process.wait()


def _address(log: Path) -> str:
    deadline = time.perf_counter() + 60
    while time.perf_counter() < deadline:
        found = re.search(r"Scheduler at:\s*(tcp://[\d.:]+)", log.read_text(encoding="utf-8"))
        if found:
            return found.group(1)
        time.sleep(0.1)
    raise TimeoutError(log.read_text(encoding="utf-8"))


def _spec(**settings: Any) -> SweepSpec:
    vary = ("distance=uniform(20, 350)", "preset=choice(study_means, absent)")
    return SweepSpec(**{"vary": vary, "samples": 96, "perception": "ideal", "interpreted": True, **settings})


def _same_tables(folder: Path) -> bool:
    return len({(folder / name / "results.parquet").read_bytes() for name in ("local", "far")}) == 1


@pytest.mark.slow
def test_a_cluster_gives_the_local_table_though_all_its_workers_are_killed(
    conflict: Path, tmp_path: Path, cluster: Dask
) -> None:
    run_sweep(conflict, _spec(), tmp_path / "local", workers=1, report=False)
    cluster.start(2)

    def kill(progress: Progress) -> None:
        if progress.done >= 48 and len(cluster.workers) == 2:
            for worker in cluster.workers:
                worker.kill()
            cluster.start(1)

    result = run_sweep(conflict, _spec(), tmp_path / "far", scheduler=cluster.address, progress=kill, report=False)
    assert len(cluster.workers) == 3
    assert result.tally.broken_off == 0
    assert _same_tables(tmp_path)


@pytest.mark.slow
def test_a_variant_that_ends_its_workers_is_a_row_with_an_error(conflict: Path, tmp_path: Path, cluster: Dask) -> None:
    (tmp_path / "ends.py").write_text(ENDS, encoding="utf-8")
    spec = SweepSpec(vary=("speed=values(8, 20, 9, 10)",), perception="camera", controller="ends:Ends", duration=0.2)
    cluster.start(3)
    run_sweep(conflict, spec, tmp_path / "far", scheduler=cluster.address, report=False)
    rows, _ = read_results(tmp_path / "far")
    assert rows["error"] == ["", "each worker that ran it died", "", ""]


@pytest.mark.slow
def test_a_sweep_whose_scheduler_ends_can_be_resumed(conflict: Path, tmp_path: Path, cluster: Dask) -> None:
    cluster.start(1)

    def kill(progress: Progress) -> None:
        if progress.done >= 48:
            cluster.processes[0].kill()

    with pytest.raises(OSError, match="the cluster has lost the tasks of the sweep"):
        run_sweep(conflict, _spec(), tmp_path / "far", scheduler=cluster.address, progress=kill, report=False)
    result = run_sweep(conflict, _spec(), tmp_path / "far", resume=True, workers=1, report=False)
    assert (result.tally.runs, result.tally.broken_off) == (96, 0)


@pytest.mark.slow
def test_workers_that_join_later_get_parts_too(conflict: Path, cluster: Dask) -> None:
    from distributed import Client

    from scenario_compiler.batch.cluster import AHEAD, Cluster

    sweep = prepare(conflict, _spec(vary=("distance=uniform(20, 350)",), samples=160), Diagnostics())
    taken: list[Part] = []

    def parts() -> Iterator[Part]:
        for number in range(sweep.parts):
            taken.append(sweep.part(number)[0])
            yield taken[-1]

    cluster.start(1)
    with closing(Cluster(sweep.form, cluster.address)) as far:
        rows = far.run(parts())
        next(rows)
        assert len(taken) == AHEAD
        cluster.start(1)
        with Client(cluster.address) as client:
            client.wait_for_workers(2, timeout=60)
        next(rows)
        assert len(taken) == 1 + 2 * AHEAD


@pytest.mark.slow
def test_a_worker_with_several_threads_runs_one_part_at_a_time(conflict: Path, tmp_path: Path, cluster: Dask) -> None:
    spec = _spec(samples=4000, interpreted=False)
    run_sweep(conflict, spec, tmp_path / "local", workers=1, report=False)
    cluster.start(1, threads=4)
    run_sweep(conflict, spec, tmp_path / "far", scheduler=cluster.address, report=False)
    assert _same_tables(tmp_path)


@pytest.mark.slow
def test_each_sweep_on_a_cluster_runs_its_own_plans(conflict: Path, tmp_path: Path, cluster: Dask) -> None:
    cluster.start(1)
    for speed in ("8", "20"):
        spec = _spec(vary=("distance=grid(20, 350, 4)",), samples=1, settings={"speed": speed})
        run_sweep(conflict, spec, tmp_path / speed / "local", workers=1, report=False)
        run_sweep(conflict, spec, tmp_path / speed / "far", scheduler=cluster.address, report=False)
        assert _same_tables(tmp_path / speed)


@pytest.mark.slow
def test_a_missing_cluster_is_reported() -> None:
    from scenario_compiler.batch.cluster import Cluster

    with pytest.raises(SweepError, match="no Dask cluster answers at tcp://127"):
        Cluster("interpreted", "tcp://127.0.0.1:9", patience=1.0)


@pytest.mark.slow
def test_the_documented_slurm_settings_make_a_job_script(repository: Path, tmp_path: Path) -> None:
    script = tmp_path / "job_script.py"
    script.write_text(JOB_SCRIPT, encoding="utf-8")
    command = [sys.executable, str(script), str(repository / "docs" / "slurm.yaml")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True, cwd=tmp_path)
    assert "#SBATCH -t 02:00:00" in done.stdout
    assert "#SBATCH --cpus-per-task=16" in done.stdout
    assert "export SCENARIO_COMPILER_CACHE=$HOME/.cache/scenario-compiler" in done.stdout
    assert "--nworkers 16" in done.stdout


JOB_SCRIPT = """
import sys
from pathlib import Path

import dask
import yaml

if __name__ == "__main__":
    dask.config.update(dask.config.config, yaml.safe_load(Path(sys.argv[1]).read_text()))
    from dask_jobqueue import SLURMCluster

    with SLURMCluster(scheduler_options={"dashboard_address": None}) as cluster:
        print(cluster.job_script())
"""
