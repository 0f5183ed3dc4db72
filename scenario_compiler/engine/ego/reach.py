"""How far a sensor sees in the weather: one equation for camera, radar and lidar.

A sensor with the range R in clear air sees as far as d, where

    d exp(a d + b max(d - f, 0)) = q R

    a    extinction by rain and dust, 1/m, which depends on the kind of sensor (below)
    b    extinction by fog, 1/m, which begins f ahead of the sensor (`fog_distance` of the weather)
    q    what the sensor's own noise and faults leave: for a camera its health (`camera_health`), for radar and lidar
         10^(-noise / 40), for noise in dB above that for which R holds

Camera: the contrast of an object with its surroundings falls with exp(-e d) at an extinction e of the air (Koschmieder
1924), and the signal-to-noise ratio of its picture with 1 / d (Rose 1948): a = e, and b = e of the fog. Lidar: the echo
of an object that fills the beam falls with exp(-2 e d) / d^2 (the lidar equation; Rasshofer, Spies and Spies 2011),
which gives the same a and b. Radar: the echo of a point falls with exp(-2 g d) / d^4 (the radar equation): a = g / 2.

Extinctions, with R the rain in mm/h, which is half of `precipitation` in percent:

    fog and dust   light: as in `visibility`; 5 % of a contrast are left at the meteorological optical range ln 20 / e
    rain           light: 1.076 R^0.67 dB/km (Carbonneau and Wisely 1998); drops are far larger than the wavelength of
                   light, so that camera and lidar lose alike
    rain           77 GHz: 1.13 R^0.717 dB/km (Recommendation ITU-R P.838-3, horizontal polarization)
    fog            77 GHz: 3.15 dB/km for each g/m3 of water (Recommendation ITU-R P.840, at 10 degrees Celsius), with
                   0.5 g/m3 at 50 m of visibility and 0.05 g/m3 at 300 m (the same), a power law between
    dust           77 GHz: none

Night: a camera sees dark objects only as far as the vehicle's own headlights light them (5 lux at `headlights`), if
that is less than R. This light travels there and back, so that the equation holds. During civil twilight (the sun from
0 to 6 degrees below the horizon) the range changes linearly. Radar and lidar emit their own signal.

Not modelled: the echo of fog, drops and spray themselves, drops on the lens, glare, and the lights of other vehicles.
"""

from __future__ import annotations

from math import exp, log

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.numbers import clip
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.camera_health import (
    WHITE,
    blur_health,
    dirt_health,
    measured_blur,
    noise_health,
    tones_health,
)
from scenario_compiler.engine.ego.failures import health_of_camera
from scenario_compiler.engine.ego.sensor import look_ahead
from scenario_compiler.engine.ego.visibility import (
    W_DUST_STORM,
    W_FOG_DENSITY,
    W_FOG_DISTANCE,
    W_FOG_FALLOFF,
    W_PRECIPITATION,
    W_SUN_ALTITUDE,
    haze_extinction,
)
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables

MM_PER_PERCENT = 0.5
"""Rain per percent of `precipitation`, mm/h; 50 mm/h is a cloudburst in the terms of the German weather service."""

LN_10 = 2.302585092994046
PER_DECIBEL = 2.302585092994046e-4
"""Extinction of power, 1/m, for an attenuation of 1 dB/km: ln 10 / 10 000."""

RAIN_LIGHT = 1.076
RAIN_LIGHT_POWER = 0.67
RAIN_RADAR = 1.13
RAIN_RADAR_POWER = 0.717
"""Attenuation by 1 mm/h of rain, dB/km, and the exponent of its growth with the rain."""

LN_20 = 2.995732273553991
"""Meteorological optical range times extinction: 5 % of a contrast are left."""

WATER_RADAR = 3.15
"""Attenuation by fog at 77 GHz, dB/km for each g/m3 of liquid water."""

WATER_AT_50 = 0.5
WATER_POWER = 1.2850972089384687
"""Liquid water of fog with 50 m of visibility, g/m3, and the exponent of its growth with falling visibility: ln 10 / ln
6.
"""

TWILIGHT = 6.0
"""Depression of the sun at which civil twilight ends, degrees."""

LEAST = 1.0e-12
"""Lower bound, before a power is taken, of the rain in mm/h and of the extinction relative to that at 50 m of
visibility.
"""

HALVINGS = 40
"""How often bisection halves the interval of the equation's solution: from 10 km to 1e-8 m."""


@compiled
def rain_attenuation(rain: float, factor: float, power: float) -> float:
    """Return the extinction by `rain`, mm/h, from its power law in dB/km, 1/m."""
    if rain <= 0.0:
        return 0.0
    return PER_DECIBEL * factor * exp(clip(power * log(max(rain, LEAST)), -50.0, 50.0))


