"""The automation uses the planned route near junctions and in sharp bends."""

from __future__ import annotations

import math

from scenario_compiler.perception.route_ahead import known_way, stretch_of
from tests.perception.test_planned_way import way


def test_the_route_is_used_near_junctions_and_in_sharp_bends() -> None:
    assert not known_way(way(40.0, 0.0), math.inf)
    assert not known_way(way(0.0, 1.0 / 150.0), math.inf)
    assert not known_way(way(0.0, 0.0), 18.5)
    for route, junction in ((way(40.0, 0.0), 17.5), (way(0.0, 1.0 / 50.0), math.inf), (way(12.0, -0.05), math.inf)):
        assert list(known_way(route, junction)) == route


def test_the_compared_stretch_is_measured_along_the_route() -> None:
    bend = way(0.0, 1.0 / 10.0)
    assert len(stretch_of(bend)) == len(stretch_of(way(40.0, 0.0))) == 13
    assert max(x for x, _ in stretch_of(bend)) < 11.0
