"""The roads around a run, as they are drawn."""

from __future__ import annotations

import numpy as np

from scenario_compiler.report.surroundings import Window, surroundings
from scenario_compiler.roads.network import Network
from scenario_compiler.roads.positions import MarkStretch


def window_at(network: Network, s: float, size: float) -> Window:
    pose = network.road_pose("1", s, 0.0)
    return Window(pose.x - size, pose.y - size, pose.x + size, pose.y + size)


def test_lanes_cover_their_window(network: Network) -> None:
    found = surroundings(network, window_at(network, 100.0, 20.0), spacing=2.0)
    assert {strip.type for strip in found.strips if strip.drivable} == {"driving"}
    assert any(strip.type == "sidewalk" and not strip.drivable for strip in found.strips)
    for strip in found.strips:
        assert strip.outline.shape[1] == 2
        assert np.isfinite(strip.outline).all()


def test_a_lane_is_as_wide_as_the_network_says(network: Network) -> None:
    found = surroundings(network, window_at(network, 100.0, 20.0), spacing=2.0)
    widths = {round(float(np.linalg.norm(s.outline[0] - s.outline[-1])), 6) for s in found.strips if s.drivable}
    assert widths == {3.5}


def test_marks_have_their_type_and_fade_with_their_quality(network: Network) -> None:
    worn = network.with_mark_quality([MarkStretch("1", None, 80.0, 120.0, 1.0, 0.0)])
    window = window_at(network, 100.0, 30.0)
    fresh = {(mark.type, mark.quality) for mark in surroundings(network, window, 2.0).marks}
    assert {kind for kind, _ in fresh} == {"solid", "broken"}
    assert {quality for _, quality in fresh} == {1.0}
    assert len({mark.quality for mark in surroundings(worn, window, 2.0).marks}) > 5


def test_an_empty_window_has_no_roads(network: Network) -> None:
    found = surroundings(network, Window(1e6, 1e6, 1e6 + 1, 1e6 + 1), spacing=1.0)
    assert (found.strips, found.marks) == ((), ())
