"""The only place that converts between OpenDRIVE's and CARLA's axes.

OpenDRIVE: x east, y north, z up; heading counter-clockwise, pitch positive with the nose down, roll positive with the
left side up, in radians. CARLA: x east, y south, z up; yaw clockwise seen from above, pitch positive with the nose up,
roll positive with the left side up, in degrees. An entity's reference point here is the centre of its rear axle on the
ground; CARLA's actor origin is the centre of its box, on the ground, and of a walker the centre of its box.

Angles are intrinsic in the order heading, pitch, roll on both sides.
"""

from __future__ import annotations

import math
from typing import NamedTuple


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
    """Return a vector of CARLA's world, as a velocity, in OpenDRIVE's axes; the same converts back."""
    return x, -y, z


def heading_from_carla(yaw: float) -> float:
    """Return the heading in [0, 2 pi) of a CARLA yaw in degrees."""
    return math.radians(-yaw) % (2 * math.pi)


def yaw_from_heading(heading: float) -> float:
    """Return the CARLA yaw in [-180, 180) degrees of a heading in radians."""
    return (180.0 - math.degrees(heading)) % 360.0 - 180.0


def reference_from_center(x: float, y: float, heading: float, center: float) -> tuple[float, float]:
    """Return the rear axle's position when the box's centre, `center` m ahead of it, is at (x, y)."""
    return x - center * math.cos(heading), y - center * math.sin(heading)


def center_from_reference(x: float, y: float, heading: float, center: float) -> tuple[float, float]:
    """Return the position of the box's centre, `center` m ahead of the rear axle at (x, y)."""
    return x + center * math.cos(heading), y + center * math.sin(heading)


def _moved(at: tuple[float, ...], ahead: float, up: float) -> tuple[float, float, float]:
    """Return the point that is so far ahead of and above a placement, in its own axes, m."""
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
