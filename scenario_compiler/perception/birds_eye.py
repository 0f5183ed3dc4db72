"""The ground seen from above, and the ridges in it (brighter than both sides), where lines are searched."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.course import Course

Floats = NDArray[np.float64]
Map = NDArray[np.float32]

X_FROM, X_TO, X_STEP = 5.0, 30.0, 0.25
Y_FROM, Y_TO, Y_STEP = 8.0, -8.0, 0.05
"""Extent of the map, m: rows ahead of the camera, columns from left to right. At 30 m, a mark of 0.12 m is two pixels
wide in an image of 512 columns.
"""

COMPARED = round(0.22 / Y_STEP)
"""Columns on both sides of a mark where the ground is compared with it; the widest marks are 0.3 m."""

PITCH_STEP = 0.002
"""Lookups are prepared for multiples of this pitch, rad: half a step shifts a boundary 18 m ahead by 0.03 m."""

MEAN_OVER = (2, 3)
"""Columns and rows over which brightness is averaged."""

STRONGEST = 8.0
"""Response at which a ridge is clipped, in units of the row's own deviation."""

ASIDE, ASIDE_FROM = 2, 2.5
"""In a sharp bend a line moves to the side from row to row, and the mean over three rows would wash it out. Columns by
which the rows of a second mean follow such a line outwards, which is 0.4 m per metre (a line has that 15 m ahead in a
bend with a radius of 40 m), and the distance to the side from which this mean is used as well, m.
"""

_GREENNESS = np.array([[-0.5, 1.0, -0.5, 64.0]], np.float32)
"""Green minus the mean of blue and red, plus 64 so that noise is not clipped at 0."""


@dataclass(frozen=True, eq=False)
class Ridges:
    """Ridges of one image.

    Attributes:
        strength: (rows, columns) by how much a cell is brighter than both its sides, in units of the row's deviation,
            0-8.
        contrast: (rows, columns) the same in grey levels (twice the smaller step).
        scale: (rows,) the row's deviation, grey levels.
        green: (rows, columns) greenness of the greener side, grey levels: green minus the mean of red and blue.
        ground: (rows, columns) brightness, grey levels.
        seen: (rows, columns) 1 if a cell and its sides lie in the image, else 0.
    """

    strength: Map
    contrast: Map
    scale: Map
    green: Map
    ground: Map
    seen: Map


@dataclass(frozen=True, eq=False)
class Lookup:
    """The places of cells of the ground in the image, for one pitch.

    Attributes:
        column: (rows, columns) u, pixels; -1 behind the camera.
        row: (rows, columns) v, pixels; -1 behind the camera.
        seen: (rows, columns) 1 if a cell and its sides lie in the image, else 0.
        count: (rows,) number of visible cells, plus 1.
    """

    column: Map
    row: Map
    seen: Map
    count: Map


class BirdsEye:
    """The view of the ground from above through one camera (inverse perspective mapping of a plane)."""

    def __init__(self, camera: Camera) -> None:
        """Prepare the map; see `X_FROM` and `Y_FROM` for its extent."""
        self.camera = camera
        rows, columns = round((X_TO - X_FROM) / X_STEP), round((Y_FROM - Y_TO) / Y_STEP)
        self.x = (X_FROM + (np.arange(rows) + 0.5) * X_STEP).astype(np.float32)
        self.y = (Y_FROM - (np.arange(columns) + 0.5) * Y_STEP).astype(np.float32)
        outer = round((Y_FROM - ASIDE_FROM) / Y_STEP)
        self._outer = ((slice(None, outer), _following(-ASIDE)), (slice(-outer, None), _following(ASIDE)))
        self._lookups: dict[int, Lookup] = {}
        self.seen = self.lookup(0.0).seen

    def lookup(self, pitch: float) -> Lookup:
        """Return the lookup for a camera tilted up by `pitch`, rad, against its mounting, to the nearest step."""
        step = round(pitch / PITCH_STEP)
        if step not in self._lookups:
            self._lookups[step] = self._tilted(step * PITCH_STEP)
        return self._lookups[step]

    def _tilted(self, pitch: float, course: Course | None = None) -> Lookup:
        return ground_lookup(self.camera, self.x[:, None].astype(np.float64), self.y.astype(np.float64), pitch, course)

    def ridges(self, image: NDArray[np.uint8], pitch: float = 0.0, course: Course | None = None) -> Ridges:
        """Return the ridges of a BGR image (see `bright_of`).

        Args:
            image: (height, width, 3) uint8, BGR.
            pitch: Upward tilt of the camera against its mounting, rad.
            course: The line along which the ground is viewed; rows are along it then, and the pitch is that against
                the map. None for straight ahead.
        """
        lookup = self.lookup(pitch) if course is None else self._tilted(pitch, course)
        bright = bright_of(image)
        if self.camera.width > 700:
            bright = np.asarray(cv2.GaussianBlur(bright, (3, 3), 0), np.uint8)
        single = cv2.remap(bright, lookup.column, lookup.row, cv2.INTER_LINEAR).astype(np.float32)
        above = np.asarray(cv2.blur(single, MEAN_OVER), np.float32)
        curve, contrast = stands_out(above)
        for outer, following in self._outer:
            mean = np.asarray(cv2.filter2D(single, -1, following), np.float32)
            contrast[:, outer] = np.maximum(contrast[:, outer], stands_out(mean)[1][:, outer])
        contrast *= lookup.seen
        scale = deviation_of(np.abs(curve) * lookup.seen, lookup.count)
        strength = np.minimum(contrast / scale[:, None], STRONGEST)
        return Ridges(strength, contrast, scale, self._green(image, lookup), above, lookup.seen)

    def _green(self, image: NDArray[np.uint8], lookup: Lookup) -> Map:
        tone = cv2.transform(image, _GREENNESS)
        above = cv2.remap(tone, lookup.column, lookup.row, cv2.INTER_LINEAR).astype(np.float32)
        above = np.asarray(cv2.blur(above, (5, 15)), np.float32)
        return np.maximum(_shifted(above, COMPARED), _shifted(above, -COMPARED)) - np.float32(64.0)


