"""Every controller keeps its contract: commands in range, equal for equal inputs, no memory after a reset."""

from __future__ import annotations

import math
import textwrap
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from scenario_compiler.controllers import (
    CONTROLLERS,
    CameraMounting,
    Control,
    ControllerError,
    ControllerModel,
    SensorData,
    VehicleState,
    controller_class,
    create_controller,
)
from scenario_compiler.trust import Trust
from scenario_compiler.vocabulary.entities import Controller, Property

CAMERA = CameraMounting(512, 256, math.radians(45.0), 0.5, 1.3, math.radians(-5.0))
VEHICLE = VehicleState(0.0, 0.0, 0.0, 2.6, 1.3, math.radians(40.0), 3.5, 8.0, 10.0, 0.1)


def images() -> list[SensorData]:
    """Three images: black, a plain road with two lines towards the vanishing point, and noise."""
    black = np.zeros((256, 512, 3), np.uint8)
    road = np.full((256, 512, 3), 90, np.uint8)
    for row in range(90, 256):
        for side in (-1, 1):
            column = int(256 + side * (row - 80) * 1.4)
            road[row, max(column - 3, 0) : max(column + 3, 0)] = 230
    noise = np.random.default_rng(3).integers(0, 255, (256, 512, 3), dtype=np.uint8)
    return [SensorData(0.1 * i, image, CAMERA) for i, image in enumerate((black, road, noise))]


def commands(controller: ControllerModel) -> list[Control]:
    controller.reset(1)
    return [controller.control(data, 8.0, VEHICLE) for data in images()]


@pytest.fixture(params=sorted(CONTROLLERS))
def controller(request: pytest.FixtureRequest) -> ControllerModel:
    return create_controller(Controller(model=request.param))


def test_commands_are_in_range(controller: ControllerModel) -> None:
    for command in commands(controller):
        assert 0.0 <= command.throttle <= 1.0
        assert -1.0 <= command.steer <= 1.0
        assert 0.0 <= command.brake <= 1.0
        for share in (command.confidence_left, command.confidence_right, command.sensor_health):
            assert 0.0 <= share <= 1.0


def test_same_inputs_give_the_same_commands_after_a_reset(controller: ControllerModel) -> None:
    def plain(found: list[Control]) -> list[tuple[object, ...]]:
        return [(c.throttle, c.steer, c.brake, c.trajectory, c.confidence_left, c.confidence_right) for c in found]

    assert plain(commands(controller)) == plain(commands(controller))


def test_it_brakes_for_an_object_close_ahead(controller: ControllerModel) -> None:
    controller.reset(1)
    close = replace(images()[1], lead_gap=8.0, lead_speed=0.0)
    assert controller.control(close, 8.0, VEHICLE).brake > 0.2


def test_display_and_messages_are_texts_before_and_after_an_image(controller: ControllerModel) -> None:
    controller.reset(1)
    for _ in range(2):
        assert all(isinstance(value, str) for value in controller.display_info().values())
        assert all(isinstance(text, str) for text in controller.warning_messages() + controller.critical_messages())
        assert isinstance(controller.initiate_takeover(), bool)
        controller.control(images()[1], 8.0, VEHICLE)


def test_overlay_keeps_the_size(controller: ControllerModel) -> None:
    data = images()[1]
    controller.reset(1)
    controller.control(data, 8.0, VEHICLE)
    assert controller.overlay_image(data.image.copy()).shape == data.image.shape


def test_a_users_own_controller_is_named_by_module_and_class(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "mine.py").write_text(
        textwrap.dedent(
            """
            from scenario_compiler import Control, ControllerModel, ControllerParams

            class Straight(ControllerModel):
                class Params(ControllerParams):
                    throttle: float = 0.2

                def control(self, sensor_data, speed, vehicle):
                    return Control(throttle=self.params.throttle, steer=0.0, brake=0.0)
            """
        ),
        encoding="utf-8",
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    written = Controller(model="mine:Straight", properties=(Property(name="throttle", value="0.7"),))
    assert commands(create_controller(written, Trust(("mine:Straight",))))[0].throttle == 0.7


@pytest.mark.parametrize("name", ["lane_detectoin", "no.such:Class", "math:pi", "pathlib:Path", "a:b:c", ""])
def test_a_class_that_is_not_a_controller_is_reported(name: str) -> None:
    with pytest.raises(ControllerError, match=r"controller|ControllerModel"):
        controller_class(name, Trust((name,)))
