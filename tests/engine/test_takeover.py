"""The takeover from cause to response or minimum-risk stop, and what the driver then does."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots
from tests.engine.make import Draft, Run, highway, lane, network_of, ramp, road

SPEED = 14.0


def blocked(driver: float | None, *, causes: tuple[int, ...] = (op.CAUSE_PATH_BLOCKED,), offset: float = 0.0) -> Run:
    """Return a run towards a vehicle across the lane, 200 m ahead; a driver of None never answers."""
    draft = Draft(highway(), {slots.K_DRIVER_TIME: 1.0e6 if driver is None else driver})
    draft.causes(*causes)
    draft.ego(speed=SPEED)
    draft.parked(250.0, offset=offset, turn=math.pi / 2)
    return draft.start()


def test_a_blocked_path_is_requested_within_the_budget_and_not_before() -> None:
    run = blocked(2.0)
    ahead = []
    while run.st.takeover_state[0] < op.TAKEOVER_REQUEST:
        ahead.append((run.st.blocked_distance[0], run.st.v[0]))
        run.go(run.st.clock[0] + 0.05)
    assert run.st.cause[0] == op.CAUSE_PATH_BLOCKED
    assert run.st.blocked_distance[0] <= 7.0 * run.st.v[0]
    assert all(distance > 7.0 * v for distance, v in ahead[:-3])


@pytest.mark.parametrize("towards", [5.0, 15.0, 25.0])
@pytest.mark.parametrize("budget", [3.0, 7.0])
def test_the_budget_to_an_oncoming_object_counts_both_speeds(budget: float, towards: float) -> None:
    far = {slots.K_BUDGET: budget, slots.K_SENSOR_RANGE: 400.0, slots.K_DRIVER_TIME: 1.0e6}
    draft = Draft(network_of(road(1, 2000.0, lane(-1, "solid"), left=lane(1, "solid"))), far)
    draft.causes(op.CAUSE_PATH_BLOCKED)
    draft.ego(speed=SPEED)
    draft.entity(op.MOTION_SCRIPTED, draft.position(0, -1, 650.0, 0.0, math.pi), towards)
    run = draft.start()
    while run.st.takeover_state[0] < op.TAKEOVER_REQUEST and run.st.stop[0] == op.STOP_NONE:
        run.go(run.st.clock[0] + 0.05)
    assert run.time_of(op.EVENT_REQUEST) > 0.0
    assert run.st.blocked_speed[0] == pytest.approx(towards, rel=1e-3)
    assert run.st.blocked_distance[0] / (run.st.v[0] + towards) == pytest.approx(budget, abs=0.11)


def test_a_stop_obstructs_a_free_lane_and_not_a_blocked_one() -> None:
    free = Draft(highway(), {slots.K_DRIVER_TIME: 1.0e6, slots.K_NOISE: 60.0})
    free.ego(speed=SPEED)
    stopped = free.start().go()
    assert stopped.time_of(op.EVENT_OBSTRUCTION) == stopped.time_of(op.EVENT_STANDSTILL) > 0.0
    before = blocked(None).go()
    assert before.time_of(op.EVENT_STANDSTILL) > 0.0
    assert before.time_of(op.EVENT_OBSTRUCTION) == -1.0


def test_a_leader_that_drives_on_does_not_hold_the_stopped_ego() -> None:
    draft = Draft(highway(), {slots.K_DRIVER_TIME: 1.0e6, slots.K_NOISE: 60.0})
    draft.ego(speed=12.0)
    draft.moving(-1, 85.0, 12.0)
    run = draft.start().go()
    assert run.time_of(op.EVENT_OBSTRUCTION) == run.time_of(op.EVENT_STANDSTILL) > 0.0


def test_a_disabled_cause_requests_nothing() -> None:
    run = blocked(2.0, causes=(op.CAUSE_LANE_CONFIDENCE,)).go()
    assert run.time_of(op.EVENT_REQUEST) == -1.0


@pytest.mark.parametrize("driver", [0.0, 1.0, 2.5, 4.0, 6.0])
def test_a_driver_who_answers_within_the_budget_does_not_collide(driver: float) -> None:
    run = blocked(driver).go()
    assert run.st.crashed[0] == 0
    assert run.time_of(op.EVENT_RESPONSE) == pytest.approx(run.time_of(op.EVENT_REQUEST) + driver, abs=0.051)
    assert run.st.flag[0] == op.FAULT_NONE


def test_a_driver_passes_on_the_free_lane_beside_and_comes_back() -> None:
    run = blocked(1.0).go()
    assert run.time_of(op.EVENT_EVADE) > 0.0
    assert run.st.x[0] > 260.0
    assert abs(run.st.off[0]) < 0.8
    assert run.st.lane[0] == -1


@pytest.mark.parametrize("gap", [30.0, 40.0])
def test_a_driver_does_not_come_back_where_the_lane_is_too_narrow_for_a_safe_distance(gap: float) -> None:
    """After the vehicle across the lane, others stand at its left edge, 15 cm beside the way in its centre."""
    draft = Draft(highway(), {slots.K_DRIVER_TIME: 1.0})
    draft.causes(op.CAUSE_PATH_BLOCKED)
    draft.ego(speed=20.0)
    draft.parked(250.0, turn=math.pi / 2)
    for k in range(6):
        draft.parked(250.0 + gap + 5.0 * k, offset=1.95)
    run = draft.start().go()
    assert run.time_of(op.EVENT_EVADE) > 0.0
    assert run.time_of(op.EVENT_BRAKE) == -1.0
    assert run.st.crashed[0] == 0
    assert run.st.x[0] > 350.0


def test_nothing_changes_before_the_driver_answers() -> None:
    early, late = blocked(3.0), blocked(5.0)
    response = -1.0
    while early.st.takeover_state[0] != op.TAKEOVER_MANUAL:
        assert (early.st.x, early.st.y, early.st.v) == (late.st.x, late.st.y, late.st.v)
        response = early.st.clock[0]
        early.go(response + 0.05)
        late.go(response + 0.05)
    assert response == pytest.approx(early.st.time_request[0] + 3.0, abs=0.051)


def test_an_absent_driver_ends_in_a_minimum_risk_stop_before_the_obstacle() -> None:
    run = blocked(None).go()
    request, manoeuvre = run.time_of(op.EVENT_REQUEST), run.time_of(op.EVENT_MINIMUM_RISK)
    assert run.time_of(op.EVENT_ESCALATION) == pytest.approx(request + 4.0, abs=0.051)
    assert request < manoeuvre <= request + 10.051
    assert run.st.takeover_state[0] == op.TAKEOVER_STANDSTILL
    assert run.st.hazard_lights[0] == 1
    assert run.st.crashed[0] == 0
    assert run.st.stop[0] == op.STOP_STANDSTILL
    assert run.st.clock[0] == pytest.approx(run.time_of(op.EVENT_STANDSTILL) + 3.0, abs=0.11)


def test_the_minimum_risk_manoeuvre_has_the_given_deceleration_and_begins_when_the_distance_requires_it() -> None:
    draft = Draft(highway(), {slots.K_DRIVER_TIME: 1.0e6, slots.K_BUDGET: 4.0})
    draft.program.perception[0] = op.PERCEPTION_CAMERA
    draft.causes(op.CAUSE_PATH_BLOCKED)
    draft.ego(speed=20.0)
    draft.parked(300.0)
    run = draft.start()
    while run.st.takeover_state[0] != op.TAKEOVER_MINIMUM_RISK:
        run.go(run.st.clock[0] + 0.05)
    assert run.st.clock[0] - run.st.request_at[0] < 9.0
    needed = run.st.v[0] * run.st.v[0] / 8.0
    assert needed < run.st.blocked_distance[0] < needed + 8.0
    run.go(run.st.clock[0] + 1.0)
    assert run.st.a[0] == pytest.approx(-4.0)
    run.go()
    assert run.st.crashed[0] == 0
    assert run.st.v[0] == 0.0


@pytest.mark.parametrize(("driver", "responds"), [(6.5, True), (8.0, False)])
def test_a_collision_ends_the_takeover(driver: float, responds: bool) -> None:
    """With a budget of 7 s and a car that neither slows down nor stops by itself, a driver of 8 s comes too late."""
    draft = Draft(highway(), {slots.K_DRIVER_TIME: driver})
    draft.program.minimum_risk[0] = 0
    draft.program.after_request[0] = op.BEHAVIOUR_HOLD_SPEED
    draft.causes(op.CAUSE_PATH_BLOCKED)
    draft.ego(speed=SPEED)
    draft.parked(250.0)
    run = draft.start()
    while run.st.crashed[0] == 0:
        run.go(run.st.clock[0] + 0.05)
    crash = run.time_of(op.EVENT_COLLISION)
    assert (run.time_of(op.EVENT_RESPONSE) > 0.0) == responds
    run.st.ordered_request[0] = op.CAUSE_SCHEDULED
    run.go()
    assert run.st.stop[0] == op.STOP_COLLISION
    assert run.st.clock[0] > crash + 3.0
    assert run.st.requests[0] == 1
    for kind in (op.EVENT_ESCALATION, op.EVENT_HANDS_ON, op.EVENT_RESPONSE, op.EVENT_STANDSTILL):
        assert run.time_of(kind) <= crash


@pytest.mark.parametrize("friction", [1.0, 0.3, 0.2])
def test_the_minimum_risk_manoeuvre_stops_in_time_on_a_slippery_road(friction: float) -> None:
    """Before, it began where 4 m/s2 would have sufficed, which tyres do not hold below a friction of 0.5."""
    draft = Draft(highway(), {slots.K_DRIVER_TIME: 1.0e6, slots.K_BUDGET: 9.0})
    draft.program.after_request[0] = op.BEHAVIOUR_HOLD_SPEED
    draft.causes(op.CAUSE_PATH_BLOCKED)
    draft.ego(speed=SPEED)
    draft.parked(250.0)
    run = draft.start()
    run.st.friction[0] = friction
    run.go()
    assert run.st.stop[0] == op.STOP_STANDSTILL
    assert 1.0 < run.st.blocked_distance[0] < 6.0


@pytest.mark.parametrize(("parked", "stop"), [(250.0, op.STOP_COLLISION), (1500.0, op.STOP_DESTINATION)])
def test_a_wreck_that_slides_to_the_destination_has_not_arrived(parked: float, stop: int) -> None:
    draft = Draft(highway(), {slots.K_DRIVER_TIME: 1.0e6, slots.K_DURATION: 60.0})
    draft.program.minimum_risk[0] = 0
    draft.program.after_request[0] = op.BEHAVIOUR_HOLD_SPEED
    draft.causes(op.CAUSE_PATH_BLOCKED)
    draft.program.destination_road[0] = 0
    draft.ego(speed=SPEED)
    draft.parked(parked)
    run = draft.start()
    run.st.destination_x[0], run.st.destination_y[0] = 258.0, run.st.y[0]
    run.go()
    assert run.st.x[0] > 250.0
    assert run.st.stop[0] == stop


def test_a_driver_may_take_over_during_the_minimum_risk_manoeuvre() -> None:
    draft = Draft(highway(), {slots.K_DRIVER_TIME: 11.0, slots.K_HEALTH_COUNT: 1.0, slots.K_NOISE: 60.0})
    draft.ego(speed=25.0)
    run = draft.start().go()
    assert run.time_of(op.EVENT_MINIMUM_RISK) == pytest.approx(run.time_of(op.EVENT_REQUEST) + 10.0, abs=0.051)
    assert run.time_of(op.EVENT_RESPONSE) == pytest.approx(run.time_of(op.EVENT_REQUEST) + 11.0, abs=0.051)
    assert run.st.takeover_state[0] == op.TAKEOVER_MANUAL
    assert run.st.v[0] > 20.0


def test_confidence_must_be_low_in_count_of_the_last_control_steps() -> None:
    draft = Draft(highway(), {slots.K_WARNING_LEAD: 0.0})
    draft.program.perception[0] = op.PERCEPTION_CAMERA
    draft.causes(op.CAUSE_LANE_CONFIDENCE)
    draft.ego()
    run = draft.start()
    low = [1, 0, 1, 0, 1, 0, 0, 1, 0, 0, 1, 1, 1, 1, 1]
    asked = []
    for weak in low:
        run.st.conf_left[0] = run.st.conf_right[0] = 0.2 if weak else 0.9
        run.go(run.st.clock[0] + 0.05)
        asked.append(run.st.takeover_state[0] >= op.TAKEOVER_REQUEST)
    expected = [sum(low[max(0, k - 7) : k + 1]) >= 5 for k in range(len(low))]
    first = expected.index(True)
    assert asked == [False] * first + [True] * (len(low) - first)


def test_one_weak_side_warns_and_does_not_request() -> None:
    draft = Draft(highway())
    draft.program.perception[0] = op.PERCEPTION_CAMERA
    draft.ego()
    run = draft.start()
    run.st.conf_left[0] = 0.1
    run.go(2.0)
    assert run.st.takeover_state[0] == op.TAKEOVER_WARNING
    run.st.conf_left[0] = 1.0
    run.go(5.2)
    assert run.st.takeover_state[0] == op.TAKEOVER_WARNING
    run.go(5.4)
    assert run.st.takeover_state[0] == op.TAKEOVER_AUTOMATED
    assert run.time_of(op.EVENT_REQUEST) == -1.0


def test_a_warning_has_a_threshold_of_its_own_to_end() -> None:
    draft = Draft(highway())
    draft.program.perception[0] = op.PERCEPTION_CAMERA
    draft.ego()
    run = draft.start()
    for confidence, until, warns in ((0.65, 2.0, 0), (0.55, 4.0, 1), (0.65, 12.0, 1), (0.75, 13.2, 0)):
        run.st.conf_left[0] = confidence
        run.go(until)
        assert (run.st.takeover_state[0] == op.TAKEOVER_WARNING) == warns, confidence


def test_worn_paint_causes_at_most_one_warning_in_five_seconds() -> None:
    draft = Draft(highway(), {slots.K_DURATION: 60.0})
    draft.program.perception[0] = op.PERCEPTION_CAMERA
    draft.ego()
    run = draft.start()
    while run.st.stop[0] == op.STOP_NONE:
        at = run.st.clock[0]
        run.st.conf_left[0] = 0.65 + 0.3 * math.sin(0.8 * at) + 0.05 * math.sin(17.0 * at)
        run.st.conf_right[0] = 0.9
        run.go(at + 0.05)
    warned = [time for kind, time in run.events() if kind == op.EVENT_WARNING]
    assert len(warned) > 2
    assert min(later - earlier for earlier, later in pairwise(warned)) >= 5.0


def lead_of_warning(run: Run) -> float:
    assert run.time_of(op.EVENT_WARNING) >= 0.0
    return run.time_of(op.EVENT_REQUEST) - run.time_of(op.EVENT_WARNING)


@pytest.mark.parametrize("speed", [8.0, 14.0, 17.0])
def test_a_blocked_path_causes_a_warning_a_second_before_the_request(speed: float) -> None:
    draft = Draft(highway())
    draft.ego(speed=speed)
    draft.parked(270.0)
    assert 1.0 - 1e-6 <= lead_of_warning(draft.start().go(30.0)) <= 1.8


@pytest.mark.parametrize("control_every", [1, 3, 5, 10])
def test_a_warning_leads_by_a_second_whatever_the_control_period(control_every: int) -> None:
    draft = Draft(highway())
    draft.program.control_every[0] = control_every
    draft.ego(speed=14.0)
    draft.parked(270.0)
    assert 1.0 - 1e-6 <= lead_of_warning(draft.start().go(30.0)) <= 1.0 + 2.0 * 0.05 * control_every + 1e-6


@pytest.mark.parametrize("seen_before_request", [0.2, 0.6, 1.0, 1.25])
def test_an_object_seen_too_late_for_a_warning_is_requested_at_its_budget(seen_before_request: float) -> None:
    speed, budget = 15.0, 6.0
    draft = Draft(highway(), {slots.K_BUDGET: budget, slots.K_SENSOR_RANGE: speed * (budget + seen_before_request)})
    draft.ego(speed=speed)
    draft.parked(250.0)
    run = draft.start()
    while run.time_of(op.EVENT_REQUEST) < 0.0:
        run.go(run.st.clock[0] + 0.05)
    assert run.st.blocked_distance[0] / speed == pytest.approx(budget, abs=0.1)
    assert run.time_of(op.EVENT_WARNING) == -1.0


@pytest.mark.parametrize("control_every", [1, 2, 4])
@pytest.mark.parametrize("count", [1.0, 2.0, 5.0])
@pytest.mark.parametrize("distance", [30.0, 70.0, 94.4, 96.1, 98.5, 99.5, 101.0, 104.0, 120.0, 200.0])
def test_a_run_that_begins_within_the_time_budget_says_so(distance: float, count: float, control_every: int) -> None:
    """A budget of 7 s is 98 m at 14 m/s; a request that comes more than a control step later is short of it."""
    draft = Draft(highway(), {slots.K_BLOCKED_COUNT: count, slots.K_BLOCKED_OF: count, slots.K_BUDGET: 7.0})
    draft.program.control_every[0] = control_every
    draft.causes(op.CAUSE_PATH_BLOCKED)
    draft.ego(speed=SPEED)
    draft.parked(50.0 + 3.7 + distance + 1.0)
    run = draft.start()
    while run.st.requests[0] == 0 and run.st.clock[0] < 20.0:
        run.go(run.st.clock[0] + 0.05)
    budget = run.st.blocked_distance[0] / SPEED
    said = run.time_of(op.EVENT_SHORT_START)
    assert said == (0.0 if budget < 7.0 - 0.05 * control_every - 1e-9 else -1.0)


def test_a_lane_that_ends_within_its_budget_from_the_start_is_logged_and_a_disabled_cause_is_not() -> None:
    for causes, said in (((op.CAUSE_LANE_ENDS,), 0.0), ((op.CAUSE_PATH_BLOCKED,), -1.0)):
        draft = Draft(ramp(), {slots.K_BUDGET: 7.0})
        draft.causes(*causes)
        draft.ego(lane=-2, s=200.0, speed=SPEED)
        for s in range(140, 300, 8):
            draft.moving(-1, float(s), SPEED)
        run = draft.start().go(1.0)
        assert run.time_of(op.EVENT_SHORT_START) == said
        assert run.time_of(op.EVENT_WARNING) == -1.0


@pytest.mark.parametrize("speed", [8.0, 14.0, 17.0])
def test_a_lane_end_beside_a_full_lane_causes_a_warning_a_second_before_the_request(speed: float) -> None:
    draft = Draft(ramp(290.0))
    draft.ego(speed=speed, lane=-2)
    for s in range(20, 200, 8):
        draft.moving(-1, float(s), speed)
    assert 1.0 - 1e-6 <= lead_of_warning(draft.start().go(40.0)) <= 1.8


def test_lost_lanes_cause_a_warning_a_second_before_the_request_and_a_dead_camera_does_not() -> None:
    draft = Draft(highway())
    draft.program.perception[0] = op.PERCEPTION_CAMERA
    draft.ego()
    run = draft.start().go(2.0)
    run.st.conf_left[0] = run.st.conf_right[0] = 0.0
    run.go(5.0)
    assert run.time_of(op.EVENT_WARNING) == pytest.approx(2.3, abs=0.06)
    assert run.time_of(op.EVENT_REQUEST) == pytest.approx(run.time_of(op.EVENT_WARNING) + 1.0, abs=0.06)
    dead = draft.start().go(2.0)
    dead.st.conf_left[0] = dead.st.conf_right[0] = dead.st.health[0] = 0.0
    dead.go(5.0)
    assert dead.time_of(op.EVENT_REQUEST) == pytest.approx(2.2, abs=0.06)
    assert dead.time_of(op.EVENT_WARNING) == -1.0


@pytest.mark.parametrize(("sigma", "requested"), [(5.0, False), (60.0, True)])
def test_ideal_health_falls_with_the_noise(sigma: float, requested: bool) -> None:
    draft = Draft(highway(), {slots.K_NOISE: sigma})
    draft.ego()
    run = draft.start().go(3.0)
    assert (0.0 < run.time_of(op.EVENT_REQUEST) < 1.0) == requested


def test_the_automation_takes_back_after_the_given_time() -> None:
    draft = Draft(highway(), {slots.K_HAND_BACK_AFTER: 4.0})
    draft.program.perception[0] = op.PERCEPTION_CAMERA
    draft.ego()
    run = draft.start()
    run.st.conf_left[0] = run.st.conf_right[0] = 0.0
    run.go(2.0)
    run.st.conf_left[0] = run.st.conf_right[0] = 1.0
    run.go(12.0)
    assert run.time_of(op.EVENT_HAND_BACK) == pytest.approx(run.time_of(op.EVENT_RESPONSE) + 4.0, abs=0.051)
    assert run.time_of(op.EVENT_ACTIVATION) == pytest.approx(run.time_of(op.EVENT_HAND_BACK) + 0.05, abs=0.001)
    assert run.st.takeover_state[0] == op.TAKEOVER_AUTOMATED
    run.st.conf_left[0] = run.st.conf_right[0] = 0.0
    run.go(14.0)
    assert run.st.requests[0] == 2


def test_the_ramp_is_left_by_merging_where_the_gap_is_free() -> None:
    draft = Draft(ramp())
    draft.ego(lane=-2, s=20.0, speed=15.0)
    run = draft.start().go()
    assert run.time_of(op.EVENT_MERGE) > 0.0
    assert run.time_of(op.EVENT_REQUEST) == -1.0
    assert run.st.lane[0] == -1
    assert run.st.x[0] > 320.0


def test_a_merge_across_the_line_is_no_lost_lane_but_the_lane_behind_it_may_be() -> None:
    draft = Draft(ramp(), {slots.K_DRIVER_TIME: 1.0e6})
    draft.program.perception[0] = op.PERCEPTION_CAMERA
    draft.ego(lane=-2, s=20.0, speed=15.0)
    run = draft.start()
    merged = -1.0
    while run.st.stop[0] == op.STOP_NONE and run.time_of(op.EVENT_REQUEST) < 0.0:
        crossing = run.time_of(op.EVENT_MERGE) > 0.0
        run.st.conf_left[0] = run.st.conf_right[0] = 0.0 if crossing else 1.0
        run.go(run.st.clock[0] + 0.05)
        if crossing and merged < 0.0 and run.st.merging[0] == 0:
            merged = run.st.clock[0]
            assert run.time_of(op.EVENT_WARNING) == -1.0
    assert merged > run.time_of(op.EVENT_MERGE) + 2.0
    assert merged < run.time_of(op.EVENT_WARNING) < run.time_of(op.EVENT_REQUEST) < merged + 2.0
    assert run.st.cause[0] == op.CAUSE_LANE_CONFIDENCE


def test_an_occupied_gap_is_requested_and_never_entered() -> None:
    draft = Draft(ramp(), {slots.K_DRIVER_TIME: 1.0e6})
    draft.ego(lane=-2, s=100.0, speed=15.0)
    for k in range(8):
        draft.moving(-1, 60.0 + 12.0 * k, 15.0)
    run = draft.start()
    lanes = set()
    while run.st.stop[0] == op.STOP_NONE and run.st.x[0] < 300.0 and run.st.clock[0] < 15.0:
        run.go(run.st.clock[0] + 0.05)
        lanes.add(run.st.lane[0])
    assert run.st.cause[0] == op.CAUSE_LANE_ENDS
    assert lanes == {-2} or run.time_of(op.EVENT_MERGE) > 0.0
    assert run.st.crashed[0] == 0


def test_a_driver_waits_for_an_oncoming_car_before_passing() -> None:
    draft = Draft(network_of(road(1, 2000.0, lane(-1, "solid"), left=lane(1, "solid"))), {slots.K_DRIVER_TIME: 1.0})
    draft.causes(op.CAUSE_PATH_BLOCKED)
    draft.ego(speed=SPEED)
    draft.parked(250.0)
    draft.moving(1, 420.0, 12.0)
    run = draft.start()
    sides = []
    while run.st.stop[0] == op.STOP_NONE:
        run.go(run.st.clock[0] + 0.05)
        if abs(run.st.x[2] - run.st.x[0]) < 10.0:
            sides.append(run.st.y[0] + 0.9 < run.st.y[2] - 0.9)
    assert run.st.crashed[0] == 0
    assert sides
    assert all(sides)
    assert run.st.x[0] > 260.0


def test_a_run_ends_at_the_destination() -> None:
    draft = Draft(highway())
    draft.ego()
    draft.program.destination_road[0], draft.program.destination_lane[0] = 0, -1
    draft.program.const[slots.K_DESTINATION_S] = 150.0
    run = draft.start().go()
    assert run.st.stop[0] == op.STOP_DESTINATION
    assert 144.9 < run.st.x[0] < 146.0


def test_after_a_lapse_there_is_no_response_and_a_lognormal_time_comes_from_the_draw() -> None:
    numbers = {slots.K_DRIVER_MU: 0.876, slots.K_DRIVER_SIGMA: 0.5, slots.K_DRIVER_PERSON: 1.0, slots.K_NOISE: 60.0}
    draft = Draft(highway(), numbers)
    draft.program.driver_kind[0] = op.DRIVER_LOGNORMAL
    draft.ego()
    run = draft.start().go(12.0)
    expected = math.exp(0.876 + 0.5 * run.st.draw[op.DRAW_PERSON])
    request, response = run.time_of(op.EVENT_REQUEST), run.time_of(op.EVENT_RESPONSE)
    assert response - request == pytest.approx(expected, abs=0.051)
    assert request < run.time_of(op.EVENT_EYES_ON) < run.time_of(op.EVENT_HANDS_ON) < response
    draft.program.const[slots.K_DRIVER_LAPSE] = 1.0
    assert draft.start().go(12.0).time_of(op.EVENT_RESPONSE) == -1.0


def standing_behind(target_speed: float) -> Run:
    """Return a run towards a parked vehicle, with the cause `no_progress` alone; a speed is ordered at 8 s."""
    draft = Draft(highway(), {slots.K_DRIVER_TIME: 1.0e6, slots.K_DURATION: 60.0})
    draft.causes(op.CAUSE_NO_PROGRESS)
    draft.ego(speed=SPEED)
    draft.parked(250.0)
    draft.event(draft.maneuver(), draft.at_time(8.0), draft.speed(0, target_speed, 2.0))
    return draft.start()


def test_a_car_that_stands_without_a_reason_requests_after_the_time_of_the_cause() -> None:
    run = standing_behind(SPEED).go()
    assert run.st.cause[0] == op.CAUSE_NO_PROGRESS
    assert run.time_of(op.EVENT_NO_PROGRESS) == run.time_of(op.EVENT_REQUEST)
    assert run.st.takeover_state[0] == op.TAKEOVER_STANDSTILL


def test_a_stop_ordered_by_the_scenario_is_not_a_lack_of_progress() -> None:
    run = standing_behind(0.0).go()
    assert run.st.v[0] == 0.0
    assert run.time_of(op.EVENT_NO_PROGRESS) == -1.0


@pytest.mark.parametrize("count", [1.0, 2.0, 5.0])
@pytest.mark.parametrize("deceleration", [3.0, 7.0])
def test_the_brake_is_not_let_go_between_a_leaders_stop_and_the_request_for_it(
    deceleration: float, count: float
) -> None:
    numbers = {slots.K_DRIVER_TIME: 1.0e6, slots.K_BLOCKED_COUNT: count, slots.K_BLOCKED_OF: 8.0}
    draft = Draft(highway(), numbers)
    draft.causes(op.CAUSE_PATH_BLOCKED)
    draft.ego(speed=25.0)
    leader = draft.moving(-1, 95.0, 25.0)
    draft.event(draft.maneuver(), draft.at_time(2.0), draft.speed(leader, 0.0, 25.0 / deceleration))
    run = draft.start().go(2.0 + 0.5 * 25.0 / deceleration)
    accelerations = []
    while run.st.takeover_state[0] < op.TAKEOVER_REQUEST:
        accelerations.append(run.st.a[0])
        run.go(run.st.clock[0] + 0.05)
    assert run.st.v[leader] < 2.0
    assert max(accelerations) < -1.0


def test_a_stop_and_go_leader_is_followed_without_a_request_while_its_queue_moves() -> None:
    draft = Draft(highway(), {slots.K_DRIVER_TIME: 1.0e6, slots.K_DURATION: 40.0})
    draft.causes(op.CAUSE_NO_PROGRESS)
    draft.ego(speed=10.0)
    leader = draft.moving(-1, 100.0, 10.0)
    maneuver = draft.maneuver()
    draft.event(maneuver, draft.at_time(2.0), draft.speed(leader, 0.0, 4.0))
    draft.event(maneuver, draft.at_time(13.0), draft.speed(leader, 10.0, 4.0))
    run = draft.start().go()
    assert run.time_of(op.EVENT_NO_PROGRESS) == -1.0
    assert run.st.v[0] > 8.0
