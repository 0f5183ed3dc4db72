from pathlib import Path

import numpy as np
import pytest

from scenario_compiler.roads import lanes
from scenario_compiler.roads.mesh import (
    TOLERANCE,
    Marks,
    Material,
    Paint,
    Surface,
    mesh_origin,
    road_marks,
    road_surface,
)
from scenario_compiler.roads.network import Network, load_network
from scenario_compiler.roads.positions import MarkStretch
from tests.roads import make
from tests.roads.make import shifted

ROAD = """<OpenDRIVE><header revMajor="1" revMinor="4"/>
<road name="" length="{length}" id="1" junction="-1">
 <planView><geometry s="0" x="0" y="0" hdg="0.3" length="{length}">{shape}</geometry></planView>
 <elevationProfile>{elevation}</elevationProfile>
 <lanes><laneOffset s="0" a="0.5" b="0" c="0" d="0"/>
 <laneSection s="0">
  <left><lane id="1" type="driving"><width sOffset="0" a="3.5" b="0" c="0" d="0"/>
   <roadMark sOffset="0" type="solid" width="0.15" color="yellow"/></lane></left>
  <center><lane id="0" type="none"><roadMark sOffset="0" type="{centre}" width="0.12"/></lane></center>
  <right><lane id="-1" type="driving"><width sOffset="0" a="3.5" b="0" c="0" d="0"/>{mark}</lane>
   <lane id="-2" type="sidewalk"><width sOffset="0" a="2" b="0" c="0" d="0"/>{curb}</lane></right>
 </laneSection></lanes>
</road></OpenDRIVE>"""


def network(tmp_path: Path, **changes: str) -> Network:
    values = {
        "length": "120", "shape": "<line/>", "elevation": "", "centre": "broken",
        "mark": '<roadMark sOffset="0" type="solid" width="0.12"/>', "curb": "",
    } | changes  # fmt: skip
    path = tmp_path / "road.xodr"
    path.write_text(ROAD.format(**values), encoding="utf-8")
    loaded = load_network(path, cache=False)
    assert loaded is not None
    return loaded


def area(quads: np.ndarray) -> float:
    a, b = quads[:, 2, :2] - quads[:, 0, :2], quads[:, 3, :2] - quads[:, 1, :2]
    return float(0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum())


def of_lane(part: Surface | Marks, lane: int) -> np.ndarray:
    found: np.ndarray = part.quads[part.lane == lane]
    return found


def test_lanes_cover_their_area_with_their_materials(tmp_path: Path) -> None:
    surface = road_surface(network(tmp_path))
    assert area(of_lane(surface, 1)) == pytest.approx(120 * 3.5, rel=1e-5)
    assert area(of_lane(surface, -2)) == pytest.approx(120 * 2.0, rel=1e-5)
    assert set(surface.material[surface.lane == -2]) == {Material.CONCRETE}
    assert set(surface.material[surface.lane == -1]) == {Material.ASPHALT}
    assert not (surface.material == Material.VERGE).any()


def test_corners_are_left_start_left_end_right_end_right_start(tmp_path: Path) -> None:
    net = network(tmp_path, shape='<arc curvature="0.01"/>')
    surface = road_surface(net)
    for k in range(len(surface.quads)):
        s0, s1 = surface.s[k]
        lane = int(surface.lane[k])
        left = net.lane_width("1", lane, float(s0)) / 2
        for corner, (s, offset) in zip(
            surface.quads[k], ((s0, left), (s1, left), (s1, -left), (s0, -left)), strict=True
        ):
            pose = net.lane_pose("1", lane, float(s), offset)
            assert corner == pytest.approx((pose.x, pose.y, pose.z), abs=1e-3)


def test_straight_level_roads_need_few_pieces_and_bends_more(tmp_path: Path) -> None:
    straight = road_surface(network(tmp_path))
    bend = road_surface(network(tmp_path, shape='<arc curvature="0.02"/>'))
    assert (straight.lane == 1).sum() == 6
    assert (bend.lane == 1).sum() > 20
    assert np.ptp(bend.s, axis=1).max() <= 20.0


