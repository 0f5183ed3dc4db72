"""How well the camera is, judged by its images alone: noise, darkness, blur, dirt, and images that do not change.

Each estimator gives the quantity that `engine.camera_health` has a curve for. Noise, tones and blur are read from one
image. Dirt and a frozen image are seen in what stands still while the car moves: the texture of the road ahead of the
car changes in every image, what sticks to the lens does not.

    noise    `confidence.noise_of`
    tones    99th percentile of the brightest channel after a mean over 5 x 5 pixels, grey levels
    blur     a step blurred by a Gaussian of radius r has the slope step / (2.5 r): the largest steps over 40 pixels by
             the largest slopes, both as 99.8th percentiles, geometric mean of rows and columns. Noise has slopes of its
             own, so it is smoothed first, and what is left of it is subtracted from the squares of steps and slopes,
             as is the square of the radius of the smoothing from that of the blur
    dirt     share of the ground near the car whose blocks of 8 x 8 pixels have not changed: the rims of blotches do, so
             that it is 0.05 to 0.1 less than what dirt covers
    frozen   the image is equal to the one before

What they do not cover: dirt and frozen images at a standstill, dirt in the sky, blur under noise of 15 grey levels
and more in the dark.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.engine.ego.camera_health import blur_health, dirt_health, noise_health, tones_health
from scenario_compiler.perception.confidence import noise_of

Image = NDArray[np.uint8]
Floats = NDArray[np.float32]

STEP = 40
"""Distance over which a step in the image is looked for, pixels of an image 512 wide."""

SHARPEST, SLOPE_OF_STEP = 99.8, 2.507
"""Percentile of slopes and steps that counts, and the square root of 2 pi."""

RAREST = 3.09
"""The same percentile of the absolute value of a normal variable, in standard deviations."""

SMOOTHED = 4.0
"""Noise is smoothed the more the stronger it is: by a Gaussian of the radius sqrt(noise / 4), pixels."""

LEAST_SMOOTHING = 0.6
"""Least radius that is smoothed by: a narrower Gaussian is hardly one between pixels."""

SPARSE = 4
"""Every which row or column is looked at: enough for percentiles."""

BLOCK = 8
"""Side of a block in which change is looked for, pixels."""

MEMORY = 0.8
"""Share of what was seen of a block's change that is kept from one image to the next."""

STILL = 0.35
"""Mean change of a block, grey levels, under which it counts as still, beyond what noise makes."""

MOVING = 0.15
"""Way between two images from which on the road must have changed, m."""

SEEN_ENOUGH = 6
"""Images while moving before dirt is spoken of."""


@dataclass(frozen=True)
class SensorHealth:
    """What was found in the images up to one.

    Attributes:
        noise: Standard deviation of the noise, grey levels.
        tones: The image's brightest tones, grey levels.
        blur: Radius of the blur, 1/512 of the image's width.
        dirt: Share of the ground that does not change, 0-1.
        frozen: The image is the one before, though the car has moved.
    """

    noise: float
    tones: float
    blur: float
    dirt: float
    frozen: bool

    @property
    def health(self) -> float:
        """1 well, 0 broken."""
        if self.frozen:
            return 0.0
        return noise_health(self.noise) * tones_health(self.tones) * blur_health(self.blur) * dirt_health(self.dirt)


class SensorMonitor:
    """Watches the images of one camera, in order."""

    def __init__(self) -> None:
        """Begin with nothing seen."""
        self._last: Image | None = None
        self._blocks: Floats | None = None
        self._change: Floats | None = None
        self._seen = 0
        self._frozen = False

    def observe(self, image: Image, travelled: float) -> SensorHealth:
        """Return the health after one more image.

        Args:
            image: (height, width, 3) uint8, BGR.
            travelled: Way of the car since the image before, m.
        """
        noise = noise_of(image)
        if travelled >= MOVING:
            self._frozen = self._last is not None and np.array_equal(image, self._last)
        elif self._last is not None and not np.array_equal(image, self._last):
            self._frozen = False
        dirt = self._still_share(image, noise, travelled)
        self._last = image
        return SensorHealth(noise, tones_of(image), blur_of(image, noise), dirt, self._frozen)

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
        """Return the share of blocks whose change is no more than noise makes: mean |a - b| of two means of blocks."""
        if self._change is None or self._seen < SEEN_ENOUGH:
            return 0.0
        by_noise = 1.128 * noise / BLOCK
        still = int(np.count_nonzero(self._change < STILL + by_noise))
        return still / self._change.size


def tones_of(image: Image) -> float:
    """Return the brightest tones of a BGR image, grey levels."""
    return float(np.percentile(cv2.blur(image, (5, 5))[::SPARSE, ::SPARSE].max(axis=2), 99))


def blur_of(image: Image, noise: float) -> float:
    """Return the radius of the blur of a BGR image, in 1/512 of its width.

    Args:
        image: (height, width, 3) uint8.
        noise: Standard deviation of its noise in a channel, grey levels.
    """
    scale = float(image.shape[1] / 512.0)
    step = max(round(STEP * scale), 2)
    left = noise / math.sqrt(3.0)
    grey = cv2.transform(image.astype(np.float32), np.full((1, 3), 1.0 / 3.0, np.float32))
    radius, here, beside = math.sqrt(left / SMOOTHED), 1.0, 0.0
    if radius >= LEAST_SMOOTHING:
        grey = cv2.GaussianBlur(grey, (0, 0), radius)
        here = 1.0 / (2.0 * math.sqrt(math.pi) * radius)
        beside = here * math.exp(-0.25 / (radius * radius))
    else:
        radius = 0.0
    # `here` and `beside` are the smoothing's correlation along a row of a pixel with itself and with the next.
    by_noise = (left * RAREST * math.sqrt(2.0) * here, left * RAREST * math.sqrt(2.0 * here * (here - beside)))
    rows, columns = grey[::SPARSE], grey[:, ::SPARSE]
    across = _radius(np.abs(rows[:, step:] - rows[:, :-step]), np.abs(rows[:, 1:] - rows[:, :-1]), by_noise)
    down = _radius(np.abs(columns[step:] - columns[:-step]), np.abs(columns[1:] - columns[:-1]), by_noise)
    squared = (max(found * found - radius * radius, 0.0) for found in (across, down))
    return math.prod(squared) ** 0.25 / scale


def _radius(steps: Floats, slopes: Floats, by_noise: tuple[float, float]) -> float:
    """Return the radius of the blur of the largest steps; half a grey level is the least slope that can be seen."""
    step, slope = (_beyond_noise(found, noise) for found, noise in zip((steps, slopes), by_noise, strict=True))
    return step / max(slope, 0.5) / SLOPE_OF_STEP


def _beyond_noise(differences: Floats, noise: float) -> float:
    """Return the percentile that counts of differences, less what noise alone gives."""
    largest = float(np.percentile(differences, SHARPEST))
    return math.sqrt(max(largest * largest - noise * noise, 0.0))
