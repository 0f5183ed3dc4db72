"""A border of a lane counts as painted where a line is seen on it, whichever road the line belongs to."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from scenario_compiler import load_network
from scenario_compiler.perception.calibration.gather import seed_of
from scenario_compiler.perception.calibration.lines import JunctionLines, LinePlace, Lines
from scenario_compiler.perception.calibration.maps import MapRoads
from scenario_compiler.resources import find_map
from scenario_compiler.roads import Network
from scenario_compiler.roads.mesh import road_marks
from tests.roads.make import lane, network, road, section

WIDTH = '<width sOffset="0" a="3.5" b="0" c="0" d="0"/>'
SOLID = '<roadMark sOffset="0" type="solid" width="0.12"/>'
DASHES = (
    '<roadMark sOffset="0" type="broken" width="0.12"><type name="broken" width="0.12">'
    '<line length="3" space="9" tOffset="0" sOffset="0"/></type></roadMark>'
)


def straight(
    number: str, begin: float, length: float, mark: str = "", junction: str = "-1", heading: float = 0.0
) -> str:
    """Return a straight road from (begin, 0), with a mark on the outer border of its right lane."""
    plan = f'<geometry s="0" x="{begin}" y="0" hdg="{heading}" length="{length}"><line/></geometry>'
    lanes = section(lane(1), lane(-1, WIDTH + mark))
    return road(number, length, plan, lanes, attributes=f'junction="{junction}"')


def along_right_borders(made: Network, wear: float = 1.0) -> np.ndarray:
    """Return the paint on the right border along all roads, one place per metre; the second one is worn."""
    marks = road_marks(made)
    lines = Lines(replace(marks, quality=np.where(marks.road == 1, wear, 1.0).astype(np.float32)))
    lengths = [float(one) for one in made.tables.road_length]
    border = [(LinePlace(number, -1, s + 0.5),) for number, one in enumerate(lengths) for s in range(int(one))]
    return lines.along(border, np.linspace(0.5, len(border) - 0.5, len(border)))


def test_a_broken_line_goes_on_from_one_road_to_the_next_and_ends_with_its_last_dash(tmp_path: Path) -> None:
    made = network(tmp_path, straight("1", 0, 47, DASHES), straight("2", 47, 47, DASHES), straight("3", 94, 47))
    assert along_right_borders(made).tolist() == [1.0] * (47 + 39) + [0.0] * (8 + 47)


def test_a_gap_between_two_roads_is_as_worn_as_the_more_worn_of_their_lines(tmp_path: Path) -> None:
    made = network(tmp_path, straight("1", 0, 47, DASHES), straight("2", 47, 47, DASHES))
    found = along_right_borders(made, wear=0.25)
    assert found[:39].tolist() == [1.0] * 39
    assert found[39 : 47 + 39].tolist() == [0.25] * (8 + 39)


def test_no_line_is_seen_on_a_bare_road_between_two_painted_ones(tmp_path: Path) -> None:
    made = network(tmp_path, straight("1", 0, 20, SOLID), straight("2", 20, 8), straight("3", 28, 20, SOLID))
    assert along_right_borders(made).tolist() == [1.0] * 20 + [0.0] * 8 + [1.0] * 20


def test_a_line_of_another_connecting_road_is_seen_where_it_runs_along_the_border(tmp_path: Path) -> None:
    made = network(
        tmp_path,
        straight("1", 0, 20, junction="7"),
        straight("2", 5, 10, SOLID, junction="7"),
        straight("3", 0, 20, SOLID, junction="7", heading=0.5),
        straight("4", 0, 20, SOLID),
        '<junction id="7" name=""/>',
    )
    lines = Lines(road_marks(made))
    in_junctions = JunctionLines(made, lines)
    seen = [in_junctions.with_others(LinePlace(0, -1, s), made.road_pose("1", s, -3.5)) for s in (2.0, 8.0, 18.0)]
    assert [len(one) for one in seen] == [1, 2, 1]
    assert seen[1][1][:2] == (1, -1)
    assert seen[1][1].s == pytest.approx(3.0, abs=0.5)
    assert lines.along(seen, np.array([2.0, 8.0, 18.0])).tolist() == [0.0, 1.0, 0.0]
    assert in_junctions.with_others(LinePlace(3, -1, 8.0), made.road_pose("4", 8.0, -3.5)) == (LinePlace(3, -1, 8.0),)


def test_a_map_without_a_line_in_a_junction_has_none_there(tmp_path: Path) -> None:
    made = network(tmp_path, straight("1", 0, 20, junction="7"), '<junction id="7" name=""/>')
    own = LinePlace(0, -1, 3.0)
    assert JunctionLines(made, Lines(road_marks(made))).with_others(own, made.road_pose("1", 3.0, -3.5)) == (own,)


def test_the_truth_of_a_clip_has_the_lines_of_all_connecting_roads() -> None:
    """In clip 27 the connecting road ahead has no line on its right; the one that turns right there has, for 4 m."""
    clips = MapRoads(load_network(find_map("town_grid"))).clips(seed_of("town_grid"), range(24, 28))
    painted = {number: next(iter(views)).truth.painted for number, _, views in clips}
    assert painted[27] == pytest.approx((1 / 3, 1.0))
