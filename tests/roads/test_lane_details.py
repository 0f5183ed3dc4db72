"""Access, rules and material of lanes are kept as they were filed."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenario_compiler.roads.lane_details import LaneAccess, LaneMaterial, LaneRule, LaneVisibility
from tests.roads.make import lane, network, road, section

WIDTH = '<width sOffset="0" a="3.5" b="0" c="0" d="0"/>'
FULL = (
    WIDTH
    + '<material sOffset="0" friction="0.9" roughness="0.01" surface="asphalt"/><material sOffset="30" friction="0.4"/>'
    + '<visibility sOffset="0" forward="100" back="50" left="5" right="6"/>'
    + '<access sOffset="0" rule="deny" restriction="bus"/><access sOffset="0" rule="deny" restriction="taxi"/>'
    + '<access sOffset="40" rule="allow"><restriction type="trucks"/><restriction type="delivery"/></access>'
    + '<rule sOffset="10" value="no stopping at any time"/><userData code="a" value="b"/>'
)


def test_records_are_kept(tmp_path: Path) -> None:
    made = network(tmp_path, road(lanes=section(lane(1), lane(-1)) + section(lane(1), lane(-1, FULL), s=20.0)))
    assert made.lane_details("1", -1, 10.0) is None
    assert made.lane_details("1", 1, 30.0) is None
    details = made.lane_details("1", -1, 30.0)
    assert details is not None
    assert (details.s_from, details.lane) == (20.0, -1)
    assert details.materials == (LaneMaterial(20.0, 0.9, 0.01, "asphalt"), LaneMaterial(50.0, 0.4, None, ""))
    assert details.rules == (LaneRule(30.0, "no stopping at any time"),)
    assert details.visibility == (LaneVisibility(20.0, 100.0, 50.0, 5.0, 6.0),)
    assert details.user_data == (("a", "b"),)
    assert made.model().lanes == (details,)


def test_access_at_a_place_is_that_of_the_last_station_before_it(tmp_path: Path) -> None:
    details = network(tmp_path, road(lanes=section(lane(1), lane(-1, FULL)))).lane_details("1", -1, 5.0)
    assert details is not None
    assert details.access_at(39.9) == (LaneAccess(0.0, "deny", ("bus",)), LaneAccess(0.0, "deny", ("taxi",)))
    assert details.access_at(40.0) == (LaneAccess(40.0, "allow", ("trucks", "delivery")),)


def test_a_side_that_a_section_leaves_as_it_is_keeps_its_details(tmp_path: Path) -> None:
    one_sided = section(lane(1, FULL), "", s=50.0, attributes='singleSide="true"')
    made = network(tmp_path, road(lanes=section(lane(1), lane(-1, FULL)) + one_sided))
    kept = made.lane_details("1", -1, 80.0)
    assert kept is not None
    assert (kept.s_from, kept.s_to) == (0.0, float("inf"))
    left = made.lane_details("1", 1, 80.0)
    assert left is not None
    assert left.s_from == 50.0


def test_the_state_of_a_lane_of_1_8_is_kept(tmp_path: Path) -> None:
    state = '<lane advisory="inner" dynamicLaneDirection="true" dynamicLaneType="false" roadWorks="1" id="-1"'
    lanes = section(lane(1), lane(-1)).replace('<lane id="-1"', state)
    details = network(tmp_path, road(lanes=lanes)).lane_details("1", -1, 0.0)
    assert details is not None
    assert (details.advisory, details.dynamic_direction, details.dynamic_type) == ("inner", True, False)
    assert details.road_works


def test_only_places_on_the_road_are_allowed(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="outside road 1"):
        network(tmp_path, road()).lane_details("1", -1, 500.0)
