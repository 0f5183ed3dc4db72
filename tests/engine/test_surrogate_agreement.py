"""Surrogate perception requests when the camera did, in a sample of the runs that were not used for the fit."""

from __future__ import annotations

import importlib
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from scenario_compiler.engine.columns.view import S_QUALITY

ROOT = Path(__file__).resolve().parents[2]
SAMPLE: list[tuple[int, float | None]] = json.loads((Path(__file__).parent / "surrogate_runs.json").read_text("utf-8"))

SAME = 0.5
"""Requests that are no further apart are the same answer, s."""


@pytest.fixture
def runs(monkeypatch: pytest.MonkeyPatch) -> Any:
    """The module that draws the runs from their numbers."""
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    return importlib.import_module("surrogate_runs")


def agrees(runs: Any, number: int, asked: float | None, perception: str) -> bool:
    """Return whether a run with a perception has the camera's answer: no request, or one at that time."""
    made = runs.run_case(runs.Case("conflict", number, ""), perception, looks=False)
    again = float(made.outcome["request_time"])
    return math.isnan(again) if asked is None else abs(again - asked) <= SAME + 1e-9


@pytest.mark.parametrize("every", [3, pytest.param(1, marks=pytest.mark.slow)])
def test_it_gives_the_cameras_answer_in_most_variants_of_the_conflicts(runs: Any, every: int) -> None:
    assert len(SAMPLE) == 50
    tried = SAMPLE[::every]
    assert sum(agrees(runs, number, asked, "surrogate") for number, asked in tried) >= 0.85 * len(tried)


@pytest.mark.slow
def test_the_camera_still_gives_the_stored_answers(runs: Any) -> None:
    assert all(agrees(runs, number, asked, "camera") for number, asked in SAMPLE[:5])


@pytest.mark.slow
def test_a_camera_run_is_repeated_without_a_camera_to_work_out_its_features(runs: Any, tmp_path: Path) -> None:
    """The stored confidence belongs to the stored place, and the features are those that the engine had there."""
    runs.keep([runs.run_case(runs.Case("conflict", -6005, ""), "camera", looks=True)], tmp_path)
    (made,) = runs.kept(tmp_path, tmp_path)
    views = runs.views_of(made)
    assert len(views) == len(made.looks) > 20
    assert np.isfinite(views).all()
    confidence = made.looks[:, runs.LOOK_COLUMNS.index("p_left")]
    assert np.corrcoef(views[:, S_QUALITY], confidence)[0, 1] > 0.5
