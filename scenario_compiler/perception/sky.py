"""The sky: a panorama for each weather, with a distant line of trees, and the part of it in each pixel of a camera."""

from __future__ import annotations

import math
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.buffers import Buffers
from scenario_compiler.perception.lens import Lens
from scenario_compiler.perception.lighting import INFINITY, Air, haze_colour, zenith_colour
from scenario_compiler.perception.textures import cloud_tile
from scenario_compiler.perception.weather_look import Look

Image = NDArray[np.uint8]
Table = NDArray[np.float32]

COLUMNS, ROWS = 4096, 256
"""Size of a panorama. Columns are even in azimuth, clockwise from north of the world's x axis. Rows are even in the
square root of the elevation, so that most of them are near the horizon, where the detail is.
"""

CLEAR_ABOVE = 20.0
"""Elevation above which the sky has the colour of the zenith, degrees."""

CLOUD_TEXEL = 360.0 / 2048.0
"""Size of a texel of the field of clouds, degrees."""

FINE = 700
"""Width above which the sky is looked up for every second pixel only."""

TREE = 3
"""Channel of a panorama that is 255 where trees stand."""


class SkyView:
    """The part of a panorama in each pixel, of the sky or of ground that reflects it."""

    def __init__(self, ahead: Table, left: Table, up: Table) -> None:
        """Prepare for directions in the vehicle's axes, (rows, columns) each."""
        turn = np.arctan2(-left, ahead)
        around = turn * np.float32(COLUMNS / (2.0 * math.pi))
        elevation = np.degrees(np.arctan2(up, np.hypot(ahead, left)))
        self.row = row_of(elevation).astype(np.float32)
        first = math.floor(float(around.min()))
        self.first, self.span = first, min(math.ceil(float(around.max())) - first + 2, COLUMNS)
        self.column = (around - np.float32(first)).astype(np.float32)

    def draw(self, panorama: Image, heading: float, rows: int | None = None, into: Image | None = None) -> Image:
        """Return the visible part, (rows, columns, 4).

        Args:
            panorama: The sky (see `panorama_of`).
            heading: Heading of the vehicle, rad.
            rows: Number of rows from the top; all if None.
            into: An image of this size to draw into.
        """
        begin = (round(-heading * COLUMNS / (2.0 * math.pi)) + self.first) % COLUMNS
        part = panorama[:, begin : begin + self.span]
        column, row = self.column[:rows], self.row[:rows]
        seen = cv2.remap(part, column, row, cv2.INTER_LINEAR, into, borderMode=cv2.BORDER_REPLICATE)
        return np.asarray(seen, np.uint8)


def row_of(elevation: Table) -> Table:
    """Return the row of a panorama for elevations, degrees."""
    share = np.sqrt(np.clip(elevation, 0.0, 90.0) / np.float32(90.0))
    return np.asarray((1.0 - share) * np.float32(ROWS - 1))


@lru_cache(maxsize=4)
def panorama_of(look: Look) -> Image:
    """Return the panorama of a weather, (ROWS, 2 COLUMNS, 4): blue, green, red, trees; its halves are equal."""
    rows = np.arange(ROWS, dtype=np.float32)[:, None]
    elevation = 90.0 * np.square(1.0 - rows / np.float32(ROWS - 1))
    zenith, haze = zenith_colour(look), haze_colour(look)
    down = np.clip(1.0 - elevation / CLEAR_ABOVE, 0.0, 1.0) ** 1.5
    clear = (zenith + (haze - zenith) * down).astype(np.float32)
    cover = np.clip(_clouds(elevation) * 0.35 + (look.cloud - 0.45) * 1.3, 0, 1) * (0.75 * (1 - 0.4 * down))
    clouds = np.array([235, 235, 238], np.float32) * look.luminance * (1 - 0.3 * look.cloud) * look.tint
    trees = _trees(elevation)
    low = int(np.argmax(trees.any(axis=1)))
    leaves = 0.55 * (np.array([70, 88, 72], np.float32) * look.luminance * look.tint) + 0.45 * haze
    air = Air(look)
    share = air.seen(np.full(1, INFINITY, np.float32))
    veil = air.colour * (1.0 - share)
    image = np.empty((ROWS, COLUMNS, 4), np.uint8)
    for channel in range(TREE):
        sky = (clouds[channel] - clear[:, channel, None]) * cover
        sky += clear[:, channel, None]
        sky[low:] += (leaves[channel] - sky[low:]) * trees[low:]
        sky *= share
        sky += veil[channel]
        image[..., channel] = np.clip(sky, 0, 255, out=sky)
    image[..., TREE] = 255.0 * trees
    return np.hstack([image, image])


def _clouds(elevation: Table) -> Table:
    """Return the field of clouds by elevation (ROWS, 1), degrees, (ROWS, COLUMNS)."""
    tile = cloud_tile()
    column = np.arange(COLUMNS, dtype=np.float32)[None] * np.float32(tile.shape[1] / COLUMNS)
    row = 40.0 + elevation / np.float32(CLOUD_TEXEL)
    shape = (ROWS, COLUMNS)
    column, row = (np.ascontiguousarray(np.broadcast_to(one, shape)) for one in (column, row))
    return np.asarray(cv2.remap(tile, column, row, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REFLECT), np.float32)


def _trees(elevation: Table) -> Table:
    """Return the coverage by trees at each place of the panorama, (ROWS, COLUMNS), 0-1."""
    turn = np.arange(COLUMNS, dtype=np.float32) * np.float32(2.0 * math.pi / COLUMNS)
    crown = 1.1 + 0.25 * np.sin(9 * turn) + 0.2 * np.sin(23 * turn + 1) + 0.1 * np.sin(61 * turn)
    top = np.degrees(0.011 * crown)[None]
    soft = np.maximum(np.abs(np.gradient(elevation, axis=0)), 1e-3)
    return np.asarray(np.clip((top - elevation) / soft + 0.5, 0.0, 1.0), np.float32)


class Sky:
    """Draws the sky of one camera.

    Attributes:
        rows: Number of rows from the top that show any sky.
    """

    def __init__(self, lens: Lens, buffers: Buffers) -> None:
        """Prepare everything that does not depend on the weather."""
        self._buffers = buffers
        camera = lens.camera
        self.rows = lens.sky_rows
        self.step = 2 if camera.width > FINE else 1
        self._view: SkyView | None = None
        if self.rows:
            high = slice(0, self.rows, self.step)
            ahead, left, up = (one[high, :: self.step] for one in lens.directions())
            self._view = SkyView(ahead, left, up)
        self._width = camera.width

    def draw(self, panorama: Image, heading: float, into: Image) -> None:
        """Draw the sky into the image's topmost `rows`, (rows, width, 4)."""
        if self._view is None:
            return
        if self.step == 1:
            self._view.draw(panorama, heading, into=into)
            return
        coarse = self._buffers.get("sky", (*self._view.row.shape, 4), np.uint8)
        cv2.resize(self._view.draw(panorama, heading, into=coarse), (self._width, self.rows), into)
