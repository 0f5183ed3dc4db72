"""What the forward sensor sees, when the path counts as blocked, and what the marks are worth."""

from __future__ import annotations

import math

import pytest

from scenario_compiler.engine import opcodes as op
from scenario_compiler.engine import slots
from scenario_compiler.engine.camera_health import noise_health
from scenario_compiler.engine.opcodes import FAR
from tests.engine.make import CAR, Draft, Run, highway, ramp

FRONT = 1.4 + 2.25
"""From the reference point to the front bumper, m."""


def look(draft: Draft) -> Run:
    """Return the run after its first control step, in which the ego has not moved yet when it looks."""
    return draft.start().go(0.05)


def standing_ego(**numbers: float) -> Draft:
    """Return a draft with an ego at rest at 50 m in lane -1."""
    draft = Draft(highway(), {getattr(slots, name): value for name, value in numbers.items()})
    draft.program.perception[0] = op.PERCEPTION_CAMERA
    draft.ego(speed=0.0)
    return draft


def test_the_distance_to_a_block_is_from_bumper_to_bumper() -> None:
    draft = standing_ego()
    draft.parked(100.0)
    assert look(draft).st.blocked_distance[0] == pytest.approx(50.0 - CAR[0])


@pytest.mark.parametrize(("offset", "blocked"), [(0.0, True), (1.0, True), (1.4, True), (1.5, False), (-1.5, False)])
def test_the_path_is_blocked_while_the_rest_of_the_lane_is_too_narrow(offset: float, blocked: bool) -> None:
    draft = standing_ego()
    draft.parked(100.0, offset=offset)
    widest_rest = 1.75 + abs(offset) - 0.9
    assert (widest_rest < 1.8 + 0.5) == blocked
    assert (look(draft).st.blocked_distance[0] < FAR) == blocked


def test_two_that_leave_no_gap_between_them_block_together() -> None:
    draft = standing_ego()
    draft.parked(100.0, offset=1.75)
    assert look(draft).st.blocked_distance[0] == FAR
    draft.parked(102.0, offset=-1.75)
    assert look(draft).st.blocked_distance[0] < FAR


@pytest.mark.parametrize(("reach", "seen"), [(40.0, 0), (50.0, 1)])
def test_the_sensor_sees_as_far_as_it_reaches(reach: float, seen: int) -> None:
    draft = standing_ego(K_SENSOR_RANGE=reach)
    draft.parked(100.0)
    run = look(draft)
    assert run.st.seen[1] == seen
    assert (run.st.blocked_distance[0] < FAR) == (seen == 1)


def test_the_sensor_sees_within_its_field_of_view() -> None:
    draft = standing_ego(K_FIELD_OF_VIEW=math.radians(20.0))
    draft.parked(80.0)
    draft.parked(65.0, lane=-3)
    assert look(draft).st.seen[1:] == [1, 0]


def test_a_vehicle_behind_another_is_hidden_and_beside_it_is_not() -> None:
    draft = standing_ego()
    draft.parked(90.0)
    draft.parked(110.0)
    draft.parked(110.0, lane=-2)
    assert look(draft).st.seen[1:] == [1, 0, 1]


def test_a_leading_vehicle_and_an_oncoming_one_in_its_lane_do_not_block() -> None:
    draft = standing_ego()
    draft.moving(-1, 90.0, 10.0)
    draft.moving(1, 150.0, 10.0)
    assert look(draft).st.blocked_distance[0] == FAR


@pytest.mark.parametrize(("speed", "blocked"), [(0.0, True), (3.0, False)])
def test_a_crossing_vehicle_blocks_unless_it_is_gone_in_time(speed: float, blocked: bool) -> None:
    draft = Draft(highway())
    draft.program.perception[0] = op.PERCEPTION_CAMERA
    draft.ego(speed=10.0)
    draft.entity(op.MOTION_STATIC, draft.position(0, -1, 100.0, 0.0, math.pi / 2), speed)
    assert (look(draft).st.blocked_distance[0] < FAR) == blocked


def test_the_end_of_the_lane_and_the_lane_that_goes_on() -> None:
    draft = Draft(ramp(300.0))
    draft.ego(lane=-2, s=100.0)
    st = look(draft).st
    narrow = 260.0 + 40.0 * (3.5 - 2.0) / 3.5
    assert st.lane_end_distance[0] == pytest.approx(narrow - 100.0 - FRONT, abs=0.05)
    assert (st.through_lane[0], st.through_side[0]) == (-1, 1)


def test_confidence_is_the_marks_quality_where_the_plan_overrides_it() -> None:
    draft = Draft(highway())
    draft.ego(s=50.0)
    p = draft.program
    p.stretch_road, p.stretch_count, p.stretch_lane = [0], [1], [op.ALL_MARKS]
    p.stretch_const = [draft.block(0.0, 200.0, 0.4, 0.4, 0.0)]
    st = look(draft).st
    assert [st.conf_left[0], st.conf_right[0]] == pytest.approx([0.4, 0.4], abs=0.001)


def test_health_is_one_half_at_30_grey_levels() -> None:
    assert noise_health(30.0) == 0.5
    assert noise_health(0.0) > 0.999
    assert noise_health(60.0) < 0.001
    assert noise_health(1.0e9) >= 0.0
