"""A first-person image of the road, drawn on the CPU with OpenCV alone, in eight-bit steps and a fixed order.

Equal arguments give equal bytes on one platform and version of OpenCV, with any number of threads; between
versions single grey levels differ. A frame of 512 x 256 pixels takes 4 to 12 ms of one core, in a town as on a lone
road, and 4 ms more with sensor noise.
"""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.atmosphere import Atmosphere
from scenario_compiler.perception.camera import Camera, View
from scenario_compiler.perception.degradation import RAIN, generator
from scenario_compiler.perception.ground import SKY, Ground
from scenario_compiler.perception.scene import RoadScene
from scenario_compiler.perception.sky import Sky
from scenario_compiler.perception.solids import Box, draw_boxes, draw_shadows, far_to_near
from scenario_compiler.perception.weather_look import Look

Image = NDArray[np.uint8]


class Renderer:
    """Draws one scene for one camera. It keeps only what can be recomputed: nothing of a frame reaches the next."""

    def __init__(self, scene: RoadScene, camera: Camera) -> None:
        """Prepare what depends on neither pose nor weather."""
        self.camera = camera
        self.ground = Ground(scene, camera)
        self._weather: tuple[Look, Sky, Atmosphere] | None = None
        x, y = self.ground.x, self.ground.y
        reach = np.exp(-((y / (2.2 + 0.16 * x)) ** 2)) * np.exp(-((x / 34.0) ** 2))
        self._beam = (reach * np.clip((x - 1.5) / 5.0, 0, 1)).astype(np.float32)

    def render(self, view: View, boxes: Sequence[Box], look: Look, seed: int, frame_index: int) -> Image:
        """Return the image (height, width, 3), BGR.

        Args:
            view: The camera in the world; its camera must be this renderer's.
            boxes: Everybody else, in any order.
            look: The weather.
            seed: Seed of the run; with `frame_index` it places the streaks of rain.
            frame_index: Number of the frame.
        """
        sky, atmosphere = self._weather_of(look)
        boxes = far_to_near(view, boxes)
        top = self.ground.top
        ground, codes, patch = self.ground.draw(view, look)
        draw_shadows(ground, top, view, boxes, look)
        image = np.empty((self.camera.height, self.camera.width, 3), np.uint8)
        image[: sky.rows] = sky.facing(view.pose.heading)[: sky.rows]
        self._light(ground, look)
        if self.ground.sky_rows:
            cv2.copyTo(ground, np.where(codes == SKY, np.uint8(0), np.uint8(255)), image[top:])
        else:
            image[top:] = ground
        image = atmosphere.glow(image, view.pose.heading)
        silhouettes = draw_boxes(image, view, boxes, look)
        atmosphere.reflect(image, codes, self.ground.hard, patch)
        image = atmosphere.veil(image, silhouettes)
        return atmosphere.rain(image, generator(seed, frame_index, RAIN))

    def _light(self, ground: Image, look: Look) -> None:
        """Light the ground in place: by the sun, and by the vehicle's own headlights when the sun is low."""
        if look.sun_altitude < 8.0:
            share = 0.8 * min(max((8.0 - look.sun_altitude) / 12.0, 0.0), 1.0) * (1.0 - look.luminance)
            gain = look.luminance + self._beam * np.float32(share)
            blue, green, red = (float(t) for t in look.tint)
            lit = cv2.merge((gain * blue, gain * green, gain * red))
            cv2.multiply(ground, lit, ground, dtype=cv2.CV_8U)
            return
        table = np.clip(np.arange(256, dtype=np.float32)[:, None] * (look.luminance * look.tint), 0, 255)
        cv2.LUT(ground, table.astype(np.uint8).reshape(256, 1, 3), ground)

    def _weather_of(self, look: Look) -> tuple[Sky, Atmosphere]:
        if self._weather is None or self._weather[0] != look:
            sky = Sky(self.camera, look)
            distance = np.ascontiguousarray(self.ground.row_distance[self.ground.sky_rows :, 0])
            self._weather = (look, sky, Atmosphere(self.camera, look, distance, sky.haze))
        return self._weather[1], self._weather[2]
