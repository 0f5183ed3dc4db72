"""The ground seen from above, and what in it is brighter than both its sides: there lines are looked for."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.camera import Camera

Map = NDArray[np.float32]

X_FROM, X_TO, X_STEP = 5.0, 30.0, 0.25
Y_FROM, Y_TO, Y_STEP = 6.0, -6.0, 0.05
"""Extent of the map: rows ahead of the camera, columns from left to right, m. 30 m is where a mark of 0.12 m
is two pixels wide in an image of 512 columns."""

SIDE = 0.22
"""Distance, m, at which the ground on both sides of a mark is compared with it; widest marks are 0.3 m."""

STRONGEST = 8.0
"""Response at which a ridge counts no more, in units of the row's own deviation."""

_GREENNESS = np.array([[-0.5, 1.0, -0.5, 64.0]], np.float32)
"""Green less the mean of blue and red, plus 64 so that noise is not cut at 0."""


@dataclass(frozen=True, eq=False)
class Ridges:
    """Ridges of one image.

    Attributes:
        strength: (rows, columns) contrast of the brighter-than-both-sides kind, in units of the row's
            deviation, 0-8.
        contrast: (rows, columns) the same in grey levels (twice the smaller step).
        scale: (rows,) the row's deviation, grey levels.
        green: (rows, columns) how green the greener side is, grey levels: green less the mean of red and
            blue.
    """

    strength: Map
    contrast: Map
    scale: Map
    green: Map


class BirdsEye:
    """Looks at the ground from above through one camera (inverse perspective mapping of a plane)."""

    def __init__(self, camera: Camera) -> None:
        """Lay out the map; see `X_FROM` and `Y_FROM` for its extent."""
        self.camera = camera
        rows, columns = round((X_TO - X_FROM) / X_STEP), round((Y_FROM - Y_TO) / Y_STEP)
        self.x = (X_FROM + (np.arange(rows) + 0.5) * X_STEP).astype(np.float32)
        self.y = (Y_FROM - (np.arange(columns) + 0.5) * Y_STEP).astype(np.float32)
        self.side = round(SIDE / Y_STEP)
        self._pitch = math.nan
        self._tilt(0.0)

    def _tilt(self, pitch: float) -> None:
        """Prepare the lookup for a camera tilted by `pitch`, rad, beyond its mounting."""
        if pitch == self._pitch:
            return
        x, y = np.meshgrid(self.x, self.y, indexing="ij")
        u, v = self.camera.project_ground(x, y, pitch)
        width, height = self.camera.width, self.camera.height
        seen = ((u >= 1) & (u < width - 2) & (v >= 0) & (v < height - 1)).astype(np.float32)
        self.column = np.nan_to_num(u, nan=-1.0).astype(np.float32)
        self.row = np.nan_to_num(v, nan=-1.0).astype(np.float32)
        self.seen: Map = np.asarray(cv2.erode(seen, np.ones((1, 2 * self.side + 1), np.uint8)), np.float32)
        self.count = self.seen.sum(axis=1) + 1.0
        self._pitch = pitch

    def ridges(self, image: NDArray[np.uint8], pitch: float = 0.0) -> Ridges:
        """Return the ridges of a BGR image; white and yellow both show in the larger of green and red."""
        self._tilt(pitch)
        bright = cv2.max(image[:, :, 1], image[:, :, 2])
        if self.camera.width > 700:
            bright = cv2.GaussianBlur(bright, (3, 3), 0)
        above = cv2.remap(bright, self.column, self.row, cv2.INTER_LINEAR).astype(np.float32)
        above = np.asarray(cv2.blur(above, (2, 3)), np.float32)
        left, right = self._shifted(above, self.side), self._shifted(above, -self.side)
        curve = 2.0 * above - left - right
        contrast = np.maximum(curve - np.abs(left - right), 0.0) * self.seen
        scale = self._deviation(np.abs(curve) * self.seen)
        return Ridges(np.minimum(contrast / scale[:, None], STRONGEST), contrast, scale, self._green(image))

    def _green(self, image: NDArray[np.uint8]) -> Map:
        tone = cv2.transform(image, _GREENNESS)
        above = cv2.remap(tone, self.column, self.row, cv2.INTER_LINEAR).astype(np.float32)
        above = np.asarray(cv2.blur(above, (5, 15)), np.float32)
        return np.maximum(self._shifted(above, self.side), self._shifted(above, -self.side)) - np.float32(64.0)

    def _deviation(self, response: Map) -> Map:
        """Return each row's mean response without its outliers (the marks), smoothed along the road, at least 2."""
        mean = response.sum(axis=1) / self.count
        trimmed = np.minimum(response, 2.5 * mean[:, None]).sum(axis=1) / self.count
        smooth = cv2.blur(trimmed[:, None].astype(np.float32), (1, 9))
        return np.asarray(smooth[:, 0] + np.float32(2.0), np.float32)

    @staticmethod
    def _shifted(above: Map, by: int) -> Map:
        """Return the map moved right by `by` columns, its edge repeated."""
        moved = np.empty_like(above)
        if by > 0:
            moved[:, by:], moved[:, :by] = above[:, :-by], above[:, :1]
        else:
            moved[:, :by], moved[:, by:] = above[:, -by:], above[:, -1:]
        return moved