@compiled
def fog_on_radar(extinction: float) -> float:
    """Return the extinction of fog at 77 GHz, 1/m, from its extinction of light, 1/m."""
    if extinction <= 0.0:
        return 0.0
    denser = log(max(50.0 * extinction / LN_20, LEAST))
    water = WATER_AT_50 * exp(clip(WATER_POWER * denser, -50.0, 50.0))
    return PER_DECIBEL * WATER_RADAR * water


@compiled
def seen_through(reach: float, air: float, fog: float, begin: float) -> float:
    """Return the solution d of the equation above for q R = `reach`, m; in clear air this is the reach itself."""
    if reach <= 0.0 or (air <= 0.0 and fog <= 0.0):
        return max(reach, 0.0)
    near = 0.0
    far = reach
    for _ in range(HALVINGS):
        middle = 0.5 * (near + far)
        lost = air * middle + fog * max(middle - begin, 0.0)
        if middle * exp(clip(lost, 0.0, 50.0)) < reach:
            near = middle
        else:
            far = middle
    return 0.5 * (near + far)


@compiled
def lit_reach(reach: float, headlights: float, sun_altitude: float) -> float:
    """Return how far a camera sees in clear air in the present daylight, m."""
    day = clip((sun_altitude + TWILIGHT) / TWILIGHT, 0.0, 1.0)
    return day * reach + (1.0 - day) * min(reach, headlights)


@compiled
def seen_in_weather(p: Program, st: State, kind: int, reach: float, quality: float) -> float:
    """Return how far a sensor of a kind sees in the present weather, m; `quality` is q of the equation above."""
    fog = clip(0.01 * st.weather[W_FOG_DENSITY], 0.0, 1.0)
    dust = clip(0.01 * st.weather[W_DUST_STORM], 0.0, 1.0)
    rain = MM_PER_PERCENT * clip(st.weather[W_PRECIPITATION], 0.0, 100.0)
    begin = max(st.weather[W_FOG_DISTANCE], 0.0)
    haze = haze_extinction(fog, st.weather[W_FOG_FALLOFF], 0.0)
    if kind == op.SENSOR_RADAR:
        wet = rain_attenuation(rain, RAIN_RADAR, RAIN_RADAR_POWER)
        return seen_through(quality * reach, 0.5 * wet, 0.5 * fog_on_radar(haze), begin)
    if kind == op.SENSOR_CAMERA:
        reach = lit_reach(reach, p.const[slot.K_HEADLIGHTS], st.weather[W_SUN_ALTITUDE])
    wet = rain_attenuation(rain, RAIN_LIGHT, RAIN_LIGHT_POWER)
    return seen_through(quality * reach, wet + haze_extinction(0.0, 0.0, dust), haze, begin)


@compiled
def reach_in_weather(p: Program, st: State, quality: float) -> float:
    """Return how far the forward sensor sees in the present weather, m; `quality` is q of the equation above."""
    return seen_in_weather(p, st, p.forward_sensor[0], p.const[slot.K_SENSOR_RANGE], quality)


@compiled
def driver_sight(p: Program, st: State) -> float:
    """Return how far the driver sees now, m: like a camera of that range. The value is kept while the weather lasts."""
    if st.sight_known[0] == 0:
        st.sight_known[0] = 1
        st.driver_sight[0] = seen_in_weather(p, st, op.SENSOR_CAMERA, p.const[slot.K_SIGHT], 1.0)
    return st.driver_sight[0]


@compiled
def quality_of_sensor(p: Program, health: float) -> float:
    """Return q of the equation above: what noise and faults leave of the sensor's range.

    The received power falls with d^4 for a radar; for a lidar, the power of the detector's current does.
    """
    if p.forward_sensor[0] != op.SENSOR_CAMERA:
        return exp(clip(-p.const[slot.K_SENSOR_NOISE] * LN_10 / 40.0, -50.0, 50.0))
    best = noise_health(0.0) * tones_health(WHITE) * blur_health(measured_blur(0.0)) * dirt_health(0.0)
    return clip(health / max(best, 0.5), 0.0, 1.0)


@compiled
def sensor_reach(p: Program, st: State) -> float:
    """Return how far the forward sensor sees now, m; computed again only if the weather or the camera has changed."""
    health = health_of_camera(p, st) if p.forward_sensor[0] == op.SENSOR_CAMERA else 1.0
    if st.reach_known[0] == 0 or health != st.reach_health[0]:
        st.reach_known[0] = 1
        st.reach_health[0] = health
        st.sensor_reach[0] = reach_in_weather(p, st, quality_of_sensor(p, health))
    return st.sensor_reach[0]


@compiled
def look_with_sensor(n: RoadTables, p: Program, st: State, i: int) -> None:
    """Look ahead as far as the forward sensor sees now."""
    reach = sensor_reach(p, st)
    look_ahead(n, p, st, i, reach, p.const[slot.K_FIELD_OF_VIEW])
