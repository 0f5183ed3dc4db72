"""Optical flow: the motion in the image, since the picture before, of the point that each pixel shows.

The scene is known, so the flow is computed from depth and poses: each pixel's point is moved back with the body that
it lies on, and is looked at with the camera of the picture before. CARLA's documentation of
`sensor.camera.optical_flow` gives the range of the values, -2 to 2. Their scale and direction are those of Unreal's
velocities on the screen, as users have found them (carla-simulator/carla, issue 4795): half of the image's width to the
right, and half of its height up, is 1.
"""

from __future__ import annotations

from collections.abc import Mapping

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
Table = NDArray[np.float32]

FASTEST = 2.0
"""Greatest value, as CARLA documents it."""

LEAST_AHEAD = 1e-3
"""Least part of a direction along the optical axis for it to count as before the lens."""


class FlowCamera(CameraInstrument):
    """A camera for the optical flow; in its first picture nothing has moved."""

    def __init__(self, stage: Stage, sensor: Sensor) -> None:
        """Remember no picture; see `CameraInstrument`."""
        super().__init__(stage, sensor)
        self._before: View | None = None
        self._bodies: dict[int, Floats] = {}

    def measure(self, stage: Stage, sensor: Sensor, frame: int, dt: float, weather: Weather) -> bytes:
        """Return the flow of each pixel: right, up."""
        del dt
        drawing = self.draw(stage, sensor, frame, weather)
        bodies = {body.id: placed(stage.pose_of(body)) for body in stage.bodies()}
        before = drawing.view if self._before is None else self._before
        moved = {
            number: self._bodies[number] @ np.linalg.inv(now)
            for number, now in bodies.items()
            if number in self._bodies
        }
        self._before, self._bodies = drawing.view, bodies
        return self.message(flow(drawing, before, moved))


def placed(pose: Pose) -> Floats:
    """Return the (4, 4) matrix that takes points from a body's axes to the world's."""
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = vehicle_axes(pose), pose[:3]
    return matrix


def flow(drawing: Drawing, before: View, moved: Mapping[int, Floats]) -> NDArray[np.float32]:
    """Return the motion of the point that each pixel shows, (height, width, 2): right and up, half an image is 1.

    Args:
        drawing: The present drawing.
        before: The camera of the picture before.
        moved: By the number of a thing in the picture of instances, the (4, 4) matrix that takes its points, in the
            world's axes, from where they are now to where they were then; what is not listed stood still.
    """
    camera = drawing.view.camera
    nearness = np.where(drawing.depth < FARTHEST_DEPTH, np.float32(1.0) / drawing.depth, np.float32(0.0))
    rows, columns = (np.arange(count, dtype=np.float32) for count in drawing.depth.shape)
    found = _shift(rows[:, None], columns, nearness, drawing.view, before, np.eye(4))
    for number in np.intersect1d(drawing.instance, list(moved)).tolist():
        row, column = np.nonzero(drawing.instance == number)
        its = _shift(rows[row], columns[column], nearness[row, column], drawing.view, before, moved[number])
        found[row, column] = its
    found *= np.array([2.0 / camera.width, -2.0 / camera.height], np.float32)
    return np.asarray(np.clip(found, -FASTEST, FASTEST, out=found))


def _shift(row: Table, column: Table, nearness: Table, now: View, before: View, moved: Floats) -> Table:
    """Return the motion of points in pixels, right and down; a matrix takes the points to where they were.

    A point of depth Z in the direction (x, y, 1) was seen in the direction A (x, y, 1) + b / Z, with the rotation A and
    the way b from this camera's axes to the ones before. What was not before the lens has not moved.
    """
    camera = now.camera
    turn = (before.rotation @ moved[:3, :3] @ now.rotation.T).astype(np.float32)
    way = before.rotation @ (moved[:3, :3] @ now.position + moved[:3, 3] - before.position)
    across = (column - np.float32(camera.width / 2.0)) / np.float32(camera.focal)
    down = (row - np.float32(camera.height / 2.0)) / np.float32(camera.focal)
    right, low, ahead = (
        across * turn[k, 0] + (down * turn[k, 1] + turn[k, 2]) + nearness * np.float32(way[k]) for k in range(3)
    )
    seen = ahead > np.maximum(np.float32(NEAR) * nearness, np.float32(LEAST_AHEAD))
    scale = np.float32(camera.focal) / np.where(seen, ahead, np.float32(1.0))
    shift = np.empty((*nearness.shape, 2), np.float32)
    shift[..., 0] = np.where(seen, across * np.float32(camera.focal) - right * scale, np.float32(0.0))
    shift[..., 1] = np.where(seen, down * np.float32(camera.focal) - low * scale, np.float32(0.0))
    return shift