def test_pieces_of_a_bend_lie_within_the_tolerance(tmp_path: Path) -> None:
    net = network(tmp_path, shape='<arc curvature="0.02"/>')
    surface = road_surface(net)
    for quad, (s0, s1) in zip(of_lane(surface, 1), surface.s[surface.lane == 1], strict=True):
        pose = net.lane_pose("1", 1, float(s0 + s1) / 2, 1.75)
        assert np.hypot(*((quad[0] + quad[1])[:2] / 2 - (pose.x, pose.y))) < 1.25 * TOLERANCE


def test_a_graded_road_has_its_height_and_a_verge(tmp_path: Path) -> None:
    net = network(tmp_path, elevation='<elevation s="0" a="3" b="0.05" c="0" d="0"/>')
    surface, marks = road_surface(net), road_marks(net)
    for part in (surface, marks):
        middle = part.s.mean(axis=1)
        assert part.quads[:, :, 2].mean(axis=1) == pytest.approx(3 + 0.05 * middle, abs=1e-3)
    assert (surface.material == Material.VERGE).sum() == 2 * (surface.lane == 1).sum()


def test_broken_marks_have_dashes_of_three_and_gaps_of_nine_metres(tmp_path: Path) -> None:
    marks = road_marks(network(tmp_path))
    centre = marks.s[marks.lane == 0]
    assert len(centre) == 10
    assert centre[1] == pytest.approx([12.0, 15.0])
    assert area(of_lane(marks, 0)) == pytest.approx(30 * 0.12, rel=1e-3)


def test_the_lines_of_the_file_win_over_the_types_habit(tmp_path: Path) -> None:
    mark = (
        '<roadMark sOffset="0" type="broken" width="0.12"><type name="x" width="0.2">'
        '<line length="6" space="12" tOffset="0" sOffset="2" width="0.2"/></type></roadMark>'
    )
    marks = road_marks(network(tmp_path, mark=mark))
    right = marks.s[marks.lane == -1]
    assert right[0] == pytest.approx([2.0, 8.0])
    assert right[1] == pytest.approx([20.0, 26.0])
    assert set(marks.width[marks.lane == -1].tolist()) == {np.float32(0.2)}


def test_the_offset_of_a_line_is_to_the_left_on_both_sides(tmp_path: Path) -> None:
    line = '<line length="0" space="0" tOffset="0.3" sOffset="0"/>'
    mark = f'<roadMark sOffset="0" type="solid" width="0.12"><type name="x" width="0.1">{line}</type></roadMark>'
    inside = '<width sOffset="0" a="3.5" b="0" c="0" d="0"/>' + mark
    marks = road_marks(
        make.network(tmp_path, make.road(lanes=make.section(make.lane(1, inside), make.lane(-1, inside))))
    )
    for lane, border in ((1, 3.5), (-1, -3.5)):
        assert of_lane(marks, lane)[:, :, 1].mean() == pytest.approx(border + 0.3, abs=1e-6)


@pytest.mark.parametrize(
    ("kind", "strokes"),
    [("solid", 1), ("solid solid", 2), ("solid broken", 2), ("broken broken", 2), ("none", 0), ("curb", 0)],
)
def test_types_have_their_number_of_lines(tmp_path: Path, kind: str, strokes: int) -> None:
    marks = road_marks(network(tmp_path, centre=kind))
    at_13_5 = (marks.lane == 0) & (marks.s[:, 0] <= 13.5) & (marks.s[:, 1] > 13.5)
    assert at_13_5.sum() == strokes


def test_marks_lie_on_the_outer_border_of_their_lane(tmp_path: Path) -> None:
    net = network(tmp_path, shape='<arc curvature="-0.01"/>')
    marks = road_marks(net)
    for lane, offset in ((1, 1.75), (-1, -1.75)):
        quad = of_lane(marks, lane)[3]
        s = marks.s[marks.lane == lane][3]
        pose = net.lane_pose("1", lane, float(s[0]), offset)
        assert (quad[0] + quad[3])[:2] / 2 == pytest.approx((pose.x, pose.y), abs=1e-3)


