"""Falling rain before the camera, and the drops that it leaves on the windscreen until the wiper comes."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.buffers import Buffers
from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.degradation import DROPS, RAIN, generator
from scenario_compiler.perception.textures import rain_tile
from scenario_compiler.perception.weather_look import Look

Image = NDArray[np.uint8]

MOST_DROPS = 160
"""Number of drops on the windscreen in the heaviest rain, between two strokes of the wiper."""

DROP_RADIUS = (0.0025, 0.008)
"""Least and greatest radius of a drop, as a share of the image's width."""

STROKE = 24
"""Number of images between two strokes of the wiper; each drop begins at a random time."""

SEEN_THROUGH = 7.0
"""Width of the part of the scene that a drop shows, upside down, relative to its own width."""

OPAQUE = 0.75
"""Opacity of a drop's picture of the scene."""

SMALL = 8
"""Factor by which the image that drops show is reduced."""


class _Drops(NamedTuple):
    """All pixels of all drops: the drop, the pixel, and the pixel of the small image that it shows."""

    drop: NDArray[np.int64]
    pixel: NDArray[np.int64]
    shown: NDArray[np.int64]
    begins: NDArray[np.int64]


def add_rain(image: Image, camera: Camera, look: Look, seed: int, frame_index: int, buffers: Buffers) -> None:
    """Add rain to an image (height, width, 4) in place.

    Args:
        image: The image.
        camera: The camera.
        look: The weather.
        seed: Seed of the run; together with `frame_index` it places the streaks, alone the drops.
        frame_index: Number of the frame.
        buffers: Working memory.
    """
    if look.rain <= 0.0:
        return
    _add_streaks(image, camera, look, generator(seed, frame_index, RAIN), buffers)
    if camera.windscreen:
        _add_drops(image, look.rain, seed, frame_index)


def _add_streaks(image: Image, camera: Camera, look: Look, draw: np.random.Generator, buffers: Buffers) -> None:
    """Add streaks from a random part of a large field of them."""
    brightness = 0.45 * look.rain * max(look.luminance, 0.15)
    tile = _lit_tile(camera.width, camera.height, 0.1 + 0.25 * look.wind, brightness)
    row, column = int(draw.integers(camera.height)), int(draw.integers(camera.width))
    grey = tile[row : row + camera.height, column : column + camera.width]
    four = buffers.get("four", image.shape, np.uint8)
    cv2.add(image, cv2.merge((grey, grey, grey, grey), four), image)


@lru_cache(maxsize=4)
def _lit_tile(width: int, height: int, slant: float, brightness: float) -> Image:
    """Return the streaks of `rain_tile` with the brightness of the weather."""
    return np.asarray(cv2.convertScaleAbs(rain_tile(width, height, slant), alpha=brightness), np.uint8)


def _add_drops(image: Image, rain: float, seed: int, frame_index: int) -> None:
    """Show a small picture of the scene through each drop, upside down."""
    height, width = image.shape[:2]
    drops = _drops_on(width, height, seed)
    there = np.flatnonzero(((frame_index + drops.begins) % STROKE < STROKE * rain)[drops.drop])
    if not len(there):
        return
    small = cv2.blur(image[SMALL // 2 :: SMALL, SMALL // 2 :: SMALL], (3, 3))
    pixels, shown = image.view(np.uint32).ravel(), np.ascontiguousarray(small).view(np.uint32).ravel()
    place = drops.pixel[there]
    own = shown[drops.shown[there]].view(np.uint8)[None]
    mixed = cv2.addWeighted(pixels[place].view(np.uint8)[None], 1.0 - OPAQUE, own, OPAQUE, 0.0)
    pixels[place] = mixed.view(np.uint32).ravel()


@lru_cache(maxsize=4)
def _drops_on(width: int, height: int, seed: int) -> _Drops:
    draw = generator(seed, 0, DROPS)
    middle = draw.uniform((0.0, 0.0), (width, height), (MOST_DROPS, 2))
    radius = np.maximum(draw.uniform(*DROP_RADIUS, MOST_DROPS) * width, 1.0)
    begins = draw.integers(0, STROKE, MOST_DROPS)
    across, down = len(range(SMALL // 2, width, SMALL)), len(range(SMALL // 2, height, SMALL))
    which, pixels, shown = [], [], []
    for k, ((u, v), r) in enumerate(zip(middle.tolist(), radius.tolist(), strict=True)):
        rows = np.arange(max(int(v - 1.3 * r), 0), min(int(v + 1.3 * r) + 2, height))
        columns = np.arange(max(int(u - r), 0), min(int(u + r) + 2, width))
        x, y = (columns[None] - u) / r, (rows[:, None] - v) / (1.25 * r)
        row, column = np.nonzero(x * x + y * y < 1.0)
        pixels.append(rows[row] * width + columns[column])
        far_u = np.clip(u - SEEN_THROUGH * (columns[column] - u), 0, width - 1)
        far_v = np.clip(v - SEEN_THROUGH * (rows[row] - v), 0, height - 1)
        small_u = np.minimum(far_u.astype(np.int64) // SMALL, across - 1)
        shown.append(np.minimum(far_v.astype(np.int64) // SMALL, down - 1) * across + small_u)
        which.append(np.full(len(row), k))
    return _Drops(np.concatenate(which), np.concatenate(pixels), np.concatenate(shown), begins)
