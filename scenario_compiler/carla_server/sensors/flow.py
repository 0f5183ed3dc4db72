"""Optical flow: how far what each pixel shows has moved in the image since the picture before.

The scene is known, so the flow is computed from depth and poses: each pixel's point is moved back with the body that
it lies on, and is looked at with the camera of the picture before. CARLA's documentation of
`sensor.camera.optical_flow` gives the range of the values, -2 to 2. Their scale and direction are those of Unreal's
velocities on the screen, as users have found them (carla-simulator/carla, issue 4795): half of the image's width to the
right, and half of its height up, is 1.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.carla_server.actors import Sensor
from scenario_compiler.carla_server.sensors.cameras import CameraInstrument
from scenario_compiler.carla_server.stage import Stage
from scenario_compiler.perception.camera import View, vehicle_axes
from scenario_compiler.perception.labels import FARTHEST_DEPTH
from scenario_compiler.perception.polygons import NEAR
from scenario_compiler.perception.render import Drawing
from scenario_compiler.roads import Pose
from scenario_compiler.vocabulary.weather import Weather

Floats = NDArray[np.float64]

FASTEST = 2.0
"""Greatest value, as CARLA documents it."""


class FlowCamera(CameraInstrument):
    """A camera for the optical flow; in its first picture nothing has moved."""

    def __init__(self, stage: Stage, sensor: Sensor) -> None:
        """Remember no picture; see `CameraInstrument`."""
        super().__init__(stage, sensor)
        self._before: View | None = None
        self._bodies: dict[int, Floats] = {}

    def measure(self, stage: Stage, sensor: Sensor, frame: int, dt: float, weather: Weather) -> bytes:
        """Return the flow of each pixel: right, up."""
        del frame, dt
        drawing = self.draw(stage, sensor, weather)
        bodies = {body.id: placed(stage.pose_of(body)) for body in stage.bodies()}
        before = drawing.view if self._before is None else self._before
        moved = {
            number: self._bodies[number] @ np.linalg.inv(now)
            for number, now in bodies.items()
            if number in self._bodies
        }
        self._before, self._bodies = drawing.view, bodies
        return self.message(flow(drawing, before, moved).astype("<f4"))


def placed(pose: Pose) -> Floats:
    """Return the (4, 4) matrix that takes points from a body's axes to the world's."""
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = vehicle_axes(pose), pose[:3]
    return matrix


def flow(drawing: Drawing, before: View, moved: dict[int, Floats]) -> Floats:
    """Return how far what each pixel shows has moved, (height, width, 2): right and up, half an image is 1.

    Args:
        drawing: What is seen now.
        before: The camera of the picture before.
        moved: By the number of a thing in the picture of instances, the (4, 4) matrix that takes its points, in the
            world's axes, from where they are now to where they were then; what is not listed stood still.
    """
    view, camera = drawing.view, drawing.view.camera
    size = np.array([camera.width, camera.height], np.float64)
    columns, rows = np.meshgrid(np.arange(camera.width), np.arange(camera.height))
    pixels = np.stack([columns, rows], axis=2).reshape(-1, 2).astype(np.float64)
    depth = drawing.depth.ravel().astype(np.float64)
    rays = np.concatenate([(pixels - size / 2.0) / camera.focal, np.ones((len(pixels), 1))], axis=1) @ view.rotation
    near = depth < FARTHEST_DEPTH
    from_eye = rays * np.where(near, depth, 1.0)[:, None]
    then = from_eye + near[:, None] * (view.position - before.position)
    instances = drawing.instance.ravel()
    for number in np.intersect1d(instances, list(moved)).tolist():
        its = np.flatnonzero((instances == number) & near)
        then[its] = (from_eye[its] + view.position) @ moved[number][:3, :3].T + moved[number][:3, 3] - before.position
    seen = then @ before.rotation.T
    ahead = seen[:, 2] > NEAR * np.where(near, 1.0, 1e-3)
    old = seen[:, :2] * (camera.focal / np.where(ahead, seen[:, 2], 1.0))[:, None] + size / 2.0
    shift = np.where(ahead[:, None], pixels - old, 0.0) * np.array([2.0, -2.0]) / size
    return np.asarray(np.clip(shift, -FASTEST, FASTEST).reshape(camera.height, camera.width, 2))