def test_colour_and_quality_come_from_the_file(tmp_path: Path) -> None:
    mark = (
        '<roadMark sOffset="0" type="solid" width="0.12" color="orange">'
        '<userData code="marking_quality" value="0.4"/></roadMark>'
    )
    marks = road_marks(network(tmp_path, mark=mark))
    assert set(marks.colour[marks.lane == -1]) == {Paint.ORANGE}
    assert set(marks.colour[marks.lane == 1]) == {Paint.YELLOW}
    assert marks.quality[marks.lane == -1] == pytest.approx(0.4)
    assert marks.quality[marks.lane == 1] == pytest.approx(1.0)


def test_quality_that_changes_along_the_mark_is_cut_finely(tmp_path: Path) -> None:
    net = network(tmp_path)
    n = net.tables
    for mark in range(len(n.mark_s)):
        n.mark_quality_to[mark] = 0.0
    marks = road_marks(net)
    right = marks.lane == -1
    assert np.ptp(marks.s[right], axis=1).max() <= 1.0 + 1e-6
    assert marks.quality[right] == pytest.approx(1 - marks.s[right].mean(axis=1) / 120, abs=1e-4)


@pytest.mark.parametrize(
    "line",
    [
        '<line length="1e-9" space="1e-9" tOffset="0" sOffset="0"/>',
        '<line length="-3" space="4" tOffset="0" sOffset="-1e9"/>',
        '<line length="0" space="0" tOffset="0" sOffset="1e9"/>',
    ],
)
def test_hostile_lines_stay_bounded(tmp_path: Path, line: str) -> None:
    mark = f'<roadMark sOffset="0" type="broken" width="0.12"><type name="x" width="1">{line}</type></roadMark>'
    assert len(road_marks(network(tmp_path, mark=mark)).quads) < 50_000


def test_roads_without_lanes_give_no_quads(tmp_path: Path) -> None:
    text = ROAD.format(length="10", shape="<line/>", elevation="", centre="none", mark="", curb="")
    text = text[: text.index("<left>")] + text[text.index("<center>") : text.index("<right>")]
    path = tmp_path / "bare.xodr"
    path.write_text(text + "</laneSection></lanes></road></OpenDRIVE>", encoding="utf-8")
    net = load_network(path, cache=False)
    assert net is not None
    assert road_surface(net).quads.shape == (0, 4, 3)
    assert road_marks(net).quads.shape == (0, 4, 3)


@pytest.mark.parametrize("town", ["Scenic/assets/maps/CARLA/Town04.xodr", "opendrive-test-files/OpenDrive/Town05.xodr"])
def test_towns_are_covered_and_every_quad_is_finite(corpus: Path, town: str) -> None:
    net = load_network(corpus / town, cache=False)
    assert net is not None
    surface, marks = road_surface(net), road_marks(net)
    assert np.isfinite(surface.quads).all()
    assert np.isfinite(marks.quads).all()
    assert {int(r) for r in surface.road} == set(range(len(net.road_ids)))
    assert len(marks.quads) > 3000
    assert 0.05 < marks.width.min() <= marks.width.max() < 1.0


def test_overridden_quality_reaches_the_paint(tmp_path: Path) -> None:
    net = network(tmp_path, centre="solid").with_mark_quality([MarkStretch("1", None, 40.0, 80.0, 1.0, 0.0)])
    marks = road_marks(net)
    middle = marks.s.mean(axis=1)
    inside = (middle > 40.0) & (middle < 80.0)
    assert marks.quality[inside] == pytest.approx(1 - (middle[inside] - 40) / 40, abs=1e-3)
    assert marks.quality[middle < 40.0] == pytest.approx(1.0)
    assert area(of_lane(marks, 0)) == pytest.approx(120 * 0.12, rel=1e-3)


