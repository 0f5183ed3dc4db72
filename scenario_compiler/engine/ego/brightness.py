"""The brightness of the camera's picture in the present weather, as the renderer draws it (`perception.lighting`).

Grey levels are those of an 8-bit image, 0 to 255. The constants of the picture as a whole were measured in rendered
pictures of four maps in eight weathers.
"""

from __future__ import annotations

from math import exp, log

from scenario_compiler.engine.columns.numbers import clip
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.visibility import (
    W_CLOUDINESS,
    W_DEPOSITS,
    W_DUST_STORM,
    W_FOG_DENSITY,
    W_FOG_DISTANCE,
    W_FOG_FALLOFF,
    W_PRECIPITATION,
    W_SUN_ALTITUDE,
    W_WETNESS,
    haze_extinction,
    weather_contrast,
)
from scenario_compiler.marker import compiled

USUAL_ALTITUDE = 45.0
USUAL_CLOUDS = 0.05
"""A clear noon, for a weather that does not say."""

ASPHALT = 80.0
DARKER_WHEN_WET = 0.45
"""Brightness of dry asphalt in the sun, grey levels, and the share that water takes."""

LAMPS_ON = 8.0
LAMP_LIGHT = 0.8
"""Altitude of the sun below which headlights are on, degrees, and their light in the dark, 1 being a clear noon."""

LAMPS_ON_GROUND = 0.45
"""Share of the headlights' light that falls on the ground in the picture, as a mean."""

SKY = 190.0
DARKER_BY_DUST = 0.3
"""Brightness of the sky at a clear noon, grey levels, and the share that dust takes."""

SPRAY = 0.0005
SPRAY_IN_RAIN = 0.01
"""Extinction of clear air and of heavy rain, 1/m."""

THROUGH = 15.0
"""Distance at which most of the ground in the picture lies, m: that much haze is before it."""

BRIGHTEST = 223.0
BRIGHTEST_CLOUDS = 193.0
BRIGHTEST_BY_LAMPS = 127.0
"""Brightest tones (99th percentile) at a light of 1 below a clear and a cloudy sky, and by headlights, grey levels."""


@compiled
def share_or(percent: float, usual: float) -> float:
    """Return a share for a number in percent; the usual one if it is negative, which means that it is not given."""
    return usual if percent < 0.0 else min(0.01 * percent, 1.0)


@compiled
def sun_altitude(st: State) -> float:
    """Return the altitude of the sun, degrees."""
    return USUAL_ALTITUDE if st.weather[W_SUN_ALTITUDE] == -1.0 else st.weather[W_SUN_ALTITUDE]


@compiled
def water_on_road(st: State) -> float:
    """Return how wet the road is, 0 to 1."""
    rain = share_or(st.weather[W_PRECIPITATION], 0.0)
    return max(rain, max(share_or(st.weather[W_DEPOSITS], 0.0), share_or(st.weather[W_WETNESS], 0.0)))


@compiled
def warmth_of_light(st: State) -> float:
    """Return how red the light of a low sun is, 0 to 1."""
    cloud = share_or(st.weather[W_CLOUDINESS], USUAL_CLOUDS)
    return clip(1.0 - abs(sun_altitude(st) - 5.0) / 16.0, 0.0, 1.0) * (1.0 - 0.55 * cloud)


@compiled
def daylight(st: State) -> float:
    """Return the light of sun and sky, 1 at a clear noon."""
    rain = share_or(st.weather[W_PRECIPITATION], 0.0)
    dust = share_or(st.weather[W_DUST_STORM], 0.0)
    cloud = share_or(st.weather[W_CLOUDINESS], USUAL_CLOUDS)
    day = clip((sun_altitude(st) + 4.0) / 30.0, 0.0, 1.0)
    dimmed = (1.0 - 0.35 * cloud * (1.0 - 0.3 * warmth_of_light(st))) * (1.0 - 0.2 * rain) * (1.0 - 0.3 * dust)
    if day > 0.0:
        return (0.05 + 0.95 * exp(clip(0.6 * log(max(day, 1.0e-9)), -50.0, 0.0))) * dimmed
    return 0.05 * dimmed


@compiled
def headlights(st: State, light: float) -> float:
    """Return the light of the headlights where it is brightest, by the light of sun and sky."""
    return LAMP_LIGHT * clip((LAMPS_ON - sun_altitude(st)) / 12.0, 0.0, 1.0) * (1.0 - light)


@compiled
def asphalt(wet: float) -> float:
    """Return the brightness of asphalt at a light of 1, grey levels, by how wet it is."""
    return ASPHALT * (1.0 - DARKER_WHEN_WET * wet)


@compiled
def note_brightness(st: State) -> None:
    """Write the brightness of sky and ground and the brightest tones of a picture in the present weather."""
    light = daylight(st)
    lamps = headlights(st, light)
    rain = share_or(st.weather[W_PRECIPITATION], 0.0)
    dust = share_or(st.weather[W_DUST_STORM], 0.0)
    cloud = share_or(st.weather[W_CLOUDINESS], USUAL_CLOUDS)
    clear = BRIGHTEST + (BRIGHTEST_CLOUDS - BRIGHTEST) * cloud
    fog = haze_extinction(share_or(st.weather[W_FOG_DENSITY], 0.0), st.weather[W_FOG_FALLOFF], dust)
    fogged = max(THROUGH - max(st.weather[W_FOG_DISTANCE], 0.0), 0.0)
    through = exp(clip(-(SPRAY + SPRAY_IN_RAIN * rain) * THROUGH - fog * fogged, -50.0, 0.0))
    sky = SKY * light * (1.0 - DARKER_BY_DUST * dust)
    ground = asphalt(water_on_road(st)) * (light + LAMPS_ON_GROUND * lamps)
    st.sky_level[0] = sky
    st.ground_level[0] = sky + through * (ground - sky)
    st.brightest[0] = max(clear * light, BRIGHTEST_BY_LAMPS * lamps * weather_contrast(st))
    st.lamps_on[0] = 1 if lamps > 0.0 else 0
    st.tinted[0] = 1 if warmth_of_light(st) > 0.0 or dust > 0.0 else 0
