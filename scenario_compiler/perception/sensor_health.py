"""The health of the camera from its images alone: noise, darkness, blur, dirt, and images that do not change.

Each estimator returns the quantity for which `engine.camera_health` has a curve. Noise, tones and blur are estimated
from one image. Dirt and a frozen image are recognised in what does not change while the car moves: the texture of the
road ahead changes in every image, dirt on the lens does not.

    noise    `confidence.noise_of`
    tones    99th percentile of the brightest channel after a mean over 5 x 5 pixels, grey levels
    blur     a step blurred by a Gaussian of radius r has the slope step / (2.5 r): the largest steps over 40 pixels
             divided by the largest slopes, both as 99.8th percentiles, geometric mean of rows and columns. Noise has
             slopes of its own, so the image is smoothed first; what noise remains is subtracted from the squares of
             steps and slopes, and the square of the smoothing's radius from that of the blur
    dirt     share of the ground near the car whose blocks of 8 x 8 pixels have not changed; the rims of blotches do
             change, so that it is 0.05 to 0.1 less than what dirt covers
    frozen   the image equals the previous one

Not covered are dirt and frozen images at a standstill, dirt in the sky, and blur under noise of 15 grey levels and more
in the dark.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.engine.ego.camera_health import (
    MOVING,
    SEEN_ENOUGH,
    blur_health,
    dirt_health,
    noise_health,
    tones_health,
)
from scenario_compiler.perception.buffers import Buffers
from scenario_compiler.perception.confidence import noise_of

Image = NDArray[np.uint8]
Floats = NDArray[np.float32]

STEP = 40
"""Distance over which a step in the image is measured, pixels of an image 512 wide."""

SHARPEST, SLOPE_OF_STEP = 99.8, 2.507
"""Percentile of slopes and steps that is used, and the square root of 2 pi."""

RAREST = 3.09
"""The same percentile of the absolute value of a normal variable, in standard deviations."""

SMOOTHED = 4.0
"""Stronger noise is smoothed more: by a Gaussian of the radius sqrt(noise / 4), pixels."""

LEAST_SMOOTHING = 0.6
"""Least radius of the smoothing: a narrower Gaussian is not well represented by pixels."""

FINER = 16
"""Units of a grey level in which smoothed images are kept as integers, so that percentiles can be counted."""

SPARSE = 4
"""Step between the rows or columns that are used, which suffices for percentiles."""

BLOCK = 8
"""Side of a block whose change is measured, pixels."""

MEMORY = 0.8
"""Share of a block's earlier change that is kept from one image to the next."""

STILL = 0.35
"""Mean change of a block below which it counts as unchanged, in addition to the change by noise, grey levels."""


@dataclass(frozen=True)
class SensorHealth:
    """The estimates after an image.

    Attributes:
        noise: Standard deviation of the noise, grey levels.
        tones: The image's brightest tones, grey levels.
        blur: Radius of the blur, 1/512 of the image's width.
        dirt: Share of the ground that does not change, 0-1.
        frozen: Whether the image equals the previous one, although the car has moved.
    """

    noise: float
    tones: float
    blur: float
    dirt: float
    frozen: bool

    @property
    def health(self) -> float:
        """From 1 (healthy) to 0 (broken)."""
        if self.frozen:
            return 0.0
        return noise_health(self.noise) * tones_health(self.tones) * blur_health(self.blur) * dirt_health(self.dirt)


