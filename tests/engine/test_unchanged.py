"""The time budget of requests that are not about an obstacle, on roads where it can be calculated by hand."""

from __future__ import annotations

import math

import pytest

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots
from scenario_compiler.engine.ego.unchanged import distance_to_paint_end, time_left, time_to_leave
from tests.engine.make import Draft, Run, bend, highway, ramp

FRONT = 1.4 + 2.25
"""From the reference point to the front bumper, m."""


def driving(draft: Draft, speed: float = 20.0) -> Run:
    """Return the run of an ego that has driven its first step along the middle of its lane."""
    draft.ego(speed=speed)
    return draft.start().go(0.05)


def test_straight_on_a_straight_road_the_lane_is_never_left() -> None:
    run = driving(Draft(highway()))
    run.st.steer[0] = 0.0
    assert time_to_leave(run.n, run.p, run.st, 0) == op.FAR


@pytest.mark.parametrize("radius", [150.0, 400.0])
def test_straight_on_in_a_bend_it_is_left_when_the_bend_has_gone_aside_by_the_room_beside_the_car(
    radius: float,
) -> None:
    """Lanes are 3.5 m wide, the car 1.8 m: 0.85 m of room; the lane's middle has the radius and half a lane more."""
    run = driving(Draft(bend(radius)))
    run.st.steer[0] = 0.0
    middle = radius + 1.75
    room = 0.85 - abs(run.st.path_off[0])
    expected = math.sqrt((middle + room) ** 2 - middle**2) / run.st.v[0]
    assert time_to_leave(run.n, run.p, run.st, 0) == pytest.approx(expected, rel=0.03)


def test_with_the_wheels_turned_it_is_left_on_a_circle() -> None:
    run = driving(Draft(highway()))
    run.st.steer[0] = 0.02
    radius = 2.7 / math.tan(0.02)
    way = radius * math.acos(1.0 - 0.85 / radius)
    assert time_to_leave(run.n, run.p, run.st, 0) == pytest.approx(way / run.st.v[0], rel=0.02)


def test_the_lanes_end_counts_as_leaving_it() -> None:
    run = driving(Draft(highway(120.0)))
    run.st.steer[0] = 0.0
    assert time_to_leave(run.n, run.p, run.st, 0) == pytest.approx((120.0 - run.st.s[0]) / run.st.v[0], abs=0.1)


def unpainted(begin: float) -> Run:
    """Return a run at 51 m on a road whose paint ends."""
    draft = Draft(highway())
    p = draft.program
    p.stretch_road, p.stretch_count, p.stretch_lane = [0], [1], [op.ALL_MARKS]
    p.stretch_const = [draft.block(begin, 2000.0, 0.0, 0.0, 0.0)]
    return driving(draft)


def test_lane_confidence_has_the_time_to_the_end_of_the_paint() -> None:
    run = unpainted(80.0)
    assert run.st.s[0] == pytest.approx(51.0)
    distance = distance_to_paint_end(run.n, run.p, run.st, 0)
    assert distance == pytest.approx(80.0 - 51.0 - FRONT, abs=1.0)
    assert time_left(run.n, run.p, run.st, 0, op.CAUSE_LANE_CONFIDENCE) == distance / run.st.v[0]
    assert time_left(run.n, run.p, run.st, 0, op.CAUSE_SENSOR_HEALTH) == op.FAR
    far, near = unpainted(200.0), unpainted(52.0)
    assert distance_to_paint_end(far.n, far.p, far.st, 0) == op.FAR
    assert distance_to_paint_end(near.n, near.p, near.st, 0) == 0.0


def test_paint_that_the_weather_hides_has_ended() -> None:
    run = driving(Draft(highway()))
    run.st.paint_seen[0] = 0.1
    assert time_left(run.n, run.p, run.st, 0, op.CAUSE_LANE_CONFIDENCE) == 0.0


def test_requests_about_obstacles_have_budgets_of_their_own() -> None:
    run = driving(Draft(ramp(), {slots.K_DURATION: 20.0}))
    for cause in (op.CAUSE_PATH_BLOCKED, op.CAUSE_LANE_ENDS):
        assert time_left(run.n, run.p, run.st, 0, cause) == op.FAR
