import math

import numpy as np
import pytest

from scenario_compiler.perception.camera import Camera, View, vehicle_axes
from scenario_compiler.roads.positions import Pose

LEVEL = Pose(10.0, -4.0, 2.0, 0.7, 0.0, 0.0)
TILTED = Pose(10.0, -4.0, 2.0, 0.7, -0.05, 0.03)


MOUNTINGS = (
    Camera(),
    Camera(y=0.8, yaw=math.radians(35.0), pitch=math.radians(-12.0), roll=math.radians(6.0)),
    Camera(x=-1.0, yaw=math.pi, pitch=math.radians(-3.0)),
    Camera(z=30.0, pitch=math.radians(-90.0)),
)


def on_ground(view: View, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return the points (N, 3) of the world, x m ahead and y m to the left of the camera's foot, (N,) each."""
    return view.foot + np.stack([x, y, np.zeros(len(x))], axis=1) @ vehicle_axes(view.pose).T


@pytest.mark.parametrize("camera", MOUNTINGS)
@pytest.mark.parametrize("pose", [LEVEL, TILTED])
def test_ground_points_land_where_their_world_points_do(pose: Pose, camera: Camera) -> None:
    view = camera.view(pose, box_offset=1.4)
    x, y = (grid.ravel() for grid in np.meshgrid(np.linspace(-20.0, 30.0, 9), np.linspace(-9.0, 8.0, 7)))
    u, v = camera.project_ground(x, y)
    points = view.to_camera(on_ground(view, x, y))
    seen = points[:, 2] > 1e-3
    assert np.isfinite(u).tolist() == seen.tolist()
    assert seen.any()
    assert np.allclose(view.to_image(points[seen]), np.stack([u, v], axis=1)[seen], atol=1e-6)


@pytest.mark.parametrize("pose", [LEVEL, TILTED])
def test_points_of_the_world_are_given_in_ground_coordinates(pose: Pose) -> None:
    view = Camera().view(pose, box_offset=1.4)
    points = on_ground(view, np.array([3.0, 20.0]), np.array([1.0, -2.0]))
    assert np.allclose(view.world_to_ground(points), [[3.0, 1.0], [20.0, -2.0]])


def test_the_camera_stands_ahead_of_the_box_centre_and_above_the_ground() -> None:
    view = Camera(x=0.5, z=1.3).view(Pose(0.0, 0.0, 0.0, math.pi / 2, 0.0, 0.0), box_offset=1.4)
    assert np.allclose(view.position, [0.0, 1.9, 1.3])


def test_a_positive_pitch_lowers_the_nose_and_a_positive_roll_lifts_the_left() -> None:
    ahead, left, up = vehicle_axes(Pose(0.0, 0.0, 0.0, 0.0, 0.1, 0.2)).T
    assert ahead[2] < 0.0 < left[2]
    assert np.allclose(np.cross(ahead, left), up)


@pytest.mark.parametrize("camera", MOUNTINGS)
def test_mountings_are_those_of_carla(camera: Camera) -> None:
    """CARLA's own client turns by the same angles, but for the yaw, which is clockwise there, as y is to the right."""
    carla = pytest.importorskip("carla")
    place = carla.Location(camera.x, -camera.y, camera.z)
    turn = carla.Rotation(math.degrees(camera.pitch), -math.degrees(camera.yaw), math.degrees(camera.roll))
    inverse = np.linalg.inv(np.array(carla.Transform(place, turn).get_matrix()))
    for point in ((7.0, 2.0, 0.5), (-4.0, 1.0, 3.0), (12.0, -5.0, 0.0)):
        ahead, right, up, _ = inverse @ (point[0], -point[1], point[2], 1.0)
        ours = camera.view(Pose(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)).to_camera(point)
        assert np.allclose(ours, (right, -up, ahead), atol=1e-5)


def test_a_camera_stands_left_of_the_middle_and_looks_to_its_left() -> None:
    view = Camera(x=0.0, y=1.0, z=2.0, yaw=math.pi / 2, pitch=0.0).view(Pose(5.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    assert np.allclose(view.position, [5.0, 1.0, 2.0])
    assert np.allclose(view.to_camera([5.0, 11.0, 2.0]), [0.0, 0.0, 10.0])
    assert view.to_camera([6.0, 11.0, 2.0])[0] > 0.0


def test_a_positive_roll_lowers_the_right_side_of_the_camera() -> None:
    view = Camera(roll=math.radians(10.0), pitch=0.0).view(Pose(0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    right_and_level = view.to_camera(view.position + np.array([10.0, -1.0, 0.0]))
    assert right_and_level[1] < 0.0


def test_negative_camera_pitch_looks_down() -> None:
    _, v = Camera(pitch=math.radians(-5.0)).project_ground(np.array([1e6]), np.array([0.0]))
    assert v[0] < Camera().height / 2


def test_points_behind_the_lens_are_not_seen() -> None:
    u, v = Camera().project_ground([-5.0, 10.0], [0.0, 0.0])
    assert np.isnan(u[0])
    assert np.isnan(v[0])
    assert np.isfinite(u[1])


def test_a_falling_road_moves_ground_points_down_the_image() -> None:
    camera = Camera()
    assert camera.project_ground(20.0, 0.0, pitch=0.02)[1] > camera.project_ground(20.0, 0.0)[1]
