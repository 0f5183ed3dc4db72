"""Along the planned route a lane is straight, however the road bends; only the route's shape is used."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenario_compiler.perception.course import Course
from scenario_compiler.perception.route_ahead import WayPoint

S = np.array([0.0, 3.0, 6.0, 9.0, 12.0, 15.0, 18.0])


def arc(radius: float, aside: float = 0.0, begin: float = -2.0) -> list[WayPoint]:
    """Return the points of a route, a metre apart, that passes the camera `aside` to the left in an arc."""
    angles = [(begin + k) / radius for k in range(40)]
    return [WayPoint((radius - aside) * math.sin(a), radius - (radius - aside) * math.cos(a)) for a in angles]


@pytest.mark.parametrize("aside", [-3.0, 0.0, 1.2])
@pytest.mark.parametrize("radius", [-40.0, -18.0, 18.0, 40.0])
def test_points_beside_the_route_lie_on_the_parallel_line_through_the_camera(radius: float, aside: float) -> None:
    course = Course.along(arc(radius, aside))
    assert course is not None
    for t in (-1.75, 0.0, 1.75):
        x, y = course.points(S, np.full_like(S, t))
        assert np.abs(np.hypot(x, y - radius) - (abs(radius) - math.copysign(1.0, radius) * t)).max() < 0.05
    assert course.bend == pytest.approx(1.0 / (radius - aside), rel=0.02)


@given(
    radius=st.sampled_from([-60.0, -25.0, 25.0, 60.0]),
    offset=st.floats(-2.5, 2.5),
    slope=st.floats(-0.05, 0.05),
    curvature=st.floats(-0.02, 0.02),
)
def test_a_parabola_crosses_the_normals_where_its_points_are(
    radius: float, offset: float, slope: float, curvature: float
) -> None:
    course = Course.along(arc(radius))
    assert course is not None
    bent = curvature + 1.0 / radius
    x, y = course.points(S, course.across(S, (offset, slope, bent)))
    assert np.abs(y - (offset + slope * x + 0.5 * bent * x * x)).max() < 1e-3


def test_the_ground_beyond_the_centre_of_a_bend_is_not_viewed() -> None:
    course = Course.along(arc(6.0))
    assert course is not None
    seen = np.isfinite(course.points(np.array(6.0), np.array([-3.0, 0.0, 3.0, 5.5, 7.0]))[0])
    assert seen.tolist() == [True, True, True, False, False]


def test_a_tilt_moves_the_route_sideways_in_a_bend_only() -> None:
    straight, bend = (Course.along(arc(radius)) for radius in (1e6, 30.0))
    assert straight is not None
    assert bend is not None
    height, tilt = 1.3, 1e-4
    beside = np.zeros_like(S)
    assert np.abs(straight.lever(S, beside, beside, height)).max() < 1e-2
    x, y = bend.points(S, beside)
    heading = bend.heading_at(S)
    shrunk = tilt * x / height
    aside = shrunk * (x * np.sin(heading) - y * np.cos(heading))
    assert bend.lever(S, beside, beside, height) * tilt == pytest.approx(aside)


def test_distances_from_the_route_follow_the_width_of_the_lane() -> None:
    """A lane that becomes narrower is straight along the route, like one of constant width."""
    course = Course.along([WayPoint(float(k), 0.5, 4.0 - 0.05 * k) for k in range(-3, 37)])
    assert course is not None
    assert course.width == pytest.approx(3.5)
    for side in (-1.0, 1.0):
        x, y = course.points(S, np.full_like(S, 0.5 + side * 1.75))
        assert y == pytest.approx(0.5 + side * (2.0 - 0.025 * x))


def test_a_lane_that_begins_has_no_width_to_expect() -> None:
    course = Course.along([WayPoint(float(k), 0.0, 0.15 * max(k, 0)) for k in range(-3, 37)])
    assert course is not None
    assert course.width is None
    assert course.points(S, np.full_like(S, 1.0))[1] == pytest.approx(1.0)


def test_the_road_rises_along_the_route_and_to_its_side() -> None:
    course = Course.along([WayPoint(float(k), 1.0, 3.5, -0.04 * max(k, 0), 0.02) for k in range(-3, 37)])
    assert course is not None
    assert course.height(S, np.full_like(S, 1.0)) == pytest.approx(-0.04 * S)
    assert course.height(S, np.full_like(S, 3.0)) == pytest.approx(-0.04 * S + 0.04)
    assert course.grade == pytest.approx(0.04)


@pytest.mark.parametrize("radius", [-40.0, -12.0, 12.0, 40.0])
@pytest.mark.parametrize("t", [-2.5, 0.0, 2.5])
def test_points_have_the_place_along_the_route_at_which_they_are_seen(radius: float, t: float) -> None:
    course = Course.along(arc(radius, 0.7))
    assert course is not None
    x, y = course.points(S, np.full_like(S, t))
    back_s, back_t = course.place(x, y)
    assert back_s == pytest.approx(S, abs=0.1)
    assert back_t == pytest.approx(np.full_like(S, t), abs=0.03)
