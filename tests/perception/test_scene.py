import math

import numpy as np

from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.scene import QuadGrid, RoadScene, project
from scenario_compiler.roads.mesh import Material, Surface
from tests.perception.scenery import bend, two_lanes

STRAIGHT = bend(0.0)
QUAD = np.array([[[40, 2, 0], [60, 2, 0], [60, -2, 0], [40, -2, 0]]], np.float32)
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


def scene_with(quads: np.ndarray) -> RoadScene:
    return RoadScene(surface_of(quads), two_lanes(STRAIGHT).marks)


def test_neighbouring_lanes_are_joined() -> None:
    right = QUAD - np.array([0, 4, 0], np.float32)
    joined = scene_with(np.concatenate([QUAD, right])).surface_grid.quads
    assert joined.shape == (1, 4, 3)
    assert (joined[0, :2] == QUAD[0, :2]).all()
    assert (joined[0, 2:] == right[0, 2:]).all()


def test_slivers_that_neighbour_each_other_on_both_sides_do_no_harm() -> None:
    twisted = QUAD[:, [3, 2, 1, 0]]
    assert len(scene_with(np.concatenate([QUAD, twisted, QUAD])).surface_grid.quads) >= 1


def test_only_what_is_before_the_camera_is_looked_at() -> None:
    behind = QUAD - np.array([80, 0, 0], np.float32)
    far = QUAD + np.array([900, 0, 0], np.float32)
    beside = QUAD + np.array([0, 300, 0], np.float32)
    grid = QuadGrid(np.concatenate([behind, QUAD, far, beside]))
    assert grid.ahead(VIEW, 200.0).tolist() == [1]


def test_quads_that_reach_behind_the_lens_are_clipped() -> None:
    long = np.array([[[-50, 2, 0], [60, 2, 0], [60, -2, 0], [-50, -2, 0]]], np.float32)
    seen = project(VIEW, QuadGrid(long), 200.0, 0)
    assert len(seen.polygons) == 1
    assert seen.polygons[0][:, 1].max() > 256 << 4
    assert math.isinf(seen.thickness[0])


def test_a_quad_over_the_camera_is_seen_from_below() -> None:
    over = QUAD + np.array([0, 0, 6], np.float32)
    seen = project(VIEW, QuadGrid(np.concatenate([QUAD, over])), 200.0, 0)
    assert dict(zip(seen.index.tolist(), seen.from_below.tolist(), strict=True)) == {0: False, 1: True}
    assert sorted(np.round(seen.height).tolist()) == [0.0, 6.0]
