"""Loading and locating against CARLA's C++ map library, and the cost on larger networks: ratios of CPU time."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from scenario_compiler.forms.machine_code import why_interpreted
from tests.benchmarks import roads_figures
from tests.benchmarks.roads_figures import LARGE, SMALL, TOWN04, growth, loading, locating

REPEATS = 7

pytestmark = pytest.mark.slow


@pytest.fixture(autouse=True)
def _machine_code() -> None:
    """The figures are those of the compiled form: the interpreted one locates twice as many points as `carla.Map`."""
    assert why_interpreted() == ""


def test_loading_takes_at_most_twice_carlas_time(corpus: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SCENARIO_COMPILER_CACHE", str(tmp_path))
    found = loading(corpus / TOWN04, REPEATS)
    assert found.cached <= 0.2 * found.file
    if found.carla is None:
        pytest.skip("the client of CARLA is not installed")
    assert found.file <= 2.0 * found.carla


def test_batch_location_is_five_times_as_fast_as_carla(corpus: Path) -> None:
    found = locating(corpus / TOWN04, REPEATS)
    if found.carla is None:
        pytest.skip("the client of CARLA is not installed")
    assert found.ours >= 5.0 * found.carla


def test_cost_grows_with_points_and_not_with_the_map(tmp_path: Path) -> None:
    """From 250 km to 1 000 km: loading is linear (within a factor of 2), a batch query costs the same (within 3)."""
    small, large = growth(tmp_path, SMALL), growth(tmp_path, LARGE)
    assert large.load / large.roads <= 2.0 * small.load / small.roads
    assert large.query <= 3.0 * small.query


@pytest.mark.usefixtures("corpus")
def test_the_table_is_printed() -> None:
    script = [sys.executable, str(roads_figures.__file__), "--short", "--runs", "1"]
    done = subprocess.run(script, capture_output=True, text=True, timeout=300, check=True)
    assert "locate_many, get_waypoint" in done.stdout
    assert "held to" in done.stdout
