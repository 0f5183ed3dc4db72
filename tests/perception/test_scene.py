import math
from pathlib import Path

import numpy as np

from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.road_camera import KEPT_MAPS, scene_of
from scenario_compiler.perception.scene import QuadGrid, Scene, Uprights, field_of_view, joined_marks
from scenario_compiler.roads.mesh import Material, Surface
from scenario_compiler.roads.positions import MarkStretch, SecondaryLine
from tests.perception.scenery import bend, two_lanes
from tests.roads.make import lane, network, road, section

STRAIGHT = bend(0.0)
QUAD = np.array([[[40, 2, 0], [60, 2, 0], [60, -2, 0], [40, -2, 0]]], np.float32)
CAMERAS = (
    Camera(),
    Camera(yaw=math.radians(100.0)),
    Camera(yaw=math.pi, roll=0.4),
    Camera(fov=math.radians(150.0)),
    Camera(z=60.0, pitch=math.radians(-90.0)),
    Camera(z=20.0, pitch=math.radians(-55.0), yaw=-2.0),
)
VIEW = Camera().view(STRAIGHT.pose(20.0))


def surface_of(quads: np.ndarray) -> Surface:
    count = len(quads)
    return Surface(
        quads.astype(np.float32),
        np.full(count, Material.ASPHALT, np.uint8),
        np.zeros(count, np.uint8),
        np.zeros(count, np.int32),
        np.zeros(count, np.int32),
        np.zeros((count, 2)),
    )


def scene_with(quads: np.ndarray) -> Scene:
    return Scene(surface_of(quads), two_lanes(STRAIGHT).marks)


def test_neighbouring_lanes_are_joined() -> None:
    right = QUAD - np.array([0, 4, 0], np.float32)
    joined = scene_with(np.concatenate([QUAD, right]))
    assert len(joined.material) == 1
    surfaces, _, _ = joined.seen(VIEW)
    world = (surfaces.points[:, :, 0].T @ VIEW.rotation) + VIEW.position
    assert np.allclose(world[:2], QUAD[0, :2], atol=1e-5)
    assert np.allclose(world[2:], right[0, 2:], atol=1e-5)


def test_slivers_that_neighbour_each_other_on_both_sides_do_no_harm() -> None:
    twisted = QUAD[:, [3, 2, 1, 0]]
    assert len(scene_with(np.concatenate([QUAD, twisted, QUAD])).material) >= 1


def test_only_what_is_before_the_camera_is_seen() -> None:
    behind = QUAD - np.array([80, 0, 0], np.float32)
    far = QUAD + np.array([900, 0, 0], np.float32)
    beside = QUAD + np.array([0, 300, 0], np.float32)
    surfaces, _, _ = scene_with(np.concatenate([behind, QUAD, far, beside])).seen(VIEW)
    assert surfaces.index.tolist() == [1]


def test_cells_hold_all_that_any_camera_sees() -> None:
    """Against a search through all quads, for cameras in six degrees of freedom."""
    draw = np.random.default_rng(8)
    middles = draw.uniform(-400.0, 400.0, (4000, 1, 2))
    quads = np.concatenate([middles + draw.uniform(-6.0, 6.0, (4000, 4, 2)), np.zeros((4000, 4, 1))], axis=2)
    grid = QuadGrid(quads.astype(np.float32))
    for camera in CAMERAS:
        view = camera.view(STRAIGHT.pose(20.0, turn=float(draw.uniform(-3.0, 3.0))))
        points = view.to_camera(quads.mean(axis=1))
        pixels = view.to_image(np.where(points[:, 2:] > 0.5, points, 1.0))
        seen = (points[:, 2] > 0.5) & (np.linalg.norm(points, axis=1) < 150.0)
        seen &= (pixels >= 0.0).all(axis=1) & (pixels < (camera.width, camera.height)).all(axis=1)
        found = grid.near(view, 150.0)
        assert set(np.flatnonzero(seen).tolist()) <= set(found.tolist())
        assert (np.diff(found) > 0).all()


def test_a_camera_that_looks_ahead_searches_a_wedge_and_one_that_looks_down_all_around() -> None:
    found = {}
    for camera in (CAMERAS[0], CAMERAS[4]):
        inwards = field_of_view(camera.view(STRAIGHT.pose(0.0)))
        found[camera] = [x * 10.0 + y * 0.1 > 0.0 for x, y in inwards]
    assert found[CAMERAS[0]] == [True, True]
    assert found[CAMERAS[4]] == []


def test_each_kind_is_seen_by_its_own_numbers() -> None:
    wall = np.array([[[50, 3, 0], [50, -3, 0], [50, -3, 3], [50, 3, 3]]], np.float32)
    count = 2
    uprights = Uprights(
        np.concatenate([wall, wall[:, ::-1]]),
        np.zeros((count, 3)),
        np.zeros(count, np.uint8),
        np.zeros(count, np.int32),
        np.zeros(count, np.bool_),
        np.zeros((count, 2), np.float32),
    )
    scene = Scene(surface_of(QUAD), two_lanes(STRAIGHT).marks, uprights)
    surfaces, marks, seen = scene.seen(VIEW)
    assert surfaces.index.tolist() == [0]
    assert 0 < len(marks.index) < len(scene.marks.quads)
    assert marks.index.max() < len(scene.marks.quads)
    assert seen.index.tolist() == [0]
    assert len(scene.seen(Camera(yaw=math.pi).view(STRAIGHT.pose(80.0)))[2].index) == 1


def test_a_road_over_another_is_a_bridge_and_a_hill_is_not() -> None:
    over = QUAD + np.array([0, 0, 6], np.float32)
    hill = QUAD + np.array([100, 0, 6], np.float32)
    assert scene_with(np.concatenate([QUAD, over, hill])).bridge.tolist() == [False, True, False]


def test_marks_of_two_sources_are_put_together() -> None:
    marks = two_lanes(STRAIGHT).marks
    both = joined_marks(marks, marks)
    assert len(both.quads) == len(both.colour) == 2 * len(marks.quads)


def test_a_scene_is_kept_for_the_next_camera_on_the_same_map_and_paint(tmp_path: Path) -> None:
    painted = road(
        length=120, lanes=section(lane(1), lane(-1), centre='<roadMark sOffset="0" type="solid" width="0.15"/>')
    )
    plain = network(tmp_path, painted)
    worn = plain.with_mark_quality([MarkStretch("1", None, 0.0, 60.0, 0.5, 0.5)])
    line = SecondaryLine("1", 0.0, 20.0, 1.0, "yellow", False, 0.12, 1.0)
    kept = scene_of(plain)
    assert scene_of(network(tmp_path, painted)) is kept
    assert (scene_of(worn).marks.quality == 0.5).any()
    assert len(scene_of(plain, [line]).marks.quads) > len(kept.marks.quads)
    assert (scene_of(plain).marks.quality == kept.marks.quality).all()


def test_the_surfaces_of_the_last_maps_are_kept(tmp_path: Path) -> None:
    maps = []
    for number in range(KEPT_MAPS + 1):
        folder = tmp_path / str(number)
        folder.mkdir()
        maps.append(network(folder, road(length=100 + number, lanes=section(lane(1), lane(-1)))))
    first, *others = [scene_of(one).surface for one in maps]
    assert [scene_of(one).surface for one in maps[1:]] == others
    assert scene_of(maps[0]).surface is not first
