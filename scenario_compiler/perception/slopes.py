"""The ground where it leaves the plane that the vehicle stands on: how far away it is, for light, haze and texture.

Each piece of ground is a plane, on which 1 / depth is a linear function of the pixel. So its distance needs only the
coefficients of the piece in each pixel.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.buffers import Buffers
from scenario_compiler.perception.camera import Camera, View, vehicle_axes
from scenario_compiler.perception.lens import REACH
from scenario_compiler.perception.polygons import NEAR, Floats
from scenario_compiler.perception.scene import Seen

Table = NDArray[np.float32]
Rows = NDArray[np.int16]

UNEVEN = 0.04
"""Least height of ground above or below the plane that the vehicle stands on at which its own distance is used, as a
share of the camera's height: then the plane's distance is wrong by 4 %.
"""

EDGE_ON = 1.0
"""Relative change of 1 / depth from one row of pixels to the next from which ground counts as seen edge-on. All of it
has the distance of its centre, because pixels at its border may lie outside it.
"""

CLOSE = 1e-3
"""Least distance of the camera from the plane of a piece of ground, m."""


class Pieces(Protocol):
    """The picture of pieces of ground (see `ground.Traced`)."""

    @property
    def top(self) -> int: ...  # noqa: D102
    @property
    def ids(self) -> NDArray[np.uint16]: ...  # noqa: D102
    @property
    def planes(self) -> Floats: ...  # noqa: D102
    @property
    def centres(self) -> Floats: ...  # noqa: D102
    @property
    def slopes(self) -> int: ...  # noqa: D102


@dataclass(frozen=True, eq=False)
class Far:
    """Ground in some rows of the image, for every so many-th pixel; (rows, columns) each.

    Attributes:
        camera: The camera.
        depth: Depth, m.
        distance: Distance from the camera, m.
        slant: Length of a pixel on the ground along the line of sight, divided by depth and distance, 1/m.
        footprint: Length of a pixel on the ground along the line of sight, m.
        across: (columns,) right / depth of the pixels.
        down: (rows, 1) down / depth of the pixels.
    """

    camera: Camera
    depth: Table
    distance: Table
    slant: Table
    footprint: Table
    across: Table
    down: Table

    def depression(self, into: Table) -> Table:
        """Return the angle between the line of sight and the ground, degrees; at most 38, and exact up to 10."""
        slope = np.multiply(self.slant, self.distance, out=into)
        slope *= np.float32(self.camera.focal)
        np.divide(np.float32(1.0), np.maximum(slope, np.float32(1.0), out=slope), out=slope)
        cube = slope * slope
        cube *= slope
        cube *= np.float32(1.0 / 3.0)
        slope -= cube
        slope *= np.float32(180.0 / math.pi)
        return slope

    def along(self, way: Floats, into: Table) -> None:
        """Write how far the ground is away from the camera along a vector (3,), camera axes, in units of 1 / m."""
        right, down, ahead = (np.float32(value) for value in way)
        np.add(self.across * right + ahead, self.down * down, out=into)
        np.multiply(into, self.depth, out=into)

    def level(self) -> tuple[Table, Table]:
        """Return how far ahead and left of the camera the ground is, m, vehicle axes."""
        ahead, left = np.empty_like(self.depth), np.empty_like(self.depth)
        self.along(self.camera.rotation[:, 0], ahead)
        self.along(self.camera.rotation[:, 1], left)
        return ahead, left


class Slopes:
    """Measures the ground in the pictures of one camera."""

    def __init__(self, camera: Camera, step: int, buffers: Buffers) -> None:
        """Prepare the directions of every `step`-th pixel."""
        self.camera, self.step, self._buffers = camera, step, buffers
        self._across = ((np.arange(0, camera.width, step) - camera.width / 2.0) / camera.focal).astype(np.float32)
        self._down = ((np.arange(camera.height) - camera.height / 2.0) / camera.focal).astype(np.float32)[:, None]
        self._length = np.sqrt(np.float32(1.0) + self._across * self._across + self._down * self._down)

    def measure(self, pieces: Pieces, count: int) -> Far:
        """Return the ground in the first `count` rows from the topmost on, in steps of pixels."""
        rows = slice(pieces.top, pieces.top + count * self.step, self.step)
        part = pieces.ids[rows, :: self.step]
        whole = self.camera.height, part.shape[1]
        index = self._buffers.get("pieces", whole, np.intp)[: len(part)]
        index[:] = part
        four = self._buffers.get("planes", (*whole, 4), np.float32)[: len(part)]
        table = self._table(pieces).view(np.complex128)[:, 0]
        np.take(table, index, out=four.view(np.complex128)[..., 0], mode="clip")
        a, b, c, slant = (self._buffers.get(f"plane {k}", whole, np.float32)[: len(part)] for k in range(4))
        for channel, one in enumerate((a, b, c, slant)):
            cv2.extractChannel(four, channel, one)
        across, down = self._across, self._down[rows]
        near = np.multiply(a, across, out=a)
        near += np.multiply(b, down, out=b)
        near += c
        np.clip(near, np.float32(1.0 / REACH), np.float32(1.0 / NEAR), out=near)
        depth = np.divide(np.float32(1.0), near, out=near)
        distance = np.multiply(depth, self._length[rows], out=b)
        footprint = np.multiply(distance, depth, out=c)
        footprint *= slant
        return Far(self.camera, depth, distance, slant, footprint, across, down)

    def _table(self, pieces: Pieces) -> NDArray[np.float32]:
        """Return for each piece (K, 4) the coefficients of 1 / depth, and `Far.slant`."""
        planes, centres = pieces.planes, pieces.centres
        size = np.sqrt((planes * planes).sum(axis=1))
        table = np.empty((len(planes), 4), np.float32)
        table[:, :3], table[:, 3] = planes, np.minimum(size, 1.0 / CLOSE) / self.camera.focal
        one = size > EDGE_ON * self.camera.focal * centres
        one[len(one) - pieces.slopes :] = True
        table[one, :2], table[one, 2] = 0.0, centres[one]
        table[len(one) - pieces.slopes :, 3] = 1.0 / CLOSE / self.camera.focal
        return table


def uneven_rows(surfaces: Seen, view: View) -> Rows:
    """Return for each surface (K,) the last row of the image in which it leaves the plane that the vehicle stands on.

    It is -1 for surfaces that do not.
    """
    up = view.rotation @ vehicle_axes(view.pose)[:, 2]
    height = (np.tensordot(up, surfaces.points, axes=1) + view.camera.z) / max(UNEVEN * view.camera.z, CLOSE)
    size, sign = np.abs(height), np.sign(height)
    depth = np.maximum(surfaces.points[2], CLOSE)
    lowest = np.full(height.shape, -np.inf)
    for side in (1, -1):
        fall = size - sign * np.roll(height, side, axis=0)
        share = np.clip((size - 1.0) / np.maximum(fall, 1e-9), 0.0, 1.0)
        row = surfaces.points[1] + share * (np.roll(surfaces.points[1], side, axis=0) - surfaces.points[1])
        row /= depth + share * (np.roll(depth, side, axis=0) - depth)
        np.maximum(lowest, row, out=lowest, where=size > 1.0)
    last = lowest.max(axis=0, initial=-np.inf) * view.camera.focal + view.camera.height / 2.0
    last = np.where(surfaces.whole, last, np.where(last > -np.inf, np.inf, -np.inf))
    return np.clip(last, -1, view.camera.height - 1).astype(np.int16)
