"""How entities move, follow, are found on the road, and collide."""

from __future__ import annotations

import math

import pytest

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots
from scenario_compiler.engine.motion.collision import overlap
from scenario_compiler.engine.story.step import begin_step, end_step, move_step
from scenario_compiler.roads.lanes import lane_pose, lane_row
from tests.engine.make import CAR, Draft, bend, highway, lane, network_of, road
from tests.roads.make import road as road_of
from tests.roads.make import section


def test_a_scripted_car_on_a_bend_keeps_its_lane_and_its_speed() -> None:
    draft = Draft(bend(100.0))
    draft.moving(-1, 50.0, 10.0)
    run = draft.start().go(10.0)
    assert run.st.odometer[0] == pytest.approx(100.0, abs=0.02)
    assert math.hypot(run.st.x[0], run.st.y[0] - 100.0) == pytest.approx(101.75, abs=1e-6)


def test_an_oncoming_car_drives_against_s_and_faces_its_travel() -> None:
    draft = Draft(highway())
    draft.moving(1, 500.0, 10.0)
    run = draft.start().go(2.0)
    assert run.st.s[0] == pytest.approx(480.0)
    assert run.st.h[0] == pytest.approx(math.pi)
    assert run.st.y[0] == pytest.approx(1.75)


def test_a_car_at_the_end_of_the_road_stands_there() -> None:
    draft = Draft(highway(100.0))
    draft.moving(-1, 90.0, 20.0)
    run = draft.start().go(2.0)
    assert run.st.s[0] == pytest.approx(100.0)
    assert run.st.v[0] == 0.0


def test_a_relative_start_is_ahead_in_the_lane_and_turned() -> None:
    draft = Draft(highway())
    draft.moving(1, 500.0, 0.0)
    draft.entity(op.MOTION_STATIC, draft.ahead_of(0, 40.0, lanes=0, offset=1.0, turn=0.5))
    run = draft.start()
    assert [run.st.x[1], run.st.y[1]] == pytest.approx([460.0, 0.75])
    assert run.st.h[1] == pytest.approx(math.pi + 0.5)


def test_a_start_off_the_road_is_a_fault() -> None:
    draft = Draft(highway())
    draft.moving(-7, 100.0, 0.0)
    run = draft.start()
    assert (run.st.stop[0], run.st.flag[0], run.st.flag_at[0]) == (op.STOP_ERROR, op.FAULT_OFF_ROAD_START, 0)


def test_nan_is_a_fault() -> None:
    draft = Draft(highway())
    draft.moving(-1, 100.0, math.nan)
    assert draft.start().st.flag[0] == op.FAULT_NOT_FINITE


def test_a_follower_settles_behind_its_leader() -> None:
    draft = Draft(highway(), {slots.K_DURATION: 80.0})
    draft.moving(-1, 50.0, 20.0, follows=True)
    draft.moving(-1, 150.0, 10.0)
    run = draft.start().go(70.0)
    gap = run.st.x[1] - run.st.x[0] - CAR[0]
    wanted = (2.0 + 10.0 * 1.5) / math.sqrt(1.0 - (10.0 / 20.0) ** 4)
    assert run.st.v[0] == pytest.approx(10.0, abs=0.1)
    assert gap == pytest.approx(wanted, abs=1.0)


def test_a_follower_sees_over_a_joint_of_roads() -> None:
    onwards = '<successor elementType="road" elementId="2" contactPoint="start"/>'
    back = '<predecessor elementType="road" elementId="1" contactPoint="end"/>'
    first = road(1, 100.0, lane(-1, link='<successor id="-1"/>'), link=onwards)
    second = road(2, 400.0, lane(-1, link='<predecessor id="-1"/>'), x=100.0, link=back)
    draft = Draft(network_of(first, second))
    draft.moving(-1, 20.0, 15.0, follows=True)
    draft.entity(op.MOTION_STATIC, draft.position(1, -1, 100.0))
    run = draft.start().go(30.0)
    assert overlap(run.p, run.st, 0, 1) == 0
    assert run.st.v[0] < 0.2
    assert run.st.road[0] == 1


