"""The interface of a world: where the ego vehicle moves and its camera sees.

The engine moves every other entity and tells the world; a world that moves the ego vehicle itself (CARLA's physics)
returns its pose from `step`, any other leaves it to the engine's bicycle model.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from scenario_compiler.controllers.model import SensorData
    from scenario_compiler.roads import Network, Pose


@dataclass(frozen=True, slots=True)
class Snapshot:
    """The state of a run at one instant, as the engine knows it.

    Attributes:
        t: Time, s.
        frame: Number of the time step.
        poses: Pose of each entity's reference point, in the plan's order, OpenDRIVE axes, m and rad.
        speeds: Speed of each entity, m/s, signed along its heading.
        sigma: Standard deviation of the camera's noise, grey levels.
    """

    t: float
    frame: int
    poses: tuple[Pose, ...]
    speeds: tuple[float, ...]
    sigma: float


@dataclass(frozen=True, slots=True)
class EgoMotion:
    """Where a world with physics of its own has moved the ego vehicle: reference point and speed."""

    pose: Pose
    speed: float


class World(Protocol):
    """A world that a plan is executed in."""

    name: str
    network: Network

    def reset(self, snapshot: Snapshot, seed: int) -> None:
        """Put every entity where the run begins."""
        ...

    def observe(self, snapshot: Snapshot) -> SensorData:
        """Return what the ego vehicle's sensors deliver now."""
        ...

    def picture(self, snapshot: Snapshot) -> NDArray[np.uint8]:
        """Return a driver's view for people to look at, (height, width, 3) uint8, BGR."""
        ...

    def step(self, snapshot: Snapshot, throttle: float, steer: float, brake: float) -> EgoMotion | None:
        """Move on to `snapshot`; return the ego vehicle's motion where this world moves it, else None."""
        ...

    def close(self) -> None:
        """Give back what the world holds."""
        ...
