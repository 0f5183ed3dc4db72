"""An exposure smears what moves by as much as the vehicle's motion says, and nothing else."""

import math
from dataclasses import replace

import cv2
import numpy as np
import pytest

from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.degradation import Degradation
from scenario_compiler.perception.road_camera import RoadCamera
from scenario_compiler.perception.smear import far_homography, plane_homography, smeared
from scenario_compiler.roads import Pose
from scenario_compiler.vocabulary.sensors import EXPOSURE_AT_ONE, SEVERITIES
from tests.perception.scenery import CLEAR, bend, two_lanes

CAMERA, LEVER = Camera(), 1.4
HERE = Pose(40.0, 0.3, 0.0, 0.02, 0.0, 0.0)


def after(distance: float, turn: float) -> Pose:
    """Where the reference point is when it has gone along an arc."""
    heading = HERE.heading + 0.5 * turn
    chord = distance * (math.sin(0.5 * turn) / (0.5 * turn) if turn else 1.0)
    x, y = HERE.x + chord * math.cos(heading), HERE.y + chord * math.sin(heading)
    return HERE._replace(x=x, y=y, heading=HERE.heading + turn)


@pytest.mark.parametrize(("distance", "turn"), [(1.5, 0.0), (0.8, 0.1), (-0.5, -0.05), (0.0, 0.0)])
@pytest.mark.parametrize("camera", [CAMERA, Camera(y=0.4, yaw=0.1, pitch=-0.2, roll=0.05)])
def test_the_homography_is_where_points_of_the_road_were(camera: Camera, distance: float, turn: float) -> None:
    points = np.array([[46.0, 1.0, 0.0], [50.0, -2.0, 0.0], [70.0, 3.0, 0.0]])
    before, now = (camera.view(pose, LEVER) for pose in (HERE, after(distance, turn)))
    u, v = now.to_image(now.to_camera(points)).T
    seen = plane_homography(camera, LEVER, distance, turn) @ np.stack([u, v, np.ones(3)])
    assert np.allclose((seen[:2] / seen[2]).T, before.to_image(before.to_camera(points)), atol=1e-6)
    far = points + np.array([1e9, 1e8, 2e8])
    u, v = now.to_image(now.to_camera(far)).T
    seen = far_homography(camera, turn) @ np.stack([u, v, np.ones(3)])
    assert np.allclose((seen[:2] / seen[2]).T, before.to_image(before.to_camera(far)), atol=1e-4)


@pytest.mark.parametrize(("speed", "yaw_rate"), [(25.0, 0.0), (10.0, 0.4)])
def test_the_smear_is_the_mean_of_the_images_of_the_exposure(speed: float, yaw_rate: float) -> None:
    """Held against pictures of 61 poses: what is left is a fifth of what the exposure changes."""
    camera, exposure = RoadCamera(two_lanes(bend(0.0))), 0.05
    times = 0.5 * exposure * ((2.0 * np.arange(61) + 1.0) / 61 - 1.0)
    images = [camera.frame(after(speed * t, yaw_rate * t), [], CLEAR, 0.0, 0) for t in times.tolist()]
    true = np.mean(images, axis=0)[80:]
    state = Degradation(exposure=exposure, speed=speed, yaw_rate=yaw_rate)
    left, changed = (np.abs(camera.frame(HERE, [], CLEAR, one, 0)[80:] - true).mean() for one in (state, Degradation()))
    assert changed > 2.0
    assert left < 0.3 * changed


def test_a_car_that_stands_sees_sharply_however_long_the_exposure() -> None:
    image = np.random.default_rng(1).integers(0, 256, (256, 512, 3), dtype=np.uint8)
    assert smeared(image, CAMERA, LEVER, 0.0, 0.0, 0.1) is image
    assert smeared(image, CAMERA, LEVER, 20.0, 0.1, 0.0) is image


def test_the_sky_is_smeared_only_by_turning() -> None:
    image = np.random.default_rng(1).integers(0, 256, (256, 512, 3), dtype=np.uint8)
    straight, turning = (smeared(image, CAMERA, LEVER, 20.0, rate, 0.05) for rate in (0.0, 0.5))
    assert np.array_equal(straight[:70], image[:70])
    assert turning[:70].std() < 0.6 * image[:70].std()


@pytest.mark.parametrize("threads", [2, 7])
def test_the_smear_does_not_depend_on_the_number_of_threads(threads: int) -> None:
    image = np.random.default_rng(1).integers(0, 256, (256, 512, 3), dtype=np.uint8)
    before = cv2.getNumThreads()
    try:
        cv2.setNumThreads(1)
        alone = smeared(image, CAMERA, LEVER, 20.0, 0.2, 0.03)
        cv2.setNumThreads(threads)
        assert np.array_equal(smeared(image, CAMERA, LEVER, 20.0, 0.2, 0.03), alone)
    finally:
        cv2.setNumThreads(before)


@pytest.mark.parametrize(
    ("severity", "radius", "sigma"), [(1, 10, 3), (2, 15, 5), (3, 15, 8), (4, 15, 12), (5, 20, 15)]
)
def test_severities_smear_the_road_as_far_as_the_kernels_of_imagenet_c(
    severity: int, radius: int, sigma: float
) -> None:
    """ImageMagick's kernel of a radius and a sigma: half of a Gaussian over 2 radius + 1 pixels."""
    i = np.arange(2 * radius + 1)
    kernel = np.exp(-0.5 * (i / sigma) ** 2)
    kernel /= kernel.sum()
    length = math.sqrt(12.0 * (kernel @ (i * i) - (kernel @ i) ** 2))
    u, v = (one.ravel() for one in np.meshgrid(np.arange(512.0), np.arange(76.0, 256.0)))
    seen = plane_homography(CAMERA, LEVER, 1e-4, 0.0) @ np.stack([u, v, np.ones(len(u))])
    a_metre = np.hypot(*(seen[:2] / seen[2] - np.stack([u, v]))).mean() / 1e-4 * 224.0 / 512.0
    exposure = EXPOSURE_AT_ONE * SEVERITIES["motion_blur"][severity - 1]
    assert a_metre * exposure * 100.0 / 3.6 == pytest.approx(length, rel=0.01)


def test_a_turned_camera_sees_the_same_as_one_with_that_mounting() -> None:
    scene, turned = two_lanes(bend(0.0)), (0.03, -0.02, 0.05)
    camera = RoadCamera(scene)
    clean = camera.frame(HERE, [], CLEAR, 0.0, 0)
    mounted = replace(CAMERA, yaw=turned[0], pitch=CAMERA.pitch + turned[1], roll=turned[2])
    seen = camera.frame(HERE, [], CLEAR, Degradation(turned=turned), 0)
    assert np.array_equal(seen, RoadCamera(scene, mounted).frame(HERE, [], CLEAR, 0.0, 0))
    assert np.array_equal(camera.frame(HERE, [], CLEAR, 0.0, 0), clean)
