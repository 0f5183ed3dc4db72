"""A pinhole camera mounted on a vehicle, which maps points of the world and of the ground to pixels.

Frames used here:

    world    OpenDRIVE's axes: x east, y north, z up, metres.
    vehicle  x ahead, y left, z up; origin at the reference point (middle of the rear axle, on the ground). Heading,
             pitch and roll turn about z, y and x in this order, right-handed (ISO 8855): a positive pitch lowers the
             nose.
    ground   x ahead, y left along the vehicle, on the plane that its wheels stand on; origin on that plane below the
             camera.
    camera   x right, y down, z ahead along the optical axis, metres. A point's z is its depth.
    image    u right, v down, pixels; integers are the centres of pixels, and the principal point is at
             (width / 2, height / 2), as in CARLA's intrinsics.
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
    """A pinhole camera and its mounting; by default the AISA toolkit's at half its resolution.

    The mounting is turned by yaw, then pitch, then roll. CARLA's rotations have the same order and the same signs,
    except that yaw is clockwise there, because y is to the right.

    Attributes:
        width: Columns of the image, pixels.
        height: Rows of the image, pixels.
        fov: Horizontal field of view, rad.
        x: Distance ahead of the centre of the vehicle's bounding box (CARLA's actor origin), m.
        y: Distance to the left of that centre, m.
        z: Height above the ground, m.
        yaw: Turn of the optical axis to the left, rad; pi looks back.
        pitch: Upward turn of the optical axis, rad; negative looks down.
        roll: Turn about the optical axis, rad; positive lowers the camera's right side.
        windscreen: Whether it looks through a windscreen, on which rain leaves drops.
    """

    width: int = 512
    height: int = 256
    fov: float = math.radians(45.0)
    x: float = 0.5
    y: float = 0.0
    z: float = 1.3
    yaw: float = 0.0
    pitch: float = math.radians(-5.0)
    roll: float = 0.0
    windscreen: bool = True

    @property
    def focal(self) -> float:
        """Focal length, pixels."""
        return self.width / 2.0 / math.tan(self.fov / 2.0)

    @property
    def rotation(self) -> Floats:
        """(3, 3) matrix that transforms directions from the vehicle's axes to the camera's."""
        cy, sy = math.cos(self.yaw), math.sin(self.yaw)
        cp, sp = math.cos(self.pitch), math.sin(self.pitch)
        cr, sr = math.cos(self.roll), math.sin(self.roll)
        ahead = np.array([cy * cp, sy * cp, sp])
        left = np.array([-sy, cy, 0.0])
        up = np.array([-cy * sp, -sy * sp, cp])
        return np.array([-(left * cr + up * sr), left * sr - up * cr, ahead])

    def view(self, pose: Pose, box_offset: float = 0.0) -> View:
        """Return the camera placed in the world.

        Args:
            pose: Pose of the vehicle's reference point.
            box_offset: Distance from the reference point ahead to the centre of the bounding box, m.
        """
        axes = vehicle_axes(pose)
        foot = np.array([pose.x, pose.y, pose.z]) + axes[:, 0] * (box_offset + self.x) + axes[:, 1] * self.y
        return View(self, pose, foot, foot + axes[:, 2] * self.z, self.rotation @ axes.T)

    def project_ground(
        self, x: ArrayLike, y: ArrayLike, pitch: float = 0.0, z: ArrayLike = 0.0
    ) -> tuple[Floats, Floats]:
        """Return the pixels (u, v) of points on the ground; NaN for points that are not in front of the lens.

        Args:
            x: Ground coordinate ahead, m, any shape.
            y: Ground coordinate left, m, of the same shape.
            pitch: Upward tilt of the camera relative to its mounting, rad: positive where the ground ahead falls away.
            z: Height above the plane of the ground, m, of the same shape as x.
        """
        ahead, left = np.asarray(x, np.float64), np.asarray(y, np.float64)
        cos, sin = math.cos(pitch), math.sin(pitch)
        right, down, depth = self.rotation @ np.array([[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]])
        height = np.asarray(z, np.float64) - self.z
        far = depth[0] * ahead + depth[1] * left + depth[2] * height
        far = np.where(far > 1e-3, far, np.nan)
        u = self.width / 2.0 + (right[0] * ahead + right[1] * left + right[2] * height) / far * self.focal
        v = self.height / 2.0 + (down[0] * ahead + down[1] * left + down[2] * height) / far * self.focal
        return u, v


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

    def world_to_ground(self, points: ArrayLike) -> Floats:
        """Return ground coordinates (..., 2) of world points (..., 3), projected square to the ground plane."""
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
