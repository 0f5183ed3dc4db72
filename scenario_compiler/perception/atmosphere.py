"""What lies between the lens and the scene: reflections of a wet road, the sun's glow, fog, falling rain."""

from __future__ import annotations

import math
from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.scene import SUBPIXEL, Polygon
from scenario_compiler.perception.textures import rain_tile
from scenario_compiler.perception.weather_look import Look

Image = NDArray[np.uint8]
Weights = NDArray[np.float32]

INFINITY = 600.0
"""Distance at which the sky is hazed, m."""


class Atmosphere:
    """One weather for one camera."""

    def __init__(
        self, camera: Camera, look: Look, ground_distance: NDArray[np.float32], haze: NDArray[np.float32]
    ) -> None:
        """Prepare the weights that stay the same from frame to frame.

        Args:
            camera: The camera.
            look: The weather.
            ground_distance: (rows,) distance of the ground in the lowest rows of the image, m.
            haze: (3,) colour of the haze at the horizon.
        """
        self.camera, self.look = camera, look
        distance = np.full((camera.height, 1), INFINITY, np.float32)
        distance[camera.height - len(ground_distance) :, 0] = ground_distance
        self.clear = np.repeat(self._transmission(distance), camera.width, axis=1)
        fog = np.clip(0.8 * haze + 20.0 * look.luminance, 0, 255)
        self.fog = np.full((camera.height, camera.width, 3), fog, np.float32).astype(np.uint8)
        self.hazy = bool(self.clear.min() < 0.75)
        depression = np.degrees(np.arctan2(camera.z, np.maximum(ground_distance, 0.1)))
        self.mirror = ((0.04 + 0.75 * np.exp(-depression / 2.6)) * look.wet).astype(np.float32)[:, None]

    def reflect(self, image: Image, codes: Image, hard: Image, patch: Image) -> None:
        """Mirror what stands above the horizon in the wet ground (Fresnel's reflectance, rough), in place."""
        horizon = self.camera.height - len(self.mirror)
        rows = min(len(self.mirror), horizon)
        if self.look.wet <= 0.05 or rows == 0:
            return
        above = image[horizon - rows : horizon][::-1]
        mirrored = cv2.blur(above, (3, int(31 * self.camera.height / 512) | 1))
        first = len(codes) - len(self.mirror)
        part = slice(first, first + rows)
        puddles = cv2.convertScaleAbs(patch[part], alpha=2, beta=-230).astype(np.float32) * (0.4 / 255.0) + 0.8
        weight = np.full_like(puddles, 0.25)
        cv2.copyTo(puddles, cv2.LUT(codes[part], hard), weight)
        weight = np.minimum(weight * self.mirror[:rows], np.float32(0.9))
        below = image[horizon : horizon + rows]
        below[:] = cv2.blendLinear(below, mirrored, 1.0 - weight, weight)

    def glow(self, image: Image, heading: float) -> Image:
        """Add the low sun and its streak on the road when the camera faces it."""
        camera, look = self.camera, self.look
        turn = (look.sun_heading - heading + math.pi) % (2.0 * math.pi) - math.pi
        if not (-2.0 < look.sun_altitude < 25.0 and abs(turn) < 0.9):
            return image
        u = camera.width / 2.0 - camera.focal * math.tan(turn)
        v = camera.horizon - camera.focal * math.tan(math.radians(look.sun_altitude))
        y, x = np.mgrid[0 : camera.height // 8, 0 : camera.width // 8].astype(np.float32) * 8
        scale = camera.width / 1024.0
        radius = np.hypot(x - u, y - v) / scale
        light = (190 * np.exp(-radius / 60) + 75 * np.exp(-radius / 260)) * (1 - 0.75 * look.cloud)
        spread = camera.width * (0.035 + 0.05 * look.wet)
        streak = np.exp(-(((x - u) / spread) ** 2)) * np.exp(-(y - camera.horizon) / (camera.height * 0.55))
        light += streak * (y > camera.horizon) * ((look.wet * 150 + 22) * (1 - 0.6 * look.cloud))
        tinted = np.clip(light[..., None] * np.array([0.62, 0.82, 1.0], np.float32), 0, 255).astype(np.uint8)
        return np.asarray(cv2.add(image, cv2.resize(tinted, (camera.width, camera.height))), np.uint8)

    def veil(self, image: Image, silhouettes: Sequence[tuple[Polygon, float]]) -> Image:
        """Blend the image into the haze with distance (Koschmieder's law); boxes stand before the ground."""
        if not self.hazy:
            return image
        clear = self.clear
        if silhouettes:
            clear = clear.copy()
            for outline, distance in silhouettes:
                weight = float(self._transmission(np.array([distance], np.float32))[0])
                cv2.fillConvexPoly(clear, outline, weight, cv2.LINE_8, SUBPIXEL)
        return np.asarray(cv2.blendLinear(image, self.fog, clear, 1.0 - clear), np.uint8)

    def rain(self, image: Image, draw: np.random.Generator) -> Image:
        """Add streaks of rain, cut at a random place of a large field of them."""
        look, camera = self.look, self.camera
        if look.rain <= 0.0:
            return image
        tile = rain_tile(camera.width, camera.height, 0.1 + 0.25 * look.wind)
        row, column = int(draw.integers(camera.height)), int(draw.integers(camera.width))
        streaks = tile[row : row + camera.height, column : column + camera.width]
        grey = cv2.convertScaleAbs(streaks, alpha=0.45 * look.rain * max(look.luminance, 0.15))
        return np.asarray(cv2.add(image, cv2.merge((grey, grey, grey))), np.uint8)

    def _transmission(self, distance: NDArray[np.float32]) -> Weights:
        look = self.look
        fogged = np.maximum(distance - look.fog_start, 0.0)
        share: Weights = np.exp(-look.spray * distance - look.fog * fogged).astype(np.float32)
        return share
