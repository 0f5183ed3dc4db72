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


def reference_from_center(x: float, y: float, heading: float, center: float) -> tuple[float, float]:
    """Return the rear axle's position when the box's centre, `center` m ahead of it, is at (x, y)."""
    return x - center * math.cos(heading), y - center * math.sin(heading)


def center_from_reference(x: float, y: float, heading: float, center: float) -> tuple[float, float]:
    """Return the position of the box's centre, `center` m ahead of the rear axle at (x, y)."""
    return x + center * math.cos(heading), y + center * math.sin(heading)
