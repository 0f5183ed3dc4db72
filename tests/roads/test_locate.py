from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from scenario_compiler.roads import Network, load_network
from scenario_compiler.roads.locate import locate_lane, track
from tests.roads.make import lane, network, road, section

MAPS = (
    "Scenic/assets/maps/CARLA/Town04.xodr",
    "Scenic/assets/maps/misc/Issue295a.xodr",
    "maliput_malidrive/resources/SShapeSuperelevatedRoad.xodr",
    "maliput_malidrive/resources/Figure8.xodr",
    "esmini/EnvironmentSimulator/Unittest/xodr/two_pitched_and_rolled_roads.xodr",
)


@pytest.mark.parametrize("name", MAPS)
def test_the_batch_equals_the_single_question(corpus: Path, name: str) -> None:
    made = load_network(corpus / name, cache=False)
    draw = np.random.default_rng(5)
    n = made.tables
    xs, ys = [], []
    for _ in range(1500):
        i = int(draw.integers(len(n.road_length)))
        pose = made.road_pose(made.road_ids[i], draw.random() * n.road_length[i], draw.uniform(-12.0, 12.0))
        xs.append(pose.x)
        ys.append(pose.y)
    many = made.locate_many(xs, ys)
    for i, (x, y) in enumerate(zip(xs, ys, strict=True)):
        rows = range(many.start[i], many.start[i + 1])
        single = made.locate(x, y)
        assert [(made.road_ids[many.road[k]], many.lane[k]) for k in rows] == [(p.road, p.lane) for p in single]
        for k, place in zip(rows, single, strict=True):
            assert many.s[k] == pytest.approx(place.s, abs=1e-9)
            assert many.offset[k] == pytest.approx(place.offset, abs=1e-9)


@pytest.fixture
def bend(tmp_path: Path) -> Network:
    plan = (
        '<geometry s="0" x="0" y="0" hdg="0" length="50"><line/></geometry>'
        '<geometry s="50" x="50" y="0" hdg="0" length="50"><arc curvature="0.02"/></geometry>'
    )
    return network(tmp_path, road(plan=plan, lanes=section(lane(1), lane(-1) + lane(-2, kind="shoulder"))))


def test_off_the_road_nothing_is_found_unless_the_nearest_is_requested(bend: Network) -> None:
    assert bend.locate(20.0, 10.0) == []
    (beside,) = bend.locate(20.0, 10.0, nearest=True)
    assert beside[:3] == ("1", 1, 20.0)
    assert beside.offset == pytest.approx(8.25)
    assert bend.locate(-3.0, -2.0, nearest=True)[0][:3] == ("1", -1, 0.0)
    far = bend.locate(20.0, -5000.0, nearest=True)[0]
    assert (far.road, far.lane) == ("1", -2)


@pytest.mark.parametrize("x", [math.nan, math.inf, -math.inf, 1e300])
def test_points_that_are_not_finite_are_nowhere(bend: Network, x: float) -> None:
    assert bend.locate(x, 0.0) == []
    assert bend.locate(x, 0.0, nearest=True) == []
    assert track(bend.tables, x, 0.0, 0, 10.0)[0] == 0
    assert list(bend.locate_many([x, 10.0], [0.0, 1.0]).start) == [0, 0, 1]


def test_an_empty_batch_is_empty(bend: Network) -> None:
    assert list(bend.locate_many([], []).start) == [0]


def test_overlapping_roads_are_all_found_nearest_centre_first(tmp_path: Path) -> None:
    plan = '<geometry s="0" x="0" y="-1" hdg="0" length="100"><line/></geometry>'
    made = network(tmp_path, road("1"), road("2", plan=plan))
    assert [(p.road, p.lane) for p in made.locate(10.0, 0.5)] == [("2", 1), ("1", 1)]
    assert locate_lane(made.tables, 10.0, 0.5)[:3] == (1, 1, 1)


def test_a_driving_lane_is_preferred_to_another_as_near(tmp_path: Path) -> None:
    walk = section(lane(1, kind="sidewalk"), "")
    made = network(tmp_path, road("1", lanes=walk), road("2"))
    assert locate_lane(made.tables, 10.0, 1.0)[:3] == (1, 1, 1)


def test_tracking_stays_on_its_road_and_follows_links(tmp_path: Path) -> None:
    plan = '<geometry s="0" x="100" y="0" hdg="0" length="100"><line/></geometry>'
    after = '<successor elementType="road" elementId="2" contactPoint="start"/>'
    before = '<predecessor elementType="road" elementId="1" contactPoint="end"/>'
    made = network(tmp_path, road("1", link=after), road("over"), road("2", plan=plan, link=before))
    n = made.tables
    assert track(n, 60.0, -1.0, 0, 55.0) == pytest.approx((1, 0, 60.0, -1.0))
    assert track(n, 60.0, -1.0, 1, 55.0) == pytest.approx((1, 1, 60.0, -1.0))
    assert track(n, 100.5, 1.0, 0, 99.5) == pytest.approx((1, 2, 0.5, 1.0))
    assert track(n, 99.5, 1.0, 2, 0.5) == pytest.approx((1, 0, 99.5, 1.0))
    assert track(n, 60.0, 9.0, 0, 55.0)[0] == 0


def test_a_point_in_the_wedge_of_a_kink_is_on_the_road(tmp_path: Path) -> None:
    plan = (
        '<geometry s="0" x="0" y="0" hdg="0" length="50"><line/></geometry>'
        '<geometry s="50" x="50" y="0" hdg="0.02" length="50"><line/></geometry>'
    )
    made = network(tmp_path, road(plan=plan))
    place = made.locate(50.0 + 3.0 * math.sin(0.01), -3.0)
    assert [(p.lane, p.s) for p in place] == [(-1, 50.0)]
    assert made.locate(50.0, 3.0)[0].lane == 1


def test_the_index_costs_no_more_on_a_larger_network(tmp_path: Path) -> None:
    """Chunks looked at for one point do not grow with the number of roads."""
    counts = []
    for roads in (10, 400):
        rows = []
        for i in range(roads):
            x, y = 300 * (i % 20), 40 * (i // 20)
            plan = f'<geometry s="0" x="{x}" y="{y}" hdg="0" length="250"><line/></geometry>'
            rows.append(road(str(i), length=250.0, plan=plan))
        n = network(tmp_path, *rows).tables
        counts.append(max(b - a for a, b in zip(n.cell_chunk, n.cell_chunk[1:], strict=False)))
    assert counts[0] == counts[1]


@pytest.mark.parametrize("beside", [False, True], ids=["on the road", "off the road"])
def test_a_place_that_is_found_at_the_end_of_a_lane_lies_on_that_lane(tmp_path: Path, beside: bool) -> None:
    """A lane that only the first section has ends where the second one starts; its place is in the first."""
    lanes = section(right=lane(-1) + lane(-2)) + section(s=30.0, right=lane(-1))
    made = network(tmp_path, road(length=60, lanes=lanes))
    y = -9.0 if beside else -5.0
    for x in (30.0 - 1e-9, 30.0, 30.0 + 1e-9, 30.0 + 5e-8, 30.5 if beside else 30.0):
        for place in made.locate(x, y, nearest=beside):
            pose = made.lane_pose(place.road, place.lane, place.s, place.offset)
            assert math.hypot(pose.x - x, pose.y - y) < 1.0
