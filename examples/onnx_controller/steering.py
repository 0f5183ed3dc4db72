"""A controller that steers by a neural network, which OpenCV runs from an ONNX file.

scenario-compiler run examples/onnx_controller/keep_lane.xml --trust examples/onnx_controller/steering.py

The network sees the lower half of the image as 48 x 16 grey levels and says how far to the left the middle of the lane
is, 8, 14 and 22 m ahead of the rear axle. `train.py` makes it.
"""

from __future__ import annotations

import math
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler import Control, ControllerModel, ControllerParams, SensorData, VehicleState

WIDTH, HEIGHT = 48, 16
"""Size of the network's input, pixels."""

DISTANCES = (8.0, 14.0, 22.0)
"""Distances ahead of the rear axle that the network answers for, m."""


def network_input(image: NDArray[np.uint8]) -> NDArray[np.float32]:
    """Return the lower half of a BGR image as (1, 1, HEIGHT, WIDTH) float32, of mean 0 and deviation 1."""
    grey = cv2.cvtColor(image[image.shape[0] // 2 :], cv2.COLOR_BGR2GRAY)
    small = cv2.resize(grey, (WIDTH, HEIGHT), interpolation=cv2.INTER_AREA).astype(np.float32)
    normal: NDArray[np.float32] = (small - small.mean()) / (small.std() + 1.0)
    return normal[None, None]


class NetworkSteering(ControllerModel):
    """Pure pursuit of the middle of the lane as the network sees it, at the desired speed."""

    class Params(ControllerParams):
        """Parameters, as <property> elements give them."""

        network: Path = Path(__file__).with_name("lane_ahead.onnx")
        look_ahead: float = 0.7

    params: Params

    def __init__(self, params: Params) -> None:
        """Load the network."""
        super().__init__(params)
        self._network = cv2.dnn.readNetFromONNX(np.fromfile(params.network, np.uint8))

    def control(self, sensor_data: SensorData, speed: float, vehicle: VehicleState) -> Control:
        """Steer to where the lane's middle is `look_ahead` seconds ahead (Coulter 1992)."""
        self._network.setInput(network_input(sensor_data.image))
        offsets = self._network.forward().ravel()
        reach = min(max(self.params.look_ahead * speed, DISTANCES[0]), DISTANCES[-1])
        left = float(np.interp(reach, DISTANCES, offsets))
        angle = math.atan(2.0 * vehicle.wheelbase * left / (reach * reach + left * left))
        wanted = min(max(vehicle.desired_speed - speed, -vehicle.max_deceleration), vehicle.max_acceleration)
        return Control(
            throttle=max(wanted, 0.0) / vehicle.max_acceleration,
            steer=min(max(angle / vehicle.max_steer, -1.0), 1.0),
            brake=max(-wanted, 0.0) / vehicle.max_deceleration,
            trajectory=tuple((x, float(y)) for x, y in zip(DISTANCES, offsets, strict=True)),
        )
