"""The only place that converts between OpenDRIVE's and CARLA's axes.

OpenDRIVE: x east, y north, z up, heading counter-clockwise in radians. CARLA: x east, y south, z up, yaw clockwise seen
from above, in degrees. An entity's reference point here is the centre of its rear axle on the ground; CARLA's actor
origin is the centre of its box, on the ground.
"""

from __future__ import annotations

import math


def point_from_carla(x: float, y: float) -> tuple[float, float]:
    """Return a point of CARLA's world in OpenDRIVE's axes, m."""
    return x, -y


def heading_from_carla(yaw: float) -> float:
    """Return the heading in [0, 2 pi) of a CARLA yaw in degrees."""
    return math.radians(-yaw) % (2 * math.pi)


def point_to_carla(x: float, y: float) -> tuple[float, float]:
    """Return a point in OpenDRIVE's axes in CARLA's world, m."""
    return x, -y


def yaw_to_carla(heading: float) -> float:
    """Return the CARLA yaw in degrees, in (-180, 180], of a heading in radians."""
    yaw = -math.degrees(heading) % 360.0
    return yaw - 360.0 if yaw > 180.0 else yaw


def reference_from_center(x: float, y: float, heading: float, center: float) -> tuple[float, float]:
    """Return the rear axle's position when the box's centre, `center` m ahead of it, is at (x, y)."""
    return x - center * math.cos(heading), y - center * math.sin(heading)


def center_from_reference(x: float, y: float, heading: float, center: float) -> tuple[float, float]:
    """Return the position of the box's centre, `center` m ahead of the rear axle at (x, y)."""
    return x + center * math.cos(heading), y + center * math.sin(heading)
