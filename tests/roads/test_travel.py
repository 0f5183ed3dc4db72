"""Links, moving along lanes, routes and topology on a small junction.

Road 1 leads along x to a junction at (100, 0); road 2 goes straight on, road 3 turns left. A lane of road 2 tapers.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.roads import LanePosition, Leg, Network
from scenario_compiler.roads.travel import advance, distance_to_lane_end
from tests.roads.make import lane, network, road, section

WIDTH = '<width sOffset="0" a="3.5" b="0" c="0" d="0"/>'
BOTH = '<link><predecessor id="{0}"/><successor id="{0}"/></link>'


def at(x: float, y: float, h: float, length: float, shape: str = "<line/>") -> str:
    return f'<geometry s="0" x="{x}" y="{y}" hdg="{h}" length="{length}">{shape}</geometry>'


def linked(kind: str, number: str, contact: str = "") -> str:
    target = "junction" if not contact else "road"
    point = f' contactPoint="{contact}"' if contact else ""
    return f'<{kind} elementType="{target}" elementId="{number}"{point}/>'


def two_lanes(first: str = "", second: str = "") -> str:
    mark = '<roadMark sOffset="0" type="{}"/>'
    inside = lane(-1, first + WIDTH + mark.format("broken")) + lane(-2, second + WIDTH + mark.format("solid"))
    return section(lane(1), inside)


def connecting(number: str, plan: str, length: float, goal: str, lane_id: int) -> str:
    link = linked("predecessor", "1", "end") + linked("successor", goal, "start")
    lanes = section("", lane(-1, f'<link><predecessor id="{lane_id}"/><successor id="{lane_id}"/></link>' + WIDTH))
    return road(number, length, plan, lanes, link, 'junction="J"')


def connection(number: str, to: str, lane_id: int) -> str:
    return (
        f'<connection id="{number}" incomingRoad="1" connectingRoad="{to}" contactPoint="start">'
        f'<laneLink from="{lane_id}" to="-1"/></connection>'
    )


@pytest.fixture
def made(tmp_path: Path) -> Network:
    taper = '<width sOffset="0" a="3.5" b="0" c="0" d="0"/><width sOffset="40" a="3.5" b="-0.1" c="0" d="0"/>'
    second = section(lane(1), lane(-1) + lane(-2, taper))
    return network(
        tmp_path,
        road("1", 100.0, at(0, 0, 0, 100), two_lanes(), linked("successor", "J")),
        connecting("12", at(100, 0, 0, 20), 20.0, "2", -1),
        connecting("13", at(100, 0, 0, 15.7, '<arc curvature="0.1"/>'), 15.7, "3", -1),
        connecting("22", at(100, 0, 0, 20), 20.0, "2", -2),
        road("2", 100.0, at(120, 0, 0, 100), second, linked("predecessor", "J")),
        road("3", 50.0, at(110, 10, 1.57, 50), "", linked("predecessor", "J")),
        '<junction id="J">' + connection("0", "13", -1) + connection("1", "12", -1) + connection("2", "22", -2),
        "</junction>",
    )


def test_the_straightest_exit_is_taken_without_a_preference(made: Network) -> None:
    n = made.tables
    index = made.road_index
    assert advance(n, index("1"), -1, 99.0, 2.0, -1) == (index("12"), -1, 1.0, 0.0)
    assert advance(n, index("1"), -1, 99.0, 2.0, index("13")) == (index("13"), -1, 1.0, 0.0)
    assert advance(n, index("3"), 1, 1.0, 2.0, -1) == (index("3"), 1, 0.0, 1.0)


def test_advance_goes_over_junctions_and_back(made: Network) -> None:
    n, index = made.tables, made.road_index
    assert advance(n, index("1"), -1, 90.0, 40.0, -1) == (index("2"), -1, 10.0, 0.0)
    assert advance(n, index("2"), -1, 10.0, -40.0, -1) == (index("1"), -1, 90.0, 0.0)
    road_id, lane_id, s, left = advance(n, index("1"), -1, 90.0, 100.0, index("13"))
    assert (road_id, lane_id, s) == (index("3"), -1, 50.0)
    assert left == pytest.approx(100.0 - 10.0 - 15.7 - 50.0)


def test_next_and_previous_keep_the_offset(made: Network) -> None:
    start = LanePosition("1", -1, 95.0, 0.4)
    ahead = made.next(start, 30.0)
    assert ahead == LanePosition("2", -1, 5.0, 0.4)
    assert made.previous(ahead, 30.0) == start
    assert made.next(start, 1000.0) is None


def test_left_and_right_are_seen_by_the_traveller(made: Network) -> None:
    assert made.left(LanePosition("1", -2, 5.0)) == LanePosition("1", -1, 5.0)
    assert made.left(LanePosition("1", -1, 5.0)) == LanePosition("1", 1, 5.0)
    assert made.left(LanePosition("1", 1, 5.0)) == LanePosition("1", -1, 5.0)
    assert made.right(LanePosition("1", -2, 5.0)) is None


def test_a_tapering_lane_ends_where_it_is_too_narrow(made: Network) -> None:
    n, index = made.tables, made.road_index
    assert distance_to_lane_end(n, index("1"), -2, 50.0, 500.0, -1) == pytest.approx(50 + 20 + 40 + 15, abs=0.02)
    assert distance_to_lane_end(n, index("1"), -2, 50.0, 30.0, -1) == 30.0
    assert distance_to_lane_end(n, index("1"), -1, 50.0, 500.0, -1) == 170.0


def test_a_route_changes_lanes_only_where_it_must(made: Network) -> None:
    route = made.route(LanePosition("1", -2, 10.0), LanePosition("3", -1, 20.0))
    assert route is not None
    assert route.lane_changes == 1
    assert route.length == pytest.approx(90.0 + 15.7 + 20.0)
    assert [(leg.road, leg.lane, leg.changes_lane) for leg in route.legs] == [
        ("1", -2, False),
        ("1", -1, True),
        ("13", -1, False),
        ("3", -1, False),
    ]
    straight = made.route(LanePosition("1", -1, 10.0), LanePosition("2", -1, 20.0))
    assert straight is not None
    assert (straight.lane_changes, straight.length) == (0, 130.0)


def test_no_route_leads_backwards(made: Network) -> None:
    assert made.route(LanePosition("1", -1, 50.0), LanePosition("1", -1, 20.0)) is None
    assert made.route(LanePosition("3", -1, 1.0), LanePosition("1", -1, 20.0)) is None
    with pytest.raises(ValueError, match="no lane 5"):
        made.route(LanePosition("1", 5, 1.0), LanePosition("1", -1, 20.0))


def test_a_route_crosses_a_forbidding_mark_only_when_nothing_else_leads_there(tmp_path: Path) -> None:
    solid = section("", lane(-1, WIDTH + '<roadMark sOffset="0" type="solid"/>') + lane(-2))
    part = section("", lane(-1, WIDTH + '<roadMark sOffset="0" type="broken" laneChange="both"/>') + lane(-2), s=50.0)
    start, goal = LanePosition("1", -1, 0.0), LanePosition("1", -2, 90.0)
    route = network(tmp_path, road(lanes=solid + part)).route(start, goal)
    assert route is not None
    assert route.legs[0].s_to == 50.0
    route = network(tmp_path, road(lanes=solid)).route(start, goal)
    assert route is not None
    assert route.legs[0].s_to == 0.0


def test_topology_pairs_entries(made: Network) -> None:
    pairs = made.topology()
    assert (LanePosition("1", -1, 0.0), LanePosition("13", -1, 0.0)) in pairs
    assert (LanePosition("22", -1, 0.0), LanePosition("2", -2, 0.0)) in pairs
    assert len(pairs) == 6


def test_a_direct_junction_joins_the_roads_themselves(tmp_path: Path) -> None:
    direct = (
        '<junction id="J" type="direct"><connection id="0" incomingRoad="1" linkedRoad="2" contactPoint="start">'
        '<laneLink from="-2" to="-1"/></connection></junction>'
    )
    made = network(
        tmp_path,
        road("1", 100.0, at(0, 0, 0, 100), two_lanes(), linked("successor", "J")),
        road("2", 100.0, at(100, -3.5, 0, 100), "", linked("predecessor", "J")),
        direct,
    )
    assert made.next(LanePosition("1", -2, 90.0), 30.0) == LanePosition("2", -1, 20.0)
    assert made.next(LanePosition("1", -1, 90.0), 30.0) is None


def test_roads_that_meet_head_on_turn_the_lane_ids_round(tmp_path: Path) -> None:
    turned = section(lane(1, BOTH.format(-1)), lane(-1, BOTH.format(1)))
    made = network(
        tmp_path,
        road("1", 100.0, at(0, 0, 0, 100), turned, linked("successor", "2", "end")),
        road("2", 100.0, at(200, 0, 3.14159265, 100), "", linked("successor", "1", "end")),
    )
    assert made.next(LanePosition("1", -1, 90.0), 30.0) == LanePosition("2", 1, 80.0)
    assert made.next(LanePosition("1", -1, 90.0, 1.0), 30.0) == LanePosition("2", 1, 80.0, -1.0)
    assert made.previous(LanePosition("1", 1, 90.0, 1.0), 30.0) == LanePosition("2", -1, 80.0, -1.0)


def test_a_lane_may_be_reversed_in_one_section_only(tmp_path: Path) -> None:
    turned = lane(-1).replace("<lane ", '<lane direction="reversed" ')
    made = network(tmp_path, road(lanes=section("", lane(-1)) + section("", turned, 50.0)))
    assert made.next(LanePosition("1", -1, 90.0), 10.0) == LanePosition("1", -1, 80.0)
    assert made.next(LanePosition("1", -1, 40.0), 20.0) is None
    end = made.next(LanePosition("1", -1, 40.0), 10.0)
    assert end is not None
    assert 49.99 < end.s < 50.0
    there = made.route(LanePosition("1", -1, 90.0), LanePosition("1", -1, 60.0))
    assert there is not None
    assert there.legs == (Leg("1", -1, 90.0, 60.0, False),)
    assert made.route(LanePosition("1", -1, 60.0), LanePosition("1", -1, 90.0)) is None
    assert made.topology() == []


def test_links_to_nothing_are_reported(tmp_path: Path) -> None:
    sink = Diagnostics()
    network(tmp_path, road("1", link=linked("successor", "7", "start")), sink=sink)
    assert [(d.code.id, d.place.line) for d in sink] == [("SC313", 1)]
