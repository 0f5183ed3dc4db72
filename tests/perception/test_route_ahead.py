"""The planned route is looked at from beside the camera, along its own length."""

from __future__ import annotations

import pytest

from scenario_compiler.perception.route_ahead import stretch_of, turn_of
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
