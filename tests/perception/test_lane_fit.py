"""The choice of a pair of arcs by their votes."""

import numpy as np
import pytest

from scenario_compiler.perception.lane_detector import ClassicalLaneDetector
from scenario_compiler.perception.lane_fit import LEFT, RIGHT


@pytest.mark.parametrize("on_course", [False, True])
def test_the_last_digits_of_equal_scores_choose_nothing(on_course: bool) -> None:
    """Sums in another order, as on another processor, differ in their last digits."""
    fitter, draw = ClassicalLaneDetector().fitter, np.random.default_rng(1)
    left, right = (np.full(len(fitter.curves[side]), 20.0) for side in (LEFT, RIGHT))
    chosen = fitter.pair((left, right), 3.5, 0.3, on_course)
    settled = fitter.settle((left, right), 3.5, 0.3, chosen)
    for _ in range(10):
        other = left + draw.uniform(-1e-12, 1e-12, len(left)), right + draw.uniform(-1e-12, 1e-12, len(right))
        assert fitter.pair(other, 3.5, 0.3, on_course) == chosen
        assert fitter.settle(other, 3.5, 0.3, chosen) == settled
