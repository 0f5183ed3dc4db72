"""Surrogate perception requests when the camera did, in a sample of the runs that were not used for the fit."""

from __future__ import annotations

import importlib
import json
import math
from pathlib import Path
from typing import Any

import pytest

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
