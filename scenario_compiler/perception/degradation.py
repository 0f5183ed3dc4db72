"""Faults of the camera, applied to a clean image at the sensor's own resolution.

They are applied in the order of the light's path: motion during the exposure (`smear`), dirt on the lens, blur,
darkness or overexposure, noise, impulses, dead rows, coarse grey levels; then, at the readout, images that are missing,
repeated or late (until the first late one arrives, the last one stays). A camera that is turned on its mount sees
another view, which `RoadCamera` draws. Overexposure adds to the value of hue, saturation and value, as ImageNet-C's
brightness does; impulses affect each channel of a pixel for itself, as ImageNet-C's do (scikit-image's "s&p").

Noise is Gaussian with mean 0 and sigma in grey levels (0-255), independent in every pixel and channel, clipped to
0-255. It is drawn with Philox, a counter-based generator with the key (seed, frame index), so a frame's noise depends
only on these two numbers and frames can be made in any order; the same holds for impulses. Sigma has a meaning only at
one resolution: halving an image by area averaging halves it. Dirt and dead rows depend only on the seed: they stay.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, replace
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.faults import CameraFaults
from scenario_compiler.perception.smear import smeared

Image = NDArray[np.uint8]


SENSOR_NOISE, RAIN, DIRT, DROPS, IMPULSES, ROWS = 0, 1, 2, 3, 4, 5
"""Streams of random numbers within one frame; dirt and drops on the windscreen are the same in all frames."""

DIRT_SIZE = 0.03
"""Size of the blotches of dirt, as a share of the image's width."""

DIRT_COLOUR = (20, 27, 32)
"""Colour of dirt on the lens, BGR: dark, because it is lit from behind."""

DIRT_RIM = 0.12
"""Width of the soft rim of the blotches, in standard deviations of the random field from which they are made."""


AT_ONCE = 1e-6
"""Difference up to which two times count as equal, s."""


@dataclass(frozen=True, slots=True)
class Degradation(CameraFaults):
    """Everything that changes one image: the camera's faults, its noise, and the vehicle's motion during the exposure.

    Attributes:
        sigma: Standard deviation of the noise, grey levels.
        speed: Speed of the vehicle's reference point during the exposure, m/s.
        yaw_rate: Yaw rate of the vehicle, rad/s, positive to the left.
    """

    sigma: float = 0.0
    speed: float = 0.0
    yaw_rate: float = 0.0

    def camera(self, mounted: Camera) -> Camera:
        """Return the camera with its present misalignment; the same object if there is none."""
        if self.turned == (0.0, 0.0, 0.0):
            return mounted
        yaw, pitch, roll = self.turned
        return replace(mounted, yaw=mounted.yaw + yaw, pitch=mounted.pitch + pitch, roll=mounted.roll + roll)


class Sensor:
    """One camera's sensor, which degrades images one after the other and remembers the last one for when it freezes."""

    def __init__(self, seed: int, camera: Camera | None = None, lever: float = 0.0) -> None:
        """Start without an image.

        Args:
            seed: Seed of the run.
            camera: The camera, the default camera if None.
            lever: Distance ahead from the vehicle's reference point to the origin of the camera's `x`, m.
        """
        self.seed = seed
        self.camera = camera if camera is not None else Camera()
        self.lever = lever
        self._last: Image | None = None
        self._on_the_way: deque[tuple[float, Image]] = deque()

    def deliver(self, image: Image, state: Degradation, frame_index: int, t: float = 0.0) -> Image:
        """Return the image that is delivered for an image.

        Args:
            image: (height, width, 3) uint8, BGR, as the optics of a clean camera would see it.
            state: The faults.
            frame_index: Number of the frame within the run.
            t: Time at which it was taken, s.
        """
        if state.missing:
            return np.zeros_like(image)
        if state.frozen and self._last is not None:
            return self._last
        if state.exposure > 0.0:
            camera = state.camera(self.camera)
            image = smeared(image, camera, self.lever, state.speed, state.yaw_rate, state.exposure)
        self._on_the_way.append((t, degraded(image, state, self.seed, frame_index)))
        while self._on_the_way and (self._last is None or self._on_the_way[0][0] <= t - state.late + AT_ONCE):
            self._last = self._on_the_way.popleft()[1]
        assert self._last is not None
        return self._last


