from itertools import pairwise

import numpy as np
import pytest

from scenario_compiler.engine.ego.camera_health import noise_health
from scenario_compiler.perception.calibration.fit import cross_validated, fit_logistic, reliability
from scenario_compiler.perception.calibration.frames import CLEAR_DAY, Wanted, random_frame
from scenario_compiler.perception.calibration.measure import collect, mean_confidence
from scenario_compiler.perception.confidence import (
    FEATURES,
    load_calibration,
    noise_of,
    probability,
)
from scenario_compiler.perception.degradation import add_noise
from scenario_compiler.perception.lane_detector import ClassicalLaneDetector

TABLE = load_calibration()


def falling(rows: tuple[tuple[float, float], ...]) -> bool:
    return all(a[1] >= b[1] - TABLE.error for a, b in pairwise(rows))


def test_the_table_says_what_the_confidence_is_for() -> None:
    assert len(TABLE.weights) == len(FEATURES)
    assert TABLE.error < 0.06
    assert falling(tuple(reversed(sorted(TABLE.by_quality, key=lambda row: row[0]))))
    assert falling(tuple(sorted(TABLE.by_sigma)))
    quality, sigma = dict(TABLE.by_quality), dict(TABLE.by_sigma)
    assert quality[1.0] > 0.9
    assert quality[0.0] < 0.15
    assert sigma[5.0] > sigma[0.0] - 0.02
    assert sigma[60.0] < 0.01
    assert TABLE.neither_without_paint > 0.8


def test_the_table_still_holds_for_fresh_roads() -> None:
    """Rows measured again on other roads stay within the stated error and the sampling error of 30 frames."""
    detector = ClassicalLaneDetector()
    for quality in (1.0, 0.3, 0.0):
        row = mean_confidence(detector, "quality", quality, 30, seed=77)
        assert row.p == pytest.approx(dict(TABLE.by_quality)[quality], abs=TABLE.error + 0.09)


def test_probabilities_come_true_on_fresh_roads() -> None:
    rows, outcomes, _ = collect(100, seed=78)
    p = np.array([probability(row, TABLE.weights) for row in rows])
    assert abs(p.mean() - outcomes.mean()) < TABLE.error + 0.05
    assert reliability(p, outcomes).area > 0.93


def test_measured_noise_is_the_noise_that_was_added() -> None:
    image = random_frame(np.random.default_rng(3), Wanted(1.0, 0.0, CLEAR_DAY, False)).image
    assert noise_of(image) < 2.0
    for sigma in (5.0, 15.0, 25.0):
        assert noise_of(add_noise(image, sigma, 1, 0)) == pytest.approx(sigma, rel=0.08)


def test_health_falls_through_one_half_at_thirty_grey_levels() -> None:
    assert noise_health(30.0) == 0.5
    assert noise_health(5.0) > 0.99
    assert noise_health(60.0) < 0.001
    assert noise_health(1e9) >= 0.0


def test_the_fit_finds_the_weights_that_made_the_outcomes() -> None:
    draw = np.random.default_rng(1)
    rows = np.concatenate([np.ones((4000, 1)), draw.normal(size=(4000, 2))], axis=1)
    truth = np.array([0.3, 1.5, -2.0])
    outcomes = (draw.random(4000) < 1 / (1 + np.exp(-rows @ truth))).astype(float)
    assert np.allclose(fit_logistic(rows, outcomes), truth, atol=0.2)
    p = cross_validated(rows, outcomes, np.arange(4000))
    assert reliability(p, outcomes).largest_error < 0.06
