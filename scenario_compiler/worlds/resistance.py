"""The deceleration of a rolling vehicle in CARLA: its wheels' damping and the air's drag, from its physics control."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

AIR_DENSITY = 1.25
"""Density of air in Unreal, kg/m3."""


SMALLEST = 0.001
MOST = 1000.0
"""Least radius of a wheel that is used, m, and greatest value of either part of a resistance; clients can set any
number.
"""


class Resistance(NamedTuple):
    """The resistance of a rolling vehicle, divided by its mass.

    Attributes:
        wheels: Deceleration by the wheels' damping divided by the speed, 1/s.
        air: Deceleration by the air's drag divided by the square of the speed, 1/m.
    """

    wheels: float
    air: float

    def at(self, speed: float, grip: float = 1.0) -> float:
        """Return the deceleration at a speed, m/s2; `grip` is the share of the wheels' forces that reaches the road."""
        return (self.wheels * grip + self.air * abs(speed)) * abs(speed)


def resistance(wheels: Iterable[tuple[float, float]], drag: float, area: float, mass: float) -> Resistance:
    """Return the resistance of a vehicle.

    The force of a wheel's damping is the damping rate times the wheel's angular speed divided by its radius (PhysX:
    damping rate of `PxVehicleWheelData`). That of the air is half its density times drag coefficient, area and the
    square of the speed (Unreal: `UWheeledVehicleMovementComponent`).

    Args:
        wheels: Damping rate, N m s, and radius, m, of each wheel.
        drag: Drag coefficient.
        area: Frontal area of the chassis, m2.
        mass: Mass, kg.
    """
    damped = sum(max(damping, 0.0) / (radius * radius) for damping, radius in wheels if radius >= SMALLEST)
    dragged = 0.5 * AIR_DENSITY * max(drag, 0.0) * area
    return Resistance(min(damped / mass, MOST), min(dragged / mass, MOST))
