"""The planned route is looked at from beside the camera, along its own length."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from scenario_compiler.perception.route_ahead import WayPoint, stretch_of, turn_of, without_folds
from tests.perception.test_planned_way import way


def test_the_compared_stretch_is_measured_along_the_route() -> None:
    bend = way(0.0, 1.0 / 10.0)
    assert len(stretch_of(bend)) == len(stretch_of(way(40.0, 0.0))) == 13
    assert max(point.x for point in stretch_of(bend)) < 11.0


@pytest.mark.parametrize(("begin", "radius", "turn"), [(40.0, 10.0, 0.0), (0.0, 50.0, 17 / 50), (9.0, -20.0, -8 / 20)])
def test_a_route_turns_by_what_its_heading_changes_up_to_18_metres_ahead(
    begin: float, radius: float, turn: float
) -> None:
    assert turn_of(way(begin, 1.0 / radius)) == pytest.approx(turn)


@pytest.mark.parametrize("turned", [0.2, 0.5])
def test_a_lane_that_goes_back_at_a_corner_of_its_road_leads_on(turned: float) -> None:
    """Points of the middle of a lane 3 m to the inner side of a corner, one for each metre of the reference line."""
    before = [WayPoint(float(s), 3.0) for s in range(11)]
    sine, cosine = math.sin(turned), math.cos(turned)
    after = [WayPoint(10.5 + s * cosine - 3.0 * sine, s * sine + 3.0 * cosine) for s in np.arange(0.5, 10.0)]
    assert after[0].x < before[-1].x + 0.5
    kept = without_folds([*before, *after])
    headings = [math.atan2(b.y - a.y, b.x - a.x) for a, b in pairwise(kept)]
    assert kept[0] == before[0]
    assert kept[-1] == after[-1]
    assert all(-0.01 < heading < turned + 0.2 for heading in headings)


def test_a_route_without_corners_is_kept_as_it_is() -> None:
    for route in (way(0.0, 1.0 / 4.0), way(5.0, -1.0 / 12.0)):
        assert without_folds(route) == list(route)
