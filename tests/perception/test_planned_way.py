"""A boundary keeps its probability if it follows the planned route, and loses it where the route turns away."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from scenario_compiler.perception.course import Course
from scenario_compiler.perception.lane_detector import Boundary
from scenario_compiler.perception.planned_way import worth_on_way
from scenario_compiler.perception.route_ahead import WayPoint

STRAIGHT = Boundary(1.75, 0.0, 0.0, 0.9, 0.9, 0.9, (5.0, 25.0))


def way(begin: float, curvature: float, aside: float = 0.0) -> list[WayPoint]:
    """Return a way of points a metre apart, straight for `begin` metres and then with a curvature, 1/m."""
    points = [WayPoint(0.0, aside)]
    heading = 0.0
    for k in range(40):
        x, y = points[-1][:2]
        points.append(WayPoint(x + math.cos(heading), y + math.sin(heading)))
        heading += curvature if k >= begin else 0.0
    return points


def test_a_boundary_along_the_route_keeps_its_probability() -> None:
    assert worth_on_way(STRAIGHT, way(40.0, 0.0)) == 1.0
    bend = replace(STRAIGHT, curvature=1.0 / 80.0)
    assert worth_on_way(bend, way(0.0, 1.0 / 80.0)) == 1.0


@pytest.mark.parametrize("sense", [-1.0, 1.0])
def test_a_straight_boundary_loses_probability_as_the_routes_turn_comes_nearer(sense: float) -> None:
    worth = [worth_on_way(STRAIGHT, way(begin, sense / 8.0)) for begin in (20, 13, 12, 11, 10, 9, 4)]
    assert worth == sorted(worth, reverse=True)
    assert worth[0] == 1.0
    assert worth[-1] == 0.0
    assert len(set(worth)) > 3


def test_a_boundary_that_leaves_a_straight_route_loses_probability() -> None:
    assert worth_on_way(replace(STRAIGHT, curvature=1.0 / 40.0), way(40.0, 0.0)) < 0.6


@pytest.mark.parametrize("aside", [-3.0, 0.7])
def test_the_lateral_position_of_the_route_is_not_used(aside: float) -> None:
    for begin in (40, 11):
        assert worth_on_way(STRAIGHT, way(begin, 0.125, aside)) == worth_on_way(STRAIGHT, way(begin, 0.125))


@pytest.mark.parametrize(
    "known", [[], [WayPoint(0.0, 0.0)], way(40.0, 0.0)[:5], [WayPoint(-float(k), 0.0) for k in range(20)]]
)
def test_without_a_route_on_the_stretch_the_probability_is_kept(known: list[WayPoint]) -> None:
    assert worth_on_way(STRAIGHT, known) == 1.0
    assert Course.along(known) is None


@pytest.mark.parametrize("offset", [-1.75, 1.75])
@pytest.mark.parametrize("radius", [-18.0, 18.0, 30.0])
def test_both_boundaries_of_a_sharp_bend_keep_their_probability(radius: float, offset: float) -> None:
    route = way(0.0, 1.0 / radius)
    x = [x - offset * math.sin(k / radius) for k, (x, *_) in enumerate(route)][5:20]
    y = [y + offset * math.cos(k / radius) for k, (_, y, *_) in enumerate(route)][5:20]
    half, slope, y0 = np.polyfit(x, y, 2).tolist()
    assert worth_on_way(replace(STRAIGHT, y0=y0, slope=slope, curvature=2.0 * half), route) == 1.0


@pytest.mark.parametrize("radius", [-12.0, 12.0, 40.0])
def test_along_a_course_a_boundary_is_compared_with_the_route_itself(radius: float) -> None:
    route = way(0.0, 1.0 / radius)
    along = replace(STRAIGHT, course=Course.along(route))
    assert worth_on_way(along, route) == 1.0
    assert worth_on_way(replace(along, slope=0.3), route) < 0.6
