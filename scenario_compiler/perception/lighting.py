"""Light and air of one weather: the brightness of things, and how much of them is visible at a distance.

Light comes from the sun and the sky, and in the dark from the vehicle's own headlights. Haze follows Koschmieder's law:
of a thing at a distance d the share exp(-extinction d) is visible, the rest is the colour of the air.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.weather_look import Look

Table = NDArray[np.float32]

LAMPS_ON = 8.0
"""Altitude of the sun below which headlights are on, degrees."""

INFINITY = 600.0
"""Distance that is used for the haze of the sky, m."""

LAMPS_BEHIND = 0.5
"""Start of the headlights' pattern, m ahead of the centre of the vehicle's box."""


def haze_colour(look: Look) -> Table:
    """Return the colour of the haze at the horizon (blue, green, red)."""
    pale, overcast = np.array([235, 220, 205], np.float32), np.array([190, 188, 185], np.float32)
    glow, dust = np.array([120, 175, 250], np.float32), np.array([90, 140, 180], np.float32)
    haze = pale + (overcast - pale) * np.float32(look.cloud)
    haze = haze + (glow - haze) * np.float32(look.warmth)
    return np.asarray((haze + (dust - haze) * np.float32(look.dust)) * np.float32(max(look.luminance, 0.04)))


def zenith_colour(look: Look) -> Table:
    """Return the colour of the sky overhead."""
    clear, grey = np.array([205, 150, 95], np.float32), np.array([165, 160, 155], np.float32)
    return np.asarray((clear + (grey - clear) * np.float32(look.cloud)) * np.float32(look.luminance) * look.tint)


class Air:
    """The effect of the air on visibility.

    Attributes:
        colour: (3,) colour of thick air (blue, green, red).
    """

    def __init__(self, look: Look) -> None:
        """Prepare for a weather."""
        self._look = look
        self.colour = np.clip(0.8 * haze_colour(look) + 20.0 * look.luminance, 0, 255).astype(np.float32)

    def seen(self, distance: Table, into: Table | None = None) -> Table:
        """Return the share of a thing that is visible at a distance, m; it is written into an array if one is given."""
        look = self._look
        share = np.multiply(-np.float32(look.spray), distance, out=into)
        if look.fog > 0.0:
            fogged = np.maximum(distance - np.float32(look.fog_start), np.float32(0.0))
            share -= np.multiply(np.float32(look.fog), fogged, out=fogged)
        return np.asarray(np.exp(share, out=share), np.float32)


class Light:
    """The brightness around a vehicle with a camera."""

    def __init__(self, camera: Camera, look: Look) -> None:
        """Prepare for a camera and a weather."""
        self.look = look
        self._ahead, self._left = camera.x - LAMPS_BEHIND, camera.y
        dark = min(max((LAMPS_ON - look.sun_altitude) / 12.0, 0.0), 1.0)
        self.lamps = 0.8 * dark * (1.0 - look.luminance)

    def at(self, x: Table, y: Table) -> Table:
        """Return the brightness, 1 at a clear noon, at points x ahead and y left of the camera's foot, m."""
        if self.lamps <= 0.0:
            return np.full(np.broadcast(x, y).shape, self.look.luminance, np.float32)
        return np.asarray(np.float32(self.look.luminance) + np.float32(self.lamps) * self._beam(x, y), np.float32)

    def _beam(self, x: Table, y: Table) -> Table:
        """Return the light of the low beams: a cone that widens with the distance and ends after some 60 m."""
        x, y = x + np.float32(self._ahead), y + np.float32(self._left)
        ahead = np.maximum(x, np.float32(0.0))
        beside = y / (np.float32(2.2) + np.float32(0.16) * ahead)
        far = ahead / np.float32(34.0)
        rise = np.clip((x - np.float32(1.5)) / np.float32(5.0), 0.0, 1.0)
        return np.asarray(np.exp(-(beside * beside) - far * far) * rise, np.float32)
