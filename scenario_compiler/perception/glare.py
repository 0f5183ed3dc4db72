"""The glare of a low sun: a disc that saturates, the light that it scatters in the lens, and its streak on the road."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.buffers import Buffers
from scenario_compiler.perception.lens import Lens
from scenario_compiler.perception.weather_look import Look

Image = NDArray[np.uint8]
Table = NDArray[np.float32]

STEP = 8
"""Glare is computed for every eighth pixel."""

LOWEST, HIGHEST = -2.0, 25.0
"""Range of the sun's altitudes at which it dazzles, degrees."""

WIDEST = 60.0
"""Angle between the sun and the centre of the image up to which it dazzles, degrees."""

WARM = np.array([0.62, 0.82, 1.0, 0.0], np.float32)
"""Colour of the low sun (blue, green, red, -)."""


class Glare:
    """The glare in the images of one camera."""

    def __init__(self, lens: Lens, buffers: Buffers) -> None:
        """Prepare the directions of pixels."""
        self.camera, self._buffers = lens.camera, buffers
        ahead, left, up = (np.ascontiguousarray(one[::STEP, ::STEP]) for one in lens.directions())
        self._azimuth = np.degrees(np.arctan2(left, ahead))
        self._elevation = np.degrees(np.arctan2(up, np.hypot(ahead, left)))
        self._axis = self.camera.rotation[2]

    def add(self, image: Image, heading: float, look: Look) -> None:
        """Add the glare to an image (height, width, 4) in place.

        Args:
            image: The image.
            heading: Heading of the vehicle, rad.
            look: The weather.
        """
        if not LOWEST < look.sun_altitude < HIGHEST:
            return
        turn, altitude = look.sun_heading - heading, math.radians(look.sun_altitude)
        sun = math.cos(altitude) * math.cos(turn), math.cos(altitude) * math.sin(turn), math.sin(altitude)
        if math.degrees(math.acos(min(max(float(self._axis @ sun), -1.0), 1.0))) > WIDEST:
            return
        beside = (self._azimuth - math.degrees(turn) + 180.0) % 360.0 - 180.0
        above = self._elevation - look.sun_altitude
        away = np.hypot(beside * np.cos(np.radians(self._elevation)), above).astype(np.float32)
        light = (170.0 * np.exp(-away / 1.2) + 190.0 * np.exp(-away / 2.8) + 75.0 * np.exp(-away / 12.0)) * (
            1.0 - 0.75 * look.cloud
        )
        spread = 1.7 + 2.4 * look.wet
        streak = np.exp(-np.square(beside / spread) + np.minimum(self._elevation, 0.0) / 12.8)
        light += streak * (self._elevation < 0.0) * ((look.wet * 150.0 + 22.0) * (1.0 - 0.6 * look.cloud))
        tinted = np.clip(light[..., None] * WARM, 0, 255).astype(np.uint8)
        four = self._buffers.get("four", image.shape, np.uint8)
        cv2.add(image, cv2.resize(tinted, (self.camera.width, self.camera.height), four), image)
