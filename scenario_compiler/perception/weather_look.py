"""The look of the weather: light, wetness, fog and the visibility of paint from CARLA's 14 numbers.

The image is a model, tuned to have the right order (rain hides paint more than a wet road does, a low sun over a wet
road more than a high one), not a photometric simulation. The one curve that decides takeovers is
`engine.visibility.paint_contrast`, for drawn pictures and for ideal perception. CARLA's presets give:

    ClearNoon 1.00    WetNoon 0.88    SoftRainNoon 0.76    MidRainyNoon 0.64   HardRainNoon 0.44
    ClearSunset 1.00  WetSunset 0.88  SoftRainSunset 0.71  MidRainSunset 0.48  HardRainSunset 0.06
    ClearNight 1.00   WetNight 0.85   SoftRainNight 0.74   MidRainyNight 0.60  HardRainNight 0.44
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.engine.ego.visibility import haze_extinction, paint_contrast


class WeatherNumbers(Protocol):
    """CARLA's `WeatherParameters` by name, in its percent, degrees and metres; -1 is unset (a clear noon)."""

    @property
    def cloudiness(self) -> float: ...  # noqa: D102
    @property
    def precipitation(self) -> float: ...  # noqa: D102
    @property
    def precipitation_deposits(self) -> float: ...  # noqa: D102
    @property
    def wind_intensity(self) -> float: ...  # noqa: D102
    @property
    def sun_azimuth_angle(self) -> float: ...  # noqa: D102
    @property
    def sun_altitude_angle(self) -> float: ...  # noqa: D102
    @property
    def fog_density(self) -> float: ...  # noqa: D102
    @property
    def fog_distance(self) -> float: ...  # noqa: D102
    @property
    def fog_falloff(self) -> float: ...  # noqa: D102
    @property
    def wetness(self) -> float: ...  # noqa: D102
    @property
    def dust_storm(self) -> float: ...  # noqa: D102


@dataclass(frozen=True)
class Look:
    """The properties of the weather that the renderer needs.

    Attributes:
        sun_altitude: Degrees above the horizon.
        sun_heading: Heading of the sun in the world, rad.
        cloud: Cover of the sky, 0-1.
        rain: Precipitation, 0-1.
        wind: Wind, 0-1; it slants the rain.
        wet: Water on the road, 0-1.
        fog: Extinction of fog and dust, 1/m, beyond `fog_start`.
        fog_start: Distance at which fog begins, m.
        spray: Extinction of falling rain and spray, 1/m.
        dust: Brown share of the haze, 0-1.
        contrast: Share of a mark's contrast that remains, see `paint_contrast`.
        luminance: Brightness of sunlit ground, 1 at a clear noon.
        warmth: How near the sun is to the horizon, 0-1.
    """

    sun_altitude: float
    sun_heading: float
    cloud: float
    rain: float
    wind: float
    wet: float
    fog: float
    fog_start: float
    spray: float
    dust: float
    contrast: float
    luminance: float
    warmth: float

    @property
    def tint(self) -> NDArray[np.float32]:
        """Colour of the light as (blue, green, red) gains."""
        return np.array([1 - 0.30 * self.warmth, 1 - 0.10 * self.warmth, 1 + 0.05 * self.warmth], np.float32)


def look_of(weather: WeatherNumbers) -> Look:
    """Return the look of `weather`. Every value is limited to its range; none is refused."""
    cloud = _share(weather.cloudiness, 0.05)
    rain = _share(weather.precipitation, 0.0)
    wet = max(rain, _share(weather.precipitation_deposits, 0.0), _share(weather.wetness, 0.0))
    dust = _share(weather.dust_storm, 0.0)
    altitude = 45.0 if weather.sun_altitude_angle == -1.0 else float(weather.sun_altitude_angle)
    azimuth = 0.0 if weather.sun_azimuth_angle == -1.0 else float(weather.sun_azimuth_angle)
    warmth = min(max(1.0 - abs(altitude - 5.0) / 16.0, 0.0), 1.0) * (1.0 - 0.55 * cloud)
    day = min(max((altitude + 4.0) / 30.0, 0.0), 1.0)
    dimmed = (1.0 - 0.35 * cloud * (1.0 - 0.3 * warmth)) * (1.0 - 0.2 * rain) * (1.0 - 0.3 * dust)
    return Look(
        sun_altitude=altitude,
        sun_heading=-math.radians(azimuth),
        cloud=cloud,
        rain=rain,
        wind=_share(weather.wind_intensity, 0.1),
        wet=wet,
        fog=haze_extinction(_share(weather.fog_density, 0.0), float(weather.fog_falloff), dust),
        fog_start=max(float(weather.fog_distance), 0.0),
        spray=0.0005 + 0.010 * rain,
        dust=dust,
        contrast=paint_contrast(wet, rain, altitude),
        luminance=(0.05 + 0.95 * day**0.6) * dimmed,
        warmth=warmth,
    )


def _share(percent: float, unset: float) -> float:
    return unset if percent < 0.0 else min(float(percent) / 100.0, 1.0)
