"""A camera at a mount, which all sensors there share, so that the scene is drawn only once in a tick."""

from __future__ import annotations

from collections.abc import Callable, Hashable

from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.render import Drawing
from scenario_compiler.perception.road_camera import RoadCamera
from scenario_compiler.perception.scene import Scene

SEED = 1
"""Seed of the rain in pictures."""


class SharedCamera:
    """A camera on a carrier, and its last drawing."""

    def __init__(self, scene: Scene, camera: Camera, center: float) -> None:
        """Prepare the drawing; see `RoadCamera`."""
        self._camera = RoadCamera(scene, camera, SEED, center)
        self._instant: Hashable = None
        self._drawing: Drawing | None = None

    def see(self, instant: Hashable, draw: Callable[[RoadCamera], Drawing]) -> Drawing:
        """Return the drawing of an instant; it is made at the first call."""
        if self._drawing is None or instant != self._instant:
            self._drawing, self._instant = draw(self._camera), instant
        return self._drawing
