"""The objects that the forward sensor sees, blocked paths, and the confidence from the marks."""

from __future__ import annotations

import cmath
import math

import pytest

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots
from scenario_compiler.engine.columns.opcodes import FAR
from scenario_compiler.engine.ego.camera_health import noise_health
from scenario_compiler.engine.ego.sensor import open_eye, sees
from scenario_compiler.randomness import uniform
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


@pytest.mark.parametrize("offset", [0.0, 1.0, -1.5, 2.0, 2.1, -2.1, 2.7])
def test_an_object_that_reaches_into_the_corridor_in_the_middle_of_the_lane_blocks_the_path(offset: float) -> None:
    draft = standing_ego()
    draft.parked(100.0, offset=offset)
    room = abs(offset) - 0.9
    assert (look(draft).st.blocked_distance[0] < FAR) == (room < 0.9 + 0.25)


def test_the_nearest_of_two_blocks_and_both_are_passed_before_the_path_is_free() -> None:
    draft = standing_ego()
    draft.parked(100.0, offset=1.75)
    draft.parked(102.0, offset=-1.75)
    st = look(draft).st
    assert st.blocked_distance[0] == pytest.approx(50.0 - CAR[0])
    assert st.blocked_far[0] == pytest.approx(52.0)


@pytest.mark.parametrize(("lead", "followed"), [(8.0, True), (0.0, False)])
def test_a_queue_is_followed_while_its_first_vehicle_moves(lead: float, followed: bool) -> None:
    draft = standing_ego()
    draft.moving(-1, 90.0, 0.0)
    draft.moving(-1, 99.0, 0.0)
    draft.moving(-1, 110.0, lead)
    st = look(draft).st
    assert st.ahead_is[1] == (op.AHEAD_FOLLOWED if followed else op.AHEAD_BLOCKING)
    assert (st.blocked_distance[0] == FAR) == followed


def test_objects_that_cannot_drive_on_are_not_a_queue() -> None:
    draft = standing_ego()
    draft.parked(90.0)
    draft.moving(-1, 99.0, 8.0)
    assert look(draft).st.ahead_is[1] == op.AHEAD_BLOCKING


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


@pytest.mark.parametrize(("speed", "blocked"), [(0.0, True), (0.52, True), (0.8, False), (3.0, False)])
def test_a_crossing_vehicle_blocks_unless_it_is_gone_a_second_before(speed: float, blocked: bool) -> None:
    draft = Draft(highway())
    draft.program.perception[0] = op.PERCEPTION_CAMERA
    draft.ego(speed=10.0)
    draft.entity(op.MOTION_STATIC, draft.position(0, -1, 100.0, 0.0, math.pi / 2), speed)
    assert (look(draft).st.blocked_distance[0] < FAR) == blocked


def test_the_end_of_the_lane_and_the_lane_that_continues() -> None:
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


def crowd(number: int) -> Draft:
    """Return a draft with an ego and vehicles that stand anywhere about it, turned anyhow."""
    draft = standing_ego(K_SENSOR_RANGE=between(20.0, 90.0, number, "range"))
    draft.program.const[slots.K_FIELD_OF_VIEW] = between(0.3, 2.0 * math.pi, number, "view")
    for k in range(8):
        s, offset = between(20.0, 130.0, number, f"s{k}"), between(-12.0, 12.0, number, f"offset{k}")
        draft.parked(s, -1, offset, between(0.0, 2.0 * math.pi, number, f"turn{k}"))
    return draft


def between(low: float, high: float, number: int, what: str) -> float:
    """Return a number between two that depends on the others alone."""
    return low + (high - low) * uniform(12, number, what)


def corners(run: Run, j: int) -> list[complex]:
    """Return the corners of an entity's box, in turn."""
    st, base = run.st, run.p.entity_const[j]
    long, wide = (0.5 * run.p.const[base + slot] for slot in (slots.E_LENGTH, slots.E_WIDTH))
    turn = complex(math.cos(st.h[j]), math.sin(st.h[j]))
    centre = complex(st.middle_x[j], st.middle_y[j])
    return [centre + turn * complex(u, v) for u, v in ((long, wide), (long, -wide), (-long, -wide), (-long, wide))]


def cuts(box: list[complex], a: complex, b: complex) -> bool:
    """Tell whether the segment from a to b comes into a convex box, by cutting it off at each side in turn."""
    enter, leave = 0.0, 1.0
    for k in range(4):
        side, from_a, along = box[k] - box[k - 1], a - box[k - 1], b - a
        distance, rate = (side.conjugate() * from_a).imag, (side.conjugate() * along).imag
        if rate == 0.0 and distance > 0.0:
            return False
        if rate > 0.0:
            leave = min(leave, -distance / rate)
        elif rate < 0.0:
            enter = max(enter, -distance / rate)
    return enter < leave


def lines_of_sight(run: Run, j: int) -> tuple[complex, list[complex]]:
    """Return the ego's eye, and the ways from it to an entity's centre and to the two corners furthest apart for it."""
    st, p = run.st, run.p
    front = p.const[p.entity_const[0] + slots.E_CENTER] + 0.5 * p.const[p.entity_const[0] + slots.E_LENGTH]
    eye = complex(st.x[0] + front * math.cos(st.h[0]), st.y[0] + front * math.sin(st.h[0]))
    centre = complex(st.middle_x[j], st.middle_y[j]) - eye
    ends = sorted((corner - eye for corner in corners(run, j)), key=lambda end: cmath.phase(end / centre))
    return eye, [centre, ends[0], ends[-1]]


def test_an_object_is_seen_if_a_straight_line_of_sight_reaches_it() -> None:
    found = []
    for number in range(60):
        run = look(crowd(number))
        st, p = run.st, run.p
        reach, half_view = p.const[slots.K_SENSOR_RANGE], 0.5 * p.const[slots.K_FIELD_OF_VIEW]
        open_eye(p, st, 0, reach, 2.0 * half_view)
        for j in range(1, 9):
            eye, ways = lines_of_sight(run, j)
            others = [corners(run, k) for k in range(1, 9) if k != j]
            seen = any(
                abs(way) <= reach
                and abs(cmath.phase(way / cmath.exp(1j * st.h[0]))) <= half_view
                and not any(cuts(box, eye, eye + way) for box in others)
                for way in ways
            )
            if not cuts(corners(run, j), eye, eye + 0.01):
                found.append(seen)
                assert sees(p, st, 0, j) == seen, (number, j)
    assert 0.2 < sum(found) / len(found) < 0.8
