"""The interface of controllers, which drive the ego from Python at every control step.

The method names are those of the AISA toolkit (HRI 2025): a controller that was written for the toolkit only needs the
base class `ControllerModel` and a class `Params`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import BaseModel, ConfigDict

from scenario_compiler.controllers.data import Control, SensorData, VehicleState
from scenario_compiler.perception.detectors import create_detector

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from scenario_compiler.perception.camera import Camera
    from scenario_compiler.perception.lane_detector import LaneDetector


class ControllerParams(BaseModel):
    """Parameters of a controller; subclasses declare fields, which are checked when a scenario is compiled."""

    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)


class ControllerModel(ABC):
    """Base class of controllers; every run creates one instance with its checked parameters."""

    Params: ClassVar[type[ControllerParams]] = ControllerParams

    uses_detector: ClassVar[bool] = False
    """Whether the controller finds the lane with `make_detector`, so that a scenario can name the detector."""

    def __init__(self, params: Any) -> None:
        """Keep the parameters, an instance of the class's `Params`."""
        self.params = params
        self.make_detector: Callable[[Camera], LaneDetector] = partial(create_detector, "classical")

    def reset(self, seed: int) -> None:
        """Reset all state at the start of a run; `seed` is the run's, for controllers that draw random numbers."""
        del seed

    @abstractmethod
    def control(self, sensor_data: SensorData, speed: float, vehicle: VehicleState) -> Control:
        """Return the command until the next control step; `speed` is the speed of the ego, m/s."""

    def display_info(self) -> dict[str, str]:
        """Return texts that the display shows beside the image, by label."""
        return {}

    def warning_messages(self) -> list[str]:
        """Return warnings for the driver, most important first."""
        return []

    def critical_messages(self) -> list[str]:
        """Return messages for a takeover request, most important first."""
        return []

    def initiate_takeover(self) -> bool:
        """Return whether the controller itself requests a takeover."""
        return False

    def overlay_image(self, image: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Return the camera image with the controller's detections drawn into it."""
        return image
