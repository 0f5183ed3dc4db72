"""The share of a stretch that a mark paints is that of the pieces that are drawn."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scenario_compiler import load_network
from scenario_compiler.resources import find_map
from scenario_compiler.roads.marks import (
    dashes_between,
    dashes_up_to,
    evenly_painted,
    mark_row,
    painted_share,
    usual_share,
)
from scenario_compiler.roads.mesh import road_marks
from tests.roads.make import lane, network, road, section

WIDTH = '<width sOffset="0" a="3.5" b="0" c="0" d="0"/>'


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
def test_the_usual_share_is_that_of_a_long_stretch(name: str) -> None:
    n, dashed = load_network(find_map(name)).tables, 0
    for mark in range(-1, len(n.mark_s)):
        begin = n.mark_s[max(mark, 0)]
        usual = usual_share(n, mark, begin, begin + 2.0)
        assert usual == pytest.approx(painted_share(n, mark, begin, begin + 100_000.0), abs=0.001)
        assert evenly_painted(n, mark) == 1
        dashed += 0.0 < usual < 1.0
    assert dashed > 0


def test_a_line_that_is_painted_once_is_counted_where_it_lies(tmp_path: Path) -> None:
    line = '<explicit><line length="4" tOffset="0" sOffset="10" width="0.1"/></explicit>'
    mark = f'<roadMark sOffset="0" type="broken" width="0.1">{line}</roadMark>'
    n = network(tmp_path, road(lanes=section(lane(1), lane(-1, WIDTH + mark)))).tables
    row = mark_row(n, 0, -1, 12.0)
    assert evenly_painted(n, row) == 0
    assert [usual_share(n, row, s, s + 2.0) for s in (2.0, 9.0, 11.0, 30.0)] == pytest.approx([0.0, 0.5, 1.0, 0.0])
