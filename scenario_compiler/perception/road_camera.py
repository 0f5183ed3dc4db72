"""The camera on the car, which makes an image from a map, a pose and the weather."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.camera import Camera, View
from scenario_compiler.perception.degradation import Degradation, Sensor
from scenario_compiler.perception.render import Drawing, Renderer
from scenario_compiler.perception.roadside import Roadside, roadside_of
from scenario_compiler.perception.scene import Scene, joined_marks
from scenario_compiler.perception.solids import Box
from scenario_compiler.perception.weather_look import WeatherNumbers, look_of
from scenario_compiler.roads.mesh import Surface, road_marks, road_surface
from scenario_compiler.roads.positions import Pose, SecondaryLine
from scenario_compiler.roads.quality import PAINT_COLUMNS

if TYPE_CHECKING:
    from scenario_compiler.roads.network import Network


KEPT_MAPS = 4
"""Number of maps whose unpainted parts are kept: those of a session's or a library's conflicts."""

_UNPAINTED: dict[str, tuple[Surface, Roadside]] = {}
"""The unpainted parts of the maps that were drawn last, by the digests of their files, the latest at the end."""


_PAINTED: dict[tuple[object, ...], Scene] = {}
"""The scene that was made last, by the digest of its map's file and by its paint."""


def scene_of(network: Network, secondary: Sequence[SecondaryLine] = ()) -> Scene:
    """Return the scene of a network with lines beside its marks, to be shared by cameras; the last one is kept."""
    paint = tuple(tuple(getattr(network.tables, name)) for name in PAINT_COLUMNS)
    key = (network.sha256, paint, tuple(secondary))
    found = _PAINTED.get(key)
    if found is None:
        surface, beside = _unpainted(network)
        marks = joined_marks(road_marks(network, secondary=secondary), beside.marks)
        found = Scene(surface, marks, beside.uprights)
        _PAINTED.clear()
        _PAINTED[key] = found
    return found


def _unpainted(network: Network) -> tuple[Surface, Roadside]:
    """Return the surface of the roads and the objects beside them, kept for the next runs on the same map."""
    found = _UNPAINTED.pop(network.sha256, None) or (road_surface(network), roadside_of(network))
    _UNPAINTED[network.sha256] = found
    if len(_UNPAINTED) > KEPT_MAPS:
        _UNPAINTED.pop(next(iter(_UNPAINTED)), None)
    return found


class RoadCamera:
    """A camera on a vehicle in a scene.

    Every frame is a function of its arguments and the seed, except that a frozen one repeats the previous frame.
    """

    def __init__(
        self,
        network: Network | Scene,
        camera: Camera | None = None,
        seed: int = 1,
        box_offset: float = 1.4,
    ) -> None:
        """Prepare the scene and the drawing.

        Args:
            network: The roads, or a `Scene` if several cameras share one (see `scene_of`).
            camera: The camera and its mounting, the default camera if None.
            seed: Seed of the run, for noise and rain.
            box_offset: Distance from the vehicle's reference point ahead to the centre of its bounding box, m.
        """
        self.scene = network if isinstance(network, Scene) else scene_of(network)
        self.camera = camera if camera is not None else Camera()
        self.seed = seed
        self.box_offset = box_offset
        self._sensor = Sensor(seed, self.camera, box_offset)
        self._renderer = Renderer(self.scene, self.camera)
        self._turned: Renderer | None = None

    def view(self, pose: Pose) -> View:
        """Return the camera in the world for a pose of the vehicle's reference point."""
        return self.camera.view(pose, self.box_offset)

    def draw(
        self,
        pose: Pose,
        objects: Sequence[Box],
        weather: WeatherNumbers,
        signals: Mapping[str, str] = MappingProxyType({}),
    ) -> Drawing:
        """Return the view of the camera: the image as delivered by the optics, depth, kinds and things.

        Args:
            pose: Pose of the vehicle's reference point.
            objects: All others.
            weather: CARLA's weather numbers.
            signals: States of traffic lights by their id, as scenarios write them; others are dark.
        """
        return self._renderer.draw(self.view(pose), objects, look_of(weather), signals)

    def frame(
        self,
        pose: Pose,
        objects: Sequence[Box],
        weather: WeatherNumbers,
        state: Degradation | float,
        frame_index: int,
        signals: Mapping[str, str] = MappingProxyType({}),
        t: float = 0.0,
    ) -> NDArray[np.uint8]:
        """Return the image (height, width, 3) uint8, BGR.

        Args:
            pose: Pose of the vehicle's reference point.
            objects: All others.
            weather: CARLA's weather numbers.
            state: The faults of the camera; a number is the standard deviation of its noise, grey levels.
            frame_index: Number of the frame.
            signals: States of traffic lights (see `draw`).
            t: Time of the frame, s, which determines whether a late image is due.
        """
        wrong = state if isinstance(state, Degradation) else Degradation(sigma=state)
        renderer = self._renderer_of(wrong.camera(self.camera))
        view = renderer.camera.view(pose, self.box_offset)
        image = renderer.draw(view, objects, look_of(weather), signals).image(self.seed, frame_index)
        return self._sensor.deliver(image, wrong, frame_index, t)

    def forget(self) -> None:
        """Forget the previous images, which a frozen camera repeats."""
        self._sensor = Sensor(self.seed, self.camera, self.box_offset)

    def _renderer_of(self, camera: Camera) -> Renderer:
        """Return the renderer for the camera, which may be turned on its mount."""
        if camera is self.camera:
            return self._renderer
        if self._turned is None or self._turned.camera != camera:
            self._turned = Renderer(self.scene, camera)
        return self._turned
