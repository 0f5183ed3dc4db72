"""The resistance of CARLA's vehicles."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenario_compiler.worlds.resistance import resistance

NUMBERS = st.floats(allow_nan=False, allow_infinity=False, width=32)
"""What the layouts of calls let through."""


def test_wheels_and_air_add_up() -> None:
    found = resistance([(0.25, 0.3)] * 4, drag=0.3, area=2.0, mass=1000.0)
    assert found.at(10.0) == pytest.approx(10.0 * 4 * 0.25 / 0.09 / 1000.0 + 0.5 * 1.25 * 0.3 * 2.0 * 100.0 / 1000.0)
    assert found.at(-10.0) == found.at(10.0)
    assert found.at(10.0, grip=0.0) == pytest.approx(0.0375)
    assert found.at(0.0) == 0.0


@given(NUMBERS, NUMBERS, NUMBERS, st.floats(min_value=0.0, exclude_min=True, width=32, allow_infinity=False))
def test_it_is_finite_for_any_values_of_a_client(damping: float, radius: float, drag: float, mass: float) -> None:
    found = resistance([(damping, radius)], drag, 2.0, mass)
    for grip in (0.0, 1.0):
        assert 0.0 <= found.at(300.0, grip) < math.inf
