from __future__ import annotations

import math
from pathlib import Path

import pytest

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.roads import LanePosition
from scenario_compiler.roads.lanes import lane_at, lane_direction
from tests.roads.make import lane, network, road, section

WIDE = '<width sOffset="0" a="4" b="0" c="0" d="0"/>'
GROWING = '<width sOffset="0" a="0" b="0.05" c="0" d="0"/>'
MARK = '<roadMark sOffset="0" type="{}" color="{}" width="0.2">{}</roadMark>'


def test_centres_borders_and_slope(tmp_path: Path) -> None:
    offset = '<laneOffset s="0" a="1" b="0" c="0" d="0"/>'
    made = network(tmp_path, road(lanes=offset + section(lane(1), lane(-1, GROWING) + lane(-2, WIDE))))
    assert [(at.lane, at.t_left, at.t_right) for at in made.lanes_at("1", 40.0)] == [
        (1, 4.5, 1.0),
        (-1, 1.0, -1.0),
        (-2, -1.0, -5.0),
    ]
    pose = made.lane_pose("1", -2, 40.0)
    assert pose.y == pytest.approx(-3.0)
    assert pose.heading == pytest.approx(math.tau - math.atan(0.05))


def test_a_pose_outside_the_road_is_a_value_error(tmp_path: Path) -> None:
    made = network(tmp_path, road())
    assert made.lane_pose("1", -1, 100.0 + 1e-9).x == 100.0
    for place in (("2", -1, 1.0), ("1", -1, 101.0), ("1", -1, -0.1), ("1", -2, 1.0), ("1", -1, math.nan)):
        with pytest.raises(ValueError, match="road"):
            made.lane_pose(*place)


@pytest.mark.parametrize(("rule", "expected"), [("RHT", 1), ("LHT", -1)])
def test_direction_follows_the_rule(tmp_path: Path, rule: str, expected: int) -> None:
    n = network(tmp_path, road(attributes=f'junction="-1" rule="{rule}"')).tables
    assert (lane_direction(n, 0, -1, 0.0), lane_direction(n, 0, 1, 0.0)) == (expected, -expected)


def test_a_reversed_lane_goes_the_other_way(tmp_path: Path) -> None:
    other = '<lane id="-2" type="driving" direction="reversed">' + WIDE + "</lane>"
    n = network(tmp_path, road(lanes=section("", lane(-1) + other))).tables
    assert (lane_direction(n, 0, -1, 0.0), lane_direction(n, 0, -2, 0.0)) == (1, -1)


def test_borders_stand_for_widths(tmp_path: Path) -> None:
    inner = '<border sOffset="0" a="-3" b="-0.01" c="0" d="0"/><border sOffset="50" a="-3.5" b="0" c="0" d="0"/>'
    lanes = section("", lane(-1, inner) + lane(-2, '<border sOffset="0" a="-7" b="0" c="0" d="0"/>'))
    made = network(tmp_path, road(lanes=lanes))
    assert made.lane_width("1", -1, 20.0) == pytest.approx(3.2)
    assert made.lane_width("1", -2, 20.0) == pytest.approx(3.8)
    assert made.lane_width("1", -2, 80.0) == pytest.approx(3.5)


def test_one_sided_sections_leave_the_other_side_as_it_was(tmp_path: Path) -> None:
    lanes = section(lane(1, WIDE), lane(-1)) + section("", lane(-1) + lane(-2), s=60.0, attributes='singleSide="true"')
    made = network(tmp_path, road(lanes=lanes))
    assert [at.lane for at in made.lanes_at("1", 80.0)] == [1, -1, -2]
    assert made.lane_width("1", 1, 80.0) == 4.0
    assert made.next(LanePosition("1", 1, 90.0), 80.0) == LanePosition("1", 1, 10.0)


