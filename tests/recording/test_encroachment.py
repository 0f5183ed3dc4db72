"""The post-encroachment time of crossings and followers, by hand.

Cars are 4 m long and 2 m wide; the reference point is 1 m ahead of the rear.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from scenario_compiler.recording.encroachment import least_encroachment, least_encroachment_total
from scenario_compiler.recording.recording import Recording
from tests.recording.made import STEP, Row, added_up, random_runs, record
from tests.recording.test_measures import value


def crossing(late: float, rows: int = 120, z: float = 0.0) -> Recording:
    """Return a run along x at 10 m/s, and a car that crosses at x = 40 m along y, `late` s after the ego could meet it.

    The ego's rear leaves x = 41 m, the far edge of the other's way, at t = 4.2 s; the other's front comes to y = -1 m,
    the near edge of the ego's, at t = 4.2 s + late.
    """

    def row(t: float) -> Row:
        return {
            "x": (10.0 * t, 40.0),
            "y": (0.0, -1.0 - 3.0 + 10.0 * (t - 4.2 - late)),
            "z": (0.0, z),
            "h": (0.0, 0.5 * math.pi),
            "v": (10.0, 10.0),
        }

    return record(("ego", "crosser"), rows, row)


@pytest.mark.parametrize("late", [0.5, 1.5, 3.0])
def test_the_other_comes_after_the_ego_has_left(late: float) -> None:
    assert value("minimum_post_encroachment_time", crossing(late)) == pytest.approx(late, abs=STEP + 1e-9)


def test_the_time_is_too_long_by_less_than_two_rows() -> None:
    """Boxes are compared in rows only: one before the ego has left, one after the other has come."""
    excess = []
    for shift in np.arange(0.0, 2.0 * STEP, 0.02).tolist():
        for late in np.arange(0.6, 0.6 + STEP, 0.02).tolist():

            def row(t: float, shift: float = shift, late: float = late) -> Row:
                across = -4.0 + 10.0 * (t - 4.2 - shift - late)
                turned = {"h": (0.0, 0.5 * math.pi), "v": (10.0, 10.0)}
                return {"x": (10.0 * (t - shift), 40.0), "y": (0.0, across), **turned}

            found = value("minimum_post_encroachment_time", record(("ego", "crosser"), 60, row))
            excess.append(found - late)
    assert min(excess) > -1e-9
    assert 1.5 * STEP < max(excess) < 2.0 * STEP


@pytest.mark.parametrize("early", [1.0, 2.5])
def test_the_ego_comes_after_the_other_has_left(early: float) -> None:
    """The other takes 0.6 s for the ego's way (2 m and its own 4 m), the ego 0.6 s for the other's."""
    assert value("minimum_post_encroachment_time", crossing(-early - 1.2)) == pytest.approx(early, abs=STEP + 1e-9)


def test_in_contact_the_time_is_zero() -> None:
    assert value("minimum_post_encroachment_time", crossing(-0.5)) == 0.0


def test_beyond_the_horizon_and_on_a_bridge_it_is_undefined() -> None:
    assert math.isnan(value("minimum_post_encroachment_time", crossing(11.0, rows=200)))
    assert math.isnan(value("minimum_post_encroachment_time", crossing(1.0, z=6.0)))


def test_a_followed_vehicle_has_its_time_gap() -> None:
    """30 m from reference point to reference point at 10 m/s: 26 m between the boxes, 2.6 s."""

    def row(t: float) -> Row:
        return {"x": (10.0 * t, 30.0 + 10.0 * t), "y": (0.0, 0.0), "h": (0.0, 0.0), "v": (10.0, 10.0)}

    run = record(("ego", "leader"), 80, row)
    assert value("minimum_post_encroachment_time", run) == pytest.approx(2.6, abs=STEP + 1e-9)


def test_a_standing_vehicle_has_no_post_encroachment_time() -> None:
    def row(t: float) -> Row:
        return {"x": (10.0 * t, 50.0), "y": (0.0, 3.0), "h": (0.0, 0.0), "v": (10.0, 0.0)}

    assert math.isnan(value("minimum_post_encroachment_time", record(("ego", "parked"), 100, row)))


@pytest.mark.parametrize("seed", range(4))
def test_the_fast_search_finds_the_same_as_comparing_all_rows(seed: int) -> None:
    runs = random_runs(seed, rows=150)
    found = least_encroachment(runs)
    assert np.array_equal(least_encroachment_total(added_up(runs)), found, equal_nan=True)
    assert np.isfinite(found).any()
