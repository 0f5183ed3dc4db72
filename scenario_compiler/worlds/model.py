"""The interface of a world: where the ego vehicle moves and its camera sees.

The engine moves the entities and tells the world where they are.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from scenario_compiler.vocabulary.weather import Weather

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from scenario_compiler.controllers.model import SensorData
    from scenario_compiler.roads import Network, Pose


@dataclass(frozen=True, slots=True)
class CameraFaults:
    """What is wrong with the camera beside its noise.

    Attributes:
        dark: Share of the light that is lost, 0-1.
        blur: Radius of the blur, 1/512 of the image's width.
        dirt: Share of the image that dirt covers, 0-1.
        missing: The image does not arrive.
        frozen: The image before is delivered again.
    """

    dark: float = 0.0
    blur: float = 0.0
    dirt: float = 0.0
    missing: bool = False
    frozen: bool = False


@dataclass(frozen=True, slots=True)
class Snapshot:
    """The state of a run at one instant, as the engine knows it.

    Attributes:
        t: Time, s.
        frame: Number of the time step.
        present: Whether each entity is in the world and pictures show it, in the plan's order.
        poses: Pose of each entity's reference point, in the plan's order, OpenDRIVE axes, m and rad.
        speeds: Speed of each entity, m/s, signed along its heading.
        sigma: Standard deviation of the camera's noise, grey levels.
        faults: What else is wrong with the camera.
        weather: The weather now; None while it is the plan's.
    """

    t: float
    frame: int
    present: tuple[bool, ...]
    poses: tuple[Pose, ...]
    speeds: tuple[float, ...]
    sigma: float
    faults: CameraFaults = CameraFaults()
    weather: Weather | None = None


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

    def step(self, snapshot: Snapshot) -> None:
        """Move every entity on to where the engine has moved it."""
        ...

    def close(self) -> None:
        """Give back what the world holds."""
        ...