def test_the_bicycle_turns_on_the_circle_of_its_steering_angle() -> None:
    draft = Draft(highway())
    draft.program.perception[0] = op.PERCEPTION_CAMERA
    draft.causes()
    draft.ego(lane=-2, s=500.0, speed=5.0)
    run = draft.start()
    run.st.auto_steer[0] = 0.5
    run.go(1.0)
    before, run_heading = run.st.odometer[0], run.st.h[0]
    run.go(2.0)
    turned = (run.st.h[0] - run_heading + math.pi) % (2.0 * math.pi) - math.pi
    assert turned == pytest.approx((run.st.odometer[0] - before) * math.tan(0.3) / 2.7, rel=1e-3)


@pytest.mark.parametrize("friction", [1.0, 0.25, 0.0])
def test_the_bicycle_turns_no_more_tightly_than_its_tyres_hold(friction: float) -> None:
    draft = Draft(highway())
    draft.program.perception[0] = op.PERCEPTION_CAMERA
    draft.causes()
    draft.ego(lane=-2, s=500.0, speed=25.0)
    run = draft.start()
    run.st.friction[0] = friction
    run.st.auto_steer[0] = -0.5
    run.go(1.0)
    heading, travelled = run.st.h[0], run.st.odometer[0]
    run.go(1.5)
    turned = (heading - run.st.h[0] + math.pi) % (2.0 * math.pi) - math.pi
    speed = (run.st.odometer[0] - travelled) / 0.5
    assert run.st.steer[0] == pytest.approx(-0.3)
    assert turned / 0.5 * speed == pytest.approx(8.3 * friction, rel=1e-3, abs=1e-9)


@pytest.mark.parametrize(
    ("brake", "friction", "expected"), [(0.25, 1.0, 2.0), (0.25, 0.5, 2.0), (1.0, 0.5, 4.0), (1.0, 0.0, 0.0)]
)
def test_a_pedal_has_its_effect_up_to_what_the_tyres_hold(brake: float, friction: float, expected: float) -> None:
    """Before, half of the friction halved the effect of every brake pedal, also of one far below the tyres' limit."""
    draft = Draft(highway())
    draft.program.perception[0] = op.PERCEPTION_CAMERA
    draft.causes()
    draft.ego(speed=20.0)
    run = draft.start()
    run.st.friction[0] = friction
    run.st.auto_brake[0] = brake
    run.go(2.0)
    assert run.st.v[0] == pytest.approx(20.0 - 2.0 * expected, abs=0.1 * expected + 1e-9)


def test_braking_stops_exactly() -> None:
    draft = Draft(highway())
    draft.program.perception[0] = op.PERCEPTION_CAMERA
    draft.causes()
    draft.ego(speed=10.0)
    run = draft.start()
    run.st.auto_brake[0] = 1.0
    run.go(3.0)
    assert run.st.v[0] == 0.0
    assert run.st.odometer[0] == pytest.approx(100.0 / 16.0, abs=0.3)


def test_the_body_pitches_in_braking_and_comes_back() -> None:
    """A first-order lag towards gradient times deceleration; at 8 m/s2 with 0.0035 rad per m/s2."""
    draft = Draft(highway())
    draft.program.perception[0] = op.PERCEPTION_CAMERA
    draft.causes()
    draft.ego(speed=25.0)
    run = draft.start()
    assert run.st.pitch[0] == 0.0
    run.st.auto_brake[0] = 1.0
    run.go(0.2)
    early = run.st.pitch[0]
    run.go(2.0)
    assert 0.5 * 0.028 < early < 0.028 * (1.0 - math.exp(-1.0)) + 0.003
    assert run.st.pitch[0] == pytest.approx(0.028, rel=1e-3)
    run.go(5.0)
    assert run.st.v[0] == 0.0
    assert run.st.pitch[0] == pytest.approx(0.0, abs=1e-4)


