"""A pinhole camera mounted on a vehicle: where points of the world and of the ground lie in its image.

Frames used here:
    world    OpenDRIVE's axes: x east, y north, z up, metres.
    vehicle  x ahead, y left, z up; origin at the reference point (middle of the rear axle, on the ground).
    Heading, pitch and
             roll turn about z, y and x in this order, right-handed (ISO 8855): a positive pitch lowers the
             nose.
    ground   x ahead, y left, on the plane that the wheels stand on; origin on that plane below the camera.
    camera   x right, y down, z ahead along the optical axis, metres.
    image    u right, v down, pixels, with the principal point at (width / 2, height / 2), as CARLA's
    intrinsics have it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scenario_compiler.roads.positions import Pose

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Camera:
    """A pinhole camera and where it is mounted; by default the AISA toolkit's at half its resolution.

    Attributes:
        width: Columns of the image, pixels.
        height: Rows of the image, pixels.
        fov: Horizontal field of view, rad.
        x: Distance ahead of the centre of the vehicle's bounding box (CARLA's actor origin), m.
        z: Height above the ground, m.
        pitch: Upward turn of the optical axis, rad; negative looks down, as CARLA's camera pitch does.
    """

    width: int = 512
    height: int = 256
    fov: float = math.radians(45.0)
    x: float = 0.5
    z: float = 1.3
    pitch: float = math.radians(-5.0)

    @property
    def focal(self) -> float:
        """Focal length, pixels."""
        return self.width / 2.0 / math.tan(self.fov / 2.0)

    @property
    def horizon(self) -> float:
        """Image row at which the ground plane vanishes, pixels."""
        return self.height / 2.0 + self.focal * math.tan(self.pitch)

    def view(self, pose: Pose, box_offset: float = 0.0) -> View:
        """Return the camera placed in the world.

        Args:
            pose: Pose of the vehicle's reference point.
            box_offset: Distance from the reference point ahead to the centre of the bounding box, m.
        """
        axes = vehicle_axes(pose)
        foot = np.array([pose.x, pose.y, pose.z]) + axes[:, 0] * (box_offset + self.x)
        rotation = _vehicle_to_camera(self.pitch) @ axes.T
        return View(self, pose, foot, foot + axes[:, 2] * self.z, rotation)

    def project_ground(self, x: ArrayLike, y: ArrayLike, pitch: float = 0.0) -> tuple[Floats, Floats]:
        """Return the pixels (u, v) of points on the ground; NaN for points that are not ahead of the lens.

        Args:
            x: Ground coordinate ahead, m, any shape.
            y: Ground coordinate left, m, of the same shape.
            pitch: Upward tilt of the camera, rad, beyond its mounting: positive where the ground ahead falls
                away.
        """
        ahead, left = np.asarray(x, np.float64), np.asarray(y, np.float64)
        up, cos, sin = -self.z, math.cos(self.pitch + pitch), math.sin(self.pitch + pitch)
        depth = ahead * cos + up * sin
        down = ahead * sin - up * cos
        depth = np.where(depth > 1e-3, depth, np.nan)
        u = self.width / 2.0 - left / depth * self.focal
        v = self.height / 2.0 + down / depth * self.focal
        return u, v

    def ground_coordinates(self, first_row: int, reach: float = 400.0) -> tuple[Floats, Floats]:
        """Return the ground points (x, y), each (height - first_row, width), that the pixels below `first_row` see.

        Rays at or above the horizon are laid down at `reach` metres ahead.
        """
        v, u = np.mgrid[first_row : self.height, 0 : self.width].astype(np.float64)
        right, down = (u - self.width / 2.0) / self.focal, (v - self.height / 2.0) / self.focal
        cos, sin = math.cos(self.pitch), math.sin(self.pitch)
        ahead = cos + down * sin
        fall = down * cos - sin
        scale = np.minimum(self.z / np.maximum(fall, 1e-9), reach / np.maximum(ahead, 1e-3))
        return ahead * scale, -right * scale


@dataclass(frozen=True, eq=False)
class View:
    """A camera placed in the world.

    Attributes:
        camera: The camera.
        pose: Pose of the vehicle that carries it.
        foot: (3,) point on the vehicle's ground plane below the camera, world.
        position: (3,) optical centre, world.
        rotation: (3, 3) world to camera.
    """

    camera: Camera
    pose: Pose
    foot: Floats
    position: Floats
    rotation: Floats

    def to_camera(self, points: ArrayLike) -> Floats:
        """Return world points (..., 3) in camera axes."""
        return (np.asarray(points, np.float64) - self.position) @ self.rotation.T

    def to_image(self, points: Floats) -> Floats:
        """Return camera points (..., 3), all with z > 0, as pixels (..., 2)."""
        camera = self.camera
        centre = np.array([camera.width / 2.0, camera.height / 2.0])
        pixels: Floats = points[..., :2] * (camera.focal / points[..., 2:]) + centre
        return pixels

    def ground_to_world(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Return points (..., 3) of the world for ground coordinates x, y (...) of this view."""
        axes = vehicle_axes(self.pose)
        ahead, left = np.asarray(x, np.float64)[..., None], np.asarray(y, np.float64)[..., None]
        points: Floats = self.foot + ahead * axes[:, 0] + left * axes[:, 1]
        return points

    def world_to_ground(self, points: ArrayLike) -> Floats:
        """Return ground coordinates (..., 2) of world points (..., 3), seen square to the vehicle's ground plane."""
        axes = vehicle_axes(self.pose)
        return (np.asarray(points, np.float64) - self.foot) @ axes[:, :2]


def vehicle_axes(pose: Pose) -> Floats:
    """Return the (3, 3) matrix whose columns are the vehicle's ahead, left and up directions in the world."""
    ch, sh = math.cos(pose.heading), math.sin(pose.heading)
    cp, sp = math.cos(pose.pitch), math.sin(pose.pitch)
    cr, sr = math.cos(pose.roll), math.sin(pose.roll)
    return np.array(
        [
            [ch * cp, ch * sp * sr - sh * cr, ch * sp * cr + sh * sr],
            [sh * cp, sh * sp * sr + ch * cr, sh * sp * cr - ch * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def _vehicle_to_camera(pitch: float) -> Floats:
    cos, sin = math.cos(pitch), math.sin(pitch)
    return np.array([[0.0, -1.0, 0.0], [sin, 0.0, -cos], [cos, 0.0, sin]])
