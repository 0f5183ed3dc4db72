"""The camera on the car: a map, a pose and the weather in, an image out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.camera import Camera, View
from scenario_compiler.perception.degradation import Degradation, Sensor
from scenario_compiler.perception.render import Renderer
from scenario_compiler.perception.scene import RoadScene
from scenario_compiler.perception.solids import Box
from scenario_compiler.perception.weather_look import WeatherNumbers, look_of
from scenario_compiler.roads.mesh import road_marks, road_surface
from scenario_compiler.roads.positions import Pose, SecondaryLine

if TYPE_CHECKING:
    from scenario_compiler.roads.network import Network


def scene_of(network: Network, secondary: Sequence[SecondaryLine] = ()) -> RoadScene:
    """Return the scene of a network with lines beside its marks, to be shared by the cameras of one run."""
    return RoadScene(road_surface(network), road_marks(network, secondary=secondary))


class RoadCamera:
    """A camera on a vehicle in a scene.

    Every frame is a function of its arguments and the seed, but that a frozen one repeats the frame before.
    """

    def __init__(
        self,
        network: Network | RoadScene,
        camera: Camera | None = None,
        seed: int = 1,
        box_offset: float = 1.4,
    ) -> None:
        """Prepare the scene and the drawing.

        Args:
            network: The roads; a `RoadScene` where several cameras share one (see `scene_of`).
            camera: The camera and its mounting, the default camera when None.
            seed: Seed of the run, for noise and rain.
            box_offset: Distance from the vehicle's reference point ahead to the centre of its bounding box,
                m.
        """
        self.scene = network if isinstance(network, RoadScene) else scene_of(network)
        self.camera = camera if camera is not None else Camera()
        self.seed = seed
        self.box_offset = box_offset
        self._sensor = Sensor(seed)
        self._renderer = Renderer(self.scene, self.camera)

    def view(self, pose: Pose) -> View:
        """Return where the camera is when the vehicle's reference point has this pose."""
        return self.camera.view(pose, self.box_offset)

    def frame(
        self, pose: Pose, objects: Sequence[Box], weather: WeatherNumbers, state: Degradation | float, frame_index: int
    ) -> NDArray[np.uint8]:
        """Return the image (height, width, 3) uint8, BGR.

        Args:
            pose: Pose of the vehicle's reference point.
            objects: Everybody else.
            weather: CARLA's weather numbers.
            state: What is wrong with the camera; a number is the standard deviation of its noise, grey levels.
            frame_index: Number of the frame.
        """
        image = self._renderer.render(self.view(pose), objects, look_of(weather), self.seed, frame_index)
        wrong = state if isinstance(state, Degradation) else Degradation(sigma=state)
        return self._sensor.deliver(image, wrong, frame_index)

    def forget(self) -> None:
        """Forget the images before, which a frozen camera repeats."""
        self._sensor = Sensor(self.seed)
