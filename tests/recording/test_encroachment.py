"""The post-encroachment time of crossings and followers, by hand.

Cars are 4 m long and 2 m wide; the reference point is 1 m ahead of the rear.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from scenario_compiler.recording.encroachment import least_encroachment, least_encroachment_total
from scenario_compiler.recording.recording import Booleans, Floats, Recording
from tests.recording.made import STEP, Row, added_up, random_runs, record, with_trailers
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
    assert value("minimum_post_encroachment_time", crossing(late)) == pytest.approx(late, abs=1e-9)


def test_the_time_is_that_between_the_moments_not_between_the_rows() -> None:
    """The ego leaves and the other comes at any moment between two rows."""
    for shift in np.arange(0.0, 2.0 * STEP, 0.02).tolist():
        for late in np.arange(0.6, 0.6 + STEP, 0.02).tolist():

            def row(t: float, shift: float = shift, late: float = late) -> Row:
                across = -4.0 + 10.0 * (t - 4.2 - shift - late)
                turned = {"h": (0.0, 0.5 * math.pi), "v": (10.0, 10.0)}
                return {"x": (10.0 * (t - shift), 40.0), "y": (0.0, across), **turned}

            found = value("minimum_post_encroachment_time", record(("ego", "crosser"), 60, row))
            assert found == pytest.approx(late, abs=1e-9)


def corners(x: Floats, y: Floats, h: Floats) -> Floats:
    """Return the corners of a car's boxes, (n, 4, 2), m."""
    along, across = np.array([3.0, 3.0, -1.0, -1.0]), np.array([1.0, -1.0, -1.0, 1.0])
    c, s = np.cos(h)[:, None], np.sin(h)[:, None]
    return np.stack([x[:, None] + along * c - across * s, y[:, None] + along * s + across * c], axis=-1)


def overlap(first: Floats, second: Floats) -> Booleans:
    """Return which boxes overlap, (n,): no side of one of the two separates them."""
    apart = np.zeros(len(first), dtype=bool)
    for boxes in (first, second):
        for side in (boxes[:, 1] - boxes[:, 0], boxes[:, 2] - boxes[:, 1]):
            a, b = (np.einsum("nij,nj->ni", each, side) for each in (first, second))
            apart |= (a.max(axis=1) < b.min(axis=1)) | (b.max(axis=1) < a.min(axis=1))
    return ~apart


@pytest.mark.parametrize("late", [0.93, 1.76, 2.67])
def test_of_a_turning_vehicle_the_time_is_that_of_finely_sampled_poses(late: float) -> None:
    """The ego turns to the left at 7 m/s on 12 m, across the way of an oncoming car that drives at 11 m/s."""

    def ego(t: Floats) -> tuple[Floats, Floats, Floats]:
        turned = 7.0 / 12.0 * t
        return 12.0 * np.sin(turned), 12.0 - 12.0 * np.cos(turned), turned

    def other(t: Floats) -> tuple[Floats, Floats, Floats]:
        return 35.0 - 11.0 * (t - late), np.full_like(t, 3.5), np.full_like(t, math.pi)

    def row(t: float) -> Row:
        poses = np.array([[float(value) for value in way(np.array(t))] for way in (ego, other)]).T.tolist()
        return {**dict(zip(("x", "y", "h"), poses, strict=True)), "v": (7.0, 11.0)}

    fine = 0.005
    t = np.arange(0.0, 4.0, fine)
    boxes = corners(*ego(t))
    lag = next(lag for lag in range(1600) if overlap(boxes, corners(*other(t + lag * fine))).any())
    found = value("minimum_post_encroachment_time", record(("ego", "oncoming"), 70, row))
    assert lag * fine > 1.0
    assert found == pytest.approx(lag * fine, abs=1.5 * fine)


@pytest.mark.parametrize("lead", [9.0, 12.5, 17.3])
def test_a_faster_follower_closes_up_to_the_time_at_the_last_row(lead: float) -> None:
    """When the run ends, the ego's front is where the leader's rear was at a time that follows from its speed."""

    def row(t: float) -> Row:
        return {"x": (20.0 * t, 90.0 + lead * t), "y": (0.0, 0.0), "h": (0.0, 0.0), "v": (20.0, lead)}

    front, rear = 20.0 * 5.0 + 3.0, 90.0 - 1.0
    run = record(("ego", "leader"), 51, row)
    assert value("minimum_post_encroachment_time", run) == pytest.approx(5.0 - (front - rear) / lead, abs=1e-9)


@pytest.mark.parametrize("early", [1.0, 2.5])
def test_the_ego_comes_after_the_other_has_left(early: float) -> None:
    """The other takes 0.6 s for the ego's way (2 m and its own 4 m), the ego 0.6 s for the other's."""
    assert value("minimum_post_encroachment_time", crossing(-early - 1.2)) == pytest.approx(early, abs=1e-9)


def test_in_contact_the_time_is_zero() -> None:
    assert value("minimum_post_encroachment_time", crossing(-0.5)) == 0.0


def test_beyond_the_horizon_and_on_a_bridge_it_is_undefined() -> None:
    assert math.isnan(value("minimum_post_encroachment_time", crossing(10.01, rows=200)))
    assert value("minimum_post_encroachment_time", crossing(9.97, rows=200)) == pytest.approx(9.97, abs=1e-9)
    assert math.isnan(value("minimum_post_encroachment_time", crossing(1.0, z=6.0)))


def test_a_followed_vehicle_has_its_time_gap() -> None:
    """30 m from reference point to reference point at 10 m/s: 26 m between the boxes, 2.6 s."""

    def row(t: float) -> Row:
        return {"x": (10.0 * t, 30.0 + 10.0 * t), "y": (0.0, 0.0), "h": (0.0, 0.0), "v": (10.0, 10.0)}

    run = record(("ego", "leader"), 80, row)
    assert value("minimum_post_encroachment_time", run) == pytest.approx(2.6, abs=1e-9)


def test_a_standing_vehicle_has_no_post_encroachment_time() -> None:
    def row(t: float) -> Row:
        return {"x": (10.0 * t, 50.0), "y": (0.0, 3.0), "h": (0.0, 0.0), "v": (10.0, 0.0)}

    assert math.isnan(value("minimum_post_encroachment_time", record(("ego", "parked"), 100, row)))


@pytest.mark.parametrize("seed", range(4))
def test_the_fast_search_finds_the_same_as_comparing_all_rows(seed: int) -> None:
    runs = with_trailers(random_runs(seed, rows=150))
    found = least_encroachment(runs)
    assert np.array_equal(least_encroachment_total(added_up(runs)), found, equal_nan=True)
    assert np.isfinite(found).any()
