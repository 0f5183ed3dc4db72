"""Light and air between a camera and the ground ahead, as the renderer has them: how much a line stands out.

A line is found where it is brighter than both its sides by more than the ground is rough. Its contrast and the ground's
roughness, in grey levels, follow from what the renderer does (`perception.lighting`, `perception.ground`); the shares
that a mean over a row of the image leaves of the ground's textures are rounded values of rendered pictures.
"""

from __future__ import annotations

from math import cos, exp, log

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import view as at
from scenario_compiler.engine.columns.numbers import clip, safe_sqrt
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.brightness import (
    SPRAY,
    SPRAY_IN_RAIN,
    USUAL_CLOUDS,
    asphalt,
    daylight,
    headlights,
    share_or,
    sun_altitude,
    water_on_road,
)
from scenario_compiler.engine.ego.visibility import (
    W_CLOUDINESS,
    W_DUST_STORM,
    W_FOG_DENSITY,
    W_FOG_DISTANCE,
    W_FOG_FALLOFF,
    W_PRECIPITATION,
    W_SUN_AZIMUTH,
    haze_extinction,
    paint_contrast,
)
from scenario_compiler.marker import compiled

AHEAD_FROM = 5.1
AHEAD_STEP = 2.0
"""Distance of the middle of the first piece of paint from the camera, and of each from the next, m."""

GRAIN = 0.0576
MEADOW = 7.2
"""Roughness of asphalt as a share of its brightness, and of a meadow in grey levels, near by in the sun."""

FOOTPRINT = 803.0
GRAIN_SEEN = 0.12
"""Square of the distance, m2, at which a pixel covers 1 m of the ground, and the length of which grain is not seen."""

STREAKS = 6.0
"""Roughness that heavy rain adds at noon, grey levels."""

LAMP_TO_CAMERA = 1.4
LAMP_REACH = 34.0
LAMP_SPREAD = 2.2
LAMP_WIDENING = 0.16
BESIDE = 1.75
"""The headlights' pattern (`perception.lighting`), at a line that lies so far beside, m."""

DAZZLES_FROM = -2.0
DAZZLES_TO = 25.0
DAZZLES_WITHIN = 0.35
"""Altitudes of the sun between which it dazzles, degrees, and how far beside the way it does, rad."""

LEAST_LIGHT = 0.02

ONE_DEGREE = 0.017453292519943295


@compiled
def note_air(st: State) -> None:
    """Work out light and air along the way for the present weather, where that has changed."""
    same = 1
    for k in range(op.WEATHER_SIZE):
        if st.air_weather[k] != st.weather[k]:
            st.air_weather[k] = st.weather[k]
            same = 0
    if same == 1:
        return
    st.beside_row[0] = op.NONE
    st.summed[0] = 0
    rain = share_or(st.weather[W_PRECIPITATION], 0.0)
    wet = water_on_road(st)
    dust = share_or(st.weather[W_DUST_STORM], 0.0)
    cloud = share_or(st.weather[W_CLOUDINESS], USUAL_CLOUDS)
    altitude = sun_altitude(st)
    azimuth = 0.0 if st.weather[W_SUN_AZIMUTH] == -1.0 else st.weather[W_SUN_AZIMUTH]
    light = daylight(st)
    lamps = headlights(st, light)
    fog = haze_extinction(share_or(st.weather[W_FOG_DENSITY], 0.0), st.weather[W_FOG_FALLOFF], dust)
    fog_from = max(st.weather[W_FOG_DISTANCE], 0.0)
    st.air_ground[0] = asphalt(wet)
    st.air_contrast[0] = paint_contrast(wet, rain, altitude)
    st.air_streaks[0] = STREAKS * rain * light
    st.air_glare[0] = 1.0 - 0.75 * cloud if altitude > DAZZLES_FROM and altitude < DAZZLES_TO else 0.0
    st.air_sun[0] = -ONE_DEGREE * azimuth
    for k in range(at.SAMPLES):
        x = AHEAD_FROM + AHEAD_STEP * k
        lit = light + lamps * lamp_pattern(x + LAMP_TO_CAMERA)
        through = exp(clip(-(SPRAY + SPRAY_IN_RAIN * rain) * x - fog * max(x - fog_from, 0.0), -50.0, 0.0))
        foot = x * x / FOOTPRINT
        st.air_lit[k] = lit * through
        st.air_hard[k] = lit * through * GRAIN * clip(1.1 - foot / GRAIN_SEEN, 0.0, 1.0) * st.air_ground[0]
        st.air_soft[k] = lit * through * MEADOW * exp(clip(-foot, -50.0, 0.0))
        if k == 2:
            note_lasting(st, at.V_LIGHT, log(max(lit, LEAST_LIGHT)))
        if k == 5:
            note_lasting(st, at.V_AIR, log(max(through, 1.0e-9)))
    note_lasting(st, at.V_RAIN, rain)
    note_lasting(st, at.V_WATER, wet)
    note_lasting(st, at.V_CLOUD, cloud)
    note_lasting(st, at.V_DARKNESS, clip(-0.1 * altitude, -1.0, 1.0))
    note_lasting(st, at.V_CONTRAST, log(max(st.air_contrast[0], LEAST_LIGHT)))


@compiled
def note_lasting(st: State, feature: int, value: float) -> None:
    """Note a feature that stays as it is for many views."""
    if st.view[feature] != value:
        st.view[feature] = value
        st.lasting_anew[0] = 1


@compiled
def lamp_pattern(ahead: float) -> float:
    """Return the light of the low beams on a line beside the lane, so far ahead of the headlights, m."""
    beside = BESIDE / (LAMP_SPREAD + LAMP_WIDENING * ahead)
    far = ahead / LAMP_REACH
    return exp(clip(-beside * beside - far * far, -50.0, 0.0)) * clip((ahead - 1.5) / 5.0, 0.0, 1.0)


@compiled
def note_glare(st: State, heading: float) -> None:
    """Note how much the sun dazzles in a direction of travel."""
    glare = 0.0
    if st.air_glare[0] > 0.0:
        beside = safe_sqrt(2.0 - 2.0 * cos(st.air_sun[0] - heading)) / DAZZLES_WITHIN
        glare = st.air_glare[0] * exp(clip(-beside * beside, -50.0, 0.0))
    note_lasting(st, at.V_GLARE, glare)