def test_two_one_sided_sections_may_start_at_the_same_place(tmp_path: Path) -> None:
    """The right side has one section, the left one two; the second of the first pair was left out."""
    one = 'singleSide="true"'
    first = section(lane(1), attributes=one) + section("", lane(-1) + lane(-2), attributes=one)
    made = network(tmp_path, road(lanes=first + section(lane(1, WIDE), "", 50.0, one)))
    assert [[at.lane for at in made.lanes_at("1", s)] for s in (20.0, 80.0)] == [[1, -1, -2], [1, -1, -2]]
    assert [made.lane_width("1", 1, s) for s in (20.0, 80.0)] == [3.5, 4.0]
    assert made.next(LanePosition("1", -2, 40.0), 20.0) == LanePosition("1", -2, 60.0)
    again = section("", lane(-1), 50.0, one) + section(lane(1, WIDE), "", 50.0, one)
    made = network(tmp_path, road(lanes=section(lane(1), lane(-1) + lane(-2)) + again))
    assert [at.lane for at in made.lanes_at("1", 80.0)] == [1, -1]
    assert made.lane_width("1", 1, 80.0) == 4.0


def test_lane_sections_are_sorted(tmp_path: Path) -> None:
    """Of two sections in the wrong order the first was taken for the start of the road, and the second left out."""
    made = network(tmp_path, road(lanes=section(lane(1, WIDE), lane(-1), 50.0) + section(lane(1), lane(-1))))
    assert [made.lane_width("1", 1, s) for s in (20.0, 80.0)] == [3.5, 4.0]


def test_negative_widths_count_as_zero(tmp_path: Path) -> None:
    shrinking = '<width sOffset="0" a="1" b="-0.1" c="0" d="0"/>'
    made = network(tmp_path, road(lanes=section("", lane(-1, shrinking) + lane(-2, WIDE))))
    assert made.lane_width("1", -1, 50.0) == 0.0
    assert made.lane_pose("1", -2, 50.0).y == -2.0
    assert made.lane_pose("1", -2, 50.0).heading == 0.0


def test_the_outer_lane_has_the_border(tmp_path: Path) -> None:
    n = network(tmp_path, road(lanes=section(lane(1), lane(-1) + lane(-2)))).tables
    assert [lane_at(n, 0, 10.0, t) for t in (3.6, 3.5, 0.0, -0.1, -3.5, -7.0, -7.1)] == [0, 1, 1, -1, -2, -2, 0]


def test_speed_limits_of_lanes_go_before_the_roads(tmp_path: Path) -> None:
    limited = lane(-1, WIDE + '<speed sOffset="50" max="36" unit="km/h"/>')
    more = '<type s="0" type="town"><speed max="50" unit="mph"/></type><type s="80" type="motorway"/>'
    made = network(tmp_path, road(lanes=section(lane(1), limited), more=more))
    assert made.speed_limit("1", 1, 10.0) == pytest.approx(22.352)
    assert made.speed_limit("1", -1, 60.0) == pytest.approx(10.0)
    assert made.speed_limit("1", 1, 90.0) is None
    assert made.road("1").type == "town"


def test_marks_and_their_quality(tmp_path: Path) -> None:
    data = '<userData code="marking_quality" value="0.3"/>'
    marked = lane(-1, WIDE + MARK.format("solid", "yellow", data))
    made = network(tmp_path, road(lanes=section("", marked, centre=MARK.format("broken", "white", ""))))
    outer, inner = made.marks("1", -1, 10.0)
    assert outer is not None
    assert inner is not None
    assert (outer.type, outer.colour, outer.width, outer.quality, outer.lane_change) == (
        *("solid", "yellow", 0.2, 0.3),
        "none",
    )
    assert (inner.type, inner.quality, inner.lane_change) == ("broken", 1.0, "both")


def test_unusable_lanes_are_reported_and_left_out(tmp_path: Path) -> None:
    sink = Diagnostics()
    lanes = section(
        lane(1) + lane(1) + lane(-3) + lane(1 << 20), '<lane id="x" type="lorry"/>' + lane(-1, kind="lorry")
    )
    made = network(tmp_path, road(lanes=lanes), sink=sink)
    assert [at.lane for at in made.lanes_at("1", 1.0)] == [1, -1]
    assert sorted({d.code.id for d in sink}) == ["SC305", "SC310", "SC312"]
