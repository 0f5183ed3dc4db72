"""Where vehicles can start on a map."""

from __future__ import annotations

import pytest

from scenario_compiler.carla_server.towns import AHEAD, generate_town
from tests.perception.test_terrain import tilted


def test_the_lane_goes_on_from_where_vehicles_start() -> None:
    """A Traffic Manager destroys a vehicle at the end of a lane in its second step."""
    points = generate_town(tilted(0.0, 0.0)).spawn_points
    lengths = [200.0 - point.x if abs(point.yaw) < 1.0 else point.x for point in points]
    assert len(lengths) > 20
    assert min(lengths) >= AHEAD


@pytest.mark.parametrize("length", [4, 25])
def test_a_map_of_short_lanes_has_places_too(length: int) -> None:
    text = tilted(0.0, 0.0).replace('length="200"', f'length="{length}"')
    assert generate_town(text).spawn_points
