"""A controller of the user's as the loop calls it: its faults and wrong answers are errors of the controller."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from scenario_compiler.controllers.answers import control_of, image_of, labels_of, texts_of, truth_of
from scenario_compiler.controllers.data import Control, SensorData, VehicleState
from scenario_compiler.controllers.foreign import CONTROLLER, ForeignCode, blamed
from scenario_compiler.controllers.model import ControllerModel

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class ForeignController(ControllerModel):
    """A controller of the user's; its exceptions and wrong answers become a ControllerError."""

    def __init__(self, name: str, found: type[ControllerModel], make: Callable[[], ControllerModel]) -> None:
        """Make the controller, of the class `found`.

        Raises:
            ControllerError: It cannot be made.
        """
        self._code = ForeignCode(name, CONTROLLER, found, make)
        with blamed(name, code=found):
            params = self._code.inner.params
        super().__init__(params)

    def reset(self, seed: int) -> None:
        """See ControllerModel."""
        self._code.ask("reset", lambda _: None, seed)

    def control(self, sensor_data: SensorData, speed: float, vehicle: VehicleState) -> Control:
        """See ControllerModel. A result that is not a command of finite numbers is also an error."""
        return self._code.ask("control", control_of, sensor_data, speed, vehicle)

    def display_info(self) -> dict[str, str]:
        """See ControllerModel."""
        return self._code.ask("display_info", labels_of)

    def warning_messages(self) -> list[str]:
        """See ControllerModel."""
        return self._code.ask("warning_messages", texts_of)

    def critical_messages(self) -> list[str]:
        """See ControllerModel."""
        return self._code.ask("critical_messages", texts_of)

    def initiate_takeover(self) -> bool:
        """See ControllerModel."""
        return self._code.ask("initiate_takeover", truth_of)

    def overlay_image(self, image: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """See ControllerModel."""
        return self._code.ask("overlay_image", lambda given: image_of(given, image), image)
