"""The times of reports of CARLA's sensors, which may come after a later tick."""

from __future__ import annotations

import pytest

from scenario_compiler.worlds.carla import time_before


@pytest.mark.parametrize(
    ("frames", "t"), [(0, 27.9), (1, 557 * 0.05), (2, 556 * 0.05), (558, 0.0), (600, 0.0), (-1, 27.9)]
)
def test_a_report_has_the_time_of_its_own_frame(frames: int, t: float) -> None:
    assert time_before(558 * 0.05, 0.05, frames) == pytest.approx(t, abs=1e-12)


def test_times_are_whole_numbers_of_steps_to_the_bit() -> None:
    for k in range(3, 2000):
        assert time_before(k * 0.02, 0.02, 3) == (k - 3) * 0.02
