"""The pictures that a recording keeps of the events of a takeover."""

from __future__ import annotations

import numpy as np
import pytest

from scenario_compiler import Control, ControllerModel, ControllerParams, SensorData, VehicleState, compile_scenario
from scenario_compiler.controllers.data import CameraMounting
from scenario_compiler.runtime.pictures import picture_of

VIEW = np.zeros((480, 960, 3), np.uint8)
SEEN = SensorData(0.0, np.zeros((256, 512, 3), np.uint8), CameraMounting(512, 256, 1.0, 0.5, 1.4, 0.0))
CONTROL = Control(throttle=0.0, steer=0.0, brake=0.0)


class Speaker(ControllerModel):
    """A controller with messages."""

    def __init__(self, warnings: list[str], criticals: list[str]) -> None:
        """Set the messages."""
        super().__init__(ControllerParams())
        self.warnings, self.criticals = warnings, criticals

    def control(self, sensor_data: SensorData, speed: float, vehicle: VehicleState) -> Control:
        """Do nothing."""
        return CONTROL

    def warning_messages(self) -> list[str]:
        """Return the warnings."""
        return self.warnings

    def critical_messages(self) -> list[str]:
        """Return the messages for a request."""
        return self.criticals


def drawn(kind: str, warnings: list[str], criticals: list[str]) -> bytes:
    """Return the picture of an event with these messages of the controller."""
    plan = compile_scenario("obstacle_ahead")
    return picture_of(plan, VIEW, SEEN, Speaker(warnings, criticals), CONTROL, 10.0, kind, "controller")


@pytest.mark.parametrize(
    ("kind", "shown"),
    [("warning", False), ("request", True), ("escalation", True), ("minimum_risk", True), ("response", False)],
)
def test_critical_messages_of_the_controller_are_shown_at_requests(kind: str, shown: bool) -> None:
    assert (drawn(kind, [], ["The lidar is dirty"]) != drawn(kind, [], [])) is shown


def test_warnings_of_the_controller_are_shown_at_a_warning() -> None:
    assert drawn("warning", ["The lidar is dirty"], []) != drawn("warning", [], [])
