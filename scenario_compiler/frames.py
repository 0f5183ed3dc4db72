"""Converts between the axes of OpenDRIVE and CARLA; no other module does.

OpenDRIVE: x east, y north, z up; heading counter-clockwise, pitch positive with the nose down, roll positive with the
left side up, in radians. CARLA: x east, y south, z up; yaw clockwise seen from above, pitch positive with the nose up,
roll positive with the left side up, in degrees. An entity's reference point here is the centre of its rear axle on the
ground; CARLA's actor origin is the centre of its box, on the ground, and of a walker the centre of its box.

Angles are intrinsic in the order heading, pitch, roll on both sides.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class CarlaTransform(NamedTuple):
    """A place and an orientation in CARLA's axes, m and degrees, in the order of CARLA's own fields."""

    x: float
    y: float
    z: float
    pitch: float
    yaw: float
    roll: float


class Placement(NamedTuple):
    """A place and an orientation in OpenDRIVE's axes, m and rad, in the order of `roads.Pose`."""

    x: float
    y: float
    z: float
    heading: float
    pitch: float
    roll: float


def point_from_carla(x: float, y: float) -> tuple[float, float]:
    """Return a point of CARLA's world in OpenDRIVE's axes, m."""
    return x, -y


def vector_from_carla(x: float, y: float, z: float) -> tuple[float, float, float]:
    """Return a vector of CARLA's world, such as a velocity, in OpenDRIVE's axes; it also converts back."""
    return x, -y, z


def heading_from_carla(yaw: float) -> float:
    """Return the heading in [0, 2 pi) of a CARLA yaw in degrees."""
    return math.radians(-yaw) % (2 * math.pi)


ROUNDED = 1e-6
"""Tolerance for a yaw of half a turn, degrees: numbers of 32 bits do not distinguish smaller differences."""


def yaw_from_heading(heading: float) -> float:
    """Return the CARLA yaw in (-180, 180] degrees of a heading in radians; a yaw that rounds to -180 becomes 180."""
    return (180.0 - ROUNDED - math.degrees(heading)) % 360.0 - (180.0 - ROUNDED)


def reference_from_center(x: float, y: float, heading: float, center: float) -> tuple[float, float]:
    """Return the rear axle's position when the box's centre, `center` m ahead of it, is at (x, y)."""
    return x - center * math.cos(heading), y - center * math.sin(heading)


def center_from_reference(x: float, y: float, heading: float, center: float) -> tuple[float, float]:
    """Return the position of the box's centre, `center` m ahead of the rear axle at (x, y)."""
    return x + center * math.cos(heading), y + center * math.sin(heading)


def _moved(at: tuple[float, ...], ahead: float, up: float) -> tuple[float, float, float]:
    """Return the point at these distances ahead of and above a placement, in its own axes, m."""
    x, y, z, heading, pitch, roll = at
    ch, sh, cp, sp = math.cos(heading), math.sin(heading), math.cos(pitch), math.sin(pitch)
    cr, sr = math.cos(roll), math.sin(roll)
    return (
        x + ahead * ch * cp + up * (ch * sp * cr + sh * sr),
        y + ahead * sh * cp + up * (sh * sp * cr - ch * sr),
        z - ahead * sp + up * cp * cr,
    )


def carla_from_pose(pose: tuple[float, ...], center: float = 0.0, up: float = 0.0) -> CarlaTransform:
    """Return the transform of a CARLA actor.

    Args:
        pose: The entity's pose, in the order of `Placement`.
        center: Distance from the reference point forward to the box's centre, m.
        up: Height of the actor's origin over the ground, m: 0 for a vehicle, half the box's height for a walker.
    """
    x, y, z = _moved(pose, center, up)
    _, _, _, heading, pitch, roll = pose
    return CarlaTransform(x, -y, z, -math.degrees(pitch), yaw_from_heading(heading), math.degrees(roll))


def pose_from_carla(transform: tuple[float, ...], center: float = 0.0, up: float = 0.0) -> Placement:
    """Return the entity's pose of a CARLA actor's transform; `carla_from_pose` has the arguments."""
    x, y, z, pitch, yaw, roll = transform
    turned = (heading_from_carla(yaw), -math.radians(pitch), math.radians(roll))
    return Placement(*_moved((x, -y, z, *turned), -center, -up), *turned)


def carla_rows(poses: NDArray[np.float64], center: NDArray[np.float64], up: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the transforms of `carla_from_pose` for many entities at once.

    Args:
        poses: (6, entities) columns in the order of `Placement`.
        center: (entities,), as in `carla_from_pose`.
        up: (entities,), as in `carla_from_pose`.

    Returns:
        (entities, 6), in the order of `CarlaTransform`.
    """
    import numpy as np

    x, y, z, heading, pitch, roll = poses
    ch, sh, cp, sp = np.cos(heading), np.sin(heading), np.cos(pitch), np.sin(pitch)
    cr, sr = np.cos(roll), np.sin(roll)
    rows = np.empty((len(x), 6))
    rows[:, 0] = x + center * ch * cp + up * (ch * sp * cr + sh * sr)
    rows[:, 1] = -(y + center * sh * cp + up * (sh * sp * cr - ch * sr))
    rows[:, 2] = z - center * sp + up * cp * cr
    rows[:, 3] = -np.degrees(pitch)
    rows[:, 4] = (180.0 - ROUNDED - np.degrees(heading)) % 360.0 - (180.0 - ROUNDED)
    rows[:, 5] = np.degrees(roll)
    return rows


def carla_axes(pitch: float, yaw: float, roll: float) -> tuple[tuple[float, float, float], ...]:
    """Return the directions ahead, right and up of a CARLA rotation in degrees, in CARLA's axes."""
    cp, sp = math.cos(math.radians(pitch)), math.sin(math.radians(pitch))
    cy, sy = math.cos(math.radians(yaw)), math.sin(math.radians(yaw))
    cr, sr = math.cos(math.radians(roll)), math.sin(math.radians(roll))
    return (
        (cp * cy, cp * sy, sp),
        (cy * sp * sr - sy * cr, sy * sp * sr + cy * cr, -cp * sr),
        (-cy * sp * cr - sy * sr, -sy * sp * cr + cy * sr, cp * cr),
    )


def carla_attached(parent: tuple[float, ...], relative: tuple[float, ...]) -> CarlaTransform:
    """Return the transform in CARLA's world of an object attached to a parent, in the order of `CarlaTransform`."""
    ahead, right, up = carla_axes(*parent[3:])
    x, y, z = (parent[k] + relative[0] * ahead[k] + relative[1] * right[k] + relative[2] * up[k] for k in range(3))
    if relative[3] == relative[5] == 0.0 == parent[3] == parent[5]:
        return CarlaTransform(x, y, z, 0.0, (parent[4] + relative[4] + 180.0) % 360.0 - 180.0, 0.0)
    own = carla_axes(*relative[3:])
    turned = [[sum(axis[k] * one[c] for k, one in enumerate((ahead, right, up))) for c in range(3)] for axis in own]
    pitch = math.asin(min(max(turned[0][2], -1.0), 1.0))
    yaw = math.atan2(turned[0][1], turned[0][0])
    roll = math.atan2(-turned[1][2], turned[2][2])
    return CarlaTransform(x, y, z, math.degrees(pitch), math.degrees(yaw), math.degrees(roll))
