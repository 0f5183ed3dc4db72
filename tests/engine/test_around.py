"""The traffic density around the ego at a request, and its time to collision along the lane."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots
from scenario_compiler.engine.columns.state import make_draws
from scenario_compiler.engine.simulation import Simulation
from tests.engine.make import Draft, highway
from tests.studies.study import compiled, runs


def asked_for(*others: tuple[int, float, float], length: float = 2000.0) -> float:
    """Return the traffic density at a request at s = 900 m of a road; others are (lane, s, speed)."""
    draft = Draft(highway(length), {slots.K_DURATION: 1.0, slots.K_DRIVER_TIME: 5.0})
    draft.ego(lane=-2, s=900.0, speed=30.0)
    for number, at, speed in others:
        draft.moving(number, at, speed)
    run = Simulation(draft.network.tables, draft.done())
    run.reset(make_draws(1))
    run.state.ordered_request[0] = op.CAUSE_CONTROLLER
    while run.step() and run.state.requests[0] == 0:
        pass
    assert run.state.requests[0] == 1
    return float(run.state.traffic_density[0])


@pytest.mark.parametrize(
    ("others", "density"),
    [
        ([], 0.0),
        ([(-1, 950.0, 30.0), (-3, 700.0, 30.0), (-2, 1300.0, 25.0)], 3.0),
        ([(-1, 405.0, 30.0), (-1, 1395.0, 30.0), (-1, 390.0, 30.0), (-1, 1415.0, 30.0)], 2.0),
        ([(1, 950.0, 30.0), (-1, 950.0, 0.0), (-3, 950.0, 1.5)], 0.0),
    ],
)
def test_vehicles_in_the_same_direction_are_counted_per_kilometre(
    others: list[tuple[int, float, float]], density: float
) -> None:
    assert asked_for(*others) == density


def test_where_the_road_ends_the_kilometre_is_shorter() -> None:
    assert asked_for((-1, 950.0, 30.0), length=1200.0) == pytest.approx(1000.0 / (500.0 + 300.0), rel=0.01)


def test_the_time_to_collision_along_the_lane_is_the_gap_over_the_closing_speed_until_the_ego_has_moved_aside() -> None:
    draft = Draft(highway(), {slots.K_DURATION: 12.0, slots.K_DRIVER_TIME: 1.0, slots.K_BUDGET: 7.0})
    draft.causes(op.CAUSE_PATH_BLOCKED)
    draft.ego(lane=-2, s=50.0, speed=20.0)
    draft.parked(300.0, lane=-2)
    run = Simulation(draft.network.tables, draft.done())
    run.reset(make_draws(1))
    p, st = run.program, run.state
    front, rear = (
        p.const[p.entity_const[i] + slots.E_CENTER] + sign * 0.5 * p.const[p.entity_const[i] + slots.E_LENGTH]
        for i, sign in ((0, 1.0), (1, -1.0))
    )
    seen, least = [], np.inf
    while run.step():
        if st.lane_time[0] < op.FAR:
            seen.append((st.lane_time[0], (st.x[1] + rear - st.x[0] - front) / max(st.v[0], 0.1), st.y[0]))
            least = min(least, st.lane_time[0])
    assert len(seen) > 40
    for found, expected, _ in seen:
        assert found == pytest.approx(expected, abs=0.11)
    assert st.lane_time[0] == op.FAR
    assert 0.5 < least < 5.0


def test_the_time_to_collision_along_the_lane_is_0_only_in_a_collision(repository: Path, tmp_path: Path) -> None:
    """A slow car steers past an obstacle: its front is beside it while its rear axle is still behind it."""
    text = (repository / "library" / "conflicts" / "obstacle_ahead.xml").read_text(encoding="utf-8")
    slow = 0
    for _, outcome in runs(compiled(tmp_path, text, distance=200.0), range(1, 31)):
        assert outcome.collision_with is None
        slow += outcome.measures["standstill_time"].value is not None
        assert (outcome.measures["minimum_lane_time_to_collision"].value or 0.0) > 0.2
    assert slow > 3