def bright_of(image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return the maximum of green and red of a BGR image, which shows white and yellow lines."""
    return np.asarray(cv2.max(image[:, :, 1], image[:, :, 2]), np.uint8)


def ground_lookup(camera: Camera, s: Floats, t: Floats, pitch: float, course: Course | None) -> Lookup:
    """Return where an image shows cells of the ground.

    Args:
        camera: The camera of the image.
        s: (rows, 1) distances ahead, m.
        t: (rows, columns) or (columns,) distances to the left, m, falling by `Y_STEP`.
        pitch: Upward tilt of the camera against its mounting, rad.
        course: The route along which s and t are, against which the pitch is then; None for straight ahead.
    """
    if course is None:
        x, y = np.broadcast_arrays(s, t)
        u, v = camera.project_ground(x, y, pitch)
    else:
        x, y = course.points(s, t)
        u, v = camera.project_ground(x, y, pitch, course.height(s, t))
    inside = ((u >= 1) & (u < camera.width - 2) & (v >= 0) & (v < camera.height - 1)).astype(np.float32)
    seen: Map = np.asarray(cv2.erode(inside, np.ones((1, 2 * COMPARED + 1), np.uint8)), np.float32)
    column, row = (np.nan_to_num(pixel, nan=-1.0).astype(np.float32) for pixel in (u, v))
    return Lookup(column, row, seen, seen.sum(axis=1) + np.float32(1.0))


def stands_out(above: Map) -> tuple[Map, Map]:
    """Return across the road the second difference of brightness, and it less the difference of the two sides."""
    left, right = _shifted(above, COMPARED), _shifted(above, -COMPARED)
    curve = 2.0 * above - left - right
    return curve, np.maximum(curve - np.abs(left - right), 0.0)


def deviation_of(response: Map, count: Map) -> Map:
    """Return each row's mean response without outliers (the marks), smoothed along the road, at least 2."""
    mean = response.sum(axis=1) / count
    trimmed = np.minimum(response, 2.5 * mean[:, None]).sum(axis=1) / count
    smooth = cv2.blur(trimmed[:, None].astype(np.float32), (1, 9))
    return np.asarray(smooth[:, 0] + np.float32(2.0), np.float32)


def _shifted(above: Map, by: int) -> Map:
    """Return the map moved right by `by` columns, its edge repeated."""
    moved = np.empty_like(above)
    if by > 0:
        moved[:, by:], moved[:, :by] = above[:, :-by], above[:, :1]
    else:
        moved[:, :by], moved[:, by:] = above[:, -by:], above[:, -1:]
    return moved


def _following(columns: int) -> Map:
    """Return the kernel of the mean over the same cells, each row shifted by some columns against the one before."""
    width, rows = MEAN_OVER
    kernel = np.zeros((rows, width + 2 * abs(columns)), np.float32)
    for row in range(rows):
        first = abs(columns) + columns * (row - rows // 2)
        kernel[row, first : first + width] = 1.0 / (rows * width)
    return kernel
