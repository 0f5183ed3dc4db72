"""The sky above the horizon: a panorama for each weather, of which a frame shows the part that it faces."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.textures import cloud_tile
from scenario_compiler.perception.weather_look import Look

Colour = NDArray[np.float32]


class Sky:
    """The sky of one weather for one camera; colours are BGR."""

    def __init__(self, camera: Camera, look: Look) -> None:
        """Paint the panorama: gradient, clouds, a far line of trees."""
        self.camera = camera
        self.rows = min(max(math.ceil(camera.horizon) + 1, 0), camera.height)
        self.round = round(camera.width * 2.0 * math.pi / camera.fov)
        self.zenith, self.haze = _colours(look)
        self.panorama = self._paint(look)

    def facing(self, heading: float) -> NDArray[np.uint8]:
        """Return the rows (rows, width, 3) above the horizon, seen in the direction `heading`, rad."""
        column = int((-heading / (2.0 * math.pi)) % 1.0 * self.round)
        return self.panorama[:, column : column + self.camera.width]

    def _paint(self, look: Look) -> NDArray[np.uint8]:
        rows = max(self.rows, 1)
        down = (np.linspace(0.0, 1.0, rows, dtype=np.float32) ** 1.5)[:, None]
        sky = self.zenith + (self.haze - self.zenith) * down[..., None]
        high = max(8, int(2048 * rows / self.round))
        clouds = cv2.resize(cloud_tile()[40 : 40 + high], (self.round, rows))
        cover = np.clip(clouds * 0.35 + (look.cloud - 0.45) * 1.3, 0, 1) * (0.75 * (1 - 0.4 * down))
        bright = np.array([235, 235, 238], np.float32) * look.luminance * (1 - 0.3 * look.cloud) * look.tint
        sky = sky + (bright - sky) * cover[..., None]
        self._plant_trees(sky, look)
        image = np.clip(sky, 0, 255).astype(np.uint8)
        return np.hstack([image, image[:, : self.camera.width + 1]])

    def _plant_trees(self, sky: NDArray[np.float32], look: Look) -> None:
        column = np.arange(0, self.round + 8, 8)
        turn = column / self.round * 2 * math.pi
        crown = 1.1 + 0.25 * np.sin(9 * turn) + 0.2 * np.sin(23 * turn + 1) + 0.1 * np.sin(61 * turn)
        top = np.stack([column, self.rows - 0.011 * self.camera.focal * crown], axis=1)
        line = np.concatenate([top, [[self.round, self.rows + 1], [0, self.rows + 1]]]).astype(np.int32)
        leaves = np.array([70, 88, 72], np.float32) * look.luminance * look.tint
        cv2.fillPoly(sky, [line], [float(c) for c in 0.55 * leaves + 0.45 * self.haze])


def _colours(look: Look) -> tuple[Colour, Colour]:
    """Return the colours of the zenith and of the haze at the horizon."""
    clear, grey = np.array([205, 150, 95], np.float32), np.array([165, 160, 155], np.float32)
    zenith = (clear + (grey - clear) * look.cloud) * look.luminance * look.tint
    pale, overcast = np.array([235, 220, 205], np.float32), np.array([190, 188, 185], np.float32)
    glow, dust = np.array([120, 175, 250], np.float32), np.array([90, 140, 180], np.float32)
    haze = pale + (overcast - pale) * look.cloud
    haze = haze + (glow - haze) * look.warmth
    haze = (haze + (dust - haze) * look.dust) * max(look.luminance, 0.04)
    return zenith.astype(np.float32), haze.astype(np.float32)
