"""The share of a stretch that a mark paints is that of the pieces that are drawn."""

from __future__ import annotations

import numpy as np
import pytest

from scenario_compiler import load_network
from scenario_compiler.resources import find_map
from scenario_compiler.roads.marks import dashes_between, dashes_up_to, evenly_painted, mark_row, painted_share
from scenario_compiler.roads.mesh import road_marks


def test_dashes_are_counted_from_the_start_of_the_line_in_both_directions() -> None:
    assert dashes_up_to(0.0, 3.0, 9.0) == 0.0
    assert dashes_up_to(2.0, 3.0, 9.0) == pytest.approx(2.0)
    assert dashes_up_to(8.0, 3.0, 9.0) == pytest.approx(3.0)
    assert dashes_up_to(13.0, 3.0, 9.0) == pytest.approx(4.0)
    assert dashes_up_to(-10.0, 3.0, 9.0) == pytest.approx(-1.0)
    assert dashes_between(2.0, 4.0, 3.0, 9.0) == pytest.approx(0.5)
    assert dashes_between(2.0, 4.0, 3.0, 0.0) == 1.0


@pytest.mark.parametrize("name", ["highway_loop", "town_grid"])
def test_the_share_is_that_of_the_pieces_that_are_drawn(name: str) -> None:
    network = load_network(find_map(name))
    n, drawn = network.tables, road_marks(network)
    draw, compared = np.random.default_rng(1), 0
    for _ in range(400):
        piece = int(draw.integers(len(drawn.s)))
        road, lane, s = int(drawn.road[piece]), int(drawn.lane[piece]), float(drawn.s[piece, 0])
        begin, end = s + 0.2, s + 2.2
        mark = mark_row(n, road, lane, begin)
        if mark < 0 or mark != mark_row(n, road, lane, end) or end > n.mark_end[mark] or n.mark_type[mark] > 2:
            continue
        same = (drawn.road == road) & (drawn.lane == lane)
        covered = np.clip(np.minimum(drawn.s[same, 1], end) - np.maximum(drawn.s[same, 0], begin), 0.0, None).sum()
        assert painted_share(n, mark, begin, end) == pytest.approx(covered / (end - begin), abs=0.01)
        compared += 1
    assert compared > 50


@pytest.mark.parametrize("name", ["highway_loop", "town_grid"])
def test_a_mark_is_evenly_painted_if_every_stretch_of_it_has_the_same_share(name: str) -> None:
    network = load_network(find_map(name))
    n, found = network.tables, set()
    for mark in range(-1, len(n.mark_s)):
        begin = n.mark_s[max(mark, 0)]
        shares = {painted_share(n, mark, begin + 0.5 * k, begin + 0.5 * k + 2.0) for k in range(40)}
        assert (len(shares) == 1) == (evenly_painted(n, mark) == 1)
        found.add(len(shares) == 1)
    assert found == {True, False}
