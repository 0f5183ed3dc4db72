from __future__ import annotations

from pathlib import Path

import pytest

from scenario_compiler.roads import MarkStretch, Network
from tests.roads.make import lane, network, road, section

WIDTH = '<width sOffset="0" a="3.5" b="0" c="0" d="0"/>'
MARKS = (
    '<roadMark sOffset="0" type="broken"><type name="broken" width="0.12">'
    '<line length="6" space="12" tOffset="0" sOffset="0"/></type></roadMark>'
    '<roadMark sOffset="60" type="solid"/>'
)


@pytest.fixture
def made(tmp_path: Path) -> Network:
    return network(tmp_path, road(lanes=section(lane(1, WIDTH + MARKS), lane(-1, WIDTH + MARKS))))


def quality(made: Network, lane_id: int, s: float) -> float:
    mark = made.marks("1", lane_id, s)[0]
    assert mark is not None
    return mark.quality


def test_a_stretch_fades_linearly_and_leaves_the_rest(made: Network) -> None:
    worn = made.with_mark_quality([MarkStretch("1", -1, 40.0, 80.0, 1.0, 0.0)])
    assert [quality(worn, -1, s) for s in (10.0, 50.0, 60.0, 70.0, 90.0)] == [1.0, 0.75, 0.5, 0.25, 1.0]
    assert quality(worn, 1, 60.0) == 1.0
    assert quality(made, -1, 60.0) == 1.0
    assert worn.lane_pose("1", -1, 50.0) == made.lane_pose("1", -1, 50.0)


def test_later_stretches_go_over_earlier_ones(made: Network) -> None:
    worn = made.with_mark_quality(
        [MarkStretch("1", None, 0.0, 100.0, 0.4, 0.4), MarkStretch("1", 1, 20.0, 30.0, 0.9, 0.9)]
    )
    assert [quality(worn, 1, s) for s in (10.0, 25.0, 35.0)] == [0.4, 0.9, 0.4]
    assert quality(worn, -1, 25.0) == 0.4


def test_lines_go_with_their_marks(made: Network) -> None:
    n = made.with_mark_quality([MarkStretch("1", -1, 20.0, 30.0, 0.5, 0.5)]).tables
    lines = [n.mark_line[i + 1] - n.mark_line[i] for i in range(len(n.mark_s))]
    assert lines == [1, 0, 1, 1, 1, 0]
    assert len(n.mark_line) == len(n.mark_s) + 1


def test_wrong_stretches_are_the_callers_mistake(made: Network) -> None:
    with pytest.raises(KeyError):
        made.with_mark_quality([MarkStretch("9", None, 0.0, 1.0, 0.0, 0.0)])
    with pytest.raises(ValueError, match="outside 0 to 1"):
        made.with_mark_quality([MarkStretch("1", None, 0.0, 1.0, 0.0, 1.5)])


def test_a_colour_repaints_marks_and_lines_and_keeps_their_quality(made: Network) -> None:
    worn = made.with_mark_quality([MarkStretch("1", -1, 40.0, 80.0, 1.0, 0.0)])
    n = worn.with_mark_quality([MarkStretch("1", -1, 20.0, 50.0, None, None, "yellow")])
    marks = {s: n.marks("1", -1, s)[0] for s in (10.0, 45.0, 55.0)}
    assert [mark.colour if mark else None for mark in marks.values()] == ["standard", "yellow", "standard"]
    assert quality(n, -1, 45.0) == 0.875
    assert len(set(n.tables.line_colour)) == 2
    assert len(set(made.tables.line_colour)) == 1
