"""Measures on runs whose answers are known."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from scenario_compiler.engine.columns import opcodes
from scenario_compiler.recording.boxes import distance_at, least_box_distance, touching
from scenario_compiler.recording.criteria import fails
from scenario_compiler.recording.measures import MEASURES
from scenario_compiler.recording.on_path import (
    STEEPEST,
    greatest_drac,
    least_headway,
    least_time_to_collision,
    time_bounds,
    time_to_collision,
    times_at,
)
from scenario_compiler.recording.outcome import judge
from scenario_compiler.recording.recording import Floats, Recording
from scenario_compiler.recording.traces import TIMED_EVENTS, InputLimits, Traces, traces_of
from scenario_compiler.vocabulary.criteria import (
    Criterion,
    MaximumLateralOffset,
    MinimumTimeToCollision,
    StayOnRoad,
    TakeoverWithin,
)
from scenario_compiler.vocabulary.horizon import HORIZON
from tests.recording.made import STEP, Row, added_up, approach, plan_of, random_runs, record, with_trailers

IDS = ("ego", "parked")
BY_NAME = {measure.name: measure for measure in MEASURES}

SUMMED_OTHERWISE = {"lane_position_deviation": 1e-12, "settled_lane_position_deviation": 1e-12}
"""Measures whose total adds in another order than numpy does, and how far the two may differ, relatively."""


def traces(recording: Recording) -> Traces:
    return traces_of(plan_of(*recording.header.entities), recording)


def value(name: str, recording: Recording) -> float:
    """Return a measure of a recording, of which both ways to compute it must be the same."""
    runs = traces(recording)
    computed = float(BY_NAME[name].compute(runs))
    same(name, np.array([computed]), BY_NAME[name].total(added_up(runs)))
    return computed


def same(name: str, computed: Floats, total: Floats) -> None:
    """Assert that both ways to compute a measure give the same bits, but for sums of another order."""
    if name in SUMMED_OTHERWISE:
        assert total == pytest.approx(computed, rel=SUMMED_OTHERWISE[name], abs=1e-12, nan_ok=True), name
    else:
        assert np.array_equal(total, computed, equal_nan=True), name


@pytest.fixture(scope="module")
def answered() -> Recording:
    events = [(0.5, "warning", "path_blocked"), (1.0, "request", "path_blocked"), (3.0, "response", "")]
    return record(IDS, 51, approach(), events)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("takeover_time", 2.0),
        ("first_brake_time", 2.1),
        ("braking_time", 2.1),
        ("input_time", 2.1),
        ("steering_time", math.nan),
        ("eyes_on_time", math.nan),
        ("limit_distance", 49.0),
        ("time_budget", 4.9),
        ("takeover_buffer", 2.9),
        ("minimum_time_to_collision", 1.0),
        ("minimum_time_headway", 1.0),
        ("maximum_drac", 10.0 * 10.0 / (2 * 10.0)),
        ("lateral_offset_at_response", 0.0),
        ("time_off_lanes", 0.0),
        ("requests", 1.0),
        ("minimum_distance", 10.0),
        ("maximum_longitudinal_acceleration", 0.0),
        ("maximum_lateral_acceleration", 0.0),
        ("maximum_lateral_offset", 0.0),
        ("minimum_confidence", 0.9),
        ("final_speed", 10.0),
        ("warning_time", 0.5),
        ("request_time", 1.0),
        ("response_time", 3.0),
        ("escalation_time", math.nan),
        ("collision_speed", math.nan),
        ("collision_time", math.nan),
        ("lane_position_deviation", math.nan),
    ],
)
def test_an_answered_request_before_a_parked_car(answered: Recording, name: str, expected: float) -> None:
    assert value(name, answered) == pytest.approx(expected, abs=1e-9, nan_ok=True)


def _turning(t: float) -> Row:
    """Return rows that drive on, the front wheels turning by 0.001 rad a row, and the brake by a fiftieth."""
    k = round(t / STEP)
    return {
        "x": (float(k), 90.0),
        "v": (10.0, 0.0),
        "steer": (0.001 * k, 0.0),
        "brake": (0.02 * (k - 10) * (k > 10), 0.0),
        "takeover_state": (opcodes.TAKEOVER_MANUAL if k > 20 else opcodes.TAKEOVER_REQUEST,),
    }


def test_steering_counts_from_the_angle_at_the_response_by_the_steering_wheel() -> None:
    events = [(1.0, "request", "path_blocked"), (1.2, "eyes_on", ""), (1.5, "hands_on", ""), (2.0, "response", "")]
    recording = record(IDS, 51, _turning, events)
    assert value("eyes_on_time", recording) == pytest.approx(0.2)
    assert value("hands_on_time", recording) == pytest.approx(0.5)
    assert value("steering_time", recording) == pytest.approx(1.3)  # 0.0349 rad / 16 = 0.0022 rad: 3 rows after 2.0 s
    # The brake is past a tenth before the response; the driver's own begins with the row after it.
    assert value("braking_time", recording) == value("first_brake_time", recording) == 11 * STEP
    assert value("input_time", recording) == 11 * STEP
    runs = dataclasses.replace(traces(recording), inputs=InputLimits(math.radians(4), 0.5, 8.0))
    later = BY_NAME["steering_time"]
    assert float(later.compute(runs)) == pytest.approx(1.9)  # 0.0698 rad / 8 = 0.0087 rad: 9 rows after 2.0 s
    same("steering_time", np.array([later.compute(runs)]), later.total(added_up(runs)))
    assert float(BY_NAME["braking_time"].compute(runs)) == pytest.approx(2.6)


def test_without_a_request_there_is_no_time_nor_distance() -> None:
    run = record(("ego",), 5, lambda t: {"x": (t,), "v": (1.0,)})
    assert {name for name in BY_NAME if math.isnan(value(name, run))} == set(BY_NAME) - {
        "final_speed",
        "requests",
        "time_off_road",
        "time_off_lanes",
        "lane_departures",
        "longest_lane_departure",
    }


@pytest.mark.parametrize(("handed_back", "expected"), [(math.inf, 0.9), (2.05, math.nan), (2.55, math.nan)])
def test_only_braking_by_the_driver_counts(handed_back: float, expected: float) -> None:
    """The automation brakes until 1.95 s and from the hand-back on, the driver from 2.85 s on; a second one at 4 s."""

    def row(t: float) -> Row:
        manual = 2.05 < t < handed_back or t > 4.05
        brakes = t < 2.05 or t > (2.85 if handed_back > 5 else 3.85)
        state = opcodes.TAKEOVER_MANUAL if manual else opcodes.TAKEOVER_REQUEST
        return {"x": (t,), "v": (9.0,), "brake": (0.5 if brakes else 0.0,), "takeover_state": (state,)}

    run = record(("ego",), 60, row, [(2.0, "request", "path_blocked"), (2.0, "response", "")])
    assert value("first_brake_time", run) == pytest.approx(expected, nan_ok=True)
    assert value("braking_time", run) == pytest.approx(expected, nan_ok=True)


@pytest.mark.parametrize(
    ("crash", "braking", "departures", "offset"), [(math.inf, 2.0, 2.0, 0.95), (3.0, math.nan, 1.0, 0.8)]
)
def test_the_takeover_is_measured_up_to_the_first_collision(
    crash: float, braking: float, departures: float, offset: float
) -> None:
    """The brake from 4 s on and the second departure, from 6 s on, are those of the vehicle after the collision."""

    def row(t: float) -> Row:
        aside = 0.8 if 2.35 < t < 2.75 else 0.95 if t > 5.95 else 0.0
        brake = 1.0 if t > 3.95 else 0.0
        state = opcodes.TAKEOVER_MANUAL if t > 2.05 else opcodes.TAKEOVER_REQUEST
        lane = {"road": (0,), "lane": (-1,), "lane_width": (3.5,), "s": (9 * t,), "off": (aside,)}
        return {"x": (9 * t,), "v": (9.0,), "brake": (brake,), "takeover_state": (state,), **lane}

    events = [(2.0, "request", "path_blocked"), (2.0, "response", "")]
    run = record(("ego",), 140, row, [*events, *([(crash, "collision", "parked")] if crash < math.inf else [])])
    for name in ("braking_time", "first_brake_time"):
        assert value(name, run) == pytest.approx(braking, nan_ok=True)
    assert value("lane_departures", run) == departures
    assert value("maximum_lateral_offset", run) == pytest.approx(offset)
    assert math.isnan(value("lane_position_deviation", run)) == (crash < math.inf)


def crashed(after: Callable[[float], Row]) -> Recording:
    """Return a run that ends in a collision at 6.1 s, whose rows after it are those of a function of the time since."""
    before = approach()

    def row(t: float) -> Row:
        lane = {"lane_width": (3.5,), "lane_heading": (0.01,), "on_road": (True,), "lane_time_to_collision": (9.0,)}
        place = {"steer": (0.02 * math.sin(t), 0.0), "off": (0.05 * t, 0.0), "a": (-0.1 * t, 0.0)}
        return {**before(t), **lane, **place, **(after(t - 6.1) if t > 6.15 else {})}

    events = [(1.0, "request", "path_blocked"), (3.0, "response", ""), (6.1, "collision", "parked")]
    return record(IDS, 200, row, events)


def at_rest(since: float) -> Row:
    return {"x": (61.0, 64.0), "v": (0.0, 0.0), "s": (61.0, 64.0)}


def thrown_about(since: float) -> Row:
    """It spins off the road and into an oncoming lane, without any lane in sight."""
    off = since < 3.0
    lane = {"road": (-1 if off else 0, 0), "lane": (0 if off else 1, -1), "off": (9.0, 0.0), "on_road": (not off,)}
    seen = {"confidence_left": (0.0,), "confidence_right": (0.0,), "lane_time_to_collision": (0.01,)}
    inputs = {"steer": (0.5 * math.sin(9.0 * since), 0.0), "brake": (1.0, 0.0), "a": (-15.0, 0.0)}
    motion = {"x": (61.0 + 30.0 * since, 64.0), "y": (9.0, 0.0), "h": (3.0 * since, 0.0), "v": (30.0, 0.0)}
    return {**lane, **seen, **inputs, **motion, "lane_heading": (1.5,), "s": (61.0 + 30.0 * since, 64.0)}


@pytest.mark.parametrize("name", [one.name for one in MEASURES if one.name != "final_speed"])
def test_what_happens_after_a_collision_changes_no_measure(name: str) -> None:
    assert value(name, crashed(thrown_about)) == pytest.approx(value(name, crashed(at_rest)), nan_ok=True, abs=0.0)


@pytest.mark.parametrize(("road", "lane"), [(0, 0), (-1, -1)])
def test_off_every_lane_no_distance_from_its_middle_is_kept(road: int, lane: int) -> None:
    def row(t: float) -> Row:
        off = t > 0.35
        here = {"lane": (lane if off else -1,), "road": (road if off else 0,), "on_road": (not off,)}
        return {"x": (t,), "off": (0.0 if off else 0.3,), **here}

    limit, allowed = MaximumLateralOffset(at_most=1.0), StayOnRoad(required=False)
    run = record(("ego",), 10, row)
    kept, stayed = judge(plan_of("ego", criteria=(limit, allowed)), run).criteria
    assert not kept.passed
    assert kept.when == pytest.approx(0.4)
    assert kept.why == "off every lane from 0.40 s; on lanes the greatest was 0.30 m, at most 1 m is allowed"
    assert (stayed.passed, stayed.why) == (True, "off the road from 0.40 s, which is allowed")
    assert fails(limit, added_up(traces(run)), np.array(False), np.array(1.0)).tolist() == [True]


def test_what_happens_after_a_collision_changes_no_criterion() -> None:
    required: tuple[Criterion, ...] = (
        StayOnRoad(),
        MaximumLateralOffset(at_most=1.0),
        MinimumTimeToCollision(at_least=0.0),
        TakeoverWithin(time=2.5),
    )
    for after in (at_rest, thrown_about):
        found = judge(plan_of(*IDS, criteria=required), crashed(after)).criteria
        assert [(one.passed, one.why) for one in found[:2]] == [
            (True, "the reference point stayed on the road"),
            (True, "the greatest was 0.31 m, at most 1 m is allowed"),
        ]
        assert all(one.passed for one in found)


@pytest.mark.parametrize(("crash", "when"), [(1.5, 1.5), (4.0, 3.5), (math.inf, 3.5)])
def test_a_driver_who_has_not_responded_before_a_collision_has_not_responded_in_time(crash: float, when: float) -> None:
    """Before, a collision 0.5 s after the request broke the criterion or not by how long the wreck stood there."""
    events = [(1.0, "request", "path_blocked"), *([(crash, "collision", "parked")] if crash < math.inf else [])]
    for rows in (50, 200):
        run = record(IDS, rows, approach(), events)
        (found,) = judge(plan_of(*IDS, criteria=(TakeoverWithin(time=2.5),)), run).criteria
        assert found.when == pytest.approx(when)


@pytest.mark.parametrize(
    ("rows", "request_at", "crash", "passed", "why"),
    [
        (31, 1.0, None, True, "the driver did not respond in the 2.00 s until the end of the run"),
        (
            36,
            1.0,
            None,
            False,
            "the driver did not respond in the 2.50 s until the end of the run, at most 2.5 s are allowed",
        ),
        (
            50,
            1.0,
            1.5,
            False,
            "the driver did not respond in the 0.50 s until the collision, at most 2.5 s are allowed",
        ),
        (28, 0.1 + 0.2, None, True, "the driver did not respond in the 2.40 s until the end of the run"),
        (
            29,
            0.1 + 0.2,
            None,
            False,
            "the driver did not respond in the 2.50 s until the end of the run, at most 2.5 s are allowed",
        ),
    ],
)
def test_the_time_without_a_response_is_given(
    rows: int, request_at: float, crash: float | None, passed: bool, why: str
) -> None:
    events = [(request_at, "request", "path_blocked"), *([] if crash is None else [(crash, "collision", "parked")])]
    run = record(IDS, rows, approach(), events)
    (found,) = judge(plan_of(*IDS, criteria=(TakeoverWithin(time=2.5),)), run).criteria
    assert (found.passed, found.why) == (passed, why)


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_the_lateral_offset_is_counted_from_the_lane_at_the_request(direction: float) -> None:
    """At 1 m/s to the left from 2 s to 5.5 s, over lanes 3.5 m wide: 3.5 m, half of it in the offset."""

    def row(t: float) -> Row:
        left = 0.25 + min(max(t - 2.0, 0.0), 3.5)
        lane = left > 1.75
        off = left - 3.5 * lane
        s = 100.0 + direction * 10.0 * t
        return {
            "x": (10.0 * t,), "v": (10.0,), "s": (s,), "road": (0,), "lane": (-1 if lane else -2,),
            "off": (direction * off,),
        }  # fmt: skip

    run = record(("ego",), 80, row, [(1.0, "request", "path_blocked")])
    assert value("maximum_lateral_offset", run) == pytest.approx(3.75)
    late = record(("ego",), 80, row, [(5.0, "request", "path_blocked")])
    assert value("maximum_lateral_offset", late) == pytest.approx(0.25)
    assert value("maximum_lateral_offset", record(("ego",), 80, row)) == pytest.approx(math.nan, nan_ok=True)


def test_the_time_budget_counts_the_speed_of_an_oncoming_object() -> None:
    budgets = []
    for towards, cause in ((0.0, opcodes.CAUSE_PATH_BLOCKED), (5.0, opcodes.CAUSE_PATH_BLOCKED), (5.0, 0)):
        code = cause or opcodes.CAUSE_LANE_ENDS

        def row(t: float, towards: float = towards, code: int = code) -> Row:
            ahead = {"blocked_distance": (60.0,), "blocked_speed": (towards,), "lane_end_distance": (60.0,)}
            return {"x": (t,), "v": (10.0,), "cause": (code,), **ahead}

        budgets.append(value("time_budget", record(("ego",), 60, row, [(1.0, "request", "path_blocked")])))
    assert budgets == pytest.approx([6.0, 4.0, 6.0])


def test_a_request_is_described_by_the_rows_behind_it_and_not_by_the_warning_before_it() -> None:
    """The row of a request was recorded before it: its cause and its numbers are those of the warning."""

    def row(t: float) -> Row:
        asked = t > 1.025
        cause = opcodes.CAUSE_LANE_CONFIDENCE if asked else opcodes.CAUSE_PATH_BLOCKED
        left = 4.0 if asked else opcodes.FAR
        return {
            "x": (10.0 * t,),
            "v": (10.0 if t < 1.025 else 5.0,),
            "cause": (cause,),
            "blocked_distance": (80.0,),
            "limit_time": (left,),
            "traffic_density": (12.0 if asked else 0.0,),
        }

    run = record(("ego",), 60, row, [(0.5, "warning", "path_blocked"), (1.0, "request", "lane_confidence")])
    assert value("time_budget", run) == pytest.approx(4.0)
    assert math.isnan(value("limit_distance", run))
    assert value("traffic_density", run) == 12.0
    only = judge(plan_of("ego"), run).takeovers[0]
    assert (only.cause, only.time_budget, only.speed, only.traffic_density) == ("lane_confidence", 4.0, 10.0, 12.0)
    blocked = record(("ego",), 60, lambda t: row(t) | {"cause": (opcodes.CAUSE_PATH_BLOCKED,)}, [(1.0, "request", "")])
    assert value("time_budget", blocked) == pytest.approx(8.0)


def test_the_time_to_collision_along_the_lane_is_the_least_up_to_a_collision() -> None:
    def row(t: float) -> Row:
        return {"x": (t,), "v": (10.0,), "lane_time_to_collision": (opcodes.FAR if t < 1.0 else 6.0 - t,)}

    assert value("minimum_lane_time_to_collision", record(("ego",), 31, row)) == pytest.approx(3.0)
    crash = record(("ego",), 31, row, [(2.0, "collision", "wall")])
    assert value("minimum_lane_time_to_collision", crash) == pytest.approx(4.0)
    far = record(("ego",), 61, lambda t: row(t) | {"lane_time_to_collision": (31.0,)})
    assert math.isnan(value("minimum_lane_time_to_collision", far))


def test_equal_durations_are_equal_numbers() -> None:
    found: dict[str, set[float]] = {"takeover_time": set(), "time_budget": set(), "takeover_buffer": set()}
    for k in range(1, 40, 3):
        events = [(k * STEP, "request", "path_blocked"), ((k + 7) * STEP, "response", "")]

        def row(t: float, k: int = k) -> Row:
            there = t > k * STEP - 0.05
            blocked = 12.0 + 1e-9 * k if there else opcodes.FAR
            cause = opcodes.CAUSE_PATH_BLOCKED if there else opcodes.CAUSE_NONE
            return {"x": (t,), "v": (10.0,), "cause": (cause,), "blocked_distance": (blocked,)}

        run = record(("ego",), 60, row, events)
        for name, values in found.items():
            values.add(value(name, run))
    assert {name: len(values) for name, values in found.items()} == dict.fromkeys(found, 1)
    assert found["takeover_time"] == {7 * STEP}
    assert found["time_budget"] == {12 * STEP}


def test_a_collision_has_a_time_and_the_speed_before_it() -> None:
    run = record(IDS, 71, approach(), [(6.0, "collision", "parked")])
    assert value("collision_time", run) == 6.0
    assert value("collision_speed", run) == 10.0
    assert value("minimum_distance", run) == 0.0
    assert value("minimum_time_to_collision", run) == 0.0


def test_a_car_beside_the_path_gives_no_time_to_collision_but_a_distance() -> None:
    def row(t: float) -> Row:
        return {"x": (10 * t, 64.0), "y": (0.0, 3.5), "h": (0.0, 0.0), "v": (10.0, 0.0)}

    run = record(IDS, 80, row)
    assert math.isnan(value("minimum_time_to_collision", run))
    assert value("minimum_distance", run) == pytest.approx(1.5)


@pytest.mark.parametrize(
    ("closing", "expected"),
    [(2.5, 24.0), (2.0625, 60.0 / 2.0625), (2.0, math.nan), (1.75, math.nan), (0.0009765625, math.nan)],
)
def test_beyond_the_horizon_there_is_no_time_to_collision(closing: float, expected: float) -> None:
    def row(t: float) -> Row:
        return {"x": (0.0, 64.0), "y": (0.0, 0.0), "h": (0.0, 0.0), "v": (20.0, 20.0 - closing)}

    run = record(IDS, 3, row)
    assert value("minimum_time_to_collision", run) == pytest.approx(expected, nan_ok=True)
    rows = traces(run)
    in_time = time_to_collision(rows, np.asarray(math.inf))
    assert in_time[1:].tolist() == pytest.approx([expected] * 2, nan_ok=True)


def test_time_to_collision_follows_the_curve_that_is_driven() -> None:
    radius, speed = 50.0, 10.0

    def on_circle(angle: float) -> tuple[float, float]:
        return radius * math.sin(angle), radius * (1 - math.cos(angle))

    def row(t: float) -> Row:
        (x, y), (ox, oy) = on_circle(speed * t / radius), on_circle(1.2)
        return {"x": (x, ox), "y": (y, oy), "h": (speed * t / radius, 1.2), "v": (speed, 4.0)}

    run = record(IDS, 5, row)
    rows = traces(run)
    assert math.isnan(rows.curvature[0])
    assert rows.curvature[1:] == pytest.approx(1 / radius)
    ahead = 1.2 * radius - 0.4 * speed
    assert value("minimum_time_to_collision", run) == pytest.approx((ahead - 4.0) / 6.0, abs=0.02)


def test_the_gap_ends_where_the_bent_path_meets_the_straight_side_of_a_box() -> None:
    radius, speed, place = 50.0, 10.0, 20.0
    turn = place / radius - 0.03
    middle = complex(radius * math.sin(place / radius), radius * (1 - math.cos(place / radius)))
    middle += 2j * np.exp(1j * place / radius)

    def row(t: float) -> Row:
        angle = speed * t / radius
        x, y = radius * math.sin(angle), radius * (1 - math.cos(angle))
        return {"x": (x, middle.real), "y": (y, middle.imag), "h": (angle, turn), "v": (speed, 0.0)}

    corners = np.array([3 + 1j, -1 + 1j, -1 - 1j, 3 - 1j]) * np.exp(1j * turn) + middle
    sides = np.roll(corners, -1) - corners
    outline = (corners[:, None] + sides[:, None] * np.linspace(0, 1, 20_001)).ravel() - 1j * radius
    in_path = np.abs(np.abs(outline) - radius) < 1.0
    first = radius * (np.angle(outline[in_path]) + math.pi / 2).min()
    front = 4 * STEP * speed + 3.0
    assert first > radius * (np.angle(corners - 1j * radius) + math.pi / 2).min() + 0.3
    assert value("minimum_time_to_collision", record(IDS, 5, row)) == pytest.approx((first - front) / speed, abs=1e-4)


def test_the_way_between_two_rows_is_that_of_the_speed_after_the_step() -> None:
    radius = 40.0
    speeds = [20.0 - 2.0 * k for k in range(6)]

    def row(t: float) -> Row:
        k = round(t / STEP)
        return {"h": (STEP * sum(speeds[1 : k + 1]) / radius,), "v": (speeds[k],), "x": (t,)}

    run = record(("ego",), 6, row, [(STEP, "request", "")])
    assert traces(run).curvature[1:] == pytest.approx(1 / radius)
    assert value("maximum_lateral_acceleration", run) == pytest.approx(speeds[1] ** 2 / radius)


def test_lateral_acceleration_is_speed_squared_over_radius() -> None:
    run = record(("ego",), 20, lambda t: {"h": (6.2 + 0.2 * t,), "v": (10.0,), "x": (t,)}, [(0.5, "request", "")])
    assert value("maximum_lateral_acceleration", run) == pytest.approx(2.0)


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_deviation_of_the_lateral_position(direction: float) -> None:
    def row(t: float) -> Row:
        k = round(t / STEP)
        return {
            "x": (t,),
            "v": (10.0,),
            "s": (500 + direction * 10 * t,),
            "off": (0.2 if k % 2 else -0.2,),
            "road": (0,),
            "takeover_state": (opcodes.TAKEOVER_MANUAL,),
        }

    run = record(("ego",), 130, row, [(1.0, "response", "")])
    n = 101
    expected = float(np.std([0.2 if k % 2 else -0.2 for k in range(10, 10 + n)], ddof=1))
    assert value("lane_position_deviation", run) == pytest.approx(expected)


def weaving(t: float) -> Row:
    """Return a row that weaves by 0.5 m with a period of 2 s until 13 s, and by 0.1 m from then on."""
    wide = 0.5 if t < 12.9 else 0.1
    state = opcodes.TAKEOVER_MANUAL if t > 3.05 else opcodes.TAKEOVER_REQUEST
    return {
        "x": (10.0 * t,),
        "v": (10.0,),
        "s": (10.0 * t,),
        "road": (0,),
        "lane": (-1,),
        "off": (wide * math.sin(math.pi * t),),
        "takeover_state": (state,),
    }


def test_lane_keeping_settles_in_the_first_window_from_which_on_it_is_stable() -> None:
    """Request at 1 s, response at 3 s; the window from 3 to 13 s is not stable, those from 13 s on are."""
    events = [(1.0, "request", "lane_confidence"), (3.0, "response", "")]
    run = record(("ego",), round(64.0 / STEP) + 1, weaving, events)
    assert value("stabilisation_time", run) == pytest.approx(12.0)
    assert value("lane_position_deviation", run) == pytest.approx(0.5 * math.sqrt(0.5), rel=0.02)
    assert value("settled_lane_position_deviation", run) == pytest.approx(0.1 * math.sqrt(0.5), rel=0.02)
    short = record(("ego",), round(12.0 / STEP), weaving, events)
    assert math.isnan(value("stabilisation_time", short))
    assert math.isnan(value("settled_lane_position_deviation", short))


def test_deviation_is_not_measured_over_a_lane_change_nor_over_less_than_its_window() -> None:
    def row(t: float) -> Row:
        state = (opcodes.TAKEOVER_MANUAL,)
        off = (1.7 if 4 < t < 5 else 0.0,)
        return {"x": (t,), "v": (10.0,), "s": (10 * t,), "off": off, "road": (0,), "takeover_state": state}

    assert math.isnan(value("lane_position_deviation", record(("ego",), 130, row, [(1.0, "response", "")])))
    assert math.isnan(value("lane_position_deviation", record(("ego",), 60, row, [(1.0, "response", "")])))


@pytest.mark.parametrize(
    ("handed_back", "settling", "settled"), [(8.0, False, False), (30.0, True, False), (63.2, True, True)]
)
def test_deviation_is_that_of_the_driver_alone(handed_back: float, settling: bool, settled: bool) -> None:
    """Response at 3 s; from the given time on the automation drives again, in the middle of the lane."""

    def row(t: float) -> Row:
        again = {"takeover_state": (opcodes.TAKEOVER_AUTOMATED,), "off": (0.0,)} if t > handed_back else {}
        return {**weaving(t), **again}

    run = record(("ego",), round(64.0 / STEP) + 1, row, [(1.0, "request", "lane_confidence"), (3.0, "response", "")])
    assert math.isfinite(value("lane_position_deviation", run)) is settling
    assert math.isfinite(value("settled_lane_position_deviation", run)) is settled


def test_a_road_that_runs_the_other_way_turns_no_offset_into_a_lane_change() -> None:
    def row(t: float) -> Row:
        first = t < 4
        return {
            "x": (t,),
            "v": (10.0,),
            "s": (10 * t if first else 200 - 10 * t,),
            "off": (0.8 if first else -0.8,),
            "road": (0 if first else 1,),
            "takeover_state": (opcodes.TAKEOVER_MANUAL,),
        }

    run = record(("ego",), 130, row, [(1.0, "response", "")])
    assert value("lane_position_deviation", run) == pytest.approx(0.0, abs=1e-12)


def test_a_vehicle_that_stands_keeps_its_side_of_the_lane() -> None:
    """It stands from 4 s on, 0.8 m left of the centre, and is located up to a rounding behind its place."""

    def row(t: float) -> Row:
        stands = t > 4.0
        s = 100.0 - 1e-13 * (round(t / STEP) % 7) if stands else 60.0 + 10.0 * t
        manual = opcodes.TAKEOVER_MANUAL if t > 1.0 else opcodes.TAKEOVER_REQUEST
        own = {"x": (t,), "v": (0.0 if stands else 10.0,), "s": (s,), "off": (0.8,), "road": (0,), "lane": (-1,)}
        return {**own, "takeover_state": (manual,)}

    run = record(("ego",), 130, row, [(0.5, "request", "path_blocked"), (1.0, "response", "")])
    assert value("lane_position_deviation", run) == pytest.approx(0.0, abs=1e-9)
    assert value("maximum_lateral_offset", run) == pytest.approx(0.8)
    assert value("stabilisation_time", run) == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("x", "y", "h", "distance"),
    [
        (10.0, 0.0, 0.0, 6.0),
        (0.0, 5.0, 0.0, 3.0),
        (7.0, 6.0, 0.0, 5.0),
        (2.0, 0.5, 1.0, 0.0),
        (2.0, 3.0, math.pi / 2, 1.0),
    ],
)
def test_distance_between_boxes(x: float, y: float, h: float, distance: float) -> None:
    run = record(IDS, 1, lambda _: {"x": (0.0, x), "y": (0.0, y), "h": (0.0, h)})
    assert least_box_distance(traces(run)) == pytest.approx(distance)


@pytest.mark.parametrize("towing", [(-1, 0, 1), (1, 2, -1)])
def test_the_vehicles_of_its_own_combination_are_no_other_road_users(towing: tuple[float, ...]) -> None:
    """The ego tows two trailers, or is towed; the nearer one overlaps it at the coupling, the other one follows."""

    def row(t: float) -> Row:
        x = 10.0 * t
        still = dict.fromkeys(("y", "z", "h"), (0.0,) * 3)
        return {**still, "x": (x, x - 3.5, x - 9.0), "v": (10.0,) * 3, "towed_by": towing}

    def alone(t: float) -> Row:
        return {**row(t), "towed_by": (-1,) * 3}

    for name in (
        "minimum_distance",
        "minimum_time_to_collision",
        "minimum_time_headway",
        "maximum_drac",
        "minimum_post_encroachment_time",
    ):
        assert math.isnan(value(name, record(("ego", "a", "b"), 30, row))), name
        assert value(name, record(("ego", "a", "b"), 30, alone)) in (0.0, STEEPEST), name


def test_measures_of_many_runs_at_once_equal_those_of_each() -> None:
    events = [(1.0, "request", "path_blocked"), (3.0, "response", "")]
    runs = [record(IDS, 51, approach(), events), record(IDS, 71, approach(12.0), [(5.0, "collision", "parked")])]
    single = [traces(run) for run in runs]
    many = _stacked(single)
    for measure in MEASURES:
        together = measure.compute(many)
        assert together.shape == (2,), measure.name
        alone = [float(measure.compute(one)) for one in single]
        assert together == pytest.approx(np.array(alone), nan_ok=True), measure.name


def _stacked(parts: list[Traces]) -> Traces:
    rows = max(len(part.t) for part in parts)
    columns: dict[str, Any] = {}
    for field in dataclasses.fields(Traces):
        if field.name in ("length", "width", "height", "center", "step", "inputs", "times", "requests"):
            continue
        arrays = [getattr(part, field.name) for part in parts]
        padded = []
        for array in arrays:
            more = np.full((rows - len(array), *array.shape[1:]), np.nan if array.dtype == float else 0, array.dtype)
            padded.append(np.concatenate([array, more]))
        columns[field.name] = np.stack(padded)
    times = {kind: np.stack([part.times[kind] for part in parts]) for kind in TIMED_EVENTS}
    requests = np.stack([part.requests for part in parts])
    return dataclasses.replace(parts[0], **columns, times=times, requests=requests)


def _sampled_ahead(runs: Traces, places: tuple[Any, ...]) -> tuple[Floats, Floats, Floats]:
    """Return gaps from points on the boxes' outlines, how much less they may be between points, m, and closing speeds.

    The 60 points of each side lie on the boxes' straight edges and are taken to the circle that is driven one by one.
    """
    points = 60
    number, *rows = places
    ego, other = (*rows, 0 * number), (*rows, number + 1)
    corners = runs.center[other[-1]] + 0.5 * runs.length[other[-1]] * np.array([[1.0], [-1.0], [-1.0], [1.0]])
    outline = corners + 0.5j * runs.width[other[-1]] * np.array([[1.0], [1.0], [-1.0], [-1.0]])
    outline = outline * np.exp(1j * runs.h[other]) + runs.x[other] + 1j * runs.y[other]
    outline = (outline - runs.x[ego] - 1j * runs.y[ego]) * np.exp(-1j * runs.h[ego])
    curvature = runs.curvature[tuple(rows)]
    bent = np.abs(curvature) > 1e-6
    k = np.where(bent, curvature, 1.0)

    def on_circle(plane: NDArray[np.complex128]) -> NDArray[np.complex128]:
        turned = 1 + 1j * k * plane
        return np.where(bent, (np.angle(turned) + 1j * (1 - np.abs(turned))) / k, plane)

    sides = np.roll(outline, -1, axis=0) - outline
    sampled = on_circle(outline[:, None] + sides[:, None] * (np.arange(points) / points)[:, None])
    outline = on_circle(outline)
    tangent = runs.h[ego] + curvature * outline.real.mean(axis=0)
    closing = runs.v[ego] - runs.v[other] * np.cos(runs.h[other] - tangent)
    within = np.abs(sampled.imag) < 0.5 * runs.width[0]
    gap = np.where(within, sampled.real, np.inf).min(axis=(0, 1)) - runs.center[0] - 0.5 * runs.length[0]
    half_way = np.ptp(outline.real, axis=0) * np.abs(curvature) >= np.pi
    counts = np.isfinite(gap) & (gap >= 0) & ~half_way & np.isfinite(curvature)
    return np.where(counts, gap, np.inf), np.abs(np.diff(sampled, axis=1)).max(axis=(0, 1)), closing


@pytest.mark.parametrize("seed", range(8))
def test_no_distance_and_no_time_is_below_its_bound_and_the_least_is_found(seed: int) -> None:
    runs = random_runs(seed)
    places = tuple(np.indices(runs.seen.apart.shape).reshape(3, -1))
    there = np.isfinite(runs.seen.apart).reshape(-1)
    places = tuple(place[there] for place in places)
    touched = np.asarray(touching(runs).any(axis=-1))
    distance, time = distance_at(runs, places), times_at(runs, places)
    assert (runs.seen.apart[places] <= distance).all()
    assert (time_bounds(runs)[places] <= time).all()
    gap, spacing, closing = _sampled_ahead(runs, places)
    slower = np.where(closing > 0, closing, 1.0)
    nearest, spacing = np.where(closing > 0, gap / slower, np.inf), spacing / slower
    assert (time_bounds(runs)[places] <= nearest).all()
    seen = np.isfinite(nearest) & (nearest > spacing)
    assert (time[seen] <= nearest[seen] + 1e-9).all()
    assert (time[seen] >= (nearest - spacing)[seen]).all()
    least_distance, least_time = np.full(len(touched), np.inf), np.full(len(touched), np.inf)
    np.minimum.at(least_distance, places[1], distance)
    np.minimum.at(least_time, places[1], time)
    assert np.isfinite(least_time).any()
    expected = np.where(touched, 0.0, np.where(least_time < HORIZON, least_time, np.inf))
    for found, exact in (
        (least_box_distance(runs), np.where(touched, 0.0, least_distance)),
        (least_time_to_collision(runs), expected),
    ):
        assert np.where(np.isnan(found), np.inf, found).tolist() == exact.tolist()
    limit = np.full(len(touched), 2.0)
    soon = np.fmin.reduce(time_to_collision(runs, limit), axis=-1)
    assert (soon < 2.0).tolist() == (expected < 2.0).tolist()


@pytest.mark.parametrize("seed", range(8))
def test_headway_and_drac_are_those_of_sampled_outlines(seed: int) -> None:
    """The outlines are an implementation of their own; where a gap is short beside their points, they say little."""
    runs = random_runs(seed)
    places = tuple(np.indices(runs.seen.apart.shape).reshape(3, -1))
    places = tuple(place[np.isfinite(runs.seen.apart).reshape(-1)] for place in places)
    touched = np.asarray(touching(runs).any(axis=-1))
    gap, spacing, closing = _sampled_ahead(runs, places)
    own = runs.v[..., 0][places[1:]]
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        headway = np.where(own > 0, gap / own, np.inf)
        drac = np.where((closing > 0) & (gap < HORIZON * closing), closing * closing / (2 * gap), 0.0)
        slack = np.where(own > 0, spacing / own, 0.0)
    for run in range(len(touched)):
        of_run = places[1] == run
        found, needed = least_headway(runs)[run], greatest_drac(runs)[run]
        if touched[run]:
            assert (found, needed) == (0.0, STEEPEST)
            continue
        nearest = headway[of_run].min(initial=np.inf)
        assert math.isnan(found) == (nearest >= HORIZON)
        if nearest < HORIZON:
            assert nearest - slack[of_run].max() <= found <= nearest + 1e-9
        greatest = drac[of_run].max(initial=0.0)
        assert math.isnan(needed) == (greatest == 0.0)
        if greatest and gap[of_run].min() > 100 * spacing[of_run].max():
            assert needed == pytest.approx(min(greatest, STEEPEST), rel=0.03)


def test_a_follower_at_the_same_speed_has_a_headway_and_needs_no_brake() -> None:
    def row(t: float) -> Row:
        return {"x": (20 * t, 27.0 + 20 * t), "y": (0.0, 0.0), "h": (0.0, 0.0), "v": (20.0, 20.0)}

    run = record(IDS, 9, row)
    assert value("minimum_time_headway", run) == pytest.approx((27.0 - 1.0 - 3.0) / 20.0)
    assert math.isnan(value("maximum_drac", run))
    assert math.isnan(value("minimum_time_to_collision", run))


def test_the_time_off_the_lanes_is_a_number_of_steps() -> None:
    def row(t: float) -> Row:
        off = 0.45 < t < 0.75
        return {"x": (t,), "v": (1.0,), "road": (-1 if off else 0,), "lane": (0 if off else -1,), "off": (0.0,)}

    assert value("time_off_lanes", record(("ego",), 20, row)) == 3 * STEP


@pytest.mark.parametrize("seed", range(3))
def test_the_engines_totals_equal_the_measures_of_random_recordings(seed: int) -> None:
    runs = with_trailers(random_runs(seed, rows=120))
    dice = np.random.default_rng(100 + seed)
    request = dice.uniform(0.0, 5.0, 6)
    times = {
        **runs.times,
        "request": request,
        "response": np.where(dice.random(6) < 0.3, np.nan, request + dice.uniform(0.0, 3.0, 6)),
        "collision": np.where(dice.random(6) < 0.5, np.nan, dice.uniform(0.0, 12.0, 6)),
    }
    road = np.where(runs.present, dice.integers(-1, 2, runs.road.shape), -1)
    lane = np.where(road >= 0, dice.integers(-2, 2, runs.lane.shape), 0)
    off = np.where(
        runs.present,
        np.where(road >= 0, dice.normal(0.0, 0.5, runs.off.shape) + dice.choice([0.0, 1.5], runs.off.shape), 0.0),
        np.nan,
    )
    steer = np.where(runs.present, np.cumsum(dice.normal(0.0, 0.01, runs.steer.shape), axis=1), np.nan)
    brake = np.where(runs.present, dice.random(runs.brake.shape) ** 8, np.nan)
    a = np.where(runs.present, dice.normal(0.0, 2.0, runs.a.shape), np.nan)
    states = np.repeat(dice.choice([1, 2, opcodes.TAKEOVER_MANUAL, opcodes.TAKEOVER_HAND_BACK], (6, 12)), 10, axis=-1)
    states[::2] = opcodes.TAKEOVER_MANUAL
    runs = dataclasses.replace(
        runs,
        times=times,
        road=road,
        lane=lane,
        brake=brake,
        off=off,
        a=a,
        takeover_state=states,
        requests=np.ones(6),
        steer=steer,
        lane_width=np.where(lane[..., 0] != 0, dice.choice([3.5, 3.5, 2.5], request.shape)[:, None], 0.0),
        lane_heading=dice.choice([0.0, 0.02, -0.1], runs.t.shape),
        on_road=dice.random(runs.t.shape) < 0.9,
        cause=np.where(dice.random(runs.t.shape) < 0.7, opcodes.CAUSE_LANE_CONFIDENCE, opcodes.CAUSE_NONE),
        limit_time=np.where(dice.random(runs.t.shape) < 0.5, np.nan, dice.uniform(0.0, 9.0, runs.t.shape)),
        traffic_density=dice.integers(0, 30, runs.t.shape).astype(np.float64),
        lane_time_to_collision=np.where(dice.random(runs.t.shape) < 0.7, np.nan, dice.uniform(0.0, 60.0, runs.t.shape)),
    )
    totals = added_up(runs)
    for measure in MEASURES:
        same(measure.name, measure.compute(runs), measure.total(totals))
    assert np.isfinite(totals.column("least_time_to_collision")).any()
    assert (totals.raw("fine_reversals") > totals.raw("coarse_reversals")).any()


def test_every_measure_has_a_definition_and_a_reason_for_being_undefined() -> None:
    names = [measure.name for measure in MEASURES]
    assert len(set(names)) == len(names)
    assert all(m.definition.endswith(".") and m.undefined and m.unit for m in MEASURES)
    reasons = {m.name: m.undefined for m in MEASURES}
    assert reasons["request_time"] == "no request"
    assert reasons["short_start_time"] == "the run did not begin within the time budget of a limit ahead"
