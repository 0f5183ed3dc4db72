"""Motion blur: the motion of the vehicle during an exposure smears the image.

A sensor adds up the light of its exposure, so an image is the mean of the views in that time (Potmesil and Chakravarty
1983, "Modeling motion blur in computer-generated images"). Speed and yaw rate are constant for so short a time, and the
vehicle's reference point moves along an arc. Between two instants the image of the road changes by the homography that
its plane induces, and that of everything at and above the horizon by the rotation alone (Hartley and Zisserman 2004,
equation 13.2, and section 8.4). The exposure is centred on the time of the image. What enters the picture only during
the exposure is not known, so that pixels at the edge are the mean of a shorter time.

Everything that stands on the road is smeared like the road that it hides; a real vehicle ahead with the ego's speed
would stay sharp.
"""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.lens import BELOW_HORIZON

Image = NDArray[np.uint8]
Floats = NDArray[np.float64]

STEP = 2.0
"""Greatest motion of the road between two sampled instants, pixels, in the image's lower corners."""

MOST_INSTANTS = 63
"""Greatest number of sampled instants."""


def smeared(image: Image, camera: Camera, lever: float, speed: float, yaw_rate: float, exposure: float) -> Image:
    """Return the image of a longer exposure; the image itself without motion.

    Args:
        image: (height, width, 3) uint8, as with an exposure of no duration.
        camera: Its camera.
        lever: Distance ahead from the vehicle's reference point to the origin of the camera's `x`, m.
        speed: Of the reference point, m/s, negative backwards.
        yaw_rate: rad/s, positive to the left.
        exposure: s.
    """
    if exposure <= 0.0 or (speed == 0.0 and yaw_rate == 0.0):
        return image
    times = 0.5 * exposure * _instants(camera, lever, speed, yaw_rate, exposure)
    road = _road(camera)[..., None]
    known = cv2.cvtColor(image, cv2.COLOR_BGR2BGRA)
    total = np.zeros(known.shape, np.float32)
    for t in times.tolist():
        near, far = (
            cv2.warpPerspective(
                known, one, (camera.width, camera.height), flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
            )
            for one in (plane_homography(camera, lever, speed * t, yaw_rate * t), far_homography(camera, yaw_rate * t))
        )
        cv2.accumulate(np.where(road, near, far), total)
    return np.asarray(np.rint(total[..., :3] * (255.0 / total[..., 3:])), np.uint8)


def plane_homography(camera: Camera, lever: float, distance: float, turn: float) -> Floats:
    """Return the (3, 3) matrix from a pixel of the road to that of the same point before the vehicle moved.

    Args:
        camera: The camera.
        lever: See `smeared`.
        distance: Distance that the reference point has moved along its arc, m.
        turn: Left turn of the vehicle in that time, rad.
    """
    cos, sin = math.cos(turn), math.sin(turn)
    chord = math.sin(0.5 * turn) / (0.5 * turn) if abs(turn) > 1e-9 else 1.0
    x, y = lever + camera.x, camera.y
    moved = np.array([
        [cos, -sin, distance * chord * math.cos(0.5 * turn) + cos * x - sin * y - x],
        [sin, cos, distance * chord * math.sin(0.5 * turn) + sin * x + cos * y - y],
        [0.0, 0.0, 1.0],
    ])  # fmt: skip
    seen = _inner(camera) @ camera.rotation @ np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -camera.z]])
    return np.asarray(seen @ moved @ np.linalg.inv(seen))


def far_homography(camera: Camera, turn: float) -> Floats:
    """Return the (3, 3) matrix from a pixel of distant things to that of the same point before a left turn."""
    cos, sin = math.cos(turn), math.sin(turn)
    seen = _inner(camera) @ camera.rotation
    return np.asarray(seen @ np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]]) @ np.linalg.inv(seen))


def _instants(camera: Camera, lever: float, speed: float, yaw_rate: float, exposure: float) -> Floats:
    """Return the centres of an odd number of equal parts of the exposure, -1 to 1; one is the image's time."""
    corners = np.array([[0.0, camera.width - 1.0], [camera.height - 1.0, camera.height - 1.0], [1.0, 1.0]])
    moved = [
        (one @ corners)[:2] / (one @ corners)[2] - corners[:2]
        for one in (plane_homography(camera, lever, speed * t, yaw_rate * t) for t in (-0.5 * exposure, 0.5 * exposure))
    ]
    far = camera.focal * abs(yaw_rate) * exposure
    longest = max(far, *(2.0 * float(np.hypot(*one).max()) for one in moved))
    count = min(max(math.ceil(longest / STEP), 3), MOST_INSTANTS) | 1
    return (2.0 * np.arange(count) + 1.0) / count - 1.0


def _inner(camera: Camera) -> Floats:
    return np.array(
        [[camera.focal, 0.0, camera.width / 2.0], [0.0, camera.focal, camera.height / 2.0], [0.0, 0.0, 1.0]]
    )


def _road(camera: Camera) -> NDArray[np.bool_]:
    """Return which pixels (height, width) show the plane that the vehicle stands on."""
    across = (np.arange(camera.width) - camera.width / 2.0) / camera.focal
    down = (np.arange(camera.height) - camera.height / 2.0) / camera.focal
    right, below, ahead = camera.rotation[:, 2]
    fall = -(down[:, None] * below + across * right + ahead)
    return np.asarray(fall > BELOW_HORIZON / camera.focal)
