"""Polygons are cut and projected as rays see them, close to the lens and around it too."""

import math

import cv2
import numpy as np
import pytest

from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.polygons import NEAR, SUBPIXEL, clip, facing, flatten, nearness_planes, thickness

CAMERA = Camera(width=160, height=120, fov=math.radians(80.0))


def rays() -> np.ndarray:
    """Return the directions of all pixels, (3, height, width), with depth 1."""
    v, u = np.mgrid[0 : CAMERA.height, 0 : CAMERA.width].astype(float)
    return np.stack([(u - 80.0) / CAMERA.focal, (v - 60.0) / CAMERA.focal, np.ones_like(u)])


def seen_by_rays(quad: np.ndarray, margin: float) -> np.ndarray:
    """Return which pixels see a planar convex quad (4, 3) beyond the near plane, grown by a margin, pixels.

    The rays that meet it lie on one side of every plane through the lens and an edge.
    """
    normal = np.cross(quad[1] - quad[0], quad[2] - quad[0])
    planes = np.cross(quad, np.roll(quad, -1, axis=0)) * math.copysign(1.0, normal @ quad[0])
    nearness = normal / (normal @ quad[0])
    planes = np.concatenate([planes, [(-nearness[0], -nearness[1], 1.0 / NEAR - nearness[2])]])
    inside = np.ones((CAMERA.height, CAMERA.width), np.bool_)
    for plane in planes:
        inside &= np.tensordot(plane, rays(), axes=1) * CAMERA.focal > -margin * math.hypot(plane[0], plane[1])
    return inside


def random_quad(draw: np.random.Generator, size: float) -> np.ndarray:
    """Return a planar convex quad somewhere around the lens."""
    angles = np.sort(draw.uniform(0.0, 2.0 * math.pi, 4))
    flat = np.stack([np.cos(angles), np.sin(angles), np.zeros(4)]) * size
    turn, _ = np.linalg.qr(draw.standard_normal((3, 3)))
    return np.asarray((turn @ flat).T + draw.uniform(-1.0, 1.0, 3) * (0.7 * size, 0.5 * size, size))


@pytest.mark.parametrize("size", [0.5, 4.0, 60.0, 900.0])
def test_clipped_polygons_cover_the_pixels_whose_rays_meet_them(size: float) -> None:
    """Many of them reach behind the lens, or many images beyond the border."""
    draw, cut = np.random.default_rng(5), 0
    for _ in range(150):
        quad = random_quad(draw, size)
        flat = flatten(quad.T[:, :, None], CAMERA)
        drawn = np.zeros((CAMERA.height, CAMERA.width), np.uint8)
        for shape in flat.shapes:
            cv2.fillConvexPoly(drawn, shape, 1, cv2.LINE_8, SUBPIXEL)
        assert not (seen_by_rays(quad, -0.6) & (drawn == 0)).any()
        assert not ((drawn == 1) & ~seen_by_rays(quad, 1.1)).any()
        cut += sum(~flat.whole)
    assert cut > 10 or size < 1.0


def test_parts_behind_the_lens_are_left_out() -> None:
    quad = np.array([[-1, -1, -5], [1, -1, -5], [1, 1, -5], [-1, 1, -5]], float).T[:, :, None]
    assert flatten(quad, CAMERA).shapes == []
    assert flatten(np.empty((3, 4, 0)), CAMERA).shapes == []


def test_cutting_keeps_the_part_on_the_kept_side() -> None:
    square = np.array([[0, 0], [4, 0], [4, 4], [0, 4]], float).T[:, :, None]
    half, count = clip(square, 1.0 - square[0], np.array([4]))
    assert count.tolist() == [4]
    assert sorted(map(tuple, half[:, :4, 0].T.tolist())) == [(0.0, 0.0), (0.0, 4.0), (1.0, 0.0), (1.0, 4.0)]
    _, count = clip(square, square[0] + square[1] - 1.0, np.array([4]))
    assert count.tolist() == [5]
    assert clip(square, -1.0 - square[0], np.array([4]))[1].tolist() == [0]


def test_nearness_is_linear_in_the_image() -> None:
    draw = np.random.default_rng(3)
    for _ in range(50):
        quad = random_quad(draw, 3.0) + np.array([0.0, 0.0, 12.0])
        a, b, c = nearness_planes(quad.T[:, :, None])[:, 0]
        for x, y, z in quad:
            assert a * x / z + b * y / z + c == pytest.approx(1.0 / z, rel=1e-6)


def test_faces_are_seen_from_the_side_where_their_corners_run_counter_clockwise() -> None:
    before = np.array([[-1, 1, 5], [1, 1, 5], [1, -1, 5], [-1, -1, 5]], float)
    both = np.stack([before, before[::-1]], axis=2).transpose(1, 0, 2)
    assert facing(both).tolist() == [True, False]


def test_a_mark_is_as_thick_as_its_shorter_side() -> None:
    long = np.array([[0, 0], [30, 0], [30, 2], [0, 2]], float).T[:, :, None]
    assert thickness(long)[0] == pytest.approx(2.0)
