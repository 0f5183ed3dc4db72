import math

import numpy as np
import pytest

from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.lens import REACH, Lens
from tests.perception.scenery import horizon

CAMERAS = (
    Camera(width=96, height=64),
    Camera(width=96, height=64, y=-0.6, yaw=1.9, pitch=-0.2, roll=0.3),
    Camera(width=96, height=64, fov=math.radians(120.0), pitch=0.1),
    Camera(width=96, height=64, pitch=-math.pi / 2, z=25.0),
)


@pytest.mark.parametrize("camera", CAMERAS)
def test_each_pixel_sees_the_point_that_is_projected_to_it(camera: Camera) -> None:
    lens = Lens(camera)
    rows, columns = np.mgrid[lens.top : camera.height, 0 : camera.width]
    near = lens.sees_ground & (np.hypot(lens.x, lens.y) < 0.9 * REACH)
    u, v = camera.project_ground(lens.x[near], lens.y[near])
    assert near.any()
    assert np.allclose(u, columns[near], atol=1e-2)
    assert np.allclose(v, rows[near], atol=1e-2)


@pytest.mark.parametrize("camera", CAMERAS)
def test_depth_and_distance_are_those_of_the_point(camera: Camera) -> None:
    lens = Lens(camera)
    near = lens.sees_ground & (np.hypot(lens.x, lens.y) < 0.9 * REACH)
    x, y = lens.x[near].astype(float), lens.y[near].astype(float)
    ahead = camera.rotation[2]
    assert np.allclose(lens.depth[near], ahead[0] * x + ahead[1] * y - ahead[2] * camera.z, rtol=1e-4)
    assert np.allclose(lens.distance[near], np.sqrt(x * x + y * y + camera.z**2), rtol=1e-4)


def test_a_pixel_reaches_as_far_as_the_next_row() -> None:
    camera = CAMERAS[0]
    lens = Lens(camera)
    middle = camera.width // 2
    reach = -np.diff(lens.x[20:, middle].astype(float))
    assert np.allclose(lens.footprint[20:-1, middle], reach, rtol=0.15)


def test_there_is_sky_over_the_horizon_and_none_below_it() -> None:
    camera = CAMERAS[0]
    lens = Lens(camera)
    assert lens.top == lens.sky_rows == math.ceil(horizon(camera)) + 1
    assert lens.sees_ground.all()


def test_a_camera_that_looks_up_sees_no_ground() -> None:
    lens = Lens(Camera(width=96, height=64, pitch=math.radians(60.0)))
    assert not lens.sees_ground.any()
    assert (lens.top, lens.sky_rows) == (63, 64)
