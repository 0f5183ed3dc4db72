import math

import numpy as np
import pytest

from scenario_compiler.perception.camera import Camera, vehicle_axes
from scenario_compiler.roads.positions import Pose

LEVEL = Pose(10.0, -4.0, 2.0, 0.7, 0.0, 0.0)
TILTED = Pose(10.0, -4.0, 2.0, 0.7, -0.05, 0.03)


@pytest.mark.parametrize("pose", [LEVEL, TILTED])
def test_ground_points_land_where_their_world_points_do(pose: Pose) -> None:
    camera = Camera()
    view = camera.view(pose, box_offset=1.4)
    x, y = np.array([5.0, 12.0, 30.0]), np.array([-1.8, 0.4, 2.0])
    u, v = camera.project_ground(x, y)
    pixels = view.to_image(view.to_camera(view.ground_to_world(x, y)))
    assert np.allclose(pixels, np.stack([u, v], axis=1), atol=1e-9)


@pytest.mark.parametrize("pose", [LEVEL, TILTED])
def test_world_to_ground_undoes_ground_to_world(pose: Pose) -> None:
    view = Camera().view(pose, box_offset=1.4)
    there = view.ground_to_world([3.0, 20.0], [1.0, -2.0])
    assert np.allclose(view.world_to_ground(there), [[3.0, 1.0], [20.0, -2.0]])


def test_the_camera_stands_ahead_of_the_box_centre_and_above_the_ground() -> None:
    view = Camera(x=0.5, z=1.3).view(Pose(0.0, 0.0, 0.0, math.pi / 2, 0.0, 0.0), box_offset=1.4)
    assert np.allclose(view.position, [0.0, 1.9, 1.3])


def test_a_positive_pitch_lowers_the_nose_and_a_positive_roll_lifts_the_left() -> None:
    ahead, left, up = vehicle_axes(Pose(0.0, 0.0, 0.0, 0.0, 0.1, 0.2)).T
    assert ahead[2] < 0.0 < left[2]
    assert np.allclose(np.cross(ahead, left), up)


def test_negative_camera_pitch_looks_down() -> None:
    assert Camera(pitch=math.radians(-5.0)).horizon < Camera().height / 2


def test_ground_coordinates_undo_the_projection() -> None:
    camera = Camera(width=64, height=32)
    x, y = camera.ground_coordinates(20)
    u, v = camera.project_ground(x, y)
    rows, columns = np.mgrid[20:32, 0:64]
    assert np.allclose(u, columns, atol=1e-6)
    assert np.allclose(v, rows, atol=1e-6)


def test_points_behind_the_lens_are_not_seen() -> None:
    u, v = Camera().project_ground([-5.0, 10.0], [0.0, 0.0])
    assert np.isnan(u[0])
    assert np.isnan(v[0])
    assert np.isfinite(u[1])


def test_a_falling_road_moves_ground_points_down_the_image() -> None:
    camera = Camera()
    assert camera.project_ground(20.0, 0.0, pitch=0.02)[1] > camera.project_ground(20.0, 0.0)[1]