class SensorMonitor:
    """Observes the images of one camera, in order."""

    def __init__(self) -> None:
        """Start without an image."""
        self._buffers = Buffers()
        self._last: Image | None = None
        self._blocks: Floats | None = None
        self._change: Floats | None = None
        self._seen = 0
        self._frozen = False

    def observe(self, image: Image, travelled: float) -> SensorHealth:
        """Return the health after one more image.

        Args:
            image: (height, width, 3) uint8, BGR.
            travelled: Distance that the car has travelled since the previous image, m.
        """
        noise = noise_of(image)
        if travelled >= MOVING:
            self._frozen = self._last is not None and _equal(image, self._last)
        elif self._last is not None and not _equal(image, self._last):
            self._frozen = False
        dirt = self._still_share(image, noise, travelled)
        self._last = image
        tones, blur = tones_of(image, self._buffers), blur_of(image, noise, self._buffers)
        return SensorHealth(noise, tones, blur, dirt, self._frozen)

    def _still_share(self, image: Image, noise: float, travelled: float) -> float:
        near = image[image.shape[0] * 5 // 8 :, :, 1]
        size = (max(near.shape[1] // BLOCK, 1), max(near.shape[0] // BLOCK, 1))
        blocks = np.asarray(cv2.resize(near.astype(np.float32), size, interpolation=cv2.INTER_AREA), np.float32)
        before, self._blocks = self._blocks, blocks
        if before is None or travelled < MOVING or self._frozen:
            return self._share(noise)
        change = np.abs(blocks - before)
        self._change = change if self._change is None else MEMORY * self._change + (1.0 - MEMORY) * change
        self._seen += 1
        return self._share(noise)

    def _share(self, noise: float) -> float:
        """Return the share of blocks with no more change than noise causes: mean |a - b| of two means of blocks."""
        if self._change is None or self._seen < SEEN_ENOUGH:
            return 0.0
        by_noise = 1.128 * noise / BLOCK
        still = int(np.count_nonzero(self._change < STILL + by_noise))
        return still / self._change.size


def _equal(image: Image, other: Image) -> bool:
    """Return whether two images are equal; images of a moving camera differ in the first rows already."""
    return image.shape == other.shape and all(np.array_equal(a, b) for a, b in zip(image, other, strict=True))


def tones_of(image: Image, buffers: Buffers) -> float:
    """Return the brightest tones of a BGR image, grey levels."""
    smooth = cv2.blur(image, (5, 5), buffers.get("smooth", image.shape, np.uint8))[::SPARSE, ::SPARSE]
    return percentile_of(np.maximum(np.maximum(smooth[..., 0], smooth[..., 1]), smooth[..., 2]), 99.0)


def blur_of(image: Image, noise: float, buffers: Buffers) -> float:
    """Return the radius of the blur of a BGR image, in 1/512 of its width.

    Args:
        image: (height, width, 3) uint8.
        noise: Standard deviation of its noise in a channel, grey levels.
        buffers: Working memory.
    """
    scale = float(image.shape[1] / 512.0)
    step = max(round(STEP * scale), 2)
    left = noise / math.sqrt(3.0)
    radius, here, beside, unit = math.sqrt(left / SMOOTHED), 1.0, 0.0, 1.0 / 3.0
    if radius >= LEAST_SMOOTHING:
        fine = buffers.get("fine", image.shape[:2], np.float32)
        cv2.GaussianBlur(np.multiply(_total(image), np.float32(FINER), out=fine), (0, 0), radius, fine)
        whole = buffers.get("whole", image.shape[:2], np.uint16)
        np.copyto(whole, np.rint(fine, out=fine), casting="unsafe")
        rows, columns, unit = whole[::SPARSE], _every(whole), unit / FINER
        here = 1.0 / (2.0 * math.sqrt(math.pi) * radius)
        beside = here * math.exp(-0.25 / (radius * radius))
    else:
        rows, columns, radius = _total(image[::SPARSE]), _total(_every(image)), 0.0
    # `here` and `beside` are the smoothing's correlation along a row of a pixel with itself and with the next.
    by_noise = (left * RAREST * math.sqrt(2.0) * here, left * RAREST * math.sqrt(2.0 * here * (here - beside)))
    across = cv2.absdiff(rows[:, step:], rows[:, :-step]), cv2.absdiff(rows[:, 1:], rows[:, :-1])
    down = cv2.absdiff(columns[step:], columns[:-step]), cv2.absdiff(columns[1:], columns[:-1])
    found = (_radius(steps, slopes, unit, by_noise) for steps, slopes in (across, down))
    return math.prod(max(one * one - radius * radius, 0.0) for one in found) ** 0.25 / scale


def _every(image: Any) -> Any:
    """Return the columns of an image that are used."""
    size = (-(-image.shape[1] // SPARSE), image.shape[0])
    return cv2.resize(image, size, interpolation=cv2.INTER_NEAREST)


def _total(image: Any) -> Any:
    """Return the sum of the three channels, uint16."""
    blue, green, red = cv2.split(image)
    return cv2.add(cv2.add(blue, green, dtype=cv2.CV_16U), red, dtype=cv2.CV_16U)


def percentile_of(values: Any, share: float) -> float:
    """Return a percentile of integers from 0 to 65534, linear between neighbours like `numpy.percentile`.

    The values, (rows, columns) uint8 or uint16, are counted and not sorted.
    """
    bins = int(values.max()) + 1
    counts = np.cumsum(cv2.calcHist([values], [0], None, [bins], [0, bins]))
    rank = share / 100.0 * (int(counts[-1]) - 1)
    low, high = np.searchsorted(counts, (math.floor(rank), math.ceil(rank)), side="right").tolist()
    return float(low + (high - low) * (rank - math.floor(rank)))


def _radius(steps: Any, slopes: Any, unit: float, by_noise: tuple[float, float]) -> float:
    """Return the radius of the blur of the largest steps; half a grey level is the least measurable slope.

    Args:
        steps: Differences over `STEP` pixels, integers.
        slopes: Differences of neighbours.
        unit: Grey levels of one unit.
        by_noise: The largest steps and slopes that noise causes, grey levels.
    """
    step, slope = (
        _beyond_noise(unit * percentile_of(found, SHARPEST), noise)
        for found, noise in zip((steps, slopes), by_noise, strict=True)
    )
    return step / max(slope, 0.5) / SLOPE_OF_STEP


def _beyond_noise(largest: float, noise: float) -> float:
    """Return the largest differences minus those that noise causes."""
    return math.sqrt(max(largest * largest - noise * noise, 0.0))