UTM = (500_000.0, 5_400_000.0)
"""Where a map of southern Germany lies."""


def test_a_map_far_out_has_the_same_mesh_from_its_origin(tmp_path: Path) -> None:
    bend = {"shape": '<arc curvature="0.01"/>', "elevation": '<elevation s="0" a="3" b="0.05" c="0" d="0"/>'}
    near = network(tmp_path, **bend)
    path = tmp_path / "far.xodr"
    path.write_text(shifted((tmp_path / "road.xodr").read_text(encoding="utf-8"), *UTM), encoding="utf-8")
    far = load_network(path, cache=False)
    assert far is not None
    assert mesh_origin(near).tolist() == [0.0, 0.0, 0.0]
    assert mesh_origin(far).tolist() == [*UTM, 0.0]
    for part in (road_surface, road_marks):
        here, there = part(near), part(far)
        assert there.origin.tolist() == [*UTM, 0.0]
        assert there.quads == pytest.approx(here.quads, abs=1e-4)
        assert there.s == pytest.approx(here.s, abs=1e-6)


LEANING = (
    "esmini/EnvironmentSimulator/Unittest/xodr/pitch_by_super_elevation.xodr",
    "esmini/EnvironmentSimulator/Unittest/xodr/slope_up_leaning_right.xodr",
    "esmini/EnvironmentSimulator/Unittest/xodr/straight_500_superelevation_elevation_curve.xodr",
    "esmini/EnvironmentSimulator/Unittest/xodr/two_pitched_and_rolled_roads.xodr",
    "esmini/resources/xodr/velodrome.xodr",
    "esmini/resources/xodr/fabriksgatan.xodr",
    "maliput_malidrive/resources/MultiLevelArcRoad.xodr",
    "maliput_malidrive/resources/SShapeSuperelevatedRoad.xodr",
    "maliput_malidrive/resources/SingleRoadHighCoefficients.xodr",
)
"""Rolled roads, some of them steep, and lanes with heights."""


@pytest.mark.parametrize("name", LEANING)
def test_corners_are_lane_poses_on_rolled_roads(corpus: Path, name: str) -> None:
    net = load_network(corpus / name, cache=False)
    assert net is not None
    assert_corners_are_lane_poses(net)


def test_corners_are_lane_poses_on_crossfall_and_shape(tmp_path: Path) -> None:
    lateral = (
        '<elevation s="0" a="3" b="0.08" c="0" d="0"/></elevationProfile><lateralProfile>'
        '<superelevation s="0" a="0.05" b="0" c="0" d="0"/><crossfall side="both" s="0" a="0.03" b="0" c="0" d="0"/>'
        '<shape s="0" t="-9" a="0" b="0.1" c="0" d="0"/><shape s="0" t="0" a="0.9" b="-0.02" c="0" d="0"/>'
        "</lateralProfile><elevationProfile>"
    )
    assert_corners_are_lane_poses(network(tmp_path, shape='<arc curvature="0.01"/>', elevation=lateral))


def assert_corners_are_lane_poses(net: Network) -> None:
    n, surface = net.tables, road_surface(net)
    pieces = np.flatnonzero(surface.lane != 0)
    assert len(pieces) > 0
    for k in pieces[:: max(1, len(pieces) // 1000)].tolist():
        lane, road = int(surface.lane[k]), int(surface.road[k])
        row = lanes.lane_row(n, road, lane, float(surface.s[k].mean()))
        last = n.section_end[n.lane_section[row]] - 1e-6
        for station, corners in zip(surface.s[k].tolist(), ((0, 3), (1, 2)), strict=True):
            s = min(station, last)
            half = lanes.row_width(n, row, s) / 2.0
            for corner, offset in zip(corners, (half, -half), strict=True):
                pose = lanes.lane_pose(n, road, lane, s, offset)
                assert surface.quads[k, corner] + surface.origin == pytest.approx(pose[:3], abs=1e-3)
