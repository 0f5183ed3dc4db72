"""A server that drives run after run needs no more memory than before: recordings are on the disk."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.live import soaking
from tests.live.serving import served

WARM, MORE = 25, 25
"""Runs until what is made once is there, and runs that must add nothing."""

GROWTH = 8.0
"""How much more memory may be held after `MORE` runs, MiB; one run kept with its pictures and plots is several."""


@pytest.mark.slow
def test_runs_that_are_over_leave_no_memory(tmp_path: Path) -> None:
    soaking.written(tmp_path, 1, 1)
    words = ("drive", tmp_path / "conflicts.xml", "--perception", "ideal", "-o", tmp_path / "out")
    with served(*words) as server:
        held = list(soaking.runs(server, WARM + MORE))
    assert min(held[-10:]) - min(held[WARM - 10 : WARM]) < GROWTH
    assert len(list((tmp_path / "out").glob("*/recording.parquet"))) == WARM + MORE
