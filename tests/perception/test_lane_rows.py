"""The lane and the tilt of the camera are found from rows of the picture, with and without the planned route."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from scenario_compiler.perception.course import Course
from scenario_compiler.perception.lane_rows import (
    COLUMNS,
    ROWS,
    STRETCH,
    TRAINED_FOR,
    Expected,
    Line,
    Rows,
    V,
    ground_of,
    lane_through,
)
from scenario_compiler.perception.road_plane import LEVEL, Tilt
from scenario_compiler.perception.route_ahead import WayPoint

Floats = NDArray[np.float64]

AHEAD = np.arange(2.0, 60.0, 0.05)
"""Distances along a lane at which its boundaries are projected into the picture, m."""

WIDTH = 3.5


def bend(curvature: float, aside: float = 0.0, ahead: Floats = AHEAD) -> tuple[Floats, Floats]:
    """Return x and y of a line that passes the camera `aside` to the left, all such lines with one centre."""
    if curvature == 0.0:
        return ahead, np.full_like(ahead, aside)
    angle = ahead * curvature
    radius = 1.0 / curvature - aside
    return radius * np.sin(angle), 1.0 / curvature - radius * np.cos(angle)


def rows_of(x: Floats, y: Floats, pitch: float = 0.0, z: float | Floats = 0.0) -> Rows:
    """Return the rows of a line on the ground, seen under a tilt; those in which it is not have no boundary."""
    u, v = TRAINED_FOR.project_ground(x, y, pitch, z)
    seen = np.isfinite(u) & (u >= 0.0) & (u < TRAINED_FOR.width) & (np.append(np.diff(v), 0.0) < 0.0)
    there, column = np.zeros(ROWS), np.zeros(ROWS)
    if seen.any():
        order = np.argsort(v[seen])
        found = np.interp(V, v[seen][order], u[seen][order], np.nan, np.nan)
        there = np.isfinite(found).astype(float)
        column = (np.nan_to_num(found) + 0.5) * COLUMNS / TRAINED_FOR.width - 0.5
    return Rows(there, column, np.full(ROWS, 0.5), np.ones(ROWS))


def lane(curvature: float, pitch: float = 0.0, aside: float = 0.0) -> tuple[Rows, Rows]:
    """Return the rows of both boundaries of a lane whose middle is `aside` to the left."""
    left, right = (rows_of(*bend(curvature, aside + side * WIDTH / 2.0), pitch) for side in (1, -1))
    return left, right


def route(curvature: float, aside: float = 0.0, step: float = 1.0) -> Course:
    """Return the planned route along the middle of that lane, with a point every `step` metres."""
    x, y = bend(curvature, aside, np.arange(-2.0, 50.0, step))
    course = Course.along([WayPoint(float(a), float(b), WIDTH) for a, b in zip(x, y, strict=True)])
    assert course is not None
    return course


NOTHING = Rows(np.zeros(ROWS), np.zeros(ROWS), np.ones(ROWS), np.ones(ROWS))


def expected(course: Course | None = None, tilt: Tilt = LEVEL) -> Expected:
    """Return what is known of a usual lane."""
    return Expected(tilt, WIDTH, 0.25, course=course)


def off(line: Line, curvature: float, aside: float, course: Course | None) -> float:
    """Return the largest distance of a line from a bend on the judged stretch, m."""
    found = line.at(STRETCH)
    x, y = (STRETCH, found) if course is None else course.points(STRETCH, found)
    true_x, true_y = bend(curvature, aside)
    return float(np.hypot(x[:, None] - true_x, y[:, None] - true_y).min(axis=1).max())


@pytest.mark.parametrize("pitch", [0.0, 0.02, -0.02])
def test_pixels_are_laid_on_the_ground_that_they_show(pitch: float) -> None:
    x, y = np.array([6.0, 12.0, 20.0]), np.array([1.75, -1.75, 0.3])
    u, v = TRAINED_FOR.project_ground(x, y, pitch)
    back_x, back_y = ground_of(u, v, pitch)
    assert back_x == pytest.approx(x)
    assert back_y == pytest.approx(y)


def test_pixels_over_the_horizon_show_no_ground() -> None:
    x, _ = ground_of(np.array([256.0]), np.array([10.0]), 0.0)
    assert np.isinf(x[0])


def test_a_row_tells_the_likeliest_of_two_lines() -> None:
    one = np.zeros((ROWS, COLUMNS + 1))
    one[:, 19:22] = 0.15, 0.3, 0.15
    one[:, 60] = 0.2
    one[:, -1] = 0.2
    rows = Rows.of(one)
    assert rows.column == pytest.approx(np.full(ROWS, 20.0))
    assert rows.alone == pytest.approx(np.full(ROWS, 0.75))
    assert rows.there == pytest.approx(np.full(ROWS, 0.8))
    assert (rows.spread > 15.0).all()


@given(
    curvature=st.sampled_from([0.0, 1 / 200, -1 / 200, 1 / 60, -1 / 60, 1 / 25, -1 / 25, 1 / 15, -1 / 15]),
    pitch=st.floats(-0.035, 0.035),
    aside=st.floats(-1.0, 1.0),
)
@settings(max_examples=60)
def test_along_the_route_the_lane_is_found_under_any_tilt(curvature: float, pitch: float, aside: float) -> None:
    course = route(curvature, aside)
    (left, right), tilt = lane_through(lane(curvature, pitch, aside), expected(course))
    assert tilt.pitch == pytest.approx(pitch, abs=math.radians(0.25))
    for line, side in ((left, WIDTH / 2.0), (right, -WIDTH / 2.0)):
        if line.in_view > 0.5:
            assert off(line, curvature, aside + side, course) < 0.2


@pytest.mark.parametrize("curvature", [0.0, 1 / 150, -1 / 60, 1 / 40, -1 / 40])
@pytest.mark.parametrize("pitch", [0.0, 0.02, -0.02])
def test_without_a_route_two_parallel_lines_determine_the_tilt(curvature: float, pitch: float) -> None:
    (left, right), tilt = lane_through(lane(curvature, pitch), expected())
    assert tilt.pitch == pytest.approx(pitch, abs=math.radians(0.25))
    assert tilt.deviation < math.radians(0.4)
    for line, side in ((left, WIDTH / 2.0), (right, -WIDTH / 2.0)):
        assert off(line, curvature, side, None) < 0.2


def test_a_lane_that_widens_is_taken_for_a_tilt_no_surer_than_tapers_allow() -> None:
    sides = [rows_of(AHEAD, sign * (WIDTH / 2.0 + 0.01 * AHEAD)) for sign in (1.0, -1.0)]
    _, tilt = lane_through((sides[0], sides[1]), expected())
    assert abs(tilt.pitch) < 3.0 * tilt.deviation


def test_one_straight_line_does_not_determine_the_tilt() -> None:
    left, _ = lane(0.0, pitch=0.01)
    (_, right), tilt = lane_through((left, NOTHING), expected())
    assert tilt.deviation > 0.7 * LEVEL.deviation
    assert right.at(12.0) == pytest.approx(-WIDTH / 2.0, abs=0.6)


def test_one_line_in_a_bend_determines_the_tilt_where_the_route_is_known() -> None:
    left, _ = lane(-1 / 25, pitch=0.01)
    _, tilt = lane_through((left, NOTHING), expected(route(-1 / 25)))
    assert tilt.pitch == pytest.approx(0.01, abs=math.radians(0.15))


def test_the_other_side_is_a_lanes_width_beside_the_one_that_is_seen() -> None:
    left, _ = lane(1 / 60, aside=0.4)
    (_, right), _ = lane_through((left, NOTHING), expected(route(1 / 60, 0.4)))
    assert off(right, 1 / 60, 0.4 - WIDTH / 2.0, route(1 / 60, 0.4)) < 0.3


def test_rows_that_show_another_line_count_less() -> None:
    left, right = lane(0.0)
    other = rows_of(AHEAD, np.full_like(AHEAD, 3.0))
    mixed = replace(left, column=np.where(np.arange(ROWS) % 3 == 0, other.column, left.column))
    (line, _), tilt = lane_through((mixed, right), expected(route(0.0)))
    assert np.abs(line.at(STRETCH) - WIDTH / 2.0).max() < 0.15
    assert abs(tilt.pitch) < math.radians(0.3)


def test_a_road_that_rises_ahead_by_the_map_is_no_tilt() -> None:
    rise = 0.0015 * AHEAD * AHEAD
    sides = [rows_of(AHEAD, np.full_like(AHEAD, side * WIDTH / 2.0), z=rise) for side in (1, -1)]
    points = [WayPoint(float(x), 0.0, WIDTH, 0.0015 * x * x) for x in range(-2, 50)]
    (left, right), tilt = lane_through((sides[0], sides[1]), expected(Course.along(points)))
    assert abs(tilt.pitch) < math.radians(0.1)
    assert left.at(STRETCH) == pytest.approx(np.full(len(STRETCH), WIDTH / 2.0), abs=0.05)
    assert right.at(STRETCH) == pytest.approx(np.full(len(STRETCH), -WIDTH / 2.0), abs=0.05)


def test_a_remembered_boundary_stays_while_it_is_out_of_the_picture() -> None:
    course = route(0.0)
    remembered = replace(expected(course), offsets=(2.4, None), width_deviation=5.0)
    (left, _), _ = lane_through((NOTHING, NOTHING), remembered)
    assert left.at(0.0) == pytest.approx(2.4, abs=0.05)
    (forgotten, _), _ = lane_through((NOTHING, NOTHING), expected(course))
    assert forgotten.at(0.0) == pytest.approx(WIDTH / 2.0, abs=0.05)
    assert forgotten.uncertain > left.uncertain


def test_a_tilt_that_is_given_stays() -> None:
    _, tilt = lane_through(lane(0.0, pitch=0.02), expected(tilt=Tilt(0.005, 1e-5)))
    assert tilt.pitch == pytest.approx(0.005, abs=1e-5)


@pytest.mark.parametrize("curvature", [1 / 12, -1 / 12])
def test_the_inner_boundary_of_a_sharp_bend_leaves_the_picture(curvature: float) -> None:
    (left, right), _ = lane_through(lane(curvature), expected(route(curvature)))
    inner, outer = (left, right) if curvature > 0.0 else (right, left)
    assert inner.in_view < outer.in_view < 1.0


@pytest.mark.parametrize("curvature", [0.0, 1 / 50, -1 / 20])
@pytest.mark.parametrize("known", [True, False])
def test_an_error_of_the_tilt_moves_what_is_seen_of_a_boundary_by_its_lever(curvature: float, known: bool) -> None:
    course, error = route(curvature, step=0.05) if known else None, 1e-4
    for line in lane_through(lane(curvature), expected(course, Tilt(0.0, 1e-6)))[0]:
        x, y = (STRETCH, line.at(STRETCH)) if course is None else course.points(STRETCH, line.at(STRETCH))
        off = []
        for pitch in (0.0, error):
            seen = ground_of(*TRAINED_FOR.project_ground(x, y), pitch)
            s, t = seen if course is None else course.place(*seen)
            off.append(t - line.at(s))
        assert np.abs(off[1] - off[0]).max() / error == pytest.approx(line.lever, rel=0.05)


@given(
    seed=st.integers(0, 10_000),
    curvature=st.one_of(st.none(), st.sampled_from([0.0, 0.01, -0.05, 0.1, -0.2, 0.4])),
    rise=st.floats(-0.1, 0.1),
    width=st.floats(0.5, 12.0),
    scale=st.floats(0.3, 3.0),
)
@settings(max_examples=80, deadline=None)
def test_all_rows_give_numbers(seed: int, curvature: float | None, rise: float, width: float, scale: float) -> None:
    draw = np.random.default_rng(seed)
    there = [draw.uniform(0.0, 1.0, ROWS) * draw.integers(0, 2) for _ in range(2)]
    left, right = (
        Rows(one, draw.uniform(0.0, COLUMNS - 1.0, ROWS), draw.uniform(0.0, 40.0, ROWS), draw.uniform(0.0, 1.0, ROWS))
        for one in there
    )
    course = None
    if curvature is not None:
        ahead = np.arange(-2.0, 50.0)
        points = zip(*bend(curvature, 0.3, ahead), ahead, strict=True)
        course = Course.along([WayPoint(float(x), float(y), width, rise * float(s), rise) for x, y, s in points])
    lines, tilt = lane_through((left, right), Expected(LEVEL, width, 0.25, (0.4, None), course, scale))
    for line in lines:
        assert np.isfinite([*line.curve, *line.s, *line.off, *line.deviation]).all()
        assert math.isfinite(line.lever)
        assert line.uncertain > 0.0
        assert 0.0 <= line.in_view <= 1.0
    assert abs(tilt.pitch) <= math.radians(4.0) + 1e-9
    assert 0.0 < tilt.deviation <= LEVEL.deviation