def test_a_posed_ego_is_moved_from_outside() -> None:
    draft = Draft(highway())
    draft.entity(op.MOTION_POSED, draft.position(0, -1, 50.0), 10.0)
    run = draft.start()
    for k in range(1, 21):
        assert begin_step(run.n, run.p, run.st) == 1
        move_step(run.n, run.p, run.st)
        run.st.x[0], run.st.y[0], run.st.v[0] = 50.0 + 0.5 * k, -1.75 - 0.1 * k, 10.0
        end_step(run.n, run.p, run.st)
    assert [run.st.s[0], run.st.lane[0], run.st.off[0]] == pytest.approx([60.0, -2, 1.5])


def test_the_ego_keeps_its_lane_through_a_bend() -> None:
    draft = Draft(bend(60.0))
    draft.causes()
    draft.ego(s=10.0, speed=10.0)
    run = draft.start().go(20.0)
    assert run.st.lane[0] == -1
    assert abs(run.st.off[0]) < 0.5


def test_boxes_collide_when_they_overlap_and_not_before() -> None:
    draft = Draft(highway())
    draft.moving(-1, 50.0, 10.0)
    draft.parked(100.0)
    run = draft.start()
    while run.st.crashed[0] == 0:
        assert run.st.x[0] < 100.0 - CAR[0] + 0.5
        run.go(run.st.clock[0] + 0.05)
    assert 100.0 - CAR[0] <= run.st.x[0] <= 100.0 - CAR[0] + 0.51
    assert run.st.contact == [0, 1]
    assert overlap(run.p, run.st, 0, 1) == overlap(run.p, run.st, 1, 0) == 1


def test_contacts_of_others_are_logged_once_and_do_not_end_the_run() -> None:
    draft = Draft(highway())
    draft.moving(-2, 10.0, 10.0)
    draft.moving(-1, 50.0, 10.0)
    draft.parked(100.0)
    draft.parked(101.0)
    run = draft.start().go(12.0)
    logged = zip(run.st.log_kind, run.st.log_value, strict=True)
    assert [divmod(value, 4.0) for kind, value in logged if kind == op.EVENT_CONTACT] == [(1.0, 2.0), (1.0, 3.0)]
    assert (run.st.crashed[0], run.st.contact) == (0, [0, 0, 0, 0])


@pytest.mark.parametrize(("gap", "hits"), [(2.9, True), (3.3, False)])
def test_a_turned_box_reaches_as_far_as_its_corner(gap: float, hits: bool) -> None:
    draft = Draft(highway())
    draft.parked(100.0)
    middle = 1.4 * math.sin(math.pi / 4)
    draft.parked(101.4 - middle, offset=-gap - middle, turn=math.pi / 4)
    corner = 0.9 + (2.25 + 0.9) * math.sin(math.pi / 4)
    assert (gap < corner) == hits
    assert (draft.start().st.crashed[0] == 1) == hits


def test_a_crash_stops_the_ego_and_the_run() -> None:
    draft = Draft(highway())
    draft.program.perception[0] = op.PERCEPTION_CAMERA
    draft.causes()
    draft.ego(speed=15.0)
    draft.parked(120.0)
    run = draft.start().go()
    assert run.st.stop[0] == op.STOP_COLLISION
    assert run.st.v[0] == 0.0
    assert [kind for kind, _ in run.events()].count(op.EVENT_COLLISION) == 1


def test_a_box_on_a_bridge_does_not_overlap_the_one_below() -> None:
    draft = Draft(highway())
    draft.ego(s=50.0)
    draft.parked(51.0)
    run = draft.start()
    assert overlap(run.p, run.st, 0, 1) == 1
    run.st.z[1] = 1.4
    assert overlap(run.p, run.st, 0, 1) == 1
    run.st.z[1] = 5.0
    assert (overlap(run.p, run.st, 0, 1), overlap(run.p, run.st, 1, 0)) == (0, 0)


