"""A Dask cluster with three worker processes on this machine gives the same table as the local run."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import pytest

from scenario_compiler.batch.distributions import SweepError
from scenario_compiler.batch.execute import run_sweep
from scenario_compiler.batch.spec import SweepSpec
from scenario_compiler.batch.tally import Progress

pytestmark = pytest.mark.skipif(find_spec("distributed") is None, reason="needs the extra `cluster`")
WORKERS = 3


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """Address of a scheduler, and its worker processes."""
    log = tmp_path / "scheduler.log"
    command = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0"]
    with log.open("wb") as sink:
        scheduler = subprocess.Popen([*command, "--no-dashboard"], stderr=sink, cwd=tmp_path)
    processes = [scheduler]
    try:
        address = _address(log)
        worker = [sys.executable, "-m", "distributed.cli.dask_worker", address, "--nthreads", "1", "--no-nanny"]
        with (tmp_path / "workers.log").open("wb") as sink:
            workers = [subprocess.Popen([*worker, "--no-dashboard"], stderr=sink, cwd=tmp_path) for _ in range(WORKERS)]
        processes += workers
        yield address, workers
    finally:
        for process in processes:
            process.kill()
        for process in processes:
            process.wait()


def _address(log: Path) -> str:
    deadline = time.perf_counter() + 60
    while time.perf_counter() < deadline:
        found = re.search(r"Scheduler at:\s*(tcp://[\d.:]+)", log.read_text(encoding="utf-8"))
        if found:
            return found.group(1)
        time.sleep(0.1)
    raise TimeoutError(log.read_text(encoding="utf-8"))


@pytest.mark.slow
def test_a_cluster_gives_the_local_table_though_a_worker_is_killed(
    conflict: Path, tmp_path: Path, cluster: tuple[str, list[subprocess.Popen[bytes]]]
) -> None:
    address, workers = cluster
    spec = SweepSpec(
        vary=("distance=uniform(20, 350)", "preset=choice(study_means, absent)"),
        samples=300,
        perception="ideal",
        interpreted=True,
    )
    run_sweep(conflict, spec, tmp_path / "local", workers=1, report=False)
    killed: list[int] = []

    def kill(progress: Progress) -> None:
        if progress.done >= 48 and not killed:
            killed.append(workers[0].pid)
            os.kill(workers[0].pid, signal.SIGKILL)

    result = run_sweep(conflict, spec, tmp_path / "far", scheduler=address, progress=kill, report=False)
    assert killed
    assert result.tally.broken_off == 0
    tables = [(tmp_path / name / "results.parquet").read_bytes() for name in ("local", "far")]
    assert tables[0] == tables[1]


@pytest.mark.slow
def test_each_sweep_on_a_cluster_runs_its_own_plans(
    conflict: Path, tmp_path: Path, cluster: tuple[str, list[subprocess.Popen[bytes]]]
) -> None:
    address, _ = cluster
    for speed in ("8", "20"):
        spec = SweepSpec(vary=("distance=grid(20, 350, 48)",), settings={"speed": speed}, perception="ideal")
        run_sweep(conflict, spec, tmp_path / speed / "local", workers=1, report=False)
        run_sweep(conflict, spec, tmp_path / speed / "far", scheduler=address, report=False)
        tables = [(tmp_path / speed / name / "results.parquet").read_bytes() for name in ("local", "far")]
        assert tables[0] == tables[1]


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
