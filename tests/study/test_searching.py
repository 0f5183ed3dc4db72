"""The pictures of the secondary task: none of the circles touch, one is larger, and every picture comes again."""

from __future__ import annotations

import math
from itertools import combinations

import pytest

from scenario_compiler.source.study import SearchTask
from scenario_compiler.study.searching import HEIGHT, WIDTH, search_picture


@pytest.mark.parametrize("items", [4, 7, 24, 60])
@pytest.mark.parametrize("ratio", [1.1, 1.5, 3.0])
def test_circles_stand_apart_and_the_target_is_larger(items: int, ratio: float) -> None:
    task = SearchTask(items=items, ratio=ratio)
    for number in range(20):
        found = search_picture(task, 5, number)
        assert len(found.circles) == items
        for x, y, r in found.circles:
            assert r <= x <= WIDTH - r
            assert r <= y <= HEIGHT - r
        for (x, y, r), (u, v, q) in combinations(found.circles, 2):
            assert math.hypot(x - u, y - v) > r + q
        sizes = [r for _, _, r in found.circles]
        assert sizes.index(max(sizes)) == found.target
        assert max(sizes) / min(sizes) == pytest.approx(ratio, rel=0.01)


def test_pictures_are_drawn_by_the_seed_and_their_number() -> None:
    task = SearchTask()
    assert search_picture(task, 5, 3) == search_picture(task, 5, 3)
    assert search_picture(task, 5, 3).circles != search_picture(task, 6, 3).circles
    targets = {search_picture(task, 5, number).target for number in range(100)}
    assert len(targets) > 15
