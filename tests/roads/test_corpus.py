"""Every road file of the corpus is read or diagnosed; what is read closes from (s, t) to (x, y) and back."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.roads import Network, load_network
from scenario_compiler.roads.geometry import road_pose, road_reference
from scenario_compiler.roads.lanes import lane_borders, lane_pose
from scenario_compiler.roads.locate import project_on_road, track

UNREADABLE = {"negative16.xodr", "negative17.xodr", "negative18.xodr"}
"""Files whose only road has no reference line, on purpose."""


@pytest.fixture(scope="session")
def networks(corpus: Path) -> list[Network]:
    found = []
    for path in sorted(corpus.rglob("*.xodr")):
        sink = Diagnostics()
        network = load_network(path, cache=False, sink=sink)
        assert (network is None) == sink.has_errors
        if network is None:
            assert path.name in UNREADABLE
        else:
            network.model()
            found.append(network)
    return found


def test_every_file_is_read_or_diagnosed(networks: list[Network]) -> None:
    assert len(networks) >= 274


SHARE = st.floats(0.0, 1.0)


@settings(max_examples=80, suppress_health_check=list(HealthCheck))
@given(road_share=SHARE, s_share=SHARE, lane_share=SHARE, t_share=st.floats(0.02, 0.98))
def test_round_trip_on_every_map(
    networks: list[Network], road_share: float, s_share: float, lane_share: float, t_share: float
) -> None:
    """The point at (s, t) of a lane is found at (s, t) again, by the road's projection and by the index."""
    for network in networks:
        n = network.tables
        road = int(road_share * (len(n.road_length) - 1))
        s = s_share * n.road_length[road]
        lanes = network.lanes_at(network.road_ids[road], s)
        if lanes:
            lane = lanes[int(lane_share * (len(lanes) - 1))]
            t = lane.t_right + t_share * (lane.t_left - lane.t_right)
            check_round_trip(network, road, lane.lane, s, t)


def check_round_trip(network: Network, road: int, lane: int, s: float, t: float) -> None:
    """Beyond the centre of a very tight curve (1 - curvature t <= 0) a point has several s: one of them is found."""
    n = network.tables
    x, y, *_ = road_pose(n, road, s, t)
    left, right = lane_borders(n, road, lane, s)
    at = (network.path, network.road_ids[road], lane, s, t)
    unfolded = 1.0 - road_reference(n, road, s)[3] * t > 0.05
    if left - right > 0.01 and unfolded:
        places = [p for p in network.locate(x, y) if network.road_index(p.road) == road]
        closed = False
        for place in places:
            px, py, *_ = lane_pose(n, road, place.lane, place.s, place.offset)
            there = sum(lane_borders(n, road, place.lane, place.s)) / 2.0 + place.offset
            if 1.0 - road_reference(n, road, place.s)[3] * there < 0.05:
                continue
            assert math.hypot(px - x, py - y) < 1e-6, at
            closed = closed or abs(place.s - s) < 1e-6
        assert closed, at
    found, on, s1, t1 = track(n, x, y, road, s)
    if found and on == road and abs(s1 - s) < 1.0:
        back_x, back_y, *_ = road_pose(n, road, s1, t1)
        assert math.hypot(back_x - x, back_y - y) < 1e-6, at
    s2, t2 = project_on_road(n, road, s, x, y)
    if 0.0 <= s2 <= n.road_length[road]:
        back_x, back_y, *_ = road_pose(n, road, s2, t2)
        assert math.hypot(back_x - x, back_y - y) < 1e-6, at
