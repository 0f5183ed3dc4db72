"""The view of a bare plane, on which the vehicle stands, in each pixel of a camera; computed once for a mounting."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.camera import Camera

Table = NDArray[np.float32]

REACH = 400.0
"""Greatest distance of the ground in the tables, m, also for rays that miss it."""

BELOW_HORIZON = 1.0
"""Least distance below the horizon at which a pixel sees the ground, pixels."""


class Lens:
    """The ground plane as one camera sees it, in the rows of the image from `top` on.

    Attributes:
        camera: The camera.
        top: First row of the image that shows any ground; the last row if there is none.
        sky_rows: Number of rows from the top below which there is no sky.
        sees_ground: (rows, width) bool, whether a pixel shows the ground plane; the others show the sky.
        x: (rows, width) ground coordinate ahead, m, at most `REACH`.
        y: (rows, width) ground coordinate left, m.
        depth: (rows, width) depth of the ground, m; infinite in the sky.
        distance: (rows, width) distance of the ground from the camera, m, at most about `REACH`.
        footprint: (rows, width) length of a pixel on the ground along the line of sight, m.
    """

    def __init__(self, camera: Camera) -> None:
        """Compute the tables."""
        self.camera = camera
        across = ((np.arange(camera.width) - camera.width / 2.0) / camera.focal).astype(np.float32)
        down = ((np.arange(camera.height) - camera.height / 2.0) / camera.focal).astype(np.float32)[:, None]
        self._across, self._down = across, down
        fall = -self._component(2, 0)
        seen = fall > BELOW_HORIZON / camera.focal
        rows = np.flatnonzero(seen.any(axis=1))
        self.top = int(rows[0]) if len(rows) and camera.z > 0.0 else camera.height - 1
        self.sees_ground = np.broadcast_to(seen, (camera.height, camera.width))[self.top :] & (camera.z > 0.0)
        sky = np.flatnonzero(~self.sees_ground.all(axis=1))
        self.sky_rows = self.top + (int(sky[-1]) + 1 if len(sky) else 0)
        ahead, left = self._component(0, self.top), self._component(1, self.top)
        level = np.hypot(ahead, left)
        fall = np.maximum(fall[self.top :], 1e-6)
        height = np.float32(max(camera.z, 1e-3))
        scale = np.minimum(height / fall, REACH / np.maximum(level, 1e-6))
        self.x, self.y = ahead * scale, left * scale
        length = np.hypot(level, fall)
        self.depth = np.where(self.sees_ground, height / fall, np.float32(np.inf))
        self.distance = length * scale
        self.footprint = self.distance * self.distance / (length * height * np.float32(camera.focal))

    def directions(self) -> tuple[Table, Table, Table]:
        """Return the directions (ahead, left, up) of all pixels, (height, width) each, with depth 1, vehicle's axes."""
        shape = (self.camera.height, self.camera.width)
        ahead, left, up = (np.broadcast_to(self._component(axis, 0), shape) for axis in range(3))
        return ahead, left, up

    def _component(self, axis: int, first_row: int) -> Table:
        """Return one component of the directions; a single column if all columns are equal."""
        right, down, ahead = (np.float32(value) for value in self.camera.rotation[:, axis])
        column: Table = self._down[first_row:] * down + ahead
        return column if right == 0.0 else column + self._across * right
