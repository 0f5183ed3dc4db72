"""What goes wrong in the sensor, added to a clean image at the sensor's own resolution.

Noise is Gaussian with mean 0 and sigma in grey levels (0-255), independent in every pixel and channel,
clipped to 0-255. It is drawn with Philox, a counter-based generator keyed by (seed, frame index), so a
frame's noise depends on these two numbers alone and frames can be made in any order. Sigma has a meaning
only at one resolution: halving an image by area averaging halves it.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

Image = NDArray[np.uint8]


SENSOR_NOISE, RAIN = 0, 1
"""Streams of random numbers within one frame."""


def generator(seed: int, frame_index: int, stream: int) -> np.random.Generator:
    """Return one stream of one frame's random numbers; equal for equal arguments, whatever was drawn before."""
    mask = 0xFFFFFFFFFFFFFFFF
    key = np.array([seed & mask, frame_index & mask], np.uint64)
    counter = np.array([0, 0, 0, stream], np.uint64)
    return np.random.Generator(np.random.Philox(key=key, counter=counter))


def add_noise(image: Image, sigma: float, seed: int, frame_index: int) -> Image:
    """Return `image` with Gaussian noise of `sigma` grey levels; the image itself when sigma is not positive.

    Args:
        image: (height, width, 3) uint8.
        sigma: Standard deviation, grey levels.
        seed: Seed of the run.
        frame_index: Number of the frame within the run.
    """
    if not sigma > 0.0:
        return image
    noise = generator(seed, frame_index, SENSOR_NOISE).standard_normal(image.shape, dtype=np.float32)
    noisy = cv2.scaleAdd(noise, float(sigma), image.astype(np.float32))
    return np.asarray(cv2.convertScaleAbs(np.maximum(noisy, 0.0, out=noisy)), np.uint8)
