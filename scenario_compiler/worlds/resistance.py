"""What slows a vehicle of CARLA down that rolls: its wheels' damping and the air, from its physics control."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

AIR_DENSITY = 1.25
"""kg/m3, as Unreal has it."""


SMALLEST = 0.001
MOST = 1000.0
"""Smallest radius of a wheel that counts, m, and the most that either part of a resistance can be: a client may give a
vehicle any number.
"""


class Resistance(NamedTuple):
    """What slows a vehicle down.

    Attributes:
        wheels: Share of its speed that it loses in a second by its wheels, 1/s.
        air: The same by the air, for each m/s of its speed, 1/m.
    """

    wheels: float
    air: float

    def at(self, speed: float, grip: float = 1.0) -> float:
        """Return the deceleration at a speed, m/s2, with a share of the wheels' forces that reaches the road."""
        return (self.wheels * grip + self.air * abs(speed)) * abs(speed)


def resistance(wheels: Iterable[tuple[float, float]], drag: float, area: float, mass: float) -> Resistance:
    """Return what slows a vehicle down.

    The wheels' damping acts on the road with their turning rate over their radius (PhysX: damping rate of
    `PxVehicleWheelData`); the air with half its density times drag coefficient, area and the speed squared (Unreal:
    `UWheeledVehicleMovementComponent`).

    Args:
        wheels: Damping rate, N m s, and radius, m, of each wheel.
        drag: Drag coefficient.
        area: Area of the chassis from ahead, m2.
        mass: kg.
    """
    damped = sum(max(damping, 0.0) / (radius * radius) for damping, radius in wheels if radius >= SMALLEST)
    dragged = 0.5 * AIR_DENSITY * max(drag, 0.0) * area
    return Resistance(min(damped / mass, MOST), min(dragged / mass, MOST))
