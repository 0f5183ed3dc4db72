"""The steering reversal rate: by hand, and as scipy filters."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from scipy import signal

from scenario_compiler.engine.columns import opcodes
from scenario_compiler.engine.measures.reversals import cut_off
from scenario_compiler.recording.measures import MEASURES
from scenario_compiler.recording.reversals import COARSE, FINE, reversals, smoothed
from scenario_compiler.recording.traces import traces_of
from tests.recording.made import Row, added_up, plan_of, record


@pytest.mark.parametrize(
    ("angles", "count"),
    [
        ([], 0),
        ([0.0, 1.0, 2.0, 3.0], 0),
        ([0.0, 3.0, 0.0], 1),
        ([0.0, 3.0, 0.5, 3.0, 0.0], 3),
        ([0.0, 3.0, 2.5, 3.5, 2.4, 4.0], 2),
        ([0.0, 0.5, 0.0, 0.5, 0.0], 0),
        ([0.0, -3.0, 3.0, -3.0], 2),
        ([5.0, 5.0, 3.9, 5.0], 1),
    ],
)
def test_a_reversal_is_a_turn_back_by_at_least_the_gap(angles: list[float], count: int) -> None:
    start = angles[0] if angles else 0.0
    assert reversals(angles, 1.0, start) == count
    assert reversals([-angle for angle in angles], 1.0, -start) == count


@pytest.mark.parametrize("variant", [COARSE, FINE])
@pytest.mark.parametrize("step", [0.01, 0.05, 0.1])
def test_the_filter_is_that_of_butterworth(variant: int, step: float) -> None:
    limit = cut_off(variant)
    angles = np.cumsum(np.random.default_rng(3).normal(0.0, 0.01, 300)) + 0.3
    b, a = signal.butter(2, limit, fs=1 / step)
    rest = signal.lfilter_zi(b, a) * angles[0]
    expected, _ = signal.lfilter(b, a, angles, zi=rest)
    assert smoothed(angles.tolist(), limit, step, float(angles[0])) == pytest.approx(expected, abs=1e-9)


def test_the_first_turn_counts_although_one_step_completes_it() -> None:
    """The wheel turns by 40 degrees in the step after the response, stays for 4 s, and turns back: one reversal."""

    def row(t: float) -> Row:
        angle = math.radians(40.0) / 16 if 1.05 < t < 5.05 else 0.0
        state = opcodes.TAKEOVER_MANUAL if t > 1.05 else opcodes.TAKEOVER_REQUEST
        return {"x": (t,), "v": (9.0,), "steer": (angle,), "takeover_state": (state,)}

    events = [(1.0, "request", "path_blocked"), (1.0, "response", "")]
    runs = traces_of(plan_of("ego"), record(("ego",), 111, row, events))
    measure = next(one for one in MEASURES if one.name == "steering_reversal_rate")
    assert float(measure.compute(runs)) == pytest.approx(6.0)
    assert measure.total(added_up(runs))[0] == float(measure.compute(runs))


@pytest.mark.parametrize(("step", "coarse", "fine"), [(0.24, True, True), (0.25, True, False), (0.85, False, False)])
def test_a_rate_is_undefined_if_the_steps_cannot_show_the_frequency_of_its_filter(
    step: float, coarse: bool, fine: bool
) -> None:
    def row(t: float) -> Row:
        state = opcodes.TAKEOVER_MANUAL if t > 1.05 else opcodes.TAKEOVER_REQUEST
        return {"x": (t,), "v": (9.0,), "steer": (0.1 * math.sin(t),), "takeover_state": (state,)}

    events = [(1.0, "request", "path_blocked"), (1.0, "response", "")]
    runs = dataclasses.replace(traces_of(plan_of("ego"), record(("ego",), 111, row, events)), step=step)
    totals = added_up(runs)
    for name, defined in (("steering_reversal_rate", coarse), ("fine_steering_reversal_rate", fine)):
        measure = next(one for one in MEASURES if one.name == name)
        assert (math.isfinite(float(measure.compute(runs))), math.isfinite(measure.total(totals)[0])) == (
            defined,
            defined,
        )


@pytest.mark.parametrize(("degrees", "coarse", "fine"), [(4.0, 24.0, 24.0), (1.0, 0.0, 24.0), (0.02, 0.0, 0.0)])
def test_a_wheel_that_swings_is_reversed_twice_a_period(degrees: float, coarse: float, fine: float) -> None:
    """Swings of 5 s for 30 s, by so many degrees to each side: 12 reversals of which the first way is none."""

    def row(t: float) -> Row:
        angle = math.radians(degrees) / 16 * math.sin(2 * math.pi * (t - 1.0) / 5.0)
        state = opcodes.TAKEOVER_MANUAL if t > 1.05 else opcodes.TAKEOVER_REQUEST
        return {"x": (t,), "v": (9.0,), "steer": (angle,), "takeover_state": (state,)}

    events = [(1.0, "request", "path_blocked"), (1.0, "response", "")]
    runs = traces_of(plan_of("ego"), record(("ego",), 311, row, events))
    totals = added_up(runs)
    for name, expected in (("steering_reversal_rate", coarse), ("fine_steering_reversal_rate", fine)):
        measure = next(one for one in MEASURES if one.name == name)
        found = float(measure.compute(runs))
        assert found == pytest.approx(expected, abs=60 / 30 + 1e-9)
        assert measure.total(totals)[0] == found
