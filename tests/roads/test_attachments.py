"""Roads that begin or end inside another one, as virtual junctions have them, are followed."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.roads import Network, load_network
from scenario_compiler.roads.locate import track
from scenario_compiler.roads.mesh import road_marks, road_surface
from scenario_compiler.roads.model import ConnectionEnd
from scenario_compiler.roads.positions import LanePosition
from scenario_compiler.roads.travel import advance
from scenario_compiler.roads.ways import Joint, followers, joints
from tests.roads.make import lane, network, road, section

VIRTUAL = "GT-OpenSCENARIOEditor/test-fixtures/opendrive-v1.9/GT_23_virtual_junction_17.xodr"
CROSSING = "qc-opendrive/tests/data/not_implemented_yet/rule_178_junctions_priority_high_and_low_attrib_valid.xodr"


@pytest.fixture
def branching(corpus: Path) -> Network:
    """A main road of 200 m; a branch leaves it at 100 m to the right and leads to road 3."""
    sink = Diagnostics()
    made = load_network(corpus / VIRTUAL, cache=False, sink=sink)
    assert made is not None
    assert not list(sink)
    return made


def test_the_main_road_continues(branching: Network) -> None:
    start = LanePosition("1", -1, 90.0)
    assert branching.next(start, 50.0) == LanePosition("1", -1, 140.0)
    assert branching.next(LanePosition("1", 1, 120.0), 50.0) == LanePosition("1", 1, 70.0)
    assert branching.route(start, LanePosition("1", -1, 150.0)) is not None


def test_the_branch_is_taken_by_preference_and_by_route(branching: Network) -> None:
    n, index = branching.tables, branching.road_index
    road_id, lane_id, s, left = advance(n, index("1"), -1, 90.0, 30.0, index("2"))
    assert (road_id, lane_id, left) == (index("2"), -1, 0.0)
    assert s == pytest.approx(20.0)
    route = branching.route(LanePosition("1", -1, 20.0), LanePosition("3", -1, 10.0))
    assert route is not None
    assert [(leg.road, leg.s_from, leg.s_to) for leg in route.legs] == [
        ("1", 20.0, 100.0),
        ("2", 0.0, 30.0),
        ("3", 0.0, 10.0),
    ]
    assert branching.route(LanePosition("1", 1, 120.0), LanePosition("3", -1, 10.0)) is None
    assert branching.previous(LanePosition("3", -1, 10.0), 50.0) == LanePosition("1", -1, 90.0)


def test_the_path_has_no_gap(branching: Network) -> None:
    before, after = branching.lane_pose("1", 0, 100.0), branching.lane_pose("2", 0, 0.0)
    assert (before.x, before.y) == pytest.approx((after.x, after.y), abs=1e-9)


def test_what_has_no_path_is_kept(branching: Network) -> None:
    (junction,) = branching.model().junctions
    assert (junction.type, junction.main_road, junction.s_start, junction.s_end) == ("virtual", "1", 95.0, 105.0)
    assert junction.orientation == "+"
    anchored, bypassing = junction.connections
    assert anchored.predecessor == ConnectionEnd("1", 100.0, "+")
    assert bypassing.connecting == ""
    assert bypassing.successor == ConnectionEnd("3", 0.0, "+")


def test_a_virtual_junction_of_a_crosswalk_leaves_the_road_whole(corpus: Path) -> None:
    made = load_network(corpus / CROSSING, cache=False)
    assert made is not None
    assert made.next(LanePosition("1", -1, 50.0), 20.0) == LanePosition("1", -1, 70.0)


def attached(direction: str, end: str, main: str = "") -> tuple[str, str]:
    """A main road along x and a road that joins it at 40 m; both lanes are linked by the same id."""
    place = f'<{end} elementType="road" elementId="1" elementS="40" elementDir="{direction}"/>'
    plan = '<geometry s="0" x="40" y="0" hdg="-1.2" length="30"><line/></geometry>'
    return road("1", 100.0, lanes=main), road("2", 30.0, plan, link=place)


@pytest.mark.parametrize(
    ("direction", "end", "start", "goal"),
    [
        ("+", "predecessor", LanePosition("1", -1, 30.0), LanePosition("2", -1, 5.0)),
        ("-", "predecessor", LanePosition("1", 1, 50.0), LanePosition("2", -1, 5.0)),
        ("+", "successor", LanePosition("2", -1, 25.0), LanePosition("1", -1, 50.0)),
        ("-", "successor", LanePosition("2", -1, 25.0), LanePosition("1", 1, 30.0)),
    ],
)
def test_ends_join_the_part_in_their_direction(
    tmp_path: Path, direction: str, end: str, start: LanePosition, goal: LanePosition
) -> None:
    made = network(tmp_path, *attached(direction, end))
    there = made.route(start, goal)
    assert there is not None
    assert there.length == pytest.approx(15.0)
    back = [place._replace(lane=-place.lane) for place in (goal, start)]
    assert made.route(*back) is not None
    other_side = start if start.road == "1" else goal
    wrong = other_side._replace(lane=-other_side.lane)
    assert made.route(*((wrong, goal) if start.road == "1" else (start, wrong))) is None


@pytest.mark.parametrize(("direction", "sense"), [("+", 1), ("-", -1)])
def test_a_way_leaves_the_main_road_where_a_branch_begins(tmp_path: Path, direction: str, sense: int) -> None:
    """Routes of OpenSCENARIO follow these ways, road by road; they knew only the ends of roads."""
    n = network(tmp_path, *attached(direction, "predecessor")).tables
    assert followers(n, (0, sense)) == [(1, 1)]
    assert followers(n, (0, -sense)) == []
    assert followers(n, (1, -1)) == [(0, -sense)]
    assert list(joints(n, (0, sense))) == [Joint((1, 1), 40.0, 0.0)]
    assert list(joints(n, (1, -1))) == [Joint((0, -sense), 0.0, 40.0)]


def test_a_cut_changes_nothing_but_the_sections(tmp_path: Path) -> None:
    marks = '<roadMark sOffset="0" type="broken" width="0.12"/><roadMark sOffset="60" type="solid" width="0.12"/>'
    width = '<width sOffset="0" a="3.5" b="0.01" c="0" d="0"/><speed sOffset="50" max="10" unit="m/s"/>'
    lanes = section(lane(1), lane(-1, width + marks), s=0.0)
    (tmp_path / "whole").mkdir()
    whole = network(tmp_path / "whole", road("1", 100.0, lanes=lanes))
    cut = network(tmp_path, *attached("+", "predecessor", lanes))
    assert [s for s, _ in cut.road("1").sections] == [0.0, 40.0]
    for s in (0.0, 20.0, 39.9, 40.0, 55.0, 90.0):
        assert cut.lane_width("1", -1, s) == whole.lane_width("1", -1, s)
        assert cut.speed_limit("1", -1, s) == whole.speed_limit("1", -1, s)
        assert cut.marks("1", -1, s) == whole.marks("1", -1, s)
    for part in (road_surface, road_marks):
        ours, theirs = part(cut), part(whole)
        assert ours.s[(ours.road == 0) & (ours.lane == -1)].max() == theirs.s[theirs.lane == -1].max()
    index = cut.road_index("2")
    assert track(cut.tables, 45.0, -1.0, cut.road_index("1"), 35.0)[:2] == (1, cut.road_index("1"))
    assert track(cut.tables, 44.0, -12.0, cut.road_index("1"), 39.0)[:2] == (1, index)


def test_ends_at_the_ends_of_the_main_road_are_ordinary_links(tmp_path: Path) -> None:
    link = '<predecessor elementType="road" elementId="1" elementS="100" elementDir="+"/>'
    plan = '<geometry s="0" x="100" y="0" hdg="0" length="30"><line/></geometry>'
    made = network(tmp_path, road("1", 100.0), road("2", 30.0, plan, link=link))
    assert len(made.road("1").sections) == 1
    assert made.next(LanePosition("1", -1, 95.0), 10.0) == LanePosition("2", -1, 5.0)


def test_ten_thousand_attached_roads_are_read_in_time(tmp_path: Path) -> None:
    place = '<predecessor elementType="road" elementId="1" elementS="{}" elementDir="+"/>'
    many = (road(str(i), 5.0, link=place.format(i * 0.009)) for i in range(2, 10_002))
    sink = Diagnostics()
    made = network(tmp_path, road("1", 100.0), *many, sink=sink)
    assert len(made.road("1").sections) < 10_000
    assert {one.code.id for one in sink} <= {"SC369", "SC307"}