def degraded(image: Image, state: Degradation, seed: int, frame_index: int) -> Image:
    """Return the image after all effects between exposure and readout."""
    if state.dirt > 0.0:
        image = add_dirt(image, state.dirt, seed)
    if state.blur > 0.0:
        image = np.asarray(cv2.GaussianBlur(image, (0, 0), state.blur * image.shape[1] / 512.0), np.uint8)
    if state.dark > 0.0:
        image = cv2.convertScaleAbs(image, alpha=max(1.0 - state.dark, 0.0))  # type: ignore[assignment]
    if state.brighter > 0.0:
        image = overexposed(image, state.brighter)
    image = add_noise(image, state.sigma, seed, frame_index)
    if state.impulses > 0.0:
        image = add_impulses(image, state.impulses, seed, frame_index)
    if state.dead_rows > 0.0:
        image = without_rows(image, state.dead_rows, seed)
    return image if state.coarse <= 0.0 else quantised(image, state.coarse)


def overexposed(image: Image, more: float) -> Image:
    """Return the image with `more` of white added to the value of each pixel, with unchanged hue and saturation."""
    value = image.max(axis=2, keepdims=True).astype(np.float32)
    wanted = np.minimum(value + np.float32(255.0 * more), np.float32(255.0))
    scaled = np.where(value > 0.0, image * (wanted / np.maximum(value, 1.0)), wanted)
    return np.asarray(np.rint(scaled), np.uint8)


def add_impulses(image: Image, share: float, seed: int, frame_index: int) -> Image:
    """Return the image with a share of the values of its channels replaced, half of them by 0, half by 255."""
    drawn = generator(seed, frame_index, IMPULSES).random(image.shape, dtype=np.float32)
    struck = image.copy()
    struck[drawn < 0.5 * share] = 0
    struck[drawn > 1.0 - 0.5 * share] = 255
    return struck


def without_rows(image: Image, share: float, seed: int) -> Image:
    """Return the image with a share of its rows black; a greater share includes the rows of a smaller one."""
    dead = generator(seed, 0, ROWS).random(image.shape[0]) < share
    left = image.copy()
    left[dead] = 0
    return left


def quantised(image: Image, coarse: float) -> Image:
    """Return the image with 2 to the power of 8 - 7 `coarse` grey levels (rounded), evenly from black to white."""
    steps = round(2.0 ** (8.0 - 7.0 * min(coarse, 1.0))) - 1
    levels = np.rint(np.rint(np.arange(256) * steps / 255.0) * 255.0 / steps)
    return np.asarray(cv2.LUT(image, levels.astype(np.uint8)), np.uint8)


def add_dirt(image: Image, share: float, seed: int) -> Image:
    """Return the image behind dirt that covers `share` of it; a greater share includes the dirt of a smaller one."""
    field, ordered = _dirt_field(image.shape[1], image.shape[0], seed)
    if share >= 1.0:
        return np.full_like(image, DIRT_COLOUR)
    level = float(ordered[min(int((1.0 - share) * len(ordered)), len(ordered) - 1)])
    cover = np.clip((field - level) / DIRT_RIM + 0.5, 0.0, 1.0).astype(np.float32)[:, :, None]
    mixed = image + cover * (np.array(DIRT_COLOUR, np.float32) - image)
    return np.asarray(np.clip(mixed, 0, 255), np.uint8)


@lru_cache(maxsize=4)
def _dirt_field(width: int, height: int, seed: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return a smooth field (height, width) of mean 0 and deviation 1, and its values in ascending order."""
    field = generator(seed, 0, DIRT).standard_normal((height, width), dtype=np.float32)
    field = np.asarray(cv2.GaussianBlur(field, (0, 0), DIRT_SIZE * width), np.float32)
    field = (field - field.mean()) / field.std()
    return field, np.sort(field, axis=None)


def generator(seed: int, frame_index: int, stream: int) -> np.random.Generator:
    """Return one stream of one frame's random numbers; equal arguments give equal numbers."""
    mask = 0xFFFFFFFFFFFFFFFF
    key = np.array([seed & mask, frame_index & mask], np.uint64)
    counter = np.array([0, 0, 0, stream], np.uint64)
    return np.random.Generator(np.random.Philox(key=key, counter=counter))


def add_noise(image: Image, sigma: float, seed: int, frame_index: int) -> Image:
    """Return `image` with Gaussian noise of `sigma` grey levels; the image itself if sigma is not positive.

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