def winding_road() -> str:
    """Return a road of four pieces and three sections, in the second of which its lane widens."""
    onward = '<predecessor id="-1"/><successor id="-1"/>'
    plan = (
        '<geometry s="0" x="0" y="0" hdg="0" length="40"><line/></geometry>'
        '<geometry s="40" x="40" y="0" hdg="0" length="60"><spiral curvStart="0" curvEnd="0.01"/></geometry>'
        '<geometry s="100" x="99" y="6" hdg="0.3" length="50"><arc curvature="0.01"/></geometry>'
        '<geometry s="150" x="140" y="33" hdg="0.8" length="50"><line/></geometry>'
    )
    lanes = (
        section(right=lane(-1, link=onward))
        + section(right=lane(-1, b=0.02, link=onward), s=70.0)
        + section(right=lane(-1, a=4.5, link=onward), s=120.0)
    )
    return road_of(length=200.0, plan=plan, lanes=lanes)


@pytest.mark.parametrize(("s", "speed"), [(5.0, 13.0), (195.0, -11.0)])
def test_the_remembered_road_and_lane_agree_with_the_map(s: float, speed: float) -> None:
    draft = Draft(network_of(winding_road()))
    draft.moving(-1, s, speed)
    run = draft.start()
    st, rows = run.st, set()
    while st.clock[0] < 13.0:
        begin_step(run.n, run.p, st)
        move_step(run.n, run.p, st)
        end_step(run.n, run.p, st)
        pose = lane_pose(run.n, 0, -1, st.s[0], st.kept_off[0])
        assert pose == (st.x[0], st.y[0], st.z[0], st.h[0], st.pitch[0], st.roll[0])
        assert st.here_row[0] == lane_row(run.n, 0, -1, st.s[0])
        rows.add((st.here_row[0], st.here_piece[0]))
    assert len(rows) >= 6
    assert st.s[0] > 140.0 if speed > 0.0 else st.s[0] < 60.0


@pytest.mark.parametrize(
    ("lane_id", "s", "speed", "wanted"), [(-2, 90.0, 20.0, -1.75), (-1, 90.0, 20.0, -1.75), (-1, 110.0, -20.0, -5.25)]
)
def test_a_step_that_ends_where_a_section_begins_is_in_a_lane_of_that_section(
    lane_id: int, s: float, speed: float, wanted: float
) -> None:
    """At 20 m/s a step has 1 m, so an entity comes to s = 100 exactly; lane -2 becomes -1 there, and lane -1 ends."""
    before = section(right=lane(-1) + lane(-2, link='<successor id="-1"/>'))
    after = section(right=lane(-1, link='<predecessor id="-2"/>'), s=100.0)
    draft = Draft(network_of(road_of(length=200.0, lanes=before + after)), {slots.K_STEP: 0.05})
    draft.moving(lane_id, s, speed)
    run = draft.start()
    st, ys = run.st, []
    for _ in range(12):
        begin_step(run.n, run.p, st)
        move_step(run.n, run.p, st)
        end_step(run.n, run.p, st)
        ys.append(st.y[0])
    assert st.s[0] == s + math.copysign(12.0, speed)
    left = 9 if speed > 0.0 else 10
    assert ys == pytest.approx([3.5 * lane_id + 1.75] * left + [wanted] * (12 - left))


def test_an_entity_stops_where_its_lane_is_reversed_from_there_on() -> None:
    """Neither does it go on against the traffic, nor change to the lane of the other direction."""
    reversed_lane = lane(-1).replace("<lane ", '<lane direction="reversed" ')
    lanes = section(left=lane(1), right=lane(-1)) + section(left=lane(1), right=reversed_lane, s=100.0)
    draft = Draft(network_of(road_of(length=200.0, lanes=lanes)), {slots.K_STEP: 0.05})
    draft.moving(-1, 90.5, 20.0)
    run = draft.start()
    for _ in range(20):
        begin_step(run.n, run.p, run.st)
        move_step(run.n, run.p, run.st)
        end_step(run.n, run.p, run.st)
    assert (run.st.s[0], run.st.y[0], run.st.facing[0]) == pytest.approx((100.0, -1.75, 1))
