"""The visibility of paint in the weather: one curve for drawn pictures and for ideal perception.

What the weather leaves of a mark's contrast with the asphalt, in the picture and here:

    contrast = (1 - 0.25 wet) (1 - 0.42 rain) (1 - 0.86 wet rain^1.5 glare)

    wet    water on the road, 0-1: the largest of wetness, precipitation deposits and precipitation, / 100
    rain   precipitation / 100
    glare  sun between -2 and 35 degrees of altitude: 1 up to 15, falling linearly to 0 at 35

The first factor is the water film that fills the paint's texture, the second the spray in the air before and on the
road, the third the sky's reflection in a wet road against a low sun, which makes the asphalt as bright as the paint.

With `--perception ideal` the confidence in a line is its quality times `weather_visibility`, the curve that the
camera's confidence in new paint follows over this contrast and over what fog and dust leave of it at 9 m. Measured
with the lane detector on 60 rendered roads a weather (both sides, single frames, new paint):

    weather                     contrast   camera   this curve
    ClearNoon                       1.00     0.98         1.00
    MidRainyNoon                    0.64     0.96         0.98
    MidRainSunset                   0.48     0.92         0.95
    HardRainNoon                    0.44     0.91         0.94
    sunset, rain and water 80 %     0.27     0.79         0.80
    sunset, rain and water 90 %     0.16     0.50         0.53
    HardRainSunset                  0.06     0.05         0.09
    fog 100 % from 0 m on           0.53     0.96         0.96
    fog 100 %, rain at noon 100 %   0.23     0.74         0.73
"""

from __future__ import annotations

from math import exp, log

from scenario_compiler.engine.columns.numbers import clip, safe_sqrt
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.camera_health import falling
from scenario_compiler.marker import compiled

W_CLOUDINESS = 0
W_PRECIPITATION = 1
W_DEPOSITS = 2
W_SUN_AZIMUTH = 4
W_SUN_ALTITUDE = 5
W_FOG_DENSITY = 6
W_FOG_DISTANCE = 7
W_FOG_FALLOFF = 8
W_WETNESS = 9
W_DUST_STORM = 13
"""Positions of numbers in a weather."""

FOG_AT_ONE = 0.07
DUST_AT_ONE = 0.03
"""Extinction of the thickest fog and dust, 1/m: 5 % of a contrast are left at 43 m and at 100 m."""

FOG_THINNED = 0.083
"""How much thinner fog is between the ground and a camera 2.4 m above it, per unit of its falloff with height. At a
falloff of 1 the fog reaches over houses, at 5 it still covers the road.
"""

LOOK_THROUGH = 9.0
"""Distance at which the effect of fog is evaluated, m: the marks are sampled from 5 m on, and in fog the nearest count
most.
"""

FADED_MIDDLE = 1.87
FADED_WIDTH = 0.40
"""The confidence is one half if the logarithm of the contrast is -1.87, a contrast of 0.15."""

LEAST_CONTRAST = 1.0e-3


@compiled
def paint_contrast(wet: float, rain: float, sun_altitude: float) -> float:
    """Return the share of a mark's contrast with the asphalt that remains, 0 to 1: the curve above.

    Args:
        wet: Water on the road, 0-1.
        rain: Precipitation, 0-1.
        sun_altitude: Altitude of the sun, degrees.
    """
    glare = clip((35.0 - sun_altitude) / 20.0, 0.0, 1.0) if sun_altitude > -2.0 else 0.0
    return (1.0 - 0.25 * wet) * (1.0 - 0.42 * rain) * (1.0 - 0.86 * wet * rain * safe_sqrt(rain) * glare)


@compiled
def haze_extinction(fog: float, falloff: float, dust: float) -> float:
    """Return the extinction of fog and dust, 1/m, from their shares, 0-1, and the fog's falloff with height."""
    near_ground = fog * exp(clip(-FOG_THINNED * falloff, -6.5, 0.0))
    return FOG_AT_ONE * near_ground * safe_sqrt(near_ground) + DUST_AT_ONE * dust


@compiled
def weather_contrast(st: State) -> float:
    """Return the share of new paint's contrast that the present weather leaves at `LOOK_THROUGH`, 0-1."""
    rain = clip(0.01 * st.weather[W_PRECIPITATION], 0.0, 1.0)
    water = max(st.weather[W_DEPOSITS], st.weather[W_WETNESS])
    wet = max(rain, clip(0.01 * water, 0.0, 1.0))
    fog = clip(0.01 * st.weather[W_FOG_DENSITY], 0.0, 1.0)
    dust = clip(0.01 * st.weather[W_DUST_STORM], 0.0, 1.0)
    through = max(LOOK_THROUGH - max(st.weather[W_FOG_DISTANCE], 0.0), 0.0)
    left = exp(clip(-through * haze_extinction(fog, st.weather[W_FOG_FALLOFF], dust), -50.0, 0.0))
    return paint_contrast(wet, rain, st.weather[W_SUN_ALTITUDE]) * left


@compiled
def weather_visibility(st: State) -> float:
    """Return the share of the confidence in a line that the present weather leaves, 1 at a clear noon."""
    usual = falling(0.0, FADED_MIDDLE, FADED_WIDTH)
    return clip(
        falling(-log(max(weather_contrast(st), LEAST_CONTRAST)), FADED_MIDDLE, FADED_WIDTH) / max(usual, 0.5), 0.0, 1.0
    )
