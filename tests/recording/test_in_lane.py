"""Lane departures, time to lane crossing, the heading at the response and the time off the road, by hand."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import pytest

from scenario_compiler.engine.columns import opcodes
from scenario_compiler.recording.recording import Recording
from tests.recording.made import STEP, Row, record
from tests.recording.test_measures import value

REQUEST = [(0.0, "request", "lane_confidence")]
"""The car is 2 m wide and 4 m long, its reference point 1 m before its rear; lanes are 3.5 m wide: 0.75 m of room."""


def drive(
    left: Sequence[float], lanes: Sequence[int] = (), heading: Callable[[int], float] = lambda _: 0.0, v: float = 10.0
) -> Recording:
    """Return a run along s whose offset from its lane's centre is `left` in each row, on lane -1 or `lanes`."""

    def row(t: float) -> Row:
        k = min(round(t / STEP), len(left) - 1)
        lane = lanes[k] if lanes else -1
        return {
            "x": (v * t,),
            "v": (v,),
            "road": (0,),
            "lane": (lane,),
            "s": (v * t,),
            "off": (left[k],),
            "lane_width": (3.5 if lane else 0.0,),
            "lane_heading": (heading(k),),
            "on_road": (1 if lane else 0,),
        }

    return record(("ego",), len(left), row, REQUEST)


def test_within_the_lane_there_is_no_departure() -> None:
    run = drive([0.0, 0.5, 0.74, -0.74, 0.0])
    assert value("lane_departures", run) == 0.0
    assert math.isnan(value("longest_lane_departure", run))
    assert math.isnan(value("deepest_lane_departure", run))


def test_each_departure_counts_and_the_longest_and_the_deepest_are_measured() -> None:
    """0.75 m of room: two rows out to the left by at most 0.25 m, then four out to the right by at most 0.4 m."""
    run = drive([0.0, 0.9, 1.0, 0.0, -0.8, -1.15, -1.0, -0.9, 0.0])
    assert value("lane_departures", run) == 2.0
    assert value("longest_lane_departure", run) == pytest.approx(4 * STEP)
    assert value("deepest_lane_departure", run) == pytest.approx(0.4)


def test_a_change_of_lane_is_one_departure_as_deep_as_the_car_comes_beyond_the_line() -> None:
    """At 0.5 m a row; the point passes the line at 1.75 m, and the car is within the next lane from 2.75 m on."""
    left = [0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5]
    run = drive([x if x < 1.75 else x - 3.5 for x in left], [-1 if x < 1.75 else 1 for x in left])
    assert value("lane_departures", run) == 1.0
    assert value("longest_lane_departure", run) == pytest.approx(4 * STEP)  # at 1.0, 1.5, 2.0 and 2.5 m
    assert value("deepest_lane_departure", run) == pytest.approx(2.5 + 1.0 - 1.75)


def test_off_every_lane_is_a_departure_and_off_the_road() -> None:
    run = drive([0.0, 1.0, 0.0, 0.0, 0.0], [-1, -1, 0, 0, 0])
    assert value("lane_departures", run) == 1.0
    assert value("longest_lane_departure", run) == pytest.approx(4 * STEP)
    assert value("deepest_lane_departure", run) == pytest.approx(0.25)
    assert value("time_off_road", run) == pytest.approx(3 * STEP)
    assert value("time_off_road", drive([0.0, 0.0])) == 0.0


def test_a_turned_car_reaches_farther_to_the_side() -> None:
    """At 0.1 rad the front corner is 3 sin 0.1 + cos 0.1 = 1.2945 m to the left: 0.4555 m of room, at 0.9983 m/s."""
    run = drive([0.0] * 4, heading=lambda _: 0.1)
    assert value("lane_departures", run) == 0.0
    expected = (1.75 - 3.0 * math.sin(0.1) - math.cos(0.1)) / (10.0 * math.sin(0.1))
    assert value("minimum_time_to_lane_crossing", run) == pytest.approx(expected)
    assert value("mean_time_to_lane_crossing", run) == pytest.approx(expected)


def test_time_to_crossing_is_to_the_side_that_the_car_moves_to() -> None:
    """To the right, from 0.3 m left of the centre: the front corner is 3 sin 0.1 + cos 0.1 to the right."""
    run = drive([0.3] * 3, heading=lambda _: -0.1)
    room = 1.75 - (3.0 * math.sin(0.1) + math.cos(0.1) - 0.3)
    assert value("minimum_time_to_lane_crossing", run) == pytest.approx(room / (10.0 * math.sin(0.1)))


def test_time_to_crossing_is_0_beyond_the_edge_and_undefined_straight_ahead() -> None:
    assert value("minimum_time_to_lane_crossing", drive([0.0, 0.9])) == 0.0
    assert math.isnan(value("minimum_time_to_lane_crossing", drive([0.0, 0.5])))
    slow = drive([0.0] * 3, heading=lambda _: 0.001, v=1.0)
    assert math.isnan(value("minimum_time_to_lane_crossing", slow))


def test_the_mean_is_over_the_rows_that_have_a_time() -> None:
    """Beyond the edge 0 s, and 0.5 s at twice the room over the speed; straight ahead none."""
    angles = (0.0, 0.1, 0.1)
    run = drive([0.0, 0.0, 0.9], heading=lambda k: angles[k])
    first = (1.75 - 3.0 * math.sin(0.1) - math.cos(0.1)) / (10.0 * math.sin(0.1))
    assert value("mean_time_to_lane_crossing", run) == pytest.approx(first / 2.0)


def test_the_heading_at_the_response_is_that_of_its_row() -> None:
    def row(t: float) -> Row:
        return {"x": (10.0 * t,), "v": (10.0,), "lane_heading": (0.01 * t,)}

    events = [(0.5, "request", "lane_confidence"), (1.5, "response", "")]
    assert value("heading_error_at_response", record(("ego",), 30, row, events)) == pytest.approx(0.015)
    assert math.isnan(value("heading_error_at_response", record(("ego",), 30, row, events[:1])))


def test_the_request_lead_ends_at_the_first_departure_or_collision() -> None:
    """Out of its lane from the fourth row on: 3 rows after the request; the collision that follows does not count."""
    left = [0.0, 0.5, 0.7, 0.9, 1.1, 0.0]
    assert value("request_lead", drive(left)) == pytest.approx(3 * STEP)
    assert math.isnan(value("request_lead", drive([0.0, 0.5])))


def test_a_request_without_an_obstacle_has_the_budget_that_the_engine_found() -> None:
    def row(t: float) -> Row:
        asked = t > 0.95
        return {
            "x": (10.0 * t,),
            "v": (10.0,),
            "cause": (opcodes.CAUSE_LANE_CONFIDENCE if asked else opcodes.CAUSE_NONE,),
            "limit_time": (2.52 if asked else opcodes.FAR,),
        }

    run = record(("ego",), 40, row, [(1.0, "request", "lane_confidence"), (2.0, "response", "")])
    assert value("time_budget", run) == pytest.approx(2.5)
    assert value("takeover_buffer", run) == pytest.approx(1.5)
    assert math.isnan(value("limit_distance", run))
