"""Results converge as the time step becomes shorter: the ego's decisions come at times that the step does not change.

The conflicts are those of the library that depended on the step: failures of a camera, which are counted over control
steps and images; a lane that is kept by dead reckoning with random errors; a driver who brakes.
"""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path

import pytest

from scenario_compiler import open_world, run
from scenario_compiler.compiler import Compilation, Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics, as_text
from scenario_compiler.recording.outcome import judge

LIBRARY = Path(__file__).parents[1] / "library" / "conflicts"

BEHIND_A_TRUCK = "markings_variants.xml#behind_a_truck"

PERIOD = 0.1
"""Time between two control steps in the library's conflicts, s."""


def compiled(conflict: str, step: float | None, seconds: float) -> Compilation:
    sink = Diagnostics()
    overrides = Overrides(perception="ideal", step=step, duration=seconds)
    found = compile_target(LIBRARY / conflict, {}, sink, overrides=overrides)
    assert found is not None, [as_text(one) for one in sink]
    return found


@cache
def measured(conflict: str, step: float, seconds: float = 20.0) -> dict[str, float]:
    """Return the measures of a run with seed 4, whose driver takes over; NaN for those that it does not have."""
    found = compiled(conflict, step, seconds)
    with open_world("kinematic", found.plan, found.network) as world:
        outcome = judge(found.plan, run(found.plan, world, seed=4))
    return {name: math.nan if one.value is None else one.value for name, one in outcome.measures.items()}


@pytest.mark.parametrize(
    ("step", "every"), [(None, 2), (0.1, 1), (0.05, 2), (0.02, 5), (0.03, 3), (0.005, 20), (0.4, 1)]
)
def test_another_step_keeps_the_time_between_control_steps(step: float | None, every: int) -> None:
    plan = compiled("obstacle_ahead.xml", step, 14.0).plan
    assert plan.control_every == every
    assert plan.step == (0.05 if step is None else step)


@pytest.mark.parametrize("conflict", ["camera_failures.xml#blackout", "camera_failures.xml#freeze", BEHIND_A_TRUCK])
@pytest.mark.parametrize("step", [0.05, 0.02, 0.0025])
def test_requests_and_responses_come_at_the_same_time(conflict: str, step: float) -> None:
    found, finest = measured(conflict, step), measured(conflict, 0.005)
    assert found["takeover_time"] == pytest.approx(finest["takeover_time"], abs=1e-9)
    for name in ("request_time", "response_time"):
        assert found[name] == pytest.approx(finest[name], abs=PERIOD + 1e-9)


@pytest.mark.parametrize("conflict", ["camera_failures.xml#blackout", "camera_failures.xml#dirt"])
def test_a_lane_that_is_not_seen_is_remembered_with_the_same_errors(conflict: str) -> None:
    """The random walk of the gyroscope belongs to control steps: a finer step draws the same one."""
    finest = measured(conflict, 0.005)
    for step, within in ((0.05, 0.02), (0.01, 0.01), (0.0025, 0.005)):
        found = measured(conflict, step)["lateral_offset_at_response"]
        assert found == pytest.approx(finest["lateral_offset_at_response"], abs=within)


@pytest.mark.parametrize("conflict", ["obstacle_variants.xml#cutting_in", "r157_situations.xml#deceleration"])
def test_a_driver_brakes_as_hard_at_any_step(conflict: str) -> None:
    finest = measured(conflict, 0.005, 30.0)["maximum_longitudinal_acceleration"]
    for step in (0.05, 0.02):
        assert measured(conflict, step, 30.0)["maximum_longitudinal_acceleration"] == pytest.approx(finest, abs=0.15)
