"""Tileable textures, each made once from a seed: asphalt, wear, patches, grass, clouds, streaks of rain."""

from __future__ import annotations

from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

TILE = 1024
"""Side of the ground tile, texels."""

TEXEL = 0.02
"""Size of a ground texel, m; the tile repeats every 20.48 m."""

GRAIN, WEAR, PATCH, GRASS = range(4)
"""Channels of the ground tile; all have mean 128 except wear, which is uniform from 0 to 255."""


GROUND_SEED = 7
"""Seed of the ground tile of all runs; lane detectors are trained with others."""


@lru_cache(maxsize=2)
def ground_tile(seed: int = GROUND_SEED) -> NDArray[np.uint8]:
    """Return the (TILE, TILE, 4) ground tile: grain, wear, patches, grass."""
    draw = np.random.default_rng(seed)
    grain = 128 + 38 * _noise(draw, TILE, 0.6) + 14 * _noise(draw, TILE, 2.0)
    wear = _uniform(_noise(draw, TILE, 3.0) + 0.8 * _noise(draw, TILE, 9.0) + 0.5 * _noise(draw, TILE, 1.0))
    patch = 128 + 34 * _noise(draw, TILE, 40.0) + 26 * _noise(draw, TILE, 12.0)
    grass = 128 + 30 * _noise(draw, TILE, 2.0) + 30 * _noise(draw, TILE, 15.0)
    return np.clip(np.dstack([grain, wear, patch, grass]), 0, 255).astype(np.uint8)


@lru_cache(maxsize=1)
def cloud_tile() -> NDArray[np.float32]:
    """Return a (256, 2048) cloud field with mean 0 and standard deviation near 1; it wraps around horizontally."""
    draw = np.random.default_rng(11)
    field = 0.6 * _noise(draw, 1024, 60.0) + 0.45 * _noise(draw, 1024, 18.0) + 0.15 * _noise(draw, 1024, 5.0)
    return np.asarray(cv2.resize(np.clip(field, -3, 3), (2048, 256)), np.float32)


@lru_cache(maxsize=8)
def rain_tile(width: int, height: int, slant: float) -> NDArray[np.uint8]:
    """Return a (2 height, 2 width) field of rain streaks, from which random parts are used.

    Args:
        width: Columns of the image for which it is made.
        height: Rows of the image for which it is made.
        slant: Mean sideways motion of a streak for a unit of its fall.
    """
    draw = np.random.default_rng(13)
    scale = width / 1024.0
    tile = np.zeros((2 * height, 2 * width), np.uint8)
    count = 2600
    starts = draw.uniform((0.0, 0.0), (2 * width, 2 * height), (count, 2))
    length = draw.uniform(12.0, 60.0, count) * scale
    lean = draw.normal(slant, 0.05, count)
    ends = starts + np.stack([lean * length, length], axis=1)
    shade = draw.integers(50, 170, count)
    for start, end, grey in zip(starts, ends, shade, strict=True):
        a, b = np.round(start * 8).astype(int), np.round(end * 8).astype(int)
        cv2.line(tile, (int(a[0]), int(a[1])), (int(b[0]), int(b[1])), int(grey), 1, cv2.LINE_AA, 3)
    return np.asarray(cv2.GaussianBlur(tile, (0, 0), 0.7), np.uint8)


def _noise(draw: np.random.Generator, size: int, sigma: float) -> NDArray[np.float32]:
    """Return tileable Gaussian noise (size, size), smoothed over `sigma` texels, with mean 0 and deviation 1."""
    coarse = 1
    while sigma / coarse > 6.0:
        coarse *= 2
    field = draw.standard_normal((size // coarse, size // coarse)).astype(np.float32)
    border = int(4 * sigma / coarse) + 4
    field = np.pad(field, border, mode="wrap")
    field = np.asarray(cv2.GaussianBlur(field, (0, 0), sigma / coarse), np.float32)
    if coarse > 1:
        field = np.asarray(cv2.resize(field, None, fx=coarse, fy=coarse, interpolation=cv2.INTER_CUBIC), np.float32)
    border *= coarse
    field = field[border:-border, border:-border]
    return np.asarray((field - field.mean()) / field.std(), np.float32)


def _uniform(field: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the field with its values replaced by their ranks, from 0 to 255."""
    ranked = np.empty(field.size, np.float32)
    ranked[np.argsort(field, axis=None, kind="stable")] = np.linspace(0, 255, field.size, dtype=np.float32)
    return ranked.reshape(field.shape)
